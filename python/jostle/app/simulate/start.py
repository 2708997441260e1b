"""Making a simulation: from settings, from a saved state, from one with other rules.

`SceneLoader` makes it on a worker thread, while the present one is shown.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from jostle.app.simulate.article_simulation import ArticleSimulation, Simulation
from jostle.app.simulate.containers import bounds, directions, free_positions
from jostle.app.simulate.engine import REFUSALS, Then, message_of
from jostle.app.simulate.settings import Group, Settings, too_slow
from jostle.app.simulate.simulation import Container, Frame, FrameRequest, Rect
from jostle.app.simulate.worker import Worker
from jostle.app.simulate.world_simulation import WorldSimulation


def start(settings: Settings) -> Simulation:
    """Return the simulation that the settings describe, in its first state.

    A setting that is refused, or a group of particles that does not fit between the walls, raises a
    ValueError.
    """
    simulation: Simulation
    if settings.by_article:
        simulation = ArticleSimulation(settings)
    else:
        simulation = WorldSimulation.of_scene(settings)
        simulation.add_own_walls(settings.walls)
    for number, group in enumerate(settings.particles):
        name = f"particles[{number}]"
        _require_space(name, group, simulation.frame().container)
        try:
            _scatter(simulation, group, np.random.default_rng([settings.seed, number]))
        except ValueError as error:
            raise ValueError(f"{name} cannot be added: {error}") from error
    return simulation


def resume(settings: Settings, state: bytes) -> Simulation:
    """Return the simulation that continues from a state of one with these settings."""
    # The state contains its own particles and walls.
    empty = start(replace(settings, n=0, particles=(), walls=()))
    empty.load(state)
    return empty


def _require_space(name: str, group: Group, container: Container) -> None:
    """Raise a ValueError if a group is too large for the walls, or outside them."""
    walls = bounds(container)
    if walls is None or not group.count:
        return
    x0, y0, x1, y1 = walls
    words = f"the walls, from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g})"
    smallest, largest = group.radius
    if 2 * largest > min(x1 - x0, y1 - y0):
        raise ValueError(f"{name}.radius is {largest:g}; a disc must fit between {words}")
    if group.region is not None:
        left, top, right, bottom = group.region
        if right < x0 or left > x1 or bottom < y0 or top > y1:
            region = ", ".join(f"{side:g}" for side in group.region)
            raise ValueError(f"{name}.region is [{region}]; it must overlap {words}")
    if group.count * math.pi * smallest**2 > (x1 - x0) * (y1 - y0):
        why = f"discs of radius {smallest:g} at least need more area than there is between {words}"
        raise ValueError(f"{name}.count is {group.count}; {why}")


def _scatter(simulation: Simulation, group: Group, rng: np.random.Generator) -> None:
    """Add the particles of a group at free positions, which depend only on the seed."""
    count, frame = group.count, simulation.frame()
    region = group.region or simulation.view
    radii = rng.uniform(*group.radius, count)
    free, found = free_positions(
        frame.positions, frame.radii, radii, frame.container, region,
        int(rng.integers(2**31)), frame.walls,
    )  # fmt: skip
    places = rng.uniform(region[:2], region[2:], (count, 2))
    places[found] = free  # the others overlap, and the first steps push them apart
    spread = rng.uniform(*group.speed, count)[:, None] * directions(rng, count)
    densities = rng.uniform(*group.density, count)
    velocities = np.array(group.velocity) + spread
    simulation.add(
        places, velocities, radii, densities, movable=group.movable, sensors=group.sensor,
        categories=group.categories, masks=group.masks,
    )  # fmt: skip


def switch_rules(
    settings: Settings, frame: Frame, view: Rect, before: Frame | None = None
) -> Simulation:
    """Return the simulation of other settings, in the state of a frame if possible.

    If particles were added or removed, the scene begins anew. The article's display is at the
    origin, so positions are shifted by the corner of the view. The article's particles are all
    movable and have no collision filter, so those of a world are those of `before`, its last frame,
    if there is one. Too many particles for the method raise a ValueError.
    """
    if reason := too_slow(settings.method, len(frame)):
        raise ValueError(reason)
    simulation = start(settings)
    own = simulation.frame()
    if np.array_equal(own.tags, frame.tags):
        if before is not None and np.array_equal(before.tags, own.tags):
            own = before
        corner = np.array(simulation.view[:2]) - np.array(view[:2])
        simulation.change(
            frame.tags,
            positions=frame.positions + corner,
            velocities=np.where(own.movable[:, None], frame.velocities, own.velocities),
            movable=own.movable,
            categories=own.categories,
            masks=own.masks,
        )
    return simulation


# On a worker thread

Create = Callable[[], Simulation]

MESSAGE_DELAY = 0.3  # seconds after which a message is shown


@dataclass(frozen=True)
class LoadedScene:
    """A simulation in its initial state, with its first frame and its state as bytes."""

    simulation: Simulation
    frame: Frame
    state: bytes


class SceneLoader:
    """Makes one simulation at a time."""

    def __init__(self, *, synchronous: bool = False) -> None:
        # Those of the simulation in progress, unless it is read from a file.
        self.settings: Settings | None = None
        self._message, self._began = "", 0.0
        self._then: Then | None = None
        self._worker = Worker("jostle-load", synchronous=synchronous)
        self._job: Future[LoadedScene] | None = None

    @property
    def message(self) -> str:
        """Return the message to show meanwhile, or an empty string."""
        late = time.perf_counter() - self._began >= MESSAGE_DELAY
        return self._message if self._job is not None and late else ""

    def start(
        self,
        create: Create,
        request: FrameRequest,
        message: str,
        settings: Settings | None = None,
        then: Then | None = None,
    ) -> None:
        """Begin to make a simulation; one in progress is cancelled.

        `then` is called after it has replaced the present one.
        """
        self.cancel()
        self.settings, self._then = settings, then
        self._message, self._began = message, time.perf_counter()
        self._job = self._worker.submit(partial(load, create, request))

    def cancel(self) -> None:
        """Discard the simulation in progress; its thread ends by itself."""
        if self._job is not None and not (self._job.done() or self._job.cancel()):
            self._worker.abandon()
        self._job = self.settings = self._then = None

    def take(self) -> tuple[LoadedScene, Then | None] | str | None:
        """Return a finished simulation, or an error message, once; None if there is none."""
        if self._job is None or not self._job.done():
            return None
        job, then = self._job, self._then
        self.cancel()
        try:
            return job.result(), then
        except REFUSALS as error:
            return message_of(error)

    def wait(self) -> None:
        if self._job is not None:
            self._job.exception()


def load(create: Create, request: FrameRequest) -> LoadedScene:
    simulation = create()
    return LoadedScene(simulation, simulation.frame(request), simulation.save())


def expected(settings: Settings) -> int:
    """Return the number of particles that the settings name; the defaults of scenes are small."""
    return (settings.n or 0) + sum(group.count for group in settings.particles)
