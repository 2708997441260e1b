"""The article's own programs in the same window: `jostle.article.Simulation` as the app sees it."""

from __future__ import annotations

import math
import time

import numpy as np

import jostle
from jostle import article
from jostle.app.simulation import Facts, Frame, Point, Rect, TreeBoxes
from jostle.app.world_simulation import WorldSimulation

FRAMES_A_SECOND = 30  # the article counts in frames; this is how fast its window showed them
DEFAULT_N = 500


class ArticleSimulation:
    """A scene under the article's rules, faults included.

    The scene `article` is the article's own program. Any other lends its particles: their places,
    velocities and sizes, on whole pixels, inside a plain rectangle.

    Parameters
    ----------
    scene, n, seed
        As for `jostle.scenes.create`.
    method
        "article-quadtree" or "article-brute".
    """

    time_step = 1 / FRAMES_A_SECOND

    def __init__(
        self,
        scene: str = "article",
        n: int | None = None,
        *,
        seed: int = 0,
        method: str = "article-quadtree",
    ) -> None:
        self.scene = scene
        self._start = (n, seed)
        self._build(method.removeprefix("article-"))

    def _build(self, rules: str) -> None:
        n, seed = self._start
        if self.scene == "article":
            n = DEFAULT_N if n is None else n
            self.program = article.Simulation(n, rules, seed)
        else:
            lender = WorldSimulation.of_scene(self.scene, n, seed=seed)
            self.program = article_of(lender.frame(), lender.view, rules)
        width, height = self.program.width, self.program.height
        self.view = (0.0, 0.0, float(width), float(height))
        self.container = jostle.Box(*self.view)
        self._milliseconds = 0.0

    def __len__(self) -> int:
        return len(self.program.particles)

    @property
    def method(self) -> str:
        """Return "article-quadtree" or "article-brute"."""
        return f"article-{self.program.method}"

    @property
    def stage_times(self) -> dict[str, float]:
        """Return the whole frame as one stage: the article's stages are interwoven."""
        return {"frame": self._milliseconds}

    def step(self) -> None:
        """Go on by one frame of the article."""
        start = time.perf_counter()
        self.program.frame()
        self._milliseconds = (time.perf_counter() - start) * 1e3

    def restart(self) -> None:
        """Go back to the first state; the method stays as it is."""
        self._build(self.program.method)

    def switch_method(self) -> str | None:
        """Swap the article's two programs under the same particles."""
        self.program.method = "brute" if self.program.method == "quadtree" else "quadtree"
        return None

    def frame(self) -> Frame:
        """Return the particles as arrays."""
        rows = [
            (p.x, p.y, p.speed * math.sin(p.angle), -p.speed * math.cos(p.angle), p.radius,
             p.density) for p in self.program.particles
        ]  # fmt: skip
        table = np.array(rows, np.float32).reshape(-1, 6)
        return Frame(
            positions=table[:, 0:2],
            velocities=table[:, 2:4] * FRAMES_A_SECOND,
            radii=table[:, 4],
            densities=table[:, 5],
            movable=np.ones(len(table), np.bool_),
        )

    def facts(self) -> Facts:
        """Return the numbers of the last frame; a pair met in two leaves counts twice."""
        energy = sum(0.5 * p.mass * p.speed**2 for p in self.program.particles)
        program = self.program
        return Facts(program.tests, program.hits, energy * FRAMES_A_SECOND**2)

    def tree_boxes(self) -> TreeBoxes:
        """Return the leaves of the last frame; brute force has none."""
        if not self.program.leaves:
            return TreeBoxes.none()
        leaves = np.array(self.program.leaves)
        corners = np.concatenate([leaves[:, :2], leaves[:, :2] + leaves[:, 2:4]], axis=1)
        return TreeBoxes(
            corners.astype(np.float64), leaves[:, 4].astype(np.intp), np.ones(len(leaves), bool)
        )

    def pick(self, point: Point, reach: float) -> int | None:
        """Take the first particle in the order of the list under the point, as the article."""
        held = self.program.grab(*point)
        return None if held is None else self.program.particles.index(held)

    def pull(self, particle: int, point: Point) -> None:
        """Let the held particle follow, by the article's rule of the mouse."""
        self.program.drag_to(*point)

    def release(self, particle: int, velocity: Point) -> None:
        """Let go: in the article the particle just keeps the speed of its last pull."""
        self.program.release()


def article_of(frame: Frame, view: Rect, rules: str) -> article.Simulation:
    """Return the article's program over the particles of a frame.

    Its display is the view, and everything is moved there; radii and densities become whole
    numbers of at least 1, as the article has them.
    """
    min_x, min_y, max_x, max_y = view
    places = (frame.positions - np.array([min_x, min_y])).tolist()
    velocities = (frame.velocities / FRAMES_A_SECOND).tolist()
    radii = np.maximum(np.rint(frame.radii), 1).astype(int).tolist()
    densities = np.maximum(np.rint(frame.densities), 1).astype(int).tolist()
    particles = [
        article.Particle(x, y, radius, density, math.hypot(dx, dy), math.atan2(dx, -dy))
        for (x, y), (dx, dy), radius, density in zip(
            places, velocities, radii, densities, strict=True
        )
    ]
    width, height = (
        max(math.ceil(side), article.SMALLEST_SIDE) for side in (max_x - min_x, max_y - min_y)
    )
    return article.Simulation.of(particles, rules, width=width, height=height)
