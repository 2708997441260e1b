"""`World.events`, collisions and sensors, as Python sees them."""

import numpy as np
import pytest
from results import fields

import jostle

STEP = 1 / 60
Pairs = set[tuple[int, int]]


def as_set(pairs: np.ndarray) -> Pairs:
    """Check the form of an array of pairs, and return it as a set."""
    assert pairs.dtype == np.int64 and pairs.shape == (len(pairs), 2)
    assert (pairs[:, 0] < pairs[:, 1]).all()
    rows: list[tuple[int, int]] = [tuple(pair) for pair in pairs.tolist()]
    assert rows == sorted(set(rows))
    return set(rows)


def numbers(world: jostle.World) -> tuple[int, int]:
    """The collisions of pairs and at walls."""
    return world.last_call.collisions, world.last_call.wall_collisions


def test_events_need_to_be_asked_for() -> None:
    world = jostle.World([(0, 0), (1, 0)], 1.0)
    assert world.track_events is False
    world.step(STEP)
    with pytest.raises(RuntimeError, match="track_events=True"):
        _ = world.events
    world.track_events = True
    assert all(len(column) == 0 for column in fields(world.events))
    world.step(STEP)
    assert as_set(world.events.entered) == {(0, 1)}
    assert jostle.World.restore(world.snapshot()).events.entered.tolist() == [[0, 1]]
    world.track_events = False
    with pytest.raises(RuntimeError):
        _ = world.events
    with pytest.raises(TypeError, match="track_events"):
        world.track_events = "yes"  # type: ignore[assignment]


def test_a_merged_particle_leaves() -> None:
    world = jostle.World(
        [(0, 0), (3, 0)], 1.0, velocities=[(9, 0), (0, 0)], on_touch="merge", track_events=True
    )
    world.step(0.2)
    assert as_set(world.events.entered) == as_set(world.events.exited) == {(0, 1)}
    assert world.ids.tolist() == [0]


def goal(**keywords: object) -> jostle.World:
    """Return a world of a disc in front of a gate of sensors in a row."""
    gate = [(5.0, y) for y in range(-4, 5, 2)]
    return jostle.World(
        [(0, 0), *gate],
        [0.5] + [1.0] * len(gate),
        velocities=[(3, 0)] + [(0, 0)] * len(gate),
        movable=[True] + [False] * len(gate),
        sensors=[False] + [True] * len(gate),
        track_events=True,
        **keywords,
    )


def test_a_sensor_reports_and_pushes_nothing() -> None:
    world = goal()
    seen: list[str] = []
    for _ in range(200):
        world.step(STEP)
        events = world.events
        entered, left = (pairs[pairs[:, 1] == 3] for pairs in (events.entered, events.exited))
        seen += ["entered"] * len(entered) + ["left"] * len(left)
        contacts = world.last_step.contacts
        if len(contacts.pairs):
            assert (contacts.normal_impulses == 0).all()
    assert seen == ["entered", "left"]
    assert world.velocities[0].tolist() == [3, 0]
    assert world.positions[0] == pytest.approx([10, 0], abs=1e-4)
    assert world.last_call.collisions == 0


def test_a_sensor_reports_a_disc_that_passes_in_one_step() -> None:
    for speed in (500, 1e4, 1e6):
        world = goal()
        world.set(0, velocities=(speed, 0))
        world.step(STEP)
        assert as_set(world.events.entered) == as_set(world.events.exited) == {(0, 3)}
        assert as_set(world.last_step.contacts.pairs) == {(0, 3)}


def test_a_disc_that_is_stopped_in_front_of_a_sensor_does_not_touch_it() -> None:
    """The straight line to where it would have been without the wall passes the sensor."""
    wall = [((3, -9), (3, 9))]
    world = goal(walls=wall)
    world.set(0, velocities=(300, 0))
    world.step(STEP)
    assert len(world.events.entered) == 0 and world.velocities[0, 0] == -300


def test_sensors_can_be_set_added_and_saved() -> None:
    world = jostle.World([(0, 0), (5, 0)], 1.0, sensors=[False, True])
    world.set(0, sensors=True)
    world.add((9, 0), 1.0, sensors=True)
    world.add((19, 0), 1.0)
    assert world.sensors.dtype == bool and world.sensors.tolist() == [True, True, True, False]
    assert jostle.World.restore(world.snapshot()).sensors.tolist() == world.sensors.tolist()
    with pytest.raises(ValueError, match="read-only"):
        world.sensors[0] = False
    with pytest.raises(ValueError, match="sensors"):
        world.sensors = [True]
    with pytest.raises(TypeError, match="sensors"):
        world.sensors = "no"
    world.sensors = False
    assert not world.sensors.any()


def test_sensors_obey_categories_and_masks() -> None:
    world = goal(categories=[1, 2, 2, 2, 2, 2], masks=[-1, 4, 4, 4, 4, 4])
    world.step(STEP, steps=200)
    assert len(world.events.entered) == 0


def test_a_sensor_reports_discs_that_are_not_movable() -> None:
    world = goal()
    world.set(0, movable=False)
    world.step(STEP, steps=100)
    assert as_set(world.events.entered) == {(0, 3)}
    world.set(0, velocities=(0, 0))
    world.step(STEP)
    assert as_set(world.events.stayed) == {(0, 3)}


def test_collisions_count_the_last_call() -> None:
    box = jostle.Box(-4, -1, 4, 1)
    world = jostle.World([(-3, 0), (0, 0)], 1.0, velocities=[(1, 0), (0, 0)], container=box)
    assert numbers(world) == (0, 0)
    world.step(0.5, steps=20)
    assert numbers(world) == (3, 2)
    assert jostle.World.restore(world.snapshot()).last_call == world.last_call
    world.step(0.5, steps=0)
    assert numbers(world) == (0, 0)


def test_a_refused_call_leaves_the_record_of_the_call_before() -> None:
    world = jostle.World(
        [(0, 0), (3, 0)], 1.0, velocities=[(3, 0), (0, 0)], gravity=(0, 1), track_events=True
    )
    world.step(1.0)
    assert world.last_call.collisions == 1
    before, events = world.snapshot(), world.events.entered.tolist()
    with pytest.raises(ValueError, match="dt is"):
        world.step(1e10)
    assert world.snapshot() == before
    assert world.last_call.collisions == 1 and world.events.entered.tolist() == events
