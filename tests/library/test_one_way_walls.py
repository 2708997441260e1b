"""Walls that stop only what comes from the left of start → end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import jostle

PLATFORM = ((-3.0, 0.0), (3.0, 0.0))  # its left is above it
Floats = NDArray[np.float64]


def platform(**columns: Any) -> dict[str, Any]:
    return {"segments": [PLATFORM], "one_way": True, **columns}


@pytest.mark.parametrize("radius", [0.0, 0.05, 1.0])
@pytest.mark.parametrize("speed", [0.5, 50.0, 5000.0])
def test_it_stops_discs_from_the_left_at_any_speed_and_no_others(radius, speed) -> None:
    world = jostle.World(
        [(-1, speed / 2 + radius), (1, -speed / 2)], radius, velocities=[(0, -speed), (0, speed)],
        masses=1.0, masks=0b10, walls=platform(categories=0b10),
    )  # fmt: skip
    world.step(1.0)
    assert world.positions[0, 1] == pytest.approx(speed / 2 + radius, rel=1e-5)
    assert world.positions[1, 1] == pytest.approx(speed / 2, rel=1e-5)
    assert world.velocities[:, 1].tolist() == [speed, speed]


def test_a_disc_that_turns_within_it_falls_back_as_if_it_were_not_there() -> None:
    """At every height from below it to nearly above it, in steps of any length."""
    for height in np.linspace(-1.5, 0.95, 50):
        for dt in (1 / 60, 0.7):
            rise = np.sqrt(2 * 10 * (height + 4))
            with_it, without = (
                jostle.World([(0, -4)], 1.0, velocities=(0, rise), gravity=(0, -10), walls=walls)
                for walls in (platform(), None)
            )
            for world in (with_it, without):
                world.step(dt, steps=round(2.1 / dt))
            np.testing.assert_array_equal(with_it.positions, without.positions)
            assert with_it.positions[0, 1] < -4


@pytest.mark.parametrize("dt", [1 / 60, 0.5, 2.5])
def test_a_disc_that_rises_above_it_bounces_there(dt: float) -> None:
    """Also if both happens within one step."""
    world = jostle.World(
        [(0, -3)], 1.0, velocities=(0, 12), gravity=(0, -10), substeps=1, walls=platform()
    )
    world.step(dt, steps=round(2.5 / dt))
    # It is all above at the first root of -3 + 12 t - 5 t² = 1, and comes back at the second one,
    # 2 s, with the speed 8.
    assert world.positions[0, 1] == pytest.approx(3.75, abs=1e-3)
    assert world.velocities[0, 1] == pytest.approx(3, abs=1e-3)


def impacts(
    at: Floats, velocity: Floats, radius: float, wall: Floats
) -> list[tuple[float, Floats]]:
    """Times and normals of the impacts of a straight path on a wall, by its definition."""
    (a, b), found = wall, []
    length = np.hypot(*(b - a))
    along = (b - a) / length
    left = np.array([-along[1], along[0]])
    gap, speed = (at - a) @ left - radius, velocity @ left
    if gap >= -radius / 64 and speed < 0:
        time = max(gap, 0) / -speed
        if 0 <= (at + velocity * time - a) @ along <= length:
            found.append((time, left))
    for end, sign in ((a, -1), (b, 1)):
        offset = at - end
        half, rest = offset @ velocity, offset @ offset - radius**2
        discriminant = half**2 - (velocity @ velocity) * rest
        if rest < -(radius**2) / 64 or half >= 0 or discriminant < 0:
            continue
        time = max(rest, 0) / (-half + np.sqrt(discriminant))
        there = at + velocity * time - end
        if there @ left > 0 and sign * (there @ along) > 0:
            found.append((time, there / np.hypot(*there)))
    return found


def test_random_flights_are_those_of_an_oracle() -> None:
    draw, bounces = np.random.default_rng(2), 0
    for _ in range(150):
        starts = draw.uniform(-10, 10, (14, 2))
        walls = np.stack([starts, starts + draw.normal(scale=5, size=(14, 2))], 1)
        walls = walls.astype(np.float32).astype(float)
        at = draw.uniform(-10, 10, 2).astype(np.float32).astype(float)
        velocity = draw.normal(scale=10, size=2).astype(np.float32).astype(float)
        radius = 0.5
        world = jostle.World(
            [at], radius, velocities=[velocity], walls={"segments": walls, "one_way": True}
        )
        world.step(1.0)
        left = 1.0
        for _ in range(100):
            all_found = [hit for wall in walls for hit in impacts(at, velocity, radius, wall)]
            time, normal = min(all_found, key=lambda hit: hit[0], default=(2.0, velocity))
            at, left = at + velocity * min(time, left), left - time
            if left <= 0:
                break
            velocity, bounces = velocity - 2 * (velocity @ normal) * normal, bounces + 1
        np.testing.assert_allclose(world.positions[0], at, atol=2e-3)
    assert bounces > 80


GROUND = [(-9, 2), (-6, 0), (-3, 0), (-1, 0.5), (2, -0.5), (5, 1), (9, 3)]


@pytest.mark.parametrize("columns", [{}, {"friction": 0.5}])
def test_discs_roll_over_joints_as_on_walls_that_are_solid_from_both_sides(columns) -> None:
    ends = []
    for one_way in (True, False):
        walls = {"segments": jostle.polyline(GROUND), "one_way": one_way, **columns}
        world = jostle.World(
            [(-7, 3), (0, 3)], 0.4, velocities=[(1, 0), (2, 0)], gravity=(0, -10),
            restitution=0.2, friction=0.3, walls=walls,
        )  # fmt: skip
        world.step(1 / 60, steps=90)
        ends.append(world.positions)
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-3)


def test_the_tip_of_a_roof_stops_discs_from_both_of_its_sides() -> None:
    """Also one in the wedge above a sharp tip, which is left of one wall alone."""
    roof = jostle.polyline([(-1, -5), (0, 0), (1, -5)])
    for x in np.linspace(-0.9, 0.9, 19):
        ends = []
        for one_way in (True, False):
            world = jostle.World(
                [(x, 3)], 1.0, velocities=(0, -4), walls={"segments": roof, "one_way": one_way}
            )
            world.step(1.0)
            ends.append(world.positions)
        np.testing.assert_allclose(ends[0], ends[1], atol=1e-5)


def test_no_disc_falls_through_joints_of_walls_that_face_different_sides() -> None:
    """Ends act beside a wall that is solid from below alone, or from both sides."""
    for other, one_way in (([(0, 0), (-5, 0)], True), ([(-5, 0), (0, 0)], False)):
        for order in (1, -1):
            for x in np.linspace(-0.95, 2, 30):
                segments = [((0.0, 0.0), (5.0, 0.0)), other][::order]
                walls = {"segments": segments, "one_way": [True, one_way][::order]}
                world = jostle.World([(x, 3)], 1.0, velocities=(0, -4), walls=walls)
                world.step(1.0)
                assert world.last_call.wall_collisions == 1, (x, order)
                below = jostle.World([(x, -3)], 1.0, velocities=(0, 4), walls=walls)
                below.step(1.5)
                assert below.last_call.wall_collisions == (x < 1), (x, order, one_way)


@pytest.mark.usefixtures("usual_threads")
def test_a_pile_rests_and_sleeps_on_one() -> None:
    walls = {
        "segments": [((-5, 9), (-5, 0)), ((-5, 0), (0, 0)), ((0, 0), (5, 0)), ((5, 0), (5, 9))],
        "one_way": [False, True, True, False],
    }
    draw = np.random.default_rng(0)
    places = np.stack(np.meshgrid(np.arange(-4, 5), np.arange(1, 9)), -1).reshape(-1, 2)
    world = jostle.World(
        places + draw.uniform(-0.1, 0.1, places.shape), draw.uniform(0.2, 0.4, len(places)),
        gravity=(0, -10), restitution=0.2, friction=0.3, walls=walls,
    )  # fmt: skip
    world.step(1 / 60, steps=900)
    assert (world.positions[:, 1] > 0.15).all() and world.asleep.mean() > 0.9
    world.walls.set(world.walls.ids[1:3], segments=[((0, 0), (-5, 0)), ((5, 0), (0, 0))])
    world.step(1 / 60, steps=120)
    assert (world.positions[:, 1] < 0).all()


def test_lifts_carry_what_is_on_them_and_pass_what_is_below() -> None:
    world = jostle.World(
        [(-1.5, 1), (1.5, 4)], 0.5, gravity=(0, -10), restitution=0.2,
        walls=platform(velocities=(0, 2)), movable=[True, False],
    )  # fmt: skip
    world.add((1.5, 2.0), 0.5, movable=True, restitution=0.2, velocities=(0, 0), masks=0)
    world.step(1 / 60, steps=180)
    assert world.walls.segments[0, 0, 1] == pytest.approx(6)
    assert world.positions[0, 1] == pytest.approx(6.5, abs=0.01)
    assert world.positions[1].tolist() == [1.5, 4]


def busy(**settings: Any) -> jostle.World:
    draw = np.random.default_rng(4)
    starts = draw.uniform(0, 60, (80, 2))
    segments = np.stack([starts, starts + draw.normal(scale=5, size=(80, 2))], 1)
    walls = {"segments": segments, "one_way": draw.random(80) < 0.7, "velocities": (1, 0.5)}
    walls["categories"] = draw.integers(1, 4, 80)
    places = np.stack(np.meshgrid(np.arange(20), np.arange(20)), -1).reshape(-1, 2) * 3 + 1
    return jostle.World(
        places, 0.8, velocities=draw.normal(size=(400, 2)) * 5, gravity=(0, -10), restitution=0.5,
        friction=0.2, period=60, walls=walls, **settings,
    )  # fmt: skip


def test_neither_method_nor_threads_nor_a_snapshot_shows() -> None:
    hashes = set()
    for method, threads in (("quadtree", 1), ("quadtree", 2), ("brute", 2)):
        world = busy(method=method, threads=threads)
        world.step(1 / 60, steps=30)
        again = jostle.World.restore(world.snapshot())
        for one in (world, again):
            one.step(1 / 60, steps=30)
            hashes.add(one.state_hash())
        assert again.walls.one_way.tolist() == world.walls.one_way.tolist()
    assert len(hashes) == 1
