"""Forces between kinds and flocking, from Python: against NumPy, and errors."""

import re

import numpy as np
import pytest
from copies import WAYS

import jostle
from jostle import Flocking, PairForce, life

SIDE = 50.0
lennard_jones, soft_discs = PairForce.lennard_jones, PairForce.soft_discs
particle_life = PairForce.particle_life


def random_state(n, seed=0):
    rng = np.random.default_rng(seed)
    positions = rng.uniform(0, SIDE, (n, 2)).astype(np.float32)
    return positions, rng.normal(0, 2, (n, 2)).astype(np.float32), rng.integers(0, 3, n)


def points(positions, velocities, force, **settings):
    """Return a world of particles that act on each other by a force alone."""
    return jostle.World(
        positions, 0.1, velocities=velocities, on_touch="ignore", forces=[force], **settings
    )


def offsets(positions, periodic):
    """Return the offsets from each particle to each other, and their lengths."""
    offset = (positions[None] - positions[:, None]).astype(np.float64)
    if periodic:
        offset -= SIDE * np.round(offset / SIDE)
    distance = np.sqrt((offset**2).sum(axis=2))
    np.fill_diagonal(distance, np.inf)
    return offset, distance


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("method", ["quadtree", "brute"])
def test_a_step_is_that_of_numpy(periodic, method):
    """One leapfrog step: half a flight, the forces there, half a flight."""
    positions, velocities, kinds = random_state(400)
    rng = np.random.default_rng(3)
    table, cutoff, dt = rng.uniform(-9, 9, (3, 3, 12)), 7.0, 0.01
    force = jostle.PairForce(table, cutoff)
    period = (SIDE, SIDE) if periodic else None
    masses = rng.uniform(1, 3, 400)
    settings = {"masses": masses, "kinds": kinds, "period": period, "method": method}
    world = points(positions, velocities, force, **settings)
    world.step(dt)
    offset, distance = offsets(positions + velocities * np.float32(dt / 2), periodic)
    at = np.minimum(distance / cutoff * 11, 11)
    low = np.minimum(at.astype(int), 10)
    pairs = kinds[:, None], kinds[None]
    value = table[(*pairs, low)] + (table[(*pairs, low + 1)] - table[(*pairs, low)]) * (at - low)
    value = np.where(distance < cutoff, value / distance, 0)
    acceleration = -(value[:, :, None] * offset).sum(axis=1) / masses[:, None]
    np.testing.assert_allclose(world.velocities, velocities + dt * acceleration, atol=2e-5)
    moved = positions + dt * velocities + dt**2 / 2 * acceleration
    found = world.positions - moved
    if periodic:
        found -= SIDE * np.round(found / SIDE)
    assert np.abs(found).max() < 1e-5


def test_a_flock_is_that_of_numpy():
    positions, velocities, _ = random_state(300, 1)
    birds = jostle.Flocking(6.0, separation=4.0, alignment=1.5, cohesion=0.3, max_speed=np.inf)
    world = points(positions, velocities, birds, period=(SIDE, SIDE))
    world.step(0.01)
    offset, distance = offsets(positions + velocities * np.float32(0.005), True)
    near = distance < 6.0
    count = np.maximum(near.sum(axis=1), 1)[:, None]
    distance = np.minimum(distance, 6.0)  # not infinite
    away = np.where(near, 4.0 * (1 - distance / 6.0) / distance, 0)[:, :, None]
    apart = (velocities[None] - velocities[:, None]).astype(float)
    pull = np.where(near[:, :, None], 0.3 * offset + 1.5 * apart, 0) - away * offset
    expected = velocities + 0.01 * pull.sum(axis=1) / count
    np.testing.assert_allclose(world.velocities, expected, atol=2e-5)


def test_particle_life_is_its_definition():
    matrix, core, strength = np.array([[0.7, -0.4], [0.2, -1.0]]), 0.3, 5.0
    force = jostle.PairForce.particle_life(matrix, 40.0, strength=strength)
    assert force.table.shape == (2, 2, 21)
    share = np.linspace(0, 1, 21)
    for a in range(2):
        for b in range(2):
            pull = matrix[a, b] * (1 - np.abs(2 * share - 1 - core) / (1 - core))
            expected = strength * np.where(share < core, 1 - share / core, -pull)
            np.testing.assert_allclose(force.table[a, b], expected, atol=1e-6 * strength)
    assert not force.reciprocal
    np.testing.assert_array_equal(life.matrix_of(force), matrix)


