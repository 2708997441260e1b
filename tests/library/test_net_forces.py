"""`World.net_forces` and `force_virial`, against sums over pairs and gradients of the energy."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import jostle

SIDES = np.array([30.0, 22.0])
N = 40
AT = np.random.default_rng(3).uniform(0, SIDES, (N, 2)).astype(np.float32)
MASSES = np.random.default_rng(4).uniform(0.5, 3, N).astype(np.float32)
VELOCITIES = np.random.default_rng(5).normal(0, 2, (N, 2)).astype(np.float32)
KINDS = np.arange(N) % 2
TABLE = np.random.default_rng(6).normal(0, 3, (2, 2, 5))
RECIPROCAL = (TABLE + TABLE.transpose(1, 0, 2)) / 2
PAIRS = np.array([(0, 1), (2, 3), (0, 4), (5, 6), (7, 39)])

FORCES = {
    "pairs": jostle.PairForce(RECIPROCAL, 8.0),
    "one-sided pairs": jostle.PairForce(TABLE, 8.0),
    "damped pairs": jostle.PairForce(RECIPROCAL, 8.0, damping=0.7),
    "gravitation": jostle.Gravitation(G=3.0, softening=0.5),
    "springs": jostle.Springs(PAIRS, lengths=2.0, stiffness=[1, 2, 3, 4, 5]),
    "damped springs": jostle.Springs(PAIRS, lengths=2.0, stiffness=2.0, damping=0.6),
}
CONSERVATIVE = ["pairs", "gravitation", "springs"]


def world_of(*forces: Any, period: Any = None, **rules: Any) -> jostle.World:
    """Particles that pass through each other."""
    given = {"velocities": VELOCITIES, "masses": MASSES, "kinds": KINDS, "on_touch": "ignore"}
    return jostle.World(AT, 0.1, forces=forces, period=period, **given | rules)


def pair_forces(name: str, period: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    """Offsets from j to i, and forces on i by j, shape (n, n, 2), from the formulas."""
    offset = AT[:, None].astype(float) - AT[None]
    if period is not None:
        offset -= period * np.round(offset / period)
    distance = np.hypot(*offset.T).T
    np.fill_diagonal(distance, 1.0)
    along = offset / distance[..., None]
    rate = (along * (VELOCITIES[:, None].astype(float) - VELOCITIES[None])).sum(-1)
    force = FORCES[name]
    match force:
        case jostle.PairForce():
            knots = np.linspace(0, force.cutoff, 5)
            size = np.zeros((N, N))
            for i in range(N):
                for j in range(N):
                    size[i, j] = np.interp(distance[i, j], knots, force.table[KINDS[i], KINDS[j]])
            size -= force.damping * (1 - distance / force.cutoff) ** 2 * rate
            size[distance >= force.cutoff] = 0
        case jostle.Gravitation():
            square = distance**2 + 0.5**2
            size = -3.0 * MASSES[:, None].astype(float) * MASSES / square**1.5 * distance
        case _:
            size = np.zeros((N, N))
            stiffness = [1, 2, 3, 4, 5] if name == "springs" else [2.0] * 5
            damping = 0.0 if name == "springs" else 0.6
            for (i, j), k in zip(PAIRS, stiffness, strict=True):
                size[i, j] = size[j, i] = -k * (distance[i, j] - 2) - damping * rate[i, j]
    np.fill_diagonal(size, 0)
    return offset, size[..., None] * along


@pytest.mark.parametrize("period", [None, SIDES], ids=["plane", "period"])
@pytest.mark.parametrize("name", FORCES)
def test_sums_over_pairs(name: str, period: Any) -> None:
    world = world_of(FORCES[name], period=period)
    offset, force = pair_forces(name, period)
    expected = force.sum(axis=1)
    scale = np.abs(force).max()
    assert np.abs(expected).max() > 0.1
    found = world.net_forces()
    assert found.shape == (N, 2) and found.dtype == np.float64
    np.testing.assert_allclose(found, expected, atol=1e-5 * scale)
    virial = 0.5 * np.einsum("ijk,ijl->kl", offset, force)
    assert world.force_virial().shape == (2, 2)
    np.testing.assert_allclose(world.force_virial(), virial, atol=1e-5 * scale * SIDES.max())
    if name != "one-sided pairs":
        np.testing.assert_allclose(found.sum(axis=0), 0, atol=1e-4 * scale)  # Newton's third law


@pytest.mark.parametrize("period", [None, SIDES], ids=["plane", "period"])
@pytest.mark.parametrize("name", CONSERVATIVE)
def test_the_gradient_of_the_energy(name: str, period: Any) -> None:
    gravity = (0.5, -1.5)
    world = world_of(FORCES[name], jostle.Attractor((5, 6), 0.3, law="harmonic"), gravity=gravity)
    if period is not None:
        world = world_of(FORCES[name], period=period)
    found = world.net_forces()
    h = 1 / 64
    for row in (0, 3, 7, 39):
        for axis in (0, 1):
            energies = []
            for sign in (1, -1):
                at = AT[row].copy()
                at[axis] += sign * h
                world.set(row, positions=at)
                # In float32 the step is not quite h.
                energies.append((world.potential_energy(), float(at[axis])))
            world.set(row, positions=AT[row])
            (high, right), (low, left) = energies
            assert -(high - low) / (right - left) == pytest.approx(
                found[row, axis], rel=5e-3, abs=2e-2
            )


def test_gravity_and_drag() -> None:
    world = jostle.World(
        AT, 0.1, velocities=VELOCITIES, masses=MASSES, gravity=(0.5, -2), drag=0.25
    )
    expected = MASSES[:, None] * (np.array([0.5, -2]) - 0.25 * VELOCITIES.astype(float))
    np.testing.assert_allclose(world.net_forces(), expected, rtol=1e-6)
    assert not world.force_virial().any()


def test_newtons_second_law() -> None:
    """A short step changes the momentum by the force times its length."""
    forces = [FORCES["damped pairs"], FORCES["gravitation"], FORCES["damped springs"]]
    world = world_of(*forces, gravity=(1, -2), drag=0.3)
    expected, dt = world.net_forces(), 1e-3
    before = world.velocities.astype(float)
    world.step(dt)
    rate = MASSES[:, None] * (world.velocities - before) / dt
    np.testing.assert_allclose(rate, expected, rtol=2e-2, atol=2e-2 * np.abs(expected).max())


def test_immovable_particles_have_none_and_pull_others() -> None:
    spring = jostle.Springs([(0, 1)], lengths=1.0, stiffness=10.0)
    world = jostle.World(
        [(0, 0), (3, 0)], 0.1, movable=[False, True], forces=[spring], gravity=(0, 1)
    )
    np.testing.assert_allclose(world.net_forces(), [(0, 0), (-20, 0.01)], rtol=1e-6)
    np.testing.assert_allclose(world.force_virial(), [(-60, 0), (0, 0)], atol=1e-12)


def test_contacts_are_left_out_and_sleepers_are_not() -> None:
    world = jostle.World(
        [(0, 1), (0, 3)],
        1.0,
        masses=2.0,
        gravity=(0, -10),
        restitution=0.0,
        container=jostle.Box(-9, 0, 9, 9),
    )
    world.step(1 / 60, steps=120)
    assert world.asleep.all()
    assert world.net_forces().tolist() == [[0, -20], [0, -20]]


def test_given_accelerations_count() -> None:
    world = jostle.World([(0, 0), (5, 0)], 1.0, masses=2.0)
    world.accelerations = [(1, 2), (0, 0)]
    assert world.net_forces().tolist() == [[2, 4], [0, 0]]
    world.step(0.1)
    assert not world.net_forces().any()


def test_flocks_are_without_their_limits() -> None:
    flock = jostle.Flocking(3.0, separation=1, alignment=1, cohesion=1, max_speed=0.5)
    found = jostle.World(
        [(0, 0), (1, 0)], 0.1, masses=2.0, velocities=[(9, 0), (0, 0)], forces=[flock]
    )
    assert np.isfinite(found.net_forces()).all() and found.net_forces().any()


def test_the_order_of_adding_and_ids() -> None:
    world = world_of(FORCES["gravitation"])
    world.step(1 / 60)  # in memory they are in another order now
    found = world.net_forces()
    again = world_of(FORCES["gravitation"])
    again.positions, again.velocities = world.positions, world.velocities
    np.testing.assert_allclose(found, again.net_forces(), atol=1e-4 * np.abs(found).max())
    world.remove(5)
    assert world.net_forces().shape == (N - 1, 2)


def test_many_bodies_by_barnes_and_hut() -> None:
    rng = np.random.default_rng(2)
    at = rng.normal(0, 20, (2000, 2))
    exact = jostle.World(
        at, 0.01, masses=1.0, forces=[jostle.Gravitation(G=1, softening=0.3, theta=0)]
    )
    world = jostle.World(at, 0.01, masses=1.0, forces=[jostle.Gravitation(G=1, softening=0.3)])
    scale = np.abs(exact.net_forces()).max()
    assert np.abs(world.net_forces() - exact.net_forces()).max() < 0.02 * scale
    np.testing.assert_allclose(
        world.force_virial(),
        exact.force_virial(),
        rtol=0.02,
        atol=1e-2 * exact.force_virial()[0, 0].__abs__(),
    )
    # On the open plane it is also the sum of position times force.
    whole = np.einsum("ik,il->kl", exact.positions.astype(float), exact.net_forces())
    np.testing.assert_allclose(exact.force_virial(), whole, rtol=1e-3, atol=1e-3 * abs(whole[0, 0]))


def test_empty_worlds() -> None:
    assert jostle.World().net_forces().shape == (0, 2)
    assert jostle.World().force_virial().tolist() == [[0, 0], [0, 0]]


def test_they_change_nothing() -> None:
    forces = [FORCES["damped pairs"], FORCES["gravitation"], FORCES["springs"]]
    world, other = world_of(*forces), world_of(*forces)
    for _ in range(5):
        world.net_forces(), world.force_virial()
        world.step(1 / 60)
        other.step(1 / 60)
    assert world.state_hash() == other.state_hash()


def test_a_grab_adds_to_the_other_forces_on_its_particle() -> None:
    spring = jostle.Springs([(0, 1)], lengths=1.0, stiffness=10.0)
    world = jostle.World([(0, 0), (3, 0)], 0.1, masses=2.0, forces=[spring])
    alone = world.net_forces()
    world.forces = [spring, jostle.Grab(0, (0, 0.5), rate=4)]
    # Outside of a step the spring of the grab has its limit for short sub-steps, m ω² c.
    np.testing.assert_allclose(world.net_forces() - alone, [(0, 2 * 16 * 0.5), (0, 0)], atol=1e-5)
