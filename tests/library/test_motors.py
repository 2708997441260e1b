"""`Motor`, a given motion of immovable particles and walls."""

import math
import re
from typing import Any

import numpy as np
import pytest
from copies import WAYS

import jostle

STEP = 1 / 60


def world(**settings: Any) -> jostle.World:
    """Two immovable discs, a movable one and two walls."""
    walls = [((-5, -5), (5, -5)), ((-5, 5), (5, 5))]
    movable = [False, False, True]
    positions = [(1, 0), (2, 0), (4, 3)]
    return jostle.World(positions, 0.5, movable=movable, walls=walls, **settings)


def test_they_are_values() -> None:
    motor = jostle.Motor(
        [1, 0], walls=[1], pivot=(0.5, 1), velocity=(0, 2), angular_velocity=0, cycle=3
    )
    assert (motor.ids.tolist(), motor.walls.tolist()) == ([1, 0], [1])
    assert (motor.pivot, motor.velocity, motor.angular_velocity) == ((0.5, 1), (0, 2), 0)
    assert motor.cycle == 3 and jostle.Motor([0]).cycle is None
    assert repr(motor) == "<jostle.Motor of 2 particles and 1 walls>"
    assert all(way(motor) == motor for way in WAYS)
    assert motor != jostle.Motor([1, 0], walls=[1], pivot=(0.5, 1), velocity=(0, 2))
    moved = world(forces=[motor])
    assert moved.forces == (motor,)
    assert jostle.World.restore(moved.snapshot()).forces == (motor,)


def test_a_motor_drives_particles_and_walls() -> None:
    turning = jostle.Motor([0, 1], pivot=(0, 0), angular_velocity=math.pi / 2)
    lift = jostle.Motor(walls=[0], velocity=(0, 1), cycle=4)
    driven = world(forces=[turning, lift])
    driven.step(STEP, steps=120)
    np.testing.assert_allclose(driven.positions[:2], [(-1, 0), (-2, 0)], atol=1e-5)
    np.testing.assert_allclose(driven.walls.segments[:, :, 1], [(-3, -3), (5, 5)], atol=1e-5)
    assert driven.angular_velocities[:2] == pytest.approx(math.pi / 2)
    assert driven.walls.velocities[0].tolist() == pytest.approx([0, 1])
    driven.step(STEP, steps=120)
    np.testing.assert_allclose(driven.walls.segments[0, :, 1], -5, atol=1e-5)


def test_ids_stay_when_others_are_removed() -> None:
    driven = world(forces=[jostle.Motor([0, 1], velocity=(1, 0))])
    driven.remove(0)
    assert driven.forces[0].ids.tolist() == [1]
    driven.step(STEP, steps=60)
    assert driven.positions[0].tolist() == pytest.approx([3, 0], abs=1e-5)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: jostle.Motor([0, 1, 0]), ValueError, "ids[2] is 0; it is given twice"),
        (lambda: jostle.Motor(walls=[-1]), ValueError, "walls[0] is -1; no wall has"),
        (lambda: jostle.Motor([0], cycle=0), ValueError, "cycle is 0; it must be above 0"),
        (lambda: jostle.Motor([0], cycle=math.nan), ValueError, "cycle is NaN; it must be"),
        (lambda: jostle.Motor([0], pivot=(0, math.inf)), ValueError, "pivot is (0, inf); both"),
        (lambda: jostle.Motor([0], velocity=(1, 2, 3)), ValueError, "velocity has shape (3,)"),
        (
            lambda: jostle.Motor([0], angular_velocity=1),
            ValueError,
            "pivot is None; a motor with an angular_velocity needs the centre of the rotation",
        ),
        (
            lambda: jostle.Motor(walls=[0], pivot=(0, 0), angular_velocity=1),
            ValueError,
            "angular_velocity is 1; walls do not turn",
        ),
        (lambda: jostle.Motor("all"), TypeError, "ids must hold integers"),
        (
            lambda: world(forces=[jostle.Motor([0, 2])]),
            ValueError,
            "forces[0] is a motor of particle 2; it drives immovable particles only",
        ),
        (
            lambda: world(forces=[jostle.Motor(walls=[2])]),
            ValueError,
            "forces[0] is a motor of wall 2; no wall has this id",
        ),
    ],
)
def test_wrong_ones_are_refused(make: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        make()


def test_a_refused_step_restores_what_a_motor_drives() -> None:
    walls = [[[5, 5], [9, 5]]]
    world = jostle.World(
        [(0, 0), (5, 0)],
        1.0,
        velocities=[(0.25, 0), (0, 0)],
        movable=[False, True],
        walls={"segments": walls, "velocities": [(0.5, 0)]},
    )
    world.forces = [jostle.Motor([0], walls=[0], velocity=(1, 0))]
    with pytest.raises(ValueError, match="dt"):
        world.step(1e30)
    assert world.velocities.tolist() == [[0.25, 0], [0, 0]]
    assert world.walls.velocities.tolist() == [[0.5, 0]]


def test_what_two_motors_drive_is_named() -> None:
    driven = world()
    for twice, message in (
        (
            [jostle.Motor([0]), jostle.Motor([1, 0])],
            "forces[1] is a motor of particle 0; forces[0]",
        ),
        (
            [jostle.Motor(walls=[1]), jostle.Thermostat(1, 0), jostle.Motor([0], walls=[1])],
            "forces[2] is a motor of wall 1; forces[0] drives it already",
        ),
    ):
        with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
            driven.forces = twice
        assert driven.forces == ()
    driven.forces = [jostle.Motor([0], walls=[1]), jostle.Motor([1], walls=[0])]


def test_what_was_driven_keeps_its_velocity_and_cycles_follow_the_time_of_the_world() -> None:
    driven = world(forces=[jostle.Motor([0], velocity=(1, 0), cycle=4)])
    driven.step(0.5, 2)
    driven.forces = []
    start = driven.positions[0]
    driven.step(0.5, 4)
    assert (driven.positions[0] - start).tolist() == pytest.approx([2, 0])
    assert driven.velocities[0].tolist() == [1, 0] and driven.time == 3
    # At 3 s the second half of the cycle goes on, whenever the motor is assigned.
    driven.forces = [jostle.Motor([0], velocity=(1, 0), cycle=4)]
    driven.step(0.5)
    assert driven.velocities[0].tolist() == [-1, 0]


@pytest.mark.parametrize("velocity", [(0, 1), (0, 0)])
def test_others_sleep_while_a_motor_drives(velocity: tuple[float, float]) -> None:
    """The driven particle has a larger id than there are awake particles."""
    world = jostle.World(
        [(0, 9), (50, 0), (3, 9)],
        1.0,
        movable=[True, False, True],
        gravity=(0, 9.8),
        restitution=0.5,
        container=jostle.Box(-99, -99, 99, 10),
        forces=[jostle.Motor([1], velocity=velocity)],
    )
    world.step(1 / 60, steps=120)
    assert world.asleep.tolist() == [True, False, True]
    assert world.positions[1].tolist() == pytest.approx([50, 2 * velocity[1]], abs=1e-4)
    assert world.velocities[1].tolist() == list(velocity)
