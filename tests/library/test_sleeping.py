"""Islands that rest fall asleep, and wake when something touches them or changes."""

import copy
import math
from typing import Any

import pytest

import jostle

STEP = 1 / 60
BOX = jostle.Box(-13, 0, 13, 100)


def triangle(x: float) -> list[tuple[float, float]]:
    return [(x - 1, 1), (x + 1, 1), (x, 1 + math.sqrt(3))]


def world_of(centers: Any, **rules: Any) -> jostle.World:
    usual: dict[str, Any] = {"gravity": (0, -9.8), "restitution": 0.3, "container": BOX}
    usual["friction"] = 0.6
    return jostle.World(centers, 1.0, **usual | rules)


def asleep(*centers: float) -> jostle.World:
    """Return triangles that sleep."""
    world = world_of([disc for x in centers for disc in triangle(x)])
    world.step(STEP, steps=90)
    if not world.asleep.all():
        # Rounding lets discs roll for a while, at some millionths of their radius in a second.
        world.step(STEP, steps=60)
    assert world.asleep.all()
    return world


def test_a_sleeping_world_does_not_search() -> None:
    world = asleep(0)
    before = (
        world.state_hash(),
        world.last_step.contacts.pairs.tolist(),
        world.last_step.wall_contacts.ids.tolist(),
    )
    energy = world.potential_energy()
    assert before[1] and before[2]
    world.step(STEP, steps=1000)
    after = (
        world.state_hash(),
        world.last_step.contacts.pairs.tolist(),
        world.last_step.wall_contacts.ids.tolist(),
    )
    assert after == before
    assert world.kinetic_energy() == 0 and not world.momentum().any()
    assert world.potential_energy() == energy
    assert world.stats.tests == world.stats.nodes == 0
    assert sum(world.profile.values()) == 0
    assert world.time == pytest.approx(1090 * STEP)


def test_the_column_is_a_read_only_copy() -> None:
    world = asleep(-5, 5)
    assert world.asleep.shape == (6,) and world.asleep.dtype == bool
    with pytest.raises(ValueError, match="read-only"):
        world.asleep[0] = False
    with pytest.raises(AttributeError):
        world.asleep = True  # type: ignore[misc]


def test_sleeping_can_be_turned_off() -> None:
    off = world_of(triangle(0), sleeping=False)
    assert not off.sleeping and not copy.copy(off).sleeping
    off.step(STEP, steps=90)
    assert not off.asleep.any()
    off.sleeping = True
    off.step(STEP, steps=60)
    assert off.asleep.all()
    off.sleeping = False
    assert not off.asleep.any()
    assert world_of(triangle(0)).sleeping
    for wrong in (None, 2, "no"):
        with pytest.raises(TypeError, match="sleeping must be True or False"):
            world_of(triangle(0), sleeping=wrong)


def test_other_changes_wake_islands_or_nothing() -> None:
    world = asleep(-5, 5)
    world.method, world.threads, world.leaf_capacity, world.max_depth = "brute", 2, 5, 50
    world.velocities = world.velocities
    world.set([0], radii=1.0)
    assert world.asleep.all(), "nothing has changed"
    world.set([4], velocities=[(0, 2)])
    assert world.asleep.tolist() == [True] * 3 + [False] * 3
    world.remove([0])
    assert world.asleep.tolist() == [False] * 5
    for name, value in {"gravity": (0, -5), "forces": [jostle.Thermostat(1, 1)]}.items():
        world = asleep(-5, 5)
        setattr(world, name, value)
        assert not world.asleep.any()
    world = asleep(-5, 5)
    world.positions = world.positions + 0.5
    assert not world.asleep.any()


def test_a_million_steps_of_a_sleeping_world() -> None:
    world = asleep(0)
    world.step(STEP, steps=1_000_000)
    assert world.asleep.all()
