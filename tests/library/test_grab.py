"""`Grab`, which brings a particle to a point."""

import math
import re
from typing import Any

import numpy as np
import pytest
from copies import WAYS

import jostle

STEP = 1 / 60


def test_they_are_values() -> None:
    grab = jostle.Grab(1, (2, 0.5), rate=20, max_force=30)
    assert (grab.id, grab.point, grab.rate, grab.max_force) == (1, (2, 0.5), 20, 30)
    assert repr(grab) == "Grab(1, (2.0, 0.5), rate=20.0, max_force=30.0)"
    assert jostle.Grab(1, (2, 0.5), rate=20).max_force == math.inf
    assert all(way(grab) == grab and hash(way(grab)) == hash(grab) for way in WAYS)
    assert grab != jostle.Grab(1, (2, 0.5), rate=20)
    world = jostle.World([(0, 0), (5, 5)], 1.0, forces=[grab])
    assert world.forces == (grab,)
    assert jostle.World.restore(world.snapshot()).forces == (grab,)


def test_the_way_is_that_of_critical_damping() -> None:
    rate, distance = 4.0, 3.0
    world = jostle.World([(0, 0)], 1.0, forces=[jostle.Grab(0, (distance, 0), rate=rate)])
    for _ in range(10):
        world.step(1e-3, steps=100)
        t = world.time
        left = distance * (1 + rate * t) * math.exp(-rate * t)
        assert distance - world.positions[0, 0] == pytest.approx(left, abs=0.01)


@pytest.mark.parametrize("rate", [1.0, 60.0, 1e3, 1e6])
@pytest.mark.parametrize("dt", [1 / 240, 1 / 20, 1.0])
def test_it_arrives_at_any_length_of_a_step(rate: float, dt: float) -> None:
    world = jostle.World([(0, 0)], 1.0, velocities=(3, -2), masses=7.0)
    world.forces = [jostle.Grab(0, (4, 1), rate=rate)]
    farthest = 0.0
    for _ in range(300):
        world.step(dt, steps=max(1, round(0.1 / dt)))
        farthest = max(farthest, float(np.abs(world.positions).max()))
    np.testing.assert_allclose(world.positions, [(4, 1)], atol=1e-3)
    assert farthest < 9


@pytest.mark.parametrize("rate", [3.0, 20.0, 200.0, 1e5])
@pytest.mark.parametrize("dt", [1 / 240, 1 / 60, 0.5])
def test_from_rest_it_never_goes_beyond_the_point(rate: float, dt: float) -> None:
    world = jostle.World([(0, 0)], 1.0, forces=[jostle.Grab(0, (5, -2), rate=rate)])
    for _ in range(int(12 / dt)):
        world.step(dt)
        assert (world.positions[0] * (1, -1) < (5 + 1e-4, 2 + 1e-4)).all()
    np.testing.assert_allclose(world.positions, [(5, -2)], atol=1e-4)


def test_it_pushes_what_is_in_the_way_and_leaves_immovable_particles() -> None:
    pull = jostle.Grab(0, (8, 0), rate=10)
    world = jostle.World([(0, 0), (5, 0)], 1.0, masses=[10, 1], restitution=0, forces=[pull])
    world.step(STEP, steps=120)
    assert world.positions[0, 0] == pytest.approx(8, abs=0.05) and world.positions[1, 0] > 9.9
    world = jostle.World([(0, 0)], 1.0, movable=False, forces=[pull])
    world.step(STEP, steps=60)
    assert world.positions.tolist() == [[0, 0]]


def test_the_force_has_a_limit() -> None:
    world = jostle.World([(0, 0)], 1.0, masses=2.0)
    world.forces = [jostle.Grab(0, (3e3, 4e3), rate=20, max_force=10)]
    world.step(STEP, steps=60)
    np.testing.assert_allclose(world.velocities, [(3, 4)], rtol=1e-4)
    # The weight of the particle is 20.
    for most, sag in ((19.0, math.inf), (1e4, 10 / 20**2)):
        world = jostle.World([(0, 9)], 1.0, masses=2.0, gravity=(0, -10), restitution=0)
        world.container = jostle.Box(-9, 0, 9, 99)
        world.forces = [jostle.Grab(0, (0, 9), rate=20, max_force=most)]
        world.step(STEP, steps=600)
        height = 9 - sag if math.isfinite(sag) else 1.0
        assert world.positions[0, 1] == pytest.approx(height, abs=0.01)


def test_it_takes_the_nearest_image_of_the_point() -> None:
    world = jostle.World([(1, 5)], 0.5, period=20)
    world.forces = [jostle.Grab(0, (19, 5), rate=10)]
    world.step(STEP)
    assert world.velocities[0, 0] < 0
    world.step(STEP, steps=120)
    np.testing.assert_allclose(world.positions, [(19, 5)], atol=1e-3)


