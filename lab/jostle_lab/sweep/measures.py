"""What is measured in a run: a measure reads the world after each step and returns a number."""

from collections.abc import Callable
from functools import partial
from typing import Protocol

import numpy as np

import jostle

__all__ = ["MEASURES", "Measure"]

#: Steps between two samples of measures that look at the whole world.
_EVERY = 10


class Measure(Protocol):
    """A number that is measured during a run."""

    def see(self, world: jostle.World, step: int, dt: float) -> None:
        """Look at the world after a step."""

    def value(self) -> float:
        """Return the mean over the steps that were seen; NaN if it is not defined."""


class _Mean:
    """The mean of a function of the world, which is sampled at every tenth step."""

    def __init__(self, function: Callable[[jostle.World], float]) -> None:
        self._function = function
        self._sum, self._count = 0.0, 0

    def see(self, world: jostle.World, step: int, dt: float) -> None:
        if step % _EVERY == 0:
            self._sum += self._function(world)
            self._count += 1

    def value(self) -> float:
        return self._sum / self._count if self._count else float("nan")


def _energy(world: jostle.World) -> float:
    """Mean kinetic energy of a movable particle."""
    return world.kinetic_energy() / max(int(world.movable.sum()), 1)


def _height(world: jostle.World) -> float:
    """Mean of y of the movable particles, weighted by mass."""
    moving = world.movable
    if not moving.any():
        return float("nan")
    return float(np.average(world.positions[moving, 1], weights=world.masses[moving]))


def _hexatic(world: jostle.World) -> float:
    """Global hexatic order |⟨exp(6iθ)⟩| over the directions to the six nearest neighbours."""
    positions = world.positions[world.movable].astype(np.float64)
    count = min(7, len(positions))
    if count < 2:
        return float("nan")
    tree = jostle.Quadtree(positions, period=world.period)
    near = tree.nearest(positions, count).ids[:, 1:]
    offsets = positions[near] - positions[:, None]
    if world.period is not None:
        offsets -= world.period * np.round(offsets / world.period)
    x, y = np.moveaxis(offsets, -1, 0)
    return float(np.abs(np.exp(6j * np.arctan2(y, x)).mean()))


def _cluster(world: jostle.World) -> float:
    """Share of the movable particles in the largest group of touching ones."""
    positions, radii = world.positions[world.movable], world.radii[world.movable]
    parents = np.arange(len(positions))
    for a, b in jostle.find_pairs(positions, radii * 1.001, period=world.period):
        a, b = _root(parents, a), _root(parents, b)
        parents[max(a, b)] = min(a, b)
    roots = [_root(parents, row) for row in range(len(parents))]
    return float(np.bincount(roots).max() / len(roots)) if roots else float("nan")


def _root(parents: np.ndarray, row: int) -> int:
    while parents[row] != row:
        parents[row] = row = parents[parents[row]]
    return int(row)


class _Pressure:
    """Impulses on the sides of the container, over their length and the time."""

    def __init__(self) -> None:
        self._impulses, self._seconds, self._length = 0.0, 0.0, float("nan")

    def see(self, world: jostle.World, step: int, dt: float) -> None:
        self._length = _perimeter(world.container)
        touched = world.last_step.wall_contacts
        self._impulses += float(touched.normal_impulses[touched.walls < 0].sum(dtype=np.float64))
        self._seconds += dt

    def value(self) -> float:
        return self._impulses / (self._length * self._seconds) if self._seconds else float("nan")


def _perimeter(container: object) -> float:
    """Length of the sides; NaN without sides."""
    if isinstance(container, jostle.Box):
        return 2 * (container.max_x - container.min_x + container.max_y - container.min_y)
    if isinstance(container, jostle.Circle):
        return 2 * np.pi * container.radius
    return float("nan")


class _Collisions:
    """Collisions with others of a particle in a second."""

    def __init__(self) -> None:
        self._count, self._seconds = 0.0, 0.0

    def see(self, world: jostle.World, step: int, dt: float) -> None:
        self._count += 2 * world.last_call.collisions / max(len(world), 1)
        self._seconds += dt

    def value(self) -> float:
        return self._count / self._seconds if self._seconds else float("nan")


MEASURES: dict[str, tuple[Callable[[], Measure], str]] = {
    "energy": (partial(_Mean, _energy), "mean kinetic energy of a particle"),
    "pressure": (_Pressure, "on the sides of the container"),
    "height": (partial(_Mean, _height), "mean of y of movable particles, weighted by mass"),
    "hexatic": (partial(_Mean, _hexatic), "order of the directions to six neighbours, 0 to 1"),
    "cluster": (partial(_Mean, _cluster), "share of movable ones in the largest touching group"),
    "collisions": (_Collisions, "collisions of a particle with others in a second"),
}
