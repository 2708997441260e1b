"""`World.apply_impulse` and `apply_force`, against mechanics of a disc."""

import copy
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import jostle

AT = [(0, 0), (50, 0), (0, 70)]


def discs(**rules: Any) -> jostle.World:
    """Three discs that do not touch."""
    usual: dict[str, Any] = {"masses": [2.0, 4.0, 0.5]}
    return jostle.World(AT, [1.0, 2.0, 0.5], **usual | rules)


def test_an_impulse_acts_at_once() -> None:
    world = discs(velocities=[(1, 0), (0, 0), (3, 4)])
    before = world.momentum()
    world.apply_impulse([0, 1], [(4, 2), (0, -8)])
    assert world.velocities.tolist() == [[3, 1], [0, -2], [3, 4]]
    assert (world.momentum() - before).tolist() == [4, -6]
    assert (
        not world.angular_velocities.any()
        and world.positions.tolist() == np.array(AT, float).tolist()
    )
    world.apply_impulse(2, (1, 0))
    assert world.velocities[2].tolist() == [5, 4]


def test_impulses_on_one_particle_add_up() -> None:
    world = discs()
    world.apply_impulse([1, 0, 1, 1], [(4, 0), (2, 2), (0, 8), (-4, 4)])
    assert world.velocities.tolist() == [[1, 1], [0, 3], [0, 0]]
    world.apply_impulse([], np.zeros((0, 2)))
    # Each sum is rounded once, so large ones that cancel leave the small one.
    world.apply_impulse([0] * 3, [(2e9, 0), (2, 0), (-2e9, 0)])
    assert world.velocities[0].tolist() == [2, 1]


def test_a_point_gives_spin_and_conserves_angular_momentum() -> None:
    rng = np.random.default_rng(1)
    about = (3.0, -2.0)
    for _ in range(20):
        world = discs(velocities=rng.normal(size=(3, 2)), angular_velocities=rng.normal(size=3))
        ids, impulses = rng.integers(0, 3, 5), rng.normal(size=(5, 2))
        points = np.array(AT)[ids] + rng.normal(0, 0.5, (5, 2))
        momentum, moment = world.momentum(), world.angular_momentum(about)
        world.apply_impulse(ids, impulses, points)
        np.testing.assert_allclose(world.momentum() - momentum, impulses.sum(axis=0), atol=1e-5)
        arms = points - about
        moments = arms[:, 0] * impulses[:, 1] - arms[:, 1] * impulses[:, 0]
        change = world.angular_momentum(about) - moment
        assert change == pytest.approx(moments.sum(), abs=1e-4)


def test_the_moment_of_inertia() -> None:
    world = discs()
    world.apply_impulse(1, (0, 6), points=(52, 0))  # at the right end of the second disc
    # I = 4 · 2² / 2 = 8, the moment is 2 · 6.
    assert world.velocities[1].tolist() == [0, 1.5] and world.angular_velocities.tolist() == [
        0,
        1.5,
        0,
    ]


def test_the_nearest_image_of_a_point() -> None:
    world = jostle.World([(0.5, 5)], 1.0, masses=2.0, period=10)
    world.apply_impulse(0, (0, 1), points=(9.5, 5))  # one to the left of the centre
    assert world.angular_velocities.tolist() == [-1.0]


def test_what_does_not_move_or_rotate() -> None:
    world = jostle.World(
        [(0, 0), (5, 0)], [1.0, 0.0], masses=1.0, movable=[False, True], velocities=[(1, 1), (0, 0)]
    )
    world.apply_impulse([0, 1], [(9, 9), (1, 0)], points=[(0, 1), (5, 1)])
    assert world.velocities.tolist() == [[1, 1], [1, 0]]
    assert not world.angular_velocities.any()


def test_sleepers_wake() -> None:
    box = jostle.Box(-9, 0, 99, 9)
    world = jostle.World([(0, 1), (50, 1)], 1.0, gravity=(0, -10), restitution=0.5, container=box)
    world.step(1 / 60, steps=90)
    assert world.asleep.all()
    world.apply_impulse(0, (0, 0))  # nothing changes
    assert world.asleep.all()
    world.apply_impulse(0, (0, 3))
    assert world.asleep.tolist() == [False, True]
    world.step(1 / 60)
    assert world.positions[0, 1] > 1.03


