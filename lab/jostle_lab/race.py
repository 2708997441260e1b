"""Comparison of two methods on the same scene, each as fast as possible up to real time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pygame

from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import ACCENT, PANEL_EDGE, TEXT, TEXT_SOFT
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.text import BODY, SMALL, font, panel, scientific, write
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.simulate.engine import Engine
from jostle_lab.simulate.settings import METHODS, MOST_RUNNING
from jostle_lab.simulate.simulation import FrameRequest, StepStats
from jostle_lab.simulate.start import start

# Largest numbers of particles; with more a step takes longer than a second.
MOST = {"brute": MOST_RUNNING["brute"], "article-quadtree": 8_000, "article-brute": 1_500}
EVERY = 0.2  # seconds between updates of the numbers
PAD, EDGE, WIDEST = 12, 12, 420  # pixels


def refusal(left: str, right: str, n: int) -> str | None:
    """Return why two methods cannot be compared with n particles, or None."""
    if left == right:
        return f"A comparison needs two methods, and {METHODS[left]} runs already."
    for method in (left, right):
        most = MOST.get(method, n)
        if n > most:
            name = METHODS[method]
            return f"With more than {most:,} particles {name} is too slow for a comparison."
    return None


@dataclass(frozen=True)
class Contestant:
    """One of the two engines, with its steps since the start."""

    engine: Engine
    first: int  # steps before the start

    @property
    def steps(self) -> int:
        return self.engine.steps - self.first

    @property
    def stats(self) -> StepStats:
        return self.engine.frame.stats


class Race:
    """A second engine on the same scene, drawn next to the first, which is in its initial state.

    Mouse actions affect only the first; a change of settings begins a new comparison.
    """

    def __init__(self, left: Engine, method: str) -> None:
        self.method = method
        settings = replace(left.settings, method=method)
        self.engine = Engine(start(settings), synchronous=left.synchronous)
        self.contestants = Contestant(left, left.steps), Contestant(self.engine, 0)
        self._picture = Picture()
        self._sheets: list[pygame.Surface] = []
        self._due = 0.0

    def advance(self, elapsed: float, request: FrameRequest) -> None:
        """Advance the second engine by simulated seconds, after the first."""
        request = replace(request, energies=True)
        changed, self.engine.request = request != self.engine.request, request
        steps = self.engine.advance(elapsed)
        if changed and not steps:
            self.engine.refresh()

    def close(self) -> None:
        self.engine.abandon()

    # Drawing

    def draw(
        self, painter: Painter, picture: Picture, camera: Camera, options: ViewOptions, now: float
    ) -> None:
        """Draw both halves with a heading each, and a line between them."""
        width, height = camera.size
        middle = round(camera.column_edge(1))
        halves = pygame.Rect(0, 0, middle, height), pygame.Rect(middle, 0, width - middle, height)
        left, right = (contestant.engine for contestant in self.contestants)
        shift = right.view[0] - left.view[0], right.view[1] - left.view[1]
        picture.draw(painter, left.frame, camera, options, halves[0])
        self._picture.draw(painter, right.frame, camera.column(1, shift), options, halves[1])
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
        times = [contestant.stats.time for contestant in self.contestants]
        return [
            _heading(contestant, ahead=time > 1.02 * min(times), width=min(width, WIDEST))
            for contestant, time in zip(self.contestants, times, strict=True)
        ]


def _heading(contestant: Contestant, *, ahead: bool, width: int) -> pygame.Surface:
    """Return the heading of a half: the method and its numbers."""
    line, small = font(BODY).get_linesize(), font(SMALL).get_linesize()
    sheet = panel((max(width, 64), 2 * PAD + line + 2 * small + 8))
    write(sheet, (PAD, PAD), METHODS[contestant.engine.settings.method], TEXT, BODY)
    if ahead:
        write(sheet, (width - PAD, PAD), "ahead", ACCENT, BODY, flush_right=True)
    numbers = [
        ("steps", f"{contestant.steps:,}"),
        ("ms per step", f"{contestant.engine.step_seconds * 1e3:,.2f}"),
        ("simulated", f"{contestant.stats.time:.1f} s"),
        ("kinetic", scientific(contestant.stats.kinetic_energy)),
    ]
    columns = [max(font(SMALL).size(text)[0] for text in number) for number in numbers]
    gap, x = (width - 2 * PAD - sum(columns)) / (len(numbers) - 1), float(PAD)
    for (name, value), column in zip(numbers, columns, strict=True):
        write(sheet, (round(x), PAD + line + 4), name, TEXT_SOFT, SMALL)
        write(sheet, (round(x), PAD + line + 4 + small), value, TEXT, SMALL)
        x += column + gap
    return sheet
