"""The kinds of the particles of a world, and the matrix of particle life."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import jostle
from jostle import life
from jostle.app.simulate.motors import Forces


def pair_force(forces: Forces) -> jostle.PairForce | None:
    """Return the first force between kinds that has several of them."""
    for force in forces:
        if isinstance(force, jostle.PairForce) and force.table.shape[0] > 1:
            return force
    return None


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