def pile(**settings: Any) -> jostle.World:
    """A row of small heaps, and a disc that hangs above them."""
    heaps = [(x + dx, y) for x in range(0, 60, 10) for dx, y in ((0, 1), (2, 1), (1, 2.8))]
    return jostle.World(
        [*heaps, (30, 30)], 1.0, gravity=(0, -10), restitution=0.2, friction=0.4,
        container=jostle.Box(-20, 0, 80, 90), **settings,
    )  # fmt: skip


def test_others_stay_asleep_while_the_point_moves() -> None:
    world = pile()
    for frame in range(400):
        world.forces = [jostle.Grab(18, (30 + 10 * math.sin(frame / 30), 30), rate=20)]
        world.step(STEP)
    assert world.asleep[:18].all() and not world.asleep[18]
    world.forces = [jostle.Grab(18, (31, 2), rate=20)]
    world.step(STEP, steps=60)
    assert not world.asleep[[9, 10, 11]].any() and world.asleep[[0, 1, 2, 15, 16, 17]].all()


def test_contacts_of_others_keep_their_impulses() -> None:
    """Others have the bits that they have with a force that is never assigned again."""
    worlds = [pile(sleeping=False), pile(sleeping=False)]
    held = jostle.Grab(18, (30, 30), rate=20)
    worlds[0].forces = [held]
    for frame in range(120):
        worlds[1].forces = [jostle.Grab(18, (30 + frame / 60, 30), rate=20)]
        for world in worlds:
            world.step(STEP)
    assert worlds[0].positions[:18].tobytes() == worlds[1].positions[:18].tobytes()
    assert worlds[0].velocities[:18].tobytes() == worlds[1].velocities[:18].tobytes()
    assert worlds[1].positions[18, 0] > 31


def test_a_sleeping_particle_wakes_and_sleeps_again_after_its_release() -> None:
    world = pile()
    world.remove(18)
    world.step(STEP, steps=400)
    assert world.asleep.all()
    world.forces = [jostle.Grab(2, (1, 2.8), rate=20)]
    assert not world.asleep[:3].any() and world.asleep[3:].all()
    world.step(STEP, steps=200)
    assert not world.asleep[2]
    world.forces = []
    world.step(STEP, steps=200)
    assert world.asleep.all()


def test_it_goes_with_its_particle() -> None:
    world = jostle.World([(0, 0), (9, 0), (18, 0)], 1.0)
    world.forces = [jostle.Grab(2, (18, 5), rate=5), jostle.Grab(1, (9, 5), rate=5)]
    world.remove(1)
    assert world.forces == (jostle.Grab(2, (18, 5), rate=5),)
    world.step(0.1, steps=50)
    np.testing.assert_allclose(world.get(2).positions, (18, 5), atol=1e-3)
    merging = jostle.World([(0, 0), (3, 0)], 1.0, on_touch="merge")
    merging.forces = [jostle.Grab(1, (-5, 0), rate=5)]
    merging.step(STEP, steps=200)
    assert len(merging) == 1 and merging.forces == (jostle.Grab(0, (-5, 0), rate=5),)


def test_threads_method_and_order_do_not_show() -> None:
    draw = np.random.default_rng(0)
    at = np.stack(np.meshgrid(np.arange(20), np.arange(20)), -1).reshape(-1, 2) * 2.5
    speeds, found = draw.normal(size=(400, 2)) * 3, set()
    for settings in ({"threads": 1}, {"threads": 2}, {"method": "brute"}):
        for order in (np.arange(400), draw.permutation(400)):
            world = jostle.World(at[order], 1.0, velocities=speeds[order], **settings)
            row = int(np.flatnonzero(order == 210)[0])
            world.forces = [jostle.Grab(row, (0, 0), rate=30, max_force=500)]
            world.step(STEP, steps=60)
            found.add(world.positions[np.argsort(order)].tobytes())
    assert len(found) == 1


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: jostle.Grab(-1, (0, 0), rate=1), jostle.IdError, "id is -1; no particle has"),
        (lambda: jostle.Grab(2**70, (0, 0), rate=1), jostle.IdError, f"id is {2**70}; no particle"),
        (lambda: jostle.Grab(True, (0, 0), rate=1), TypeError, "id must be an integer, not bool"),
        (lambda: jostle.Grab("a", (0, 0), rate=1), TypeError, "id must be an integer"),
        (lambda: jostle.Grab(0, (0, math.nan), rate=1), ValueError, "point is (0, NaN); both"),
        (lambda: jostle.Grab(0, (0, 0, 0), rate=1), ValueError, "point has shape (3,)"),
        (lambda: jostle.Grab(0, (0, 0), rate=-1), ValueError, "rate is -1; it must be finite"),
        (lambda: jostle.Grab(0, (0, 0), rate=math.inf), ValueError, "rate is inf; it must be"),
        (
            lambda: jostle.Grab(0, (0, 0), rate=1, max_force=-1),
            ValueError,
            "max_force is -1; it must be at least 0",
        ),
        (
            lambda: jostle.World([(0, 0)], 1.0, forces=[jostle.Grab(1, (0, 0), rate=1)]),
            jostle.IdError,
            "forces[0] is a force on particle 1; ",
        ),
    ],
)
def test_wrong_ones_are_refused(make: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        make()