def test_an_impulse_is_in_snapshots_and_copies() -> None:
    world = discs()
    world.apply_impulse(0, (1, 2), points=(0, 1))
    for other in (copy.copy(world), jostle.World.restore(world.snapshot())):
        assert other.state_hash() == world.state_hash()


def test_a_force_lasts_one_call_and_is_in_snapshots() -> None:
    world = discs()
    world.apply_force([0, 1, 0], [(4, 0), (0, 8), (0, 2)])
    others = [copy.copy(world), jostle.World.restore(world.snapshot())]
    assert world.net_forces().tolist() == [[4, 2], [0, 8], [0, 0]]
    for each in [world, *others]:
        each.step(0.25, steps=4)
        np.testing.assert_allclose(each.velocities, [(2, 1), (0, 2), (0, 0)], atol=1e-6)
        expected = np.add(AT, [(1, 0.5), (0, 1), (0, 0)])  # ½ a t²
        np.testing.assert_allclose(each.positions, expected, atol=1e-5)
        assert not each.net_forces().any()
        each.step(1.0)
        np.testing.assert_allclose(each.velocities, [(2, 1), (0, 2), (0, 0)], atol=1e-6)


@given(st.data())
def test_a_force_at_a_point_accelerates_and_turns(data: st.DataObject) -> None:
    """A free disc under gravity, in one step or many: the equations of motion."""
    number = st.floats(-4, 4, width=32)
    pair = st.tuples(number, number)
    radius, mass = (data.draw(st.floats(0.5, 3, width=32)) for _ in range(2))
    center, start = np.array(data.draw(pair)), np.array(data.draw(pair))
    turning, steps = data.draw(number), data.draw(st.sampled_from([1, 7]))
    forces, points = (np.array([data.draw(pair) for _ in range(3)]) for _ in range(2))
    world = jostle.World(
        np.array([center, (90, 90)]), radius, masses=mass, velocities=np.array([start, (0, 0)]),
        gravity=(0, 2), angular_velocities=[turning, 1], angles=0.5,
    )  # fmt: skip
    world.apply_force([0, 0, 0], forces, points)
    if data.draw(st.booleans()):
        world = jostle.World.restore(world.snapshot())
    seconds = 0.5
    world.step(seconds / steps, steps)
    arms = points - center
    torque = (arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0]).sum()
    turn = torque / (0.5 * mass * radius**2)
    change = forces.sum(axis=0) / mass + (0, 2)
    close: dict[str, Any] = {"rtol": 1e-4, "atol": 1e-4}
    np.testing.assert_allclose(world.velocities[0], start + change * seconds, **close)
    np.testing.assert_allclose(world.angular_velocities, [turning + turn * seconds, 1], **close)
    way = start * seconds + change * seconds**2 / 2
    np.testing.assert_allclose(world.positions[0], center + way, **close)
    angle = 0.5 + turning * seconds + turn * seconds**2 / 2
    np.testing.assert_allclose(np.exp(1j * world.angles[0]), np.exp(1j * angle), atol=2e-4)
    # In the next call nothing acts.
    before = world.angular_velocities
    world.step(0.25)
    assert (world.angular_velocities == before).all()


@pytest.mark.parametrize("torque", [3.0, -12.0, 60.0])
def test_a_wheel_that_is_driven_rolls_or_slips(torque: float) -> None:
    """On a floor with friction, by a torque alone: two opposite forces."""
    mass, radius, gravity, friction = 2.0, 1.5, 10.0, 0.4
    world = jostle.World(
        [(0, radius)], radius, masses=mass, friction=friction, gravity=(0, -gravity),
        restitution=0.0, container=jostle.Box(-200, 0, 200, 99),
    )  # fmt: skip
    seconds, steps = 1.0, 60
    for _ in range(steps):
        x = world.positions[0, 0]
        ends = [(x + 1, radius), (x - 1, radius)]
        world.apply_force([0, 0], [(0, torque / 2), (0, -torque / 2)], ends)
        world.step(seconds / steps)
    inertia = mass * radius**2 / 2
    speed, turning = world.velocities[0, 0], world.angular_velocities[0]
    rolling = -torque * radius / (inertia + mass * radius**2)
    if abs(mass * rolling) < friction * mass * gravity:
        assert speed == pytest.approx(rolling * seconds, rel=0.01)
        assert turning * radius == pytest.approx(-speed, rel=0.01)
    else:
        assert speed == pytest.approx(-np.sign(torque) * friction * gravity * seconds, rel=0.02)
        grip = friction * mass * gravity * radius
        expected = (torque - np.sign(torque) * grip) / inertia
        assert turning == pytest.approx(expected * seconds, rel=0.02)


