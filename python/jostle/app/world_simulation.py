"""`jostle.World` as the app sees it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle.app.simulation import Container, Facts, Frame, Point, Rect, TreeBoxes

Rules = Literal["quadtree", "brute"]

TIME_STEP = 1 / 60
BRUTE_LIMIT = 30_000  # above it one step of brute force would freeze the window for seconds
PULL_TIME = 0.04  # seconds in which a held particle covers the way to the cursor
SPEED_LIMIT = 4.0  # a held particle's speed, in diagonals of the view a second
MIN_REACH = 1e-6  # of the view's diagonal: a one-point tree needs some radius to overlap a disc


class WorldSimulation:
    """A world with right physics.

    Parameters
    ----------
    scene
        The name to show.
    view
        The part of the world to look at: min_x, min_y, max_x, max_y.
    create
        Makes the world in its first state: called now, and at every restart.
    """

    time_step = TIME_STEP

    def __init__(self, scene: str, view: Rect, create: Callable[[], jostle.World]) -> None:
        self.scene = scene
        self.view = view
        self._create = create
        self._take(create())

    @classmethod
    def of_scene(
        cls,
        scene: str,
        n: int | None = None,
        *,
        seed: int = 0,
        method: Rules = "quadtree",
        leaf_capacity: int | None = None,
        max_depth: int | None = None,
    ) -> WorldSimulation:
        """Return a scene of `jostle.scenes`; None leaves a choice to the scene."""

        def create() -> jostle.World:
            world = jostle.scenes.create(scene, n=n, seed=seed)
            world.method = method
            if leaf_capacity is not None:
                world.leaf_capacity = leaf_capacity
            if max_depth is not None:
                world.max_depth = max_depth
            return world

        return cls(scene, jostle.scenes.view(scene, n), create)

    def _take(self, world: jostle.World) -> None:
        self.world = world
        # While their number stays, these columns do: a picture of a million need not copy them.
        self._radii: NDArray[np.float32] = world.radii
        self._movable: NDArray[np.bool_] = world.movable
        masses, areas = world.masses, self._radii**2
        self._densities = np.divide(masses, areas, out=np.zeros_like(masses), where=areas > 0)

    def __len__(self) -> int:
        return len(self.world)

    @property
    def method(self) -> str:
        """Return "quadtree" or "brute"."""
        return self.world.method

    @property
    def container(self) -> Container:
        """Return the world's walls."""
        return self.world.container

    @property
    def stage_times(self) -> dict[str, float]:
        """Return milliseconds for each stage of the last step."""
        return dict(self.world.profile)

    def step(self) -> None:
        """Go on by 1/60 s."""
        self.world.step(self.time_step)
        if len(self.world) != len(self._radii):  # some have merged
            self._take(self.world)

    def restart(self) -> None:
        """Go back to the first state; the method stays as it is."""
        method = self.world.method
        self._take(self._create())
        self.world.method = method

    def switch_method(self) -> str | None:
        """Swap brute force and tree; refused where brute force would freeze the window."""
        if self.method == "brute":
            self.world.method = "quadtree"
        elif len(self) > BRUTE_LIMIT:
            return f"Brute force is too slow to watch above {BRUTE_LIMIT:,} particles."
        else:
            self.world.method = "brute"
        return None

    def frame(self) -> Frame:
        """Return copies of the columns a picture needs."""
        world = self.world
        return Frame(world.positions, world.velocities, self._radii, self._densities, self._movable)

    def facts(self) -> Facts:
        """Return the numbers of the last step."""
        world = self.world
        return Facts(world.stats.tests, len(world.contacts.pairs), world.kinetic_energy)

    def tree_boxes(self) -> TreeBoxes:
        """Build a tree over the present positions, with the world's settings, for its boxes."""
        nodes = self._tree().nodes()
        return TreeBoxes(
            np.asarray(nodes.boxes, np.float64), np.asarray(nodes.depths, np.intp), nodes.is_leaf
        )

    def _tree(self) -> jostle.Quadtree:
        world = self.world
        return jostle.Quadtree(
            world.positions,
            self._radii,
            leaf_capacity=world.leaf_capacity,
            max_depth=world.max_depth,
        )

    def pick(self, point: Point, reach: float) -> int | None:
        """Ask the tree which movable particles overlap a small disc, and take the nearest."""
        reach = max(reach, MIN_REACH * self._diagonal())
        hits = self._tree().pairs(jostle.Quadtree(np.array([point], np.float32), reach))[:, 0]
        hits = hits[self._movable[hits]]
        if len(hits) == 0:
            return None
        gaps = np.hypot(*(self.world.positions[hits] - point).T) - self._radii[hits]
        return int(hits[np.argmin(gaps)])

    def pull(self, particle: int, point: Point) -> None:
        """Set the velocity that brings the particle to the hand, like a stiff damped spring.

        A velocity, not a position: so the particle still pushes what is in its way.
        """
        way = np.array(point) - self.world.positions[particle]
        if isinstance(self.container, jostle.Torus):
            sides = np.array([self.container.width, self.container.height])
            way -= sides * np.round(way / sides)  # the short way, across a seam if need be
        self._throw(particle, way / PULL_TIME)

    def release(self, particle: int, velocity: Point) -> None:
        """Let go of the particle: it keeps the hand's velocity."""
        self._throw(particle, np.array(velocity))

    def _throw(self, particle: int, velocity: NDArray[np.float64]) -> None:
        limit = SPEED_LIMIT * self._diagonal()
        speed = math.hypot(*velocity)
        if speed > limit:
            velocity = velocity * (limit / speed)
        self.world.set([particle], velocities=[velocity])

    def _diagonal(self) -> float:
        min_x, min_y, max_x, max_y = self.view
        return math.hypot(max_x - min_x, max_y - min_y)
