"""Types of the forces between neighbours."""

import numpy as np
from numpy.typing import NDArray
from typing_extensions import assert_type

import jostle
from jostle import life


def made(kinds: NDArray[np.int64]) -> None:
    force = jostle.PairForce(np.zeros((2, 2, 5)), 3.0, damping=0.5)
    assert_type(force.table, NDArray[np.float32])
    assert_type(force.cutoff, float)
    assert_type(force.reciprocal, bool)
    assert_type(jostle.PairForce.particle_life(life.MATRICES["cells"], 4), jostle.PairForce)
    assert_type(jostle.PairForce.lennard_jones(1, 1.0, np.float32(2.5)), jostle.PairForce)
    assert_type(jostle.PairForce.soft_discs(1.0, [[2.0]], damping=1), jostle.PairForce)
    birds = jostle.Flocking(5, 1.0, 2.0, 3.0, float("inf"), min_speed=1)
    world = jostle.World([(0, 0)], 1.0, kinds=kinds, forces=[force, birds])
    assert_type(world.kinds, NDArray[np.uint8])
    assert_type(world.add((0, 0), 1, kinds=1), int)
    assert_type(life.matrix_of(force), NDArray[np.float64] | None)
    assert_type(life.core_of(force), float)
    assert_type(life.random_matrix(np.random.default_rng(), 3), NDArray[np.float64])
