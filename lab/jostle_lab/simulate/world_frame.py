"""A world as a frame: its columns, the numbers of its last step, and the requested parts.

A particle's tag is its id in the world. Rows change when particles are removed or merge; tags do
not.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle import life
from jostle_lab.simulate.frame import (
    Energies,
    Frame,
    FrameContacts,
    FrameRequest,
    StepStats,
    Tags,
    find,
)

Forces = tuple[Any, ...]


class ParticleTable:
    """The times of birth, and copies of columns that only edits change, so that frames share them.

    All particles were born at time 0, unless `born` has other times.
    """

    def __init__(self, world: jostle.World, born: NDArray[np.float64] | None = None) -> None:
        self.tags: Tags = world.ids  # ascending
        self.born = np.zeros(len(world)) if born is None else born
        self.update(world)

    def update(self, world: jostle.World) -> None:
        """Read all columns; particles that were added since are born now."""
        before, born = self.tags, self.born
        self.tags = world.ids
        rows, known = find(before, self.tags)
        self.born = np.full(len(self.tags), world.time)
        self.born[known] = born[rows]
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


def frame_of(
    world: jostle.World, columns: ParticleTable, request: FrameRequest, **more: Any
) -> Frame:
    """Return the present state of a world; `more` are fields that the world does not have."""
    forces = world.forces
    pair = pair_force(forces)
    return Frame(
        positions=world.positions,
        velocities=world.velocities,
        radii=columns.radii,
        densities=columns.densities,
        movable=columns.movable,
        tags=columns.tags,
        born=columns.born,
        container=world.container,
        stats=_stats(world),
        energies=Energies(world.kinetic_energy, world.potential_energy, world.momentum)
        if request.energies
        else None,
        tree=world.quadtree().nodes() if request.tree else None,
        contacts=_contacts(world, columns) if request.contacts else None,
        springs=_springs(forces, columns),
        angles=world.angles if columns.turns else None,
        walls=world.walls,
        sensors=_sensors(world, columns) if columns.sensors.any() else None,
        kinds=None if pair is None else pair.kinds,
        matrix=None if pair is None else life.matrix_of(pair),
        categories=columns.categories,
        masks=columns.masks,
        **more,
    )


def _sensors(world: jostle.World, columns: ParticleTable) -> NDArray[np.int8]:
    touched = np.zeros(len(columns.tags), np.bool_)
    touched[columns.rows(world.contacts.pairs)] = True
    return columns.sensors.astype(np.int8) * (1 + touched)


def _stats(world: jostle.World) -> StepStats:
    stats = world.stats
    return StepStats(
        time=world.time,
        pairs_tested=stats.tests,
        touching=len(world.contacts.pairs),
        asleep=int(np.count_nonzero(world.asleep)),
        substeps=stats.substeps,
        nodes=stats.nodes,
        depth=stats.depth,
        kinetic_energy=world.kinetic_energy,
        stage_times=dict(world.profile),
    )


def _contacts(world: jostle.World, columns: ParticleTable) -> FrameContacts:
    contacts, walls = world.contacts, world.wall_contacts
    return FrameContacts(
        pairs=columns.rows(contacts.pairs),
        normals=contacts.normals,
        depths=contacts.depths,
        impulses=contacts.normal_impulses,
        at_walls=columns.rows(walls.ids),
        wall_normals=walls.normals,
        wall_impulses=walls.normal_impulses,
    )


def pair_force(forces: Forces) -> jostle.PairForce | None:
    """Return the first force between kinds that has several of them."""
    for force in forces:
        if isinstance(force, jostle.PairForce) and force.table.shape[0] > 1:
            return force
    return None


def _springs(forces: Forces, columns: ParticleTable) -> NDArray[np.int64] | None:
    pairs = [force.pairs for force in forces if isinstance(force, jostle.Springs)]
    return columns.rows(np.concatenate(pairs)) if pairs else None
