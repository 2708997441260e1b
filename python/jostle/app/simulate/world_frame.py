"""A world as a frame: its columns, the numbers of its last step, and the requested parts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle import life
from jostle.app.simulate.forces import Forces, pair_force
from jostle.app.simulate.particle_table import ParticleTable
from jostle.app.simulate.simulation import (
    Energies,
    Frame,
    FrameContacts,
    FrameRequest,
    StepStats,
)


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


def _springs(forces: Forces, columns: ParticleTable) -> NDArray[np.int64] | None:
    pairs = [force.pairs for force in forces if isinstance(force, jostle.Springs)]
    return columns.rows(np.concatenate(pairs)) if pairs else None
