"""The columns of particles that the app adds to those of a world.

Rows change when particles are removed or merge; tags and the world's ids do not. (Tags of older
files differ from ids.) Every change of the rows of a world must update its table.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle.app.simulate.simulation import Tags, find


class ParticleTable:
    """The additional columns of a world.

    Attributes
    ----------
    tags
        The number of each particle in the order of adding, ascending.
    born
        The time each was added.
    next_tag
        The tag of the next particle.
    ids
        The ids in the world.
    radii, movable, densities, sensors
        Copies of columns that only edits change, so frames share them.
    friction
        The largest coefficient of friction.
    turns
        Whether particles may rotate.
    """

    def __init__(self, world: jostle.World) -> None:
        self.tags: Tags = np.arange(len(world), dtype=np.int64)
        self.born: NDArray[np.float64] = np.zeros(len(world))
        self.next_tag = len(world)
        self.copy(world)

    @classmethod
    def read(
        cls, world: jostle.World, tags: Tags, born: NDArray[np.float64], next_tag: int
    ) -> ParticleTable:
        """Return columns that were saved."""
        columns = cls(world)
        columns.tags, columns.born, columns.next_tag = tags, born, next_tag
        return columns

    def copy(self, world: jostle.World) -> None:
        """Copy the columns after an edit."""
        self.ids: NDArray[np.int64] = world.ids
        self.radii: NDArray[np.float32] = world.radii
        self.movable: NDArray[np.bool_] = world.movable
        self.sensors: NDArray[np.bool_] = world.sensors
        self.friction = float(world.friction.max(initial=0.0))
        self.turns = self.friction > 0 or bool(world.angular_velocities.any())
        self._usual_mass: float | None = None
        masses, areas = world.masses, self.radii**2
        self.densities: NDArray[np.float32] = np.divide(
            masses, areas, out=np.zeros_like(masses), where=areas > 0
        )

    def add(self, world: jostle.World) -> Tags:
        """Assign tags to the particles added last; return the tags."""
        count = len(world) - len(self.tags)
        tags = np.arange(self.next_tag, self.next_tag + count, dtype=np.int64)
        self.next_tag += count
        self.tags = np.concatenate([self.tags, tags])
        self.born = np.concatenate([self.born, np.full(count, world.time)])
        self.copy(world)
        return tags

    def remove(self, world: jostle.World, rows: NDArray[np.integer]) -> None:
        """Remove rows; particles may have been added since."""
        self.tags, self.born = np.delete(self.tags, rows), np.delete(self.born, rows)
        self.add(world)

    def merge(self, world: jostle.World, renumbered: NDArray[np.int64]) -> Tags:
        """Give each merged particle the tag of the oldest of its parts.

        Returns
        -------
        ndarray of int64
            For each row before the merge, the tag of the particle that it is part of now.
        """
        new = renumbered[self.ids]
        oldest = new == self.ids
        self.tags, self.born = self.tags[oldest], self.born[oldest]
        self.copy(world)
        heirs: Tags = self.tags[self.rows(new)]
        return heirs

    def rows(self, ids: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the rows of existing ids."""
        if not len(self.ids) or self.ids[-1] == len(self.ids) - 1:
            return ids  # each is its row
        return np.searchsorted(self.ids, ids).astype(np.int64)

    def find(self, tags: ArrayLike) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Return the rows of the tags that exist, in order, and which exist."""
        return find(self.tags, tags)

    def usual_mass(self, world: jostle.World) -> float:
        """Return the median mass of the movable particles, computed on demand."""
        if self._usual_mass is None:
            self._usual_mass = float(np.median(world.masses[self.movable]))
        return self._usual_mass
