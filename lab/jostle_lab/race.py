"""Comparison of two methods on the same scene, each as fast as possible.

One of them may be a program of the article of 2015, with its own physics.
"""

import math
import time
from dataclasses import dataclass, replace

import numpy as np
import pygame
from numpy.typing import NDArray

import jostle
from jostle_lab import article
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import ACCENT, PANEL_EDGE, TEXT, TEXT_SOFT
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.text import BODY, SMALL, font, panel, scientific, write
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.schema import METHODS, MOST_BRUTE, Settings
from jostle_lab.simulate.engine import Engine
from jostle_lab.simulate.frame import Frame, FrameRequest, Rect, StepStats
from jostle_lab.simulate.simulation import Inputs, Simulation
from jostle_lab.simulate.start import start

# Names of the methods that can be compared.
RIVALS = METHODS | {
    "article-quadtree": "article's quadtree",
    "article-brute": "article's brute force",
}
# Largest numbers of particles; with more a step takes longer than a second.
MOST = {"brute": MOST_BRUTE, "article-quadtree": 8_000, "article-brute": 1_500}
EVERY = 0.2  # seconds between updates of the numbers
PAD, EDGE, WIDEST = 12, 12, 420  # pixels


def refusal(left: str, right: str, n: int) -> str | None:
    """Return why two methods cannot be compared with n particles, or None."""
    if left == right:
        return f"A comparison needs two methods, and {RIVALS[left]} runs already."
    for method in (left, right):
        most = MOST.get(method, n)
        if n > most:
            name = RIVALS[method]
            return f"With more than {most:,} particles {name} is too slow for a comparison."
    return None


def article_of(frame: Frame, view: Rect, method: str) -> article.Simulation:
    """Return the article's program over the particles of a frame.

    Its display is the view, from the origin. Radii and densities become whole numbers of at least
    1, as in the article.
    """
    x0, y0, x1, y1 = view
    velocities = frame.velocities / article.FRAME_RATE
    rows = np.column_stack([frame.positions - (x0, y0), frame.radii, frame.densities, velocities])
    particles = [
        article.Particle(
            x, y, max(round(radius), 1), max(round(density), 1), math.hypot(u, v), math.atan2(u, -v)
        )
        for x, y, radius, density, u, v in rows.tolist()
    ]
    width, height = (max(math.ceil(side), article.SMALLEST_SIDE) for side in (x1 - x0, y1 - y0))
    return article.Simulation.of(particles, method, width, height)


class ArticleProgram(Simulation):
    """The particles of a scene in a program of the article; they are only stepped and drawn."""

    time_step = 1 / article.FRAME_RATE

    def __init__(self, settings: Settings, method: str) -> None:
        scene = start(settings)
        super().__init__(Settings(settings.scene), scene.view, scene.world)
        self.program = article_of(scene.frame(), scene.view, method)
        self._corner = np.array(scene.view[:2])
        self._stats = StepStats()

    def step(self, inputs: Inputs = Inputs()) -> None:  # noqa: B008 (it is frozen)
        began, program = time.perf_counter(), self.program
        program.frame()
        self._stats = StepStats(
            time=self._stats.time + self.time_step,
            pairs_tested=program.tests,
            touching=program.hits,
            stage_times={"frame": (time.perf_counter() - began) * 1e3},
        )

    def frame(self, request: FrameRequest = FrameRequest()) -> Frame:  # noqa: B008 (it is frozen)
        rows = [
            (p.x, p.y, p.speed * math.sin(p.angle), -p.speed * math.cos(p.angle), p.radius,
             p.density) for p in self.program.particles
        ]  # fmt: skip
        table, n = np.array(rows, np.float64).reshape(-1, 6), len(rows)
        places = table[:, :2] + self._corner
        velocities = (table[:, 2:4] * article.FRAME_RATE).astype(np.float32)
        radii, densities = table[:, 4:].astype(np.float32).T
        kinetic = 0.5 * (densities * radii**2) @ (velocities**2).sum(axis=1, dtype=np.float64)
        return Frame(
            positions=places.astype(np.float32),
            velocities=velocities,
            radii=radii,
            densities=densities,
            movable=np.ones(n, np.bool_),
            tags=np.arange(n),
            born=np.zeros(n),
            container=jostle.Box(*self.view),
            stats=replace(self._stats, kinetic_energy=float(kinetic)),
            tree=self._leaves(places) if request.tree else None,
        )

    def _leaves(self, places: NDArray[np.float64]) -> jostle.Nodes:
        """Return the leaves of the last frame; brute force has none."""
        leaves = np.array(self.program.leaves, np.int64).reshape(-1, 5)
        low = leaves[:, :2] + self._corner
        high = low + leaves[:, 2:4]
        inside = (places[:, None] >= low) & (places[:, None] < high)
        boxes = np.concatenate([low, high], axis=1)
        leaf = np.ones(len(leaves), np.bool_)
        return jostle.Nodes(boxes, leaves[:, 4], inside.all(axis=2).sum(axis=0), leaf)


