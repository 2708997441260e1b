"""Copies of particles at free positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle.app.simulate.particle_table import ParticleTable
from jostle.app.simulate.placement import free_positions
from jostle.app.simulate.simulation import Rect

Column = NDArray[np.floating]


def copies_of(
    world: jostle.World,
    columns: ParticleTable,
    rows: NDArray[np.intp],
    count: int,
    view: Rect,
    seed: int,
) -> tuple[Column, Column, Column, Column] | None:
    """Return positions, velocities, radii and densities of `count` copies of random rows.

    The positions are random and free; None if there is not one for each copy.
    """
    rng = np.random.default_rng([seed, columns.next_tag])
    rows = rng.choice(rows, count)
    places, found = free_positions(
        world.positions, columns.radii, columns.radii[rows], world.container, view,
        int(rng.integers(2**31)), world.walls,
    )  # fmt: skip
    if len(found) < count:
        return None
    return places, world.velocities[rows], columns.radii[rows], columns.densities[rows]
