"""Attractors placed by the user, as forces of a world after its own forces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import jostle
from jostle.app.simulate.particle_table import ParticleTable
from jostle.app.simulate.simulation import Attractor, Tags

Attractors = tuple[Attractor, ...]


class AttractorForces:
    """The attractors of one world.

    Attributes
    ----------
    own
        Number of forces of the world itself.
    attractors
        Those of the user; each is a force after those of the world.
    """

    def __init__(self, own: int, attractors: Attractors = ()) -> None:
        self.own, self.attractors = own, attractors
        self._heirs: dict[
            int, int
        ] = {}  # tag of an attracting particle that merged: tag of the result

    def place(self, world: jostle.World, columns: ParticleTable, attractors: Attractors) -> None:
        """Replace them.

        If a particle has merged, the result of the merge attracts in its place.
        """
        attractors = self._living(columns, attractors)
        if attractors != self.attractors:
            self._bind(world, columns, attractors)

    def renew(self, world: jostle.World, columns: ParticleTable) -> None:
        """Bind them to the particles again; those of removed particles end."""
        self._bind(world, columns, self._living(columns, self.attractors))

    def merge(self, world: jostle.World, columns: ParticleTable, before: Tags, heirs: Tags) -> None:
        """Transfer them after a merge: each tag of `before` is now part of that in `heirs`."""
        tags = [attractor.tag for attractor in self.attractors if attractor.tag is not None]
        for row in np.flatnonzero(np.isin(before, tags)):
            self._heirs[int(before[row])] = int(heirs[row])
        self.renew(world, columns)

    def detach(self, world: jostle.World) -> None:
        """Remove their forces until they are renewed."""
        world.forces = world.forces[: self.own]

    def _living(self, columns: ParticleTable, attractors: Attractors) -> Attractors:
        """Return those whose particle, or the result of its merge, exists."""
        found = []
        for attractor in attractors:
            tag = attractor.tag
            while tag in self._heirs and not len(columns.find(tag)[0]):
                tag = self._heirs[tag]
            if tag is None or len(columns.find(tag)[0]):
                found.append(attractor if tag == attractor.tag else replace(attractor, tag=tag))
        return tuple(found)

    def _bind(self, world: jostle.World, columns: ParticleTable, attractors: Attractors) -> None:
        """Set the forces of the world, by its ids."""
        forces = []
        for attractor in attractors:
            if attractor.point is not None:
                forces.append(jostle.Attractor(attractor.point, attractor.strength))
            elif attractor.tag is not None:
                (row,), _ = columns.find(attractor.tag)
                particle = int(columns.ids[row])
                forces.append(jostle.Attractor(strength=attractor.strength, particle=particle))
        self.detach(world)
        world.forces = (*world.forces, *forces)
        self.attractors = attractors
