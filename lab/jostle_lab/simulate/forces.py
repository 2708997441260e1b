"""Forces of a world: between kinds of particles, of walls, and to attractors of the user."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle import life
from jostle_lab.simulate.frame import Attractor
from jostle_lab.simulate.world_frame import Forces, ParticleTable, pair_force

Attractors = tuple[Attractor, ...]

ARGUMENTS = ("ids", "walls", "center", "angular_velocity", "velocity", "period")  # of a motor


def kind_count(world: jostle.World) -> int | None:
    """Return the number of kinds; None if the world has no force between kinds."""
    counts = [f.table.shape[0] for f in world.forces if isinstance(f, jostle.PairForce)]
    return min(counts, default=None)


def set_matrix(world: jostle.World, matrix: str | Sequence[Sequence[float]]) -> None:
    """Set the matrix of particle life, by name or as numbers.

    If the number of kinds changes, the particles get all kinds in turn.
    """
    old = pair_force(world.forces)
    if old is None or life.matrix_of(old) is None:
        raise ValueError("Only particle life has a matrix: choose the scene life.")
    values = np.asarray(life.MATRICES[matrix] if isinstance(matrix, str) else matrix)
    kinds = old.kinds
    if len(values) != len(old.table):
        kinds = (np.arange(len(kinds)) % len(values)).astype(np.uint8)
    core, strength = life.core_of(old), float(old.table[0, 0, 0])
    new = jostle.PairForce.particle_life(kinds, values, old.cutoff, core, strength=strength)
    world.forces = tuple(new if force == old else force for force in world.forces)


def keeping_walls(forces: Forces, keep: NDArray[np.bool_]) -> Forces:
    """Return forces that name only the walls that are kept, by their new indices.

    Thermal walls of which none is left are left out.
    """
    index = np.cumsum(keep) - 1

    def kept(walls: ArrayLike) -> NDArray[np.intp]:
        rows = np.asarray(walls, np.intp)
        return index[rows[keep[rows]]]

    new: list[Any] = []
    for force in forces:
        if isinstance(force, jostle.Motor):
            new.append(_with(force, walls=kept(force.walls)))
        elif not isinstance(force, jostle.ThermalWalls):
            new.append(force)
        elif len(walls := kept(force.walls)) or force.sides:
            hot = jostle.ThermalWalls(force.temperature, force.sides, force.seed, walls=walls)
            new.append(hot)
    return tuple(new)


def shifted(forces: Forces, by: NDArray[np.floating]) -> Forces:
    """Return forces whose motors have shifted centres."""
    return tuple(
        _with(force, center=np.array(force.center) + by)
        if isinstance(force, jostle.Motor)
        else force
        for force in forces
    )


def _with(motor: jostle.Motor, **changes: Any) -> jostle.Motor:
    """Return a motor with some other arguments."""
    return jostle.Motor(**{name: getattr(motor, name) for name in ARGUMENTS} | changes)


class AttractorForces:
    """The attractors of the user in one world: each is a force after those of the world."""

    def __init__(
        self, world: jostle.World, columns: ParticleTable, own: int, attractors: Attractors = ()
    ) -> None:
        self._world, self._columns = world, columns
        self.own = own  # the number of forces of the world itself
        self.attractors = self._living(attractors)

    def place(self, attractors: Attractors) -> None:
        """Replace them; those of particles that do not exist are left out."""
        attractors = self._living(attractors)
        if attractors != self.attractors:
            self._bind(attractors)

    def renew(self) -> None:
        """Remove those of particles that no longer exist."""
        self._bind(self._living(self.attractors))

    def merge(self, renumbered: NDArray[np.int64]) -> None:
        """Give them the new tags of their particles after a merge."""
        self.attractors = tuple(
            one if one.tag is None else replace(one, tag=int(renumbered[one.tag]))
            for one in self.attractors
        )
        self.renew()

    @contextmanager
    def detached(self) -> Iterator[None]:
        """Remove their forces meanwhile; forces of the world may end with particles or walls."""
        self._world.forces = self._world.forces[: self.own]
        yield
        self.own = len(self._world.forces)
        self._columns.update(self._world)
        self.renew()

    def _living(self, attractors: Attractors) -> Attractors:
        tags = [one.tag for one in attractors if one.tag is not None]
        living = {None, *self._columns.tags[self._columns.find(tags)[0]].tolist()}
        return tuple(one for one in attractors if one.tag in living)

    def _bind(self, attractors: Attractors) -> None:
        forces = [
            jostle.Attractor(strength=attractor.strength, particle=attractor.tag)
            if attractor.point is None
            else jostle.Attractor(attractor.point, attractor.strength)
            for attractor in attractors
            if attractor.point is not None or attractor.tag is not None
        ]
        self._world.forces = (*self._world.forces[: self.own], *forces)
        self.attractors = attractors
