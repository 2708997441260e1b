"""`World.apply_impulse` and `apply_force`, against mechanics of a disc."""

import copy
import re
from typing import Any

import numpy as np
import pytest

import jostle

AT = [(0, 0), (50, 0), (0, 70)]


def discs(**rules: Any) -> jostle.World:
    """Three discs that do not touch."""
    given: dict[str, Any] = {"masses": [2.0, 4.0, 0.5]}
    return jostle.World(AT, [1.0, 2.0, 0.5], **given | rules)


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
        given = (arms[:, 0] * impulses[:, 1] - arms[:, 1] * impulses[:, 0]).sum()
        assert world.angular_momentum(about) - moment == pytest.approx(given, abs=1e-4)


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


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((3, (0, 0)), jostle.IdError, "ids is 3; no particle has this id; ids are below 3"),
        (
            ([0, 3], [(0, 0)] * 2),
            jostle.IdError,
            "ids[1] is 3; no particle has this id; ids are below 3",
        ),
        (([0, 1], (1, 1)), ValueError, "impulses has shape (2,); it must be (2, 2)"),
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
            "points has shape (1, 2); it must be (2, 2)",
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
