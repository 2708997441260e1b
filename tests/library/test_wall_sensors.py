"""`World.wall_events`: which particles touch walls, and walls that only report it."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import jostle

Floats = NDArray[np.float64]
Pairs = set[tuple[int, int]]
GATE = ((4.0, -1.0), (4.0, 1.0))


def told(world: jostle.World) -> list[Pairs]:
    """The pairs that entered, stayed and exited."""
    events = world.wall_events
    for pairs in (events.entered, events.stayed, events.exited):
        assert pairs.dtype == np.int64 and pairs.tolist() == np.unique(pairs, axis=0).tolist()
    return [
        {(a, b) for a, b in pairs.tolist()}
        for pairs in (events.entered, events.stayed, events.exited)
    ]


def flying(**columns: Any) -> jostle.World:
    walls = {"segments": [GATE], "sensors": True, **columns}
    return jostle.World([(0, 0)], 0.5, velocities=(2, 0), walls=walls, track_events=True)


def test_a_particle_enters_stays_and_exits() -> None:
    world, seen = flying(), []
    for _ in range(12):
        world.step(0.25)
        seen.append([len(pairs) for pairs in told(world)])
    # It touches the gate from x = 3.5 to 4.5.
    assert seen == [[0, 0, 0]] * 6 + [[1, 0, 0]] + [[0, 1, 0]] * 2 + [[0, 0, 1]] + [[0, 0, 0]] * 2
    assert world.positions.tolist() == [[6, 0]] and world.velocities.tolist() == [[2, 0]]


@pytest.mark.parametrize("speed", [20.0, 2e3, 2e5])
def test_one_that_crosses_within_a_step_enters_and_exits(speed: float) -> None:
    for way in (1, -1):
        fence = [((x, -1), (x, 1)) for x in (-3, -2, 2, 3, 1e9)]
        world = jostle.World(
            [(way * -10, 0)], 0.5, velocities=(way * speed, 0), track_events=True,
            walls={"segments": fence, "sensors": True},
        )  # fmt: skip
        world.step(1.0)
        crossed = {(0, wall) for wall in range(4)}
        assert told(world) == [crossed, set(), crossed]


def gap(point: Floats, wall: Floats) -> float:
    """The distance of a point from a segment."""
    along = wall[1] - wall[0]
    share = np.clip((point - wall[0]) @ along / (along @ along), 0, 1)
    return float(np.hypot(*(point - wall[0] - share * along)))


def nearest(path: Floats, wall: Floats) -> float:
    """The least distance of two segments."""

    def side(a: Floats, b: Floats, c: Floats) -> float:
        return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    crosses = side(*path, wall[0]) * side(*path, wall[1]) < 0
    if crosses and side(*wall, path[0]) * side(*wall, path[1]) < 0:
        return 0.0
    return min(*(gap(p, wall) for p in path), *(gap(q, path) for q in wall))


@pytest.mark.parametrize("dt", [0.1, 1.0, 20.0])
def test_events_are_those_of_brute_force(dt: float) -> None:
    draw = np.random.default_rng(5)
    places, ways = draw.uniform(0, 40, (30, 2)), draw.normal(size=(30, 2)) * 5
    radii = draw.uniform(0.1, 1, 30)
    starts = draw.uniform(0, 40, (40, 2))
    walls = np.stack([starts, starts + draw.normal(scale=4, size=(40, 2))], 1)
    walls = walls.astype(np.float32).astype(float)
    world = jostle.World(
        places, radii, velocities=ways, masks=2, track_events=True,
        walls={"segments": walls, "sensors": True, "categories": 2},
    )  # fmt: skip
    before: Pairs = set()
    for _ in range(5):
        at = world.positions.astype(float)
        world.step(dt)
        paths = np.stack([at, world.positions.astype(float)], 1)
        during: Pairs = set()
        at_end: Pairs = set()
        for i, path in enumerate(paths):
            for w, wall in enumerate(walls):
                if nearest(path, wall) <= world.radii[i]:
                    during.add((i, w))
                if gap(path[1], wall) <= world.radii[i]:
                    at_end.add((i, w))
        assert told(world) == [
            (during | at_end) - before,
            before & at_end,
            (before | during) - at_end,
        ]
        before = at_end
    assert len(during) > 5 or dt != 1


@pytest.mark.parametrize("dt", [0.02, 2.0])
def test_a_path_that_gravity_curves_touches_what_it_reaches(dt: float) -> None:
    """Sensors above and below the highest point, and one at the side of a slope."""
    rise = np.sqrt(2 * 10 * 5)
    walls = [((-1, 5.99), (1, 5.99)), ((-1, 6.02), (1, 6.02)), ((1.05, 3), (1.05, 4))]
    world = jostle.World(
        [(0, 0)], 1.0, velocities=(0, rise), gravity=(0, -10), track_events=True, substeps=1,
        walls={"segments": walls, "sensors": True},
    )  # fmt: skip
    seen: Pairs = set()
    for _ in range(round(2 / dt)):
        world.step(dt)
        seen |= told(world)[0]
    assert seen == {(0, 0)}


def busy(sensors: bool = True, **settings: Any) -> jostle.World:
    draw = np.random.default_rng(4)
    starts = draw.uniform(0, 60, (60, 2))
    segments = np.stack([starts, starts + draw.normal(scale=5, size=(60, 2))], 1)
    only = np.arange(60) % 3 == 0
    walls = {"segments": segments, "sensors": only, "velocities": (1, 0.5)}
    places = np.stack(np.meshgrid(np.arange(20), np.arange(20)), -1).reshape(-1, 2) * 3 + 1
    world = jostle.World(
        places, 0.8, velocities=draw.normal(size=(400, 2)) * 5, gravity=(0, -10), restitution=0.5,
        friction=0.2, period=60, walls=walls, track_events=True, **settings,
    )  # fmt: skip
    if not sensors:
        world.walls.remove(world.walls.ids[only])
    return world


def test_sensors_change_nothing_and_neither_method_nor_threads_show() -> None:
    hashes, events = set(), []
    worlds = [busy(threads=1), busy(threads=2), busy(method="brute"), busy(sensors=False)]
    for world in worlds:
        for _ in range(30):
            world.step(1 / 60)
            if world is not worlds[-1]:
                events.append(told(world))
        hashes.add(world.state_hash())
    assert len(hashes) == 1 and events[:30] == events[30:60] == events[60:]
    assert any(wall % 3 == 0 for step in events for _, wall in step[0])
    assert any(wall % 3 and wall >= 0 for step in events for _, wall in step[0])


def test_solid_walls_and_sides_report_touches_too() -> None:
    world = jostle.World(
        [(-5, 2), (5, 2)], 1.0, velocities=[(0, -4), (4, 0)], track_events=True,
        walls=[((-9, 0), (0, 0))], container=jostle.Box(-10, -10, 10, 10),
    )  # fmt: skip
    world.step(0.5)
    assert told(world) == [{(0, 0)}, set(), {(0, 0)}]
    world.step(1.0)
    assert told(world) == [{(1, jostle.Side.MAX_X)}, set(), {(1, jostle.Side.MAX_X)}]


def test_what_rests_and_sleeps_on_a_wall_stays_until_the_wall_goes() -> None:
    world = jostle.World(
        [(0, 1.5)], 1.0, gravity=(0, -10), restitution=0, track_events=True,
        walls=[((-9, 0), (9, 0))],
    )  # fmt: skip
    world.step(1 / 60, steps=120)
    assert told(world) == [{(0, 0)}, set(), set()] and world.asleep.all()
    world.step(1 / 60, steps=10)
    assert told(world) == [set(), {(0, 0)}, set()]
    restored = jostle.World.restore(world.snapshot())
    again = pickle.loads(pickle.dumps(world))
    for one in (world, restored, again):
        assert told(one) == [set(), {(0, 0)}, set()]
        one.walls.remove(0)
        one.step(1 / 60)
        assert told(one) == [set(), set(), {(0, 0)}]


def test_filters_moving_sensors_and_immovable_particles() -> None:
    world = jostle.World(
        [(0, 0), (0, 3), (0, 6)], 0.5, masks=[1, 2, 1], movable=[True, True, False],
        walls={"segments": [((-2, -9), (-2, 9))], "sensors": True, "velocities": (4, 0)},
        track_events=True,
    )  # fmt: skip
    world.step(0.5)
    assert told(world)[0] == {(0, 0), (2, 0)}
    world.step(0.5)
    assert told(world)[2] == {(0, 0), (2, 0)}
    world.step(2.0)
    assert told(world) == [set(), set(), set()]


def test_a_sensor_that_joins_a_wall_does_not_take_its_end_away() -> None:
    for order in (1, -1):
        walls = {"segments": [((-5, 0), (0, 0)), ((0, 0), (5, 0))][::order]}
        walls["sensors"] = [False, True][::order]
        world = jostle.World([(0.5, 3)], 1.0, velocities=(0, -4), walls=walls, track_events=True)
        world.step(1.0)
        assert world.last_call.wall_collisions == 1 and world.velocities[0, 0] > 0
        assert told(world)[0] == {(0, 0), (0, 1)}


def test_sensors_act_across_the_edges_of_a_period() -> None:
    world = jostle.World(
        [(9, 5)], 0.5, velocities=(30, 0), period=10, track_events=True,
        walls={"segments": [((0.2, 4), (0.2, 6)), ((5, 8), (5, 9))], "sensors": True},
    )  # fmt: skip
    world.step(0.1)
    assert told(world) == [{(0, 0)}, set(), {(0, 0)}]


def test_events_need_to_be_tracked_and_sensors_are_a_column() -> None:
    world = flying()
    world.track_events = False
    world.step(1.0)
    with pytest.raises(RuntimeError, match="track_events"):
        _ = world.wall_events
    assert world.walls.sensors.tolist() == [True] and world.walls.get(0).sensors is True
    world.walls.sensors = False
    world.step(5.0)
    assert world.velocities.tolist() == [[-2, 0]]
    with pytest.raises(TypeError, match="sensors must hold bool"):
        world.walls.set(0, sensors="yes")
