"""`World.walls`, `wall_restitution`, `wall_friction` and `polyline`."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import jostle

STEP = 1 / 60


def test_polyline_joins_points() -> None:
    points = [(0, 0), (4, 0), (4, 0), (4, 3)]
    assert jostle.polyline(points).tolist() == [[[0, 0], [4, 0]], [[4, 0], [4, 3]]]
    assert jostle.polyline(points, closed=True)[-1].tolist() == [[4, 3], [0, 0]]
    assert jostle.polyline([]).shape == jostle.polyline([(1, 2)], closed=True).shape == (0, 2, 2)
    assert jostle.polyline([(0, 0.7), (4, 0.7)]).dtype == np.float64
    assert jostle.polyline(np.asarray(points, np.float32)).dtype == np.float32
    with pytest.raises(ValueError, match=re.escape("points has shape (3,); it must be (n, 2)")):
        jostle.polyline([1, 2, 3])
    with pytest.raises(ValueError, match=re.escape("points[1] is (nan, 0.0); both")):
        jostle.polyline([(0, 0), (np.nan, 0)])


def test_walls_are_a_column() -> None:
    walls = jostle.polyline([(-5, 0), (0, 0), (5, 0)])
    world = jostle.World([(0, 3)], [(0, 0)], 1.0, walls=walls, wall_restitution=[0.5, 1])
    np.testing.assert_array_equal(world.walls, walls)
    assert world.walls.dtype == np.float32 and not world.walls.flags.writeable
    assert world.wall_restitution.tolist() == [0.5, 1]
    assert np.isnan(world.wall_friction).all()
    world.wall_friction = 0.25
    world.walls = [*walls, ((0, 9), (1, 9))]
    assert world.wall_restitution.tolist() == [0.5, 1, 1]
    np.testing.assert_array_equal(world.wall_friction, [0.25, 0.25, np.nan])
    world.wall_friction = None
    world.wall_restitution = 0.5
    assert np.isnan(world.wall_friction).all() and (world.wall_restitution == 0.5).all()
    again = jostle.World.restore(world.snapshot())
    np.testing.assert_array_equal(again.walls, world.walls)
    np.testing.assert_array_equal(again.wall_restitution, world.wall_restitution)
    world.walls = None
    assert world.walls.shape == (0, 2, 2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"walls": [(0, 0), (1, 0)]}, "walls has shape (2, 2); it must be (m, 2, 2)"),
        ({"walls": [[(0, 0), (0, 0)]]}, "walls[0] is ((0, 0), (0, 0)); its ends must differ"),
        ({"walls": [[(0, 0), (0, np.inf)]]}, "walls[0] is ((0, 0), (0, inf)); its coordinates"),
        ({"walls": [[(0, 0), (0, 1)]], "wall_restitution": 1.5}, "wall_restitution is 1.5; it"),
        ({"walls": [[(0, 0), (0, 1)]], "wall_restitution": [-1]}, "wall_restitution[0] is -1; it"),
        ({"walls": [[(0, 0), (0, 1)]], "wall_friction": -1}, "wall_friction is -1; it must be"),
        (
            {"walls": [[(0, 0), (0, 9.5)]], "container": jostle.Torus(9, 9)},
            "walls[0] is ((0, 0), (0, 9.5)); on a torus a wall may extend over each side once",
        ),
    ],
)
def test_invalid_walls_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        jostle.World([(3, 3)], [(0, 0)], 1.0, **arguments)


def test_a_refused_change_leaves_the_walls() -> None:
    walls = jostle.polyline([(-5, 0), (5, 0)])
    world = jostle.World([(0, 3)], [(0, 0)], 1.0, walls=walls)
    with pytest.raises(ValueError, match="its ends must differ"):
        world.walls = np.zeros((1, 2, 2))
    np.testing.assert_array_equal(world.walls, walls)


def test_a_heap_rests_in_a_hopper_and_falls_when_it_opens() -> None:
    rng = np.random.default_rng(1)
    positions = np.stack(np.meshgrid(np.arange(-4, 5) * 1.1, np.arange(6, 14) * 1.1), -1)
    hopper = jostle.polyline([(-8, 20), (-8, 6), (-1, 0), (1, 0), (8, 6), (8, 20)])
    world = jostle.World(
        positions.reshape(-1, 2) + rng.uniform(-0.02, 0.02, (72, 2)),
        np.zeros((72, 2)),
        radii=0.5,
        gravity=(0, -9.8),
        restitution=0.3,
        friction=0.3,
        walls=hopper,
        sleeping=False,
    )
    world.step(STEP, steps=600)
    assert (world.positions[:, 1] > 0.45).all()
    weight = 9.8 * world.masses.sum() * STEP
    touches = world.wall_contacts
    tangents = np.stack([-touches.normals[:, 1], touches.normals[:, 0]], 1)
    forces = touches.normal_impulses[:, None] * touches.normals
    forces += touches.friction_impulses[:, None] * tangents
    assert forces.sum(0)[1] == pytest.approx(weight, rel=0.05)
    world.sleeping = True
    world.step(STEP, steps=120)
    assert world.asleep.all()
    world.walls = hopper[:1]
    assert not world.asleep.any()
    world.step(STEP, steps=600)
    assert (world.positions[:, 1] < 0).all()


def test_walls_on_a_torus_act_across_its_boundary() -> None:
    """The wall is outside the torus; the disc meets its image."""
    world = jostle.World(
        [(18, 5)], [(4, 0)], 1.0, container=jostle.Torus(20, 10), walls=[((24, 2), (24, 8))]
    )
    world.step(0.5, steps=3)
    np.testing.assert_allclose(world.positions, [(2, 5)], atol=1e-5)
    np.testing.assert_allclose(world.velocities, [(-4, 0)])
    assert world.collisions.walls == 1
    again = jostle.World.restore(world.snapshot())
    again.step(0.5)
    world.step(0.5)
    assert again.state_hash() == world.state_hash()


def test_nothing_passes_at_a_thousand_radii_a_step() -> None:
    rng = np.random.default_rng(2)
    angles = np.arange(24) / 24 * 2 * np.pi
    corners = rng.uniform(20, 60, (24, 1)) * np.stack([np.cos(angles), np.sin(angles)], 1)
    positions = np.stack(np.meshgrid(np.arange(-3, 4) * 2.5, np.arange(-3, 4) * 2.5), -1)
    velocities = rng.normal(0, 60_000, (49, 2))
    world = jostle.World(
        positions.reshape(-1, 2), velocities, 1.0, walls=jostle.polyline(corners, closed=True)
    )
    energy = world.kinetic_energy
    world.step(STEP, steps=5)
    assert world.kinetic_energy == pytest.approx(energy, rel=1e-5)
    following = np.roll(corners, -1, axis=0)
    for x, y in world.positions:
        spans = (corners[:, 1] > y) != (following[:, 1] > y)
        slope = (following[:, 0] - corners[:, 0]) / (following[:, 1] - corners[:, 1])
        crossings = spans & (x < corners[:, 0] + (y - corners[:, 1]) * slope)
        assert crossings.sum() % 2 == 1
