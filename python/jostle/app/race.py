"""Two methods side by side on the same scene, each as fast as possible, up to real time."""

from __future__ import annotations

from dataclasses import replace

import pygame

from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import ACCENT, PANEL_EDGE, TEXT, TEXT_SOFT
from jostle.app.draw.picture import Picture
from jostle.app.draw.shown import Shown
from jostle.app.draw.text import BODY, SMALL, font, panel, write
from jostle.app.draw.words import method_name, scientific
from jostle.app.simulate.engine import SHORT, Engine
from jostle.app.simulate.simulation import Facts, Wants
from jostle.app.simulate.start import start

SHORT_IN_RACE = 0.004  # seconds: longer steps are made beside the window, for there are two
# Particles that a method may have in a race: more, and a step would take longer than a second.
MOST = {"brute": 30_000, "article-quadtree": 8_000, "article-brute": 1_500}
SMOOTH = 0.2  # share of a new measurement
EVERY = 0.2  # seconds between new numbers: faster ones cannot be read
PAD, EDGE, WIDEST = 12, 12, 420  # pixels


def refusal(left: str, right: str, n: int) -> str | None:
    """Return why two methods cannot race with n particles, or nothing."""
    if left == right:
        return f"A race needs two methods, and {method_name(left)} runs already."
    for method in (left, right):
        most = MOST.get(method, n)
        if n > most:
            return f"With more than {most:,} particles {method_name(method)} is too slow to race."
    return None


class Lane:
    """One of the two: an engine, and what it has done since the start."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._first = self.engine.steps
        self._seen = 0
        self.milliseconds = 0.0

    @property
    def steps(self) -> int:
        """Return the steps since the start."""
        return self.engine.steps - self._first

    def measure(self) -> None:
        """Take in the time of the last step, if there is a new one."""
        steps, new = self.steps, self.engine.last_seconds * 1e3
        if steps > self._seen:
            share = SMOOTH if self._seen else 1.0
            self.milliseconds += share * (new - self.milliseconds)
            self._seen = steps

    @property
    def facts(self) -> Facts:
        """Return the numbers of the last step."""
        return self.engine.frame.facts


class Race:
    """A second engine on the same scene, and the picture of both.

    What a hand does is done to the left one alone; with other settings a new race begins.

    Parameters
    ----------
    left
        The engine that runs already; it has just begun.
    method
        Of the other.
    """

    def __init__(self, left: Engine, method: str) -> None:
        self.method = method
        left.short = SHORT_IN_RACE
        self.engine = Engine(start(replace(left.settings, method=method)), SHORT_IN_RACE)
        self.lanes = Lane(left), Lane(self.engine)
        self._picture = Picture()
        self._sheets: list[pygame.Surface] = []
        self._due = 0.0

    def advance(self, elapsed: float, wants: Wants) -> None:
        """Let the right one go on by simulated seconds, or fall behind; the left one has."""
        wants = replace(wants, energies=True)
        changed, self.engine.wants = wants != self.engine.wants, wants
        steps = self.engine.advance(elapsed)
        if changed and not steps:
            self.engine.look()
        for lane in self.lanes:
            lane.measure()

    def close(self) -> None:
        """Let the left one run alone again."""
        self.lanes[0].engine.short = SHORT
        self.engine.abandon()

    # The picture

    def draw(
        self, painter: Painter, picture: Picture, camera: Camera, shown: Shown, now: float
    ) -> None:
        """Draw both halves, what each has done over it, and a line between them."""
        width, height = camera.size
        middle = round(camera.column_edge(1))
        halves = pygame.Rect(0, 0, middle, height), pygame.Rect(middle, 0, width - middle, height)
        left, right = (lane.engine for lane in self.lanes)
        shift = right.view[0] - left.view[0], right.view[1] - left.view[1]
        picture.draw(painter, left.frame, camera, shown, halves[0])
        self._picture.draw(painter, right.frame, camera.column(1, shift), shown, halves[1])
        painter.clip(pygame.Rect(middle - 1, 0, 1, height))
        painter.fill(PANEL_EDGE)
        painter.clip(None)
        if now >= self._due or not self._sheets:
            self._due = now + EVERY
            self._sheets = self._headings(round(camera.column_width) - 2 * EDGE)
        starts = round(camera.column_edge(1) - camera.column_width), middle
        for sheet, edge in zip(self._sheets, starts, strict=True):
            inset = (camera.column_width - sheet.get_width()) / 2
            painter.sheet(sheet, (edge + inset, EDGE))

    def _headings(self, width: int) -> list[pygame.Surface]:
        times = [lane.facts.time for lane in self.lanes]
        return [
            _heading(lane, ahead=time > 1.02 * min(times), width=min(width, WIDEST))
            for lane, time in zip(self.lanes, times, strict=True)
        ]


def _heading(lane: Lane, *, ahead: bool, width: int) -> pygame.Surface:
    """Return the card over a half: the method, and what it has done."""
    line, small = font(BODY).get_linesize(), font(SMALL).get_linesize()
    sheet = panel((max(width, 64), 2 * PAD + line + 2 * small + 8))
    write(sheet, (PAD, PAD), method_name(lane.engine.settings.method), TEXT, BODY)
    if ahead:
        write(sheet, (width - PAD, PAD), "ahead", ACCENT, BODY, flush_right=True)
    facts = [
        ("steps", f"{lane.steps:,}"),
        ("ms a step", f"{lane.milliseconds:,.2f}"),
        ("simulated", f"{lane.facts.time:.1f} s"),
        ("kinetic", scientific(lane.facts.kinetic_energy)),
    ]
    column = (width - 2 * PAD) // len(facts)
    for k, (name, value) in enumerate(facts):
        x = PAD + k * column
        write(sheet, (x, PAD + line + 4), name, TEXT_SOFT, SMALL)
        write(sheet, (x, PAD + line + 4 + small), value, TEXT, SMALL)
    return sheet