@pytest.mark.parametrize("core", [0.1, 0.25, 1 / 3, 0.37123, 0.9])
def test_the_matrix_can_be_read_from_the_force(core):
    matrix = life.random_matrix(np.random.default_rng(1), 5)
    force = jostle.PairForce.particle_life(matrix, 3.0, core, strength=77.0)
    assert life.core_of(force) == pytest.approx(core, abs=1e-5)
    np.testing.assert_allclose(life.matrix_of(force), matrix, atol=1e-3)


def test_other_forces_have_no_matrix():
    assert life.matrix_of(FLUID) is None
    assert life.matrix_of(jostle.PairForce([[[0.0, 0.0]]], 1.0)) is None


def test_the_scene_has_the_first_matrix():
    (force,) = jostle.scenes.create("life", n=10).forces
    np.testing.assert_array_equal(life.matrix_of(force), next(iter(life.MATRICES.values())))


def test_random_matrices_are_symmetric_if_asked():
    matrix = life.random_matrix(np.random.default_rng(0), 7, symmetric=True)
    assert (matrix == matrix.T).all() and np.abs(matrix).max() <= 1
    assert (life.random_matrix(np.random.default_rng(0), 7) != matrix).any()


def test_a_soft_disc_comes_to_rest_by_damping():
    force = jostle.PairForce.soft_discs(stiffness=100.0, diameters=2.0, damping=5.0)
    world = points([(0, 0), (1.0, 0)], [(0.5, 0), (-0.5, 0)], force, masses=1.0)
    energy = world.kinetic_energy() + world.potential_energy()
    world.step(0.005, steps=60)
    assert world.kinetic_energy() + world.potential_energy() < 0.99 * energy
    assert np.abs(world.momentum()).max() < 1e-6


def test_kinds_follow_through_add_and_remove():
    force = jostle.PairForce(np.zeros((3, 3, 2)), 5.0)
    world = jostle.World([(0, 0), (9, 0), (18, 0)], 1.0, kinds=[0, 1, 2], forces=[force])
    world.remove(1)
    assert world.kinds.tolist() == [0, 2]
    world.add((30, 0), 1.0, kinds=1)
    world.add([(40, 0), (50, 0)], 1.0, kinds=[2, 1])
    world.add((60, 0), 1.0)
    assert world.kinds.tolist() == [0, 2, 1, 2, 1, 0]
    for kinds, words in [
        (3, "kinds is 3; the table has 3 kinds, from 0 to 2"),
        ([1, 2], "kinds has shape (2,); it must be an integer or (1,)"),
        (-1, "kinds is -1; it must be a kind, between 0 and 63"),
        (64, "a kind, between 0 and 63"),
    ]:
        with pytest.raises(ValueError, match=re.escape(words)):
            world.add((70, 0), 1.0, kinds=kinds)
        assert len(world) == 6


FORCES = [
    jostle.PairForce(np.arange(12.0).reshape(2, 2, 3), 2.5, damping=0.5),
    jostle.Flocking(5.0, 1.0, 2.0, 3.0, 4.0, min_speed=0.5),
]


@pytest.mark.parametrize("force", FORCES)
def test_copies_are_equal(force):
    assert all(way(force) == force for way in WAYS)
    assert force != FORCES[0] or force != FORCES[1]


def test_columns_are_read_only():
    force, springs = FORCES[0], jostle.Springs([(0, 1)], 1, 2)
    assert force.table.dtype == np.float32
    of_springs = ("pairs", "lengths", "stiffness", "damping", "max_stretch")
    for column in (force.table, *(getattr(springs, name) for name in of_springs)):
        with pytest.raises(ValueError, match="read-only"):
            column[0] = 0