def test_a_torque_does_not_turn_what_friction_holds() -> None:
    """A disc on a corner, whose friction is larger than the torque: no creep of the angle."""
    corner = jostle.Box(0, 0, 9, 9)
    world = jostle.World(
        [(1, 1)], 1.0, masses=1.0, friction=1.0, gravity=(-10, -10), restitution=0.0,
        container=corner, sleeping=False,
    )  # fmt: skip
    for _ in range(60):
        world.apply_force([0, 0], [(0, 1), (0, -1)], [(2, 1), (0, 1)])
        world.step(1 / 60)
    assert abs(world.angles[0]) < 1e-3 and abs(world.angular_velocities[0]) < 1e-3
    free = jostle.World([(1, 1)], 1.0, masses=1.0)
    free.apply_force([0, 0], [(0, 1), (0, -1)], [(2, 1), (0, 1)])
    free.step(1 / 60, 60)
    assert free.angular_velocities[0] == pytest.approx(4.0, rel=1e-4)


def test_forces_at_points_of_what_does_not_move_or_rotate() -> None:
    """Immovable discs, kinematic ones among them, and discs of radius 0; the nearest image."""
    world = jostle.World(
        [(0, 0), (5, 0), (9, 9)], [1.0, 0.0, 1.0], masses=1.0, movable=[False, True, False],
        velocities=[(1, 1), (0, 0), (0, 0)], angular_velocities=[2, 0, 0],
    )  # fmt: skip
    world.apply_force([0, 1, 2], (0, 1), points=(0, 50))
    world.step(1.0)
    assert world.velocities.tolist() == [[1, 1], [0, 1], [0, 0]]
    assert world.angular_velocities.tolist() == [2, 0, 0]
    world = jostle.World([(0.5, 5)], 1.0, masses=2.0, period=10)
    world.apply_force(0, (0, 1), points=(9.5, 5))  # one to the left of the centre
    world.step(1.0)
    assert world.angular_velocities.tolist() == [-1.0]


def test_one_vector_for_all() -> None:
    one, each = discs(), discs()
    for world, vector in ((one, (1, 0)), (each, [(1, 0)] * 3)):
        world.apply_force([0, 1, 2], vector, points=(0, 3))
        world.step(0.1)
        world.apply_impulse([2, 1, 0], vector, points=(0, -3))
        world.accelerations = vector
        assert world.accelerations.tolist() == [[1, 0]] * 3
        world.step(0.1)
    assert one.state_hash() == each.state_hash() and one.angular_velocities.all()
    for world in (one, jostle.World(np.zeros((0, 2)), 1.0)):
        world.apply_force([], (1, 0))
        world.apply_impulse([], (1, 0), points=(0, 0))


def test_accelerations_replace_forces_and_their_torques() -> None:
    world = discs()
    world.apply_force(0, (1, 0), points=(0, 1))
    world.accelerations = (0, 1)
    world.step(0.5)
    assert not world.angular_velocities.any()
    np.testing.assert_allclose(world.velocities, [(0, 0.5)] * 3, atol=1e-6)
    world.apply_force(0, (1, 0), points=(0, 1))
    world.accelerations = None
    world.step(0.5)
    assert not world.angular_velocities.any()