def rival(settings: Settings, method: str) -> Simulation:
    """Return the scene of the settings with one of the `RIVALS`."""
    if method in METHODS:
        return start(replace(settings, method="brute" if method == "brute" else "quadtree"))
    return ArticleProgram(settings, method.removeprefix("article-"))


@dataclass(frozen=True)
class Contestant:
    """One of the two engines, with its steps since the start."""

    method: str
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
        self.engine = Engine(rival(left.settings, method), synchronous=left.synchronous)
        self.contestants = (
            Contestant(left.settings.method, left, left.steps), Contestant(method, self.engine, 0)
        )  # fmt: skip
        left.unlimited = self.engine.unlimited = True
        self._picture = Picture()
        self._sheets: list[pygame.Surface] = []
        self._due = 0.0

    def advance(self, elapsed: float, request: FrameRequest) -> None:
        """Advance the second engine for seconds of real time, after the first."""
        if request != self.engine.request:
            self.engine.request = request
            self.engine.refresh()
        self.engine.advance(elapsed, Inputs(), paused=elapsed == 0)

    def close(self) -> None:
        self.contestants[0].engine.unlimited = False
        self.engine.abandon()
        self.engine.close()

    # Drawing

    def draw(
        self, painter: Painter, picture: Picture, camera: Camera, options: ViewOptions, now: float
    ) -> None:
        """Draw both halves with a heading each, and a line between them."""
        width, height = camera.size
        middle = round(camera.column_edge(1))
        halves = pygame.Rect(0, 0, middle, height), pygame.Rect(middle, 0, width - middle, height)
        left, right = (contestant.engine for contestant in self.contestants)
        picture.draw(painter, left.frame, camera, options, halves[0])
        self._picture.draw(painter, right.frame, camera.column(1), options, halves[1])
        painter.clip(pygame.Rect(middle - 1, 0, 1, height))
        painter.fill(PANEL_EDGE)
        painter.clip(None)
        if now >= self._due or not self._sheets:
            self._due = now + EVERY
            across = min(round(camera.column_width) - 2 * EDGE, WIDEST)
            slowest = min(each.stats.time for each in self.contestants)
            self._sheets = [
                _heading(each, each.stats.time / slowest if slowest else 1.0, across)
                for each in self.contestants
            ]
        starts = round(camera.column_edge(1) - camera.column_width), middle
        for sheet, edge in zip(self._sheets, starts, strict=True):
            inset = (camera.column_width - sheet.get_width()) / 2
            painter.sheet(sheet, (edge + inset, EDGE))


def _heading(contestant: Contestant, ahead: float, width: int) -> pygame.Surface:
    """Return the heading of a half: the method and its numbers."""
    line, small = font(BODY).get_linesize(), font(SMALL).get_linesize()
    sheet = panel((max(width, 64), 2 * PAD + line + 2 * small + 8))
    write(sheet, (PAD, PAD), RIVALS[contestant.method], TEXT, BODY)
    if ahead > 1.02:
        words = f"{ahead:,.1f} × faster"
        write(sheet, (width - PAD, PAD), words, ACCENT, BODY, flush_right=True)
    numbers = {
        "steps": f"{contestant.steps:,}",
        "ms per step": f"{contestant.engine.step_seconds * 1e3:,.2f}",
        "simulated": f"{contestant.stats.time:.1f} s",
        "kinetic": scientific(contestant.stats.kinetic_energy),
    }
    for k, (name, value) in enumerate(numbers.items()):
        x = PAD + k * (width - PAD) // len(numbers)
        write(sheet, (x, PAD + line + 4), name, TEXT_SOFT, SMALL)
        write(sheet, (x, PAD + line + 4 + small), value, TEXT, SMALL)
    return sheet