FLUID, RNG = lennard_jones(1.0, 1.0, 2.5), np.random.default_rng(0)
NONE = np.zeros((1, 1, 2))
WRONG = {
    ValueError: [
        (lambda: PairForce([[1.0]], 1.0), "has shape (1, 1); it must be (K, K, m)"),
        (lambda: PairForce(np.zeros((2, 3, 4)), 1.0), "it must be (K, K, m)"),
        (lambda: PairForce(np.zeros((1, 1, 1)), 1.0), "m at least 2"),
        (lambda: PairForce(np.zeros((65, 65, 2)), 1.0), "1 to 64 kinds"),
        (lambda: PairForce([[[0, np.nan]]], 1.0), "table[0, 0, 1] is NaN"),
        (lambda: particle_life([[1, 0], [np.nan, 0]], 1.0), "matrix[1, 0] is NaN"),
        (lambda: particle_life([[1]], 1.0, strength=np.inf), "strength is inf"),
        (
            lambda: particle_life(np.zeros((65, 65)), 1.0),
            "matrix is of 65 kinds; there may be 1 to 64 kinds",
        ),
        (lambda: lennard_jones([[1, 0], [np.inf, 0]], 1, 1.0), "epsilon[1, 0] is inf"),
        (lambda: lennard_jones(1, [[1, 2], [-2, 1]], 1.0), "sigma[1, 0] is -2"),
        (lambda: soft_discs(np.nan, 1.0), "stiffness is NaN"),
        (lambda: PairForce(NONE, 0.0), "cutoff is 0"),
        (lambda: PairForce(NONE, np.inf), "cutoff is inf"),
        (lambda: PairForce(NONE, 1.0, damping=-1.0), "damping is -1"),
        (lambda: particle_life([1.0], 1.0), "shape (1,); it must be (K, K)"),
        (lambda: particle_life([[1.0]], 1.0, 1.0), "core is 1"),
        (lambda: particle_life([[np.inf]], 1.0), "matrix[0, 0] is inf; it"),
        (
            lambda: particle_life([[1.0]], 1.0, strength=np.nan),
            "strength is NaN; it must be finite",
        ),
        (lambda: lennard_jones(1.0, 0.0, 1.0), "sigma is 0"),
        (
            lambda: lennard_jones(-1.0, 1.0, 1.0),
            "epsilon is -1; it must be finite and at least 0",
        ),
        (lambda: lennard_jones([[1, 1], [1, np.nan]], 1.0, 1.0), "epsilon[1, 1] is NaN"),
        (lambda: lennard_jones(np.eye(2), np.eye(3), 1.0), "a number or (2, 2)"),
        (lambda: soft_discs(1.0, -1.0), "diameters is -1"),
        (lambda: soft_discs(-1.0, 1.0), "stiffness is -1; it must be finite and"),
        (lambda: Flocking(0, 1, 1, 1, 1), "cutoff is 0"),
        (lambda: Flocking(1, -1, 1, 1, 1), "separation is -1"),
        (lambda: Flocking(1, 1, 1, 1, 1, min_speed=2), "min_speed is 2"),
        (lambda: Flocking(1, 1, 1, 1, np.nan), "max_speed is NaN"),
        (lambda: life.random_matrix(RNG, 0), "kinds is 0"),
        (lambda: life.random_matrix(RNG, 65), "kinds is 65"),
        (lambda: life.core_of(FLUID), "force is <jostle.PairForce of 1 kind, cutoff 2.5>"),
    ],
    TypeError: [
        (lambda: PairForce([0], NONE, 1.0), "positional arguments"),
        (lambda: PairForce(["a"], 1.0), "table must hold real numbers"),
        (lambda: PairForce(NONE, "far"), "cutoff must be a number, not str"),
        (lambda: Flocking("far", 1, 1, 1, 1), "cutoff must be a number, not str"),
        (lambda: life.random_matrix(5), "rng must be a numpy.random.Generator, not int"),
        (lambda: life.random_matrix(RNG, 2.5), "kinds must be an integer"),
        (lambda: life.core_of(5), "force must be a PairForce, not int"),
        (lambda: life.matrix_of(5), "force must be a PairForce, not int"),
    ],
}


@pytest.mark.parametrize(
    ("error", "make", "words"), [(error, *case) for error in WRONG for case in WRONG[error]]
)
def test_wrong_arguments_are_refused(error, make, words):
    with pytest.raises(error, match=re.escape(words)):
        make()


def test_a_force_must_fit_the_world():
    world = jostle.World([(1, 1), (3, 3)], 0.5, kinds=[1, 2], period=(10, 10))
    unknown = r"^kinds\[1\] is 2; the table has 2 kinds, from 0 to 1$"
    with pytest.raises(ValueError, match=unknown):
        world.forces = [FORCES[0]]
    with pytest.raises(ValueError, match=unknown):
        jostle.World([(1, 1), (3, 3)], 0.5, kinds=[1, 2], forces=[FORCES[0]])
    with pytest.raises(ValueError, match="a cutoff is at most 5"):
        world.forces = [jostle.Flocking(5.1, 1, 1, 1, 1)]
    assert world.forces == ()
