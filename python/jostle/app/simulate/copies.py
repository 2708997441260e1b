"""Copies of particles at free positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle.app.simulate.columns import Columns
from jostle.app.simulate.room import free_places
from jostle.app.simulate.simulation import Rect

Column = NDArray[np.floating]


def copies_of(
    world: jostle.World, columns: Columns, rows: NDArray[np.intp], count: int, view: Rect, seed: int
) -> tuple[Column, Column, Column, Column] | None:
    """Return places, velocities, radii and densities of so many copies of some of the rows.

    The places are free ones, by chance; None if there is not one for each.
    """
    chance = np.random.default_rng([seed, columns.next_tag])
    rows = chance.choice(rows, count)
    places, found = free_places(
        world.positions, columns.radii, columns.radii[rows], world.container, view,
        int(chance.integers(2**31)), world.walls,
    )  # fmt: skip
    if len(found) < count:
        return None
    return places, world.velocities[rows], columns.radii[rows], columns.densities[rows]
