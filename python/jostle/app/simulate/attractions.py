"""Attractors placed by the user, as forces of a world after its own forces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import jostle
from jostle.app.simulate.columns import Columns
from jostle.app.simulate.simulation import Pull, Tags

Pulls = tuple[Pull, ...]


class Attractions:
    """Those of one world.

    Attributes
    ----------
    own
        How many forces the world has of its own.
    pulls
        What a person has placed; each is a force behind those.
    """

    def __init__(self, own: int, pulls: Pulls = ()) -> None:
        self.own, self.pulls = own, pulls
        self._heirs: dict[int, int] = {}  # by tag: which particle one that attracted has joined

    def place(self, world: jostle.World, columns: Columns, pulls: Pulls) -> None:
        """Replace them.

        A person may not have seen yet that a particle has merged: what has become of it attracts.
        """
        pulls = self._living(columns, pulls)
        if pulls != self.pulls:
            self._tie(world, columns, pulls)

    def renew(self, world: jostle.World, columns: Columns) -> None:
        """Tie them to the particles; those of particles that are gone end."""
        self._tie(world, columns, self._living(columns, self.pulls))

    def merge(self, world: jostle.World, columns: Columns, before: Tags, heirs: Tags) -> None:
        """Hand them on: the particles of some tags have become part of those of others."""
        tags = [pull.tag for pull in self.pulls if pull.tag is not None]
        for row in np.flatnonzero(np.isin(before, tags)):
            self._heirs[int(before[row])] = int(heirs[row])
        self.renew(world, columns)

    def lift(self, world: jostle.World) -> None:
        """Take their forces away until they are renewed."""
        world.forces = world.forces[: self.own]

    def _living(self, columns: Columns, pulls: Pulls) -> Pulls:
        """Return those whose particle is there, or an heir of it."""
        found = []
        for pull in pulls:
            tag = pull.tag
            while tag in self._heirs and not len(columns.find(tag)[0]):
                tag = self._heirs[tag]
            if tag is None or len(columns.find(tag)[0]):
                found.append(pull if tag == pull.tag else replace(pull, tag=tag))
        return tuple(found)

    def _tie(self, world: jostle.World, columns: Columns, pulls: Pulls) -> None:
        """Write them into the world, by its ids."""
        forces = []
        for pull in pulls:
            if pull.point is not None:
                forces.append(jostle.Attractor(pull.point, pull.strength))
            elif pull.tag is not None:
                (row,), _ = columns.find(pull.tag)
                particle = int(columns.ids[row])
                forces.append(jostle.Attractor(strength=pull.strength, particle=particle))
        self.lift(world)
        world.forces = (*world.forces, *forces)
        self.pulls = pulls