def test_torques_of_particles_that_merge_add_up() -> None:
    world = jostle.World(
        [(0, 0), (2.1, 0)], [1.0, 1.2], masses=[2.0, 3.0], velocities=[(9, 0), (0, 0)],
        on_touch="merge",
    )  # fmt: skip
    ends = np.array([(1, 0), (-1, 0)])
    for id, torque in ((0, 1.0), (1, 5.0)):
        forces = [(0, torque / 2), (0, -torque / 2)]
        world.apply_force([id, id], forces, world.positions[id] + ends)
    moment = world.angular_momentum()
    world.step(0.01, 100)
    assert len(world) == 1
    inertia = 0.5 * 5.0 * (1.0 + 1.2**2)
    # Both have their torques from the beginning, and the sum of both after they are one.
    turned = world.angular_momentum() - moment
    assert turned == pytest.approx(6.0, rel=0.02)
    assert world.angular_velocities[0] * inertia == pytest.approx(
        world.angular_momentum(about=world.positions[0]), rel=1e-4
    )


def test_a_force_at_a_point_wakes_and_is_the_same_for_all_threads() -> None:
    draw = np.random.default_rng(4)
    at = np.mgrid[0:40, 0:30].reshape(2, -1).T * 2.02 + 1.2
    kinds: list[tuple[int, Any]] = [(1, "quadtree"), (2, "quadtree"), (1, "brute")]
    made = [
        jostle.World(
            at, 1.0, gravity=(0, -10), friction=0.6, restitution=0.3, threads=threads,
            container=jostle.Box(0, 0, 90, 90), method=method,
        )
        for threads, method in kinds
    ]  # fmt: skip
    for _ in range(4):
        ids = draw.integers(0, len(at), 300)
        forces = draw.normal(0, 60, (300, 2))
        points = made[0].positions[ids] + draw.normal(0, 1, (300, 2))
        for world in made:
            world.apply_force(ids, forces, points)
            world.step(1 / 60, 2)
    assert len({world.state_hash() for world in made}) == 1
    assert abs(made[0].angular_velocities).max() > 1


def test_bad_input_of_apply_force() -> None:
    world = discs()
    for arguments, message in (
        ((0, (1, 1), [(0, 0)]), r"^points has shape \(1, 2\); it must be \(2,\), as there is one"),
        (([0, 1], (1, 1), [(0, 0), (0, np.nan)]), r"^points\[1\] is \(0, NaN\); both coord"),
        ((0, (0, 1e18), (1e18, 0)), r"^forces is .*; the acceleration of particle 0 would be"),
        ((3, (0, 0), (0, 0)), r"^ids is 3; no particle has this id"),
    ):
        with pytest.raises(ValueError, match=message):
            world.apply_force(*arguments)
    with pytest.raises(TypeError, match="did you mean 'points'"):
        world.apply_force(0, (1, 1), point=(0, 0))  # type: ignore[call-arg]
    world.step(0.1)
    assert not world.velocities.any() and not world.angular_velocities.any()


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((3, (0, 0)), jostle.IdError, "ids is 3; no particle has this id; ids are below 3"),
        (
            ([0, 3], [(0, 0)] * 2),
            jostle.IdError,
            "ids[1] is 3; no particle has this id; ids are below 3",
        ),
        (
            ([0, 1], [(1, 1)] * 3),
            ValueError,
            "impulses has shape (3, 2); it must be (2,) or (2, 2)",
        ),
        (
            (0, [(1, 1)]),
            ValueError,
            "impulses has shape (1, 2); it must be (2,), as there is one id",
        ),
        ((0, "x"), TypeError, None),
        (
            ([0, 1], [(1, 1), (np.nan, 0)]),
            ValueError,
            "impulses[1] is (NaN, 0); both coordinates must be finite",
        ),
        (
            ([0, 1], [(1, 1)] * 2, [(0, 0), (0, np.inf)]),
            ValueError,
            "points[1] is (0, inf); both coordinates must be finite",
        ),
        (
            ([0, 1], [(1, 1)] * 2, [(0, 0)]),
            ValueError,
            "points has shape (1, 2); it must be (2,) or (2, 2)",
        ),
        (
            ([0, 2], [(1, 1), (1e18, 0)]),
            ValueError,
            "impulses[1] is (1000000000000000000, 0); the velocity of particle 2 would be too "
            "large",
        ),
    ],
    ids=str,
)
def test_bad_input(arguments: Any, error: type[Exception], message: str | None) -> None:
    world = discs(velocities=(1, 2))
    before = world.state_hash()
    with pytest.raises(error, match=message and f"^{re.escape(message)}$"):
        world.apply_impulse(*arguments)
    assert world.state_hash() == before
