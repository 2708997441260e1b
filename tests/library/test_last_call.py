"""`World.last_call`: sums over all steps of a call, against conservation laws and single steps."""

import numpy as np
import pytest

import jostle

NORMALS = np.array([(1, 0), (-1, 0), (0, 1), (0, -1)])  # of the sides of a box
TANGENTS = np.array([(0, 1), (0, -1), (-1, 0), (1, 0)])
FUNNEL = [[(0, 60), (40, 20)], [(100, 60), (60, 20)], [(45, 80), (55, 80)]]


def falling(**rules) -> jostle.World:
    """Discs that fall into a funnel with a gap, and come to rest below it and in it."""
    rng = np.random.default_rng(3)
    at = np.stack(np.meshgrid(np.arange(5, 96, 7), np.arange(85, 145, 7)), axis=-1).reshape(-1, 2)
    given = {
        "velocities": rng.normal(0, 9, at.shape),
        "restitution": 0.4,
        "friction": 0.3,
        "gravity": (0, -30),
        "container": jostle.Box(0, 0, 100, 150),
        "walls": FUNNEL,
        "sleeping": False,
    }
    return jostle.World(at, rng.uniform(1.5, 3, len(at)), **given | rules)


def given_by_boundaries(call: jostle.LastCall) -> np.ndarray:
    """The momentum that walls and sides gave to the particles."""
    sides = call.side_impulses[:4]
    return call.wall_impulses.sum(axis=0) + sides[:, 0] @ NORMALS + sides[:, 1] @ TANGENTS


def test_one_impact() -> None:
    world = jostle.World([(0, 0), (3, 4)], [2, 2], velocities=[(3, 4), (0, 0)], masses=2.0)
    world.step(1.0)
    call = world.last_call
    impulse = 2 * np.array([3, 4])  # all of the momentum
    np.testing.assert_allclose(call.collision_virial, np.outer([2.4, 3.2], impulse), rtol=1e-6)
    assert (call.duration, call.steps, call.collisions, call.wall_collisions) == (1.0, 1, 1, 0)
    assert call.wall_impulses.shape == (0, 2) and not call.side_impulses.any()


@pytest.mark.parametrize("rules", [{}, {"friction": 0.0}, {"restitution": 1.0}], ids=str)
def test_walls_and_sides_change_the_momentum(rules) -> None:
    world = falling(**rules)
    for steps in (1, 30, 300):
        before = world.momentum()
        world.step(1 / 60, steps=steps)
        call = world.last_call
        weight = np.array([0, -30]) * world.masses.sum(dtype=float) * steps / 60
        changed = world.momentum() - before - weight
        # A few steps leave out up to the weight of one disc.
        most = max(np.abs(weight).sum() / 2000, world.masses.max() * 30 / 60)
        np.testing.assert_allclose(given_by_boundaries(call), changed, atol=most)
        assert call.duration == pytest.approx(steps / 60) and call.steps == steps


def test_a_call_is_the_sum_of_its_steps() -> None:
    world, single = falling(), falling()
    world.step(1 / 60, steps=200)
    sums = {}
    for _ in range(200):
        single.step(1 / 60)
        for name, value in single.last_call.to_dict().items():
            sums[name] = sums.get(name, 0) + value
    for name, value in world.last_call.to_dict().items():
        np.testing.assert_allclose(value, sums[name], rtol=1e-9, atol=1e-6, err_msg=name)


def test_contacts_of_single_steps_add_up() -> None:
    world, single = falling(), falling()
    world.step(1 / 60, steps=200)
    trace, normal = 0.0, np.zeros(5)
    for _ in range(200):
        single.step(1 / 60)
        step = single.last_step
        pairs, walls = step.contacts, step.wall_contacts
        trace += (single.radii[pairs.pairs].sum(axis=1) * pairs.normal_impulses).sum(dtype=float)
        sides = walls.walls < 0
        np.add.at(normal, -2 - walls.walls[sides], walls.normal_impulses[sides])
    call = world.last_call
    assert np.trace(call.collision_virial) == pytest.approx(trace, rel=1e-4)
    np.testing.assert_allclose(call.side_impulses[:, 0], normal, rtol=1e-4)


def test_a_rim() -> None:
    world = jostle.World(
        [(0, 0)], 1.0, velocities=[(3, 4)], masses=2.0, container=jostle.Circle((0, 0), 11)
    )
    world.step(8.0)  # impacts after 2 and 6 seconds
    np.testing.assert_allclose(world.last_call.side_impulses, [[0, 0]] * 4 + [[40, 0]], atol=1e-5)
    assert world.last_call.wall_collisions == 2


@pytest.mark.parametrize("length", [0.02, 5.0])
def test_the_virial_is_right_at_any_step_length(length: float) -> None:
    """In a gas at rest as a whole the pressure is the same along both axes."""
    rng = np.random.default_rng(5)
    n, eta = 400, 0.4
    side = np.sqrt(n * np.pi / eta)
    at = (np.indices((20, 20)).reshape(2, -1).T + 0.5) * side / 20
    world = jostle.World(at, 1.0, velocities=rng.normal(size=(n, 2)), period=side)
    world.step(length, steps=round(20 / length))
    world.step(length, steps=round(400 / length))
    call = world.last_call
    pressures = np.diag(call.collision_virial) / (side**2 * call.duration)
    ideal = n * world.temperature() / side**2
    henderson = ideal * (1 + eta**2 / 8) / (1 - eta) ** 2
    np.testing.assert_allclose(pressures + ideal, henderson, rtol=0.05)
    assert abs(call.collision_virial[0, 1]) < 0.05 * call.collision_virial[0, 0]


def test_the_same_bits_for_all_threads_and_after_a_snapshot() -> None:
    calls = []
    for threads in (1, 2):
        world = falling(threads=threads)
        world.step(1 / 60, steps=100)
        calls.append(world.last_call)
        assert jostle.World.restore(world.snapshot()).last_call == world.last_call
    assert calls[0] == calls[1]


def test_a_refused_call_and_an_empty_one() -> None:
    world = falling()
    world.step(1 / 60, steps=60)
    before = world.last_call
    with pytest.raises(ValueError, match="dt is"):
        world.step(1e10)
    assert world.last_call == before
    world.step(1 / 60, steps=0)
    call = world.last_call
    assert (call.duration, call.steps, call.collisions) == (0.0, 0, 0)
    assert call.wall_impulses.tolist() == [[0, 0]] * 3 and not call.side_impulses.any()


def test_sleepers_add_nothing() -> None:
    world = jostle.World(
        [(5, 1)], 1.0, gravity=(0, -10), restitution=0.0, container=jostle.Box(0, 0, 10, 10)
    )
    world.step(1 / 60, steps=300)
    assert world.asleep.all()
    world.step(1 / 60, steps=60)
    assert not world.last_call.side_impulses.any() and world.last_call.duration == pytest.approx(1)


def test_walls_that_were_removed_have_no_row() -> None:
    world = falling()
    world.step(1 / 60, steps=100)
    before = world.last_call.wall_impulses
    assert before[[0, 2]].any(axis=1).all()
    world.walls.remove(1)
    world.walls.add(FUNNEL[1])
    np.testing.assert_array_equal(world.last_call.wall_impulses, [*before[[0, 2]], (0, 0)])
