"""The columns of particles that the app keeps beside those of a world.

A particle's tag is its id in the world. Rows change when particles are removed or merge; tags do
not. Every change of the rows or of these columns must be followed by `update`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle.app.simulate.simulation import Tags, find


class ParticleTable:
    """The times of birth, and copies of columns that only edits change, so that frames share them.

    All particles were born at time 0, unless `born` has other times. `next_tag` is the tag of the
    next particle, or a larger number.
    """

    def __init__(
        self, world: jostle.World, born: NDArray[np.float64] | None = None, next_tag: int = 0
    ) -> None:
        self.tags: Tags = world.ids  # ascending
        self.born = np.zeros(len(world)) if born is None else born
        self.next_tag = next_tag
        self.update(world)

    def update(self, world: jostle.World) -> None:
        """Read all columns; particles that were added since are born now."""
        before, born = self.tags, self.born
        self.tags = world.ids
        rows, known = find(before, self.tags)
        self.born = np.full(len(self.tags), world.time)
        self.born[known] = born[rows]
        self.next_tag = max(self.next_tag, int(self.tags[-1]) + 1 if len(self.tags) else 0)
        self.radii: NDArray[np.float32] = world.radii
        self.movable: NDArray[np.bool_] = world.movable
        self.sensors: NDArray[np.bool_] = world.sensors
        self.categories: NDArray[np.uint32] = world.categories
        self.masks: NDArray[np.uint32] = world.masks
        self.friction = float(world.friction.max(initial=0.0))  # the largest coefficient
        self.turns = self.friction > 0 or bool(world.angular_velocities.any())
        self._usual_mass: float | None = None
        masses, areas = world.masses, self.radii**2
        self.densities: NDArray[np.float32] = np.divide(
            masses, areas, out=np.zeros_like(masses), where=areas > 0
        )

    def rows(self, tags: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the rows of existing tags."""
        if not len(self.tags) or self.tags[-1] == len(self.tags) - 1:
            return tags  # each is its row
        return np.searchsorted(self.tags, tags).astype(np.int64)

    def find(self, tags: ArrayLike) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        return find(self.tags, tags)

    def usual_mass(self, world: jostle.World) -> float:
        """Return the median mass of the movable particles, computed on demand."""
        if self._usual_mass is None:
            self._usual_mass = float(np.median(world.masses[self.movable]))
        return self._usual_mass
