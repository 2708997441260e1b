"""`World.unwrapped_positions`, against free flight and sums of displacements."""

import copy

import numpy as np
import pytest

import jostle

SIDES = np.array([40.0, 25.0])


def gas(n: int = 150, **rules) -> jostle.World:
    """Fast discs on a periodic plane."""
    rng = np.random.default_rng(4)
    world = jostle.World(period=SIDES, **rules)
    at = world.free_positions(n, 0.7, seed=5)
    world.add(at, 0.7, velocities=rng.normal(0, 30, (n, 2)))
    return world


def test_free_flight() -> None:
    rng = np.random.default_rng(1)
    n, steps, dt = 200, 300, 1 / 64
    at = rng.uniform(0, SIDES, (n, 2)).astype(np.float32)
    v = rng.normal(0, 50, (n, 2)).astype(np.float32)
    world = jostle.World(at, 0.1, velocities=v, period=SIDES, on_touch="ignore")
    world.step(dt, steps=steps)
    expected = at.astype(float) + v.astype(float) * dt * steps
    assert np.abs(expected - at).max() > 10 * SIDES.max()
    assert world.unwrapped_positions.dtype == np.float64
    np.testing.assert_allclose(world.unwrapped_positions, expected, atol=1e-3)
    np.testing.assert_allclose(world.positions, world.unwrapped_positions % SIDES, atol=1e-5)


def test_a_walk_is_the_sum_of_its_steps() -> None:
    world = gas()
    sums = world.positions.astype(float)
    for _ in range(300):
        before = world.positions.astype(float)
        world.step(1 / 200)  # far less than half a period
        moved = world.positions - before
        sums += moved - SIDES * np.round(moved / SIDES)
    assert world.last_call.collisions > 0
    assert np.ptp(np.floor(world.unwrapped_positions / SIDES), axis=0).min() >= 2
    np.testing.assert_allclose(world.unwrapped_positions, sums, atol=2e-3)


def test_many_steps_in_a_call_are_as_in_single_calls() -> None:
    one, many = gas(), gas(threads=1)
    one.step(1 / 30, steps=40)
    for _ in range(40):
        many.step(1 / 30)
    np.testing.assert_array_equal(one.unwrapped_positions, many.unwrapped_positions)


def test_without_a_period_they_are_the_positions() -> None:
    box = jostle.Box(0, 0, 9, 9)
    world = jostle.World([(4, 5), (2, 2)], 1.0, velocities=[(30, 7), (0, 0)], container=box)
    world.step(1 / 60, steps=100)
    np.testing.assert_allclose(world.unwrapped_positions, world.positions, atol=1e-6)


def test_new_paths_begin_where_positions_are_set() -> None:
    world = jostle.World([(9, 5), (9, 2)], 1.0, velocities=[(2, 0), (2, 0)], period=10)
    world.step(0.5, steps=26)
    assert world.unwrapped_positions.tolist() == [[35, 5], [35, 2]]
    world.set(0, positions=(1, 5))
    world.velocities = world.velocities * 2
    world.set(1, masses=3.0, positions=world.get(1).positions)  # nothing new
    assert world.unwrapped_positions.tolist() == [[1, 5], [35, 2]]
    added = world.add((3, 8), 0.5)
    world.remove(0)
    assert world.ids.tolist() == [1, added]
    assert world.unwrapped_positions.tolist() == [[35, 2], [3, 8]]
    world.step(1.0)
    assert world.unwrapped_positions.tolist() == [[39, 2], [3, 8]]
    world.positions = np.add(world.positions, (0, 1))
    assert world.unwrapped_positions.tolist() == [[9, 3], [3, 9]]


def test_a_position_outside_of_the_period_stays_where_it_was_set() -> None:
    world = jostle.World([(25, -5)], 1.0, velocities=[(1, 0)], period=10)
    assert world.unwrapped_positions.tolist() == [[25, -5]]
    world.step(1.0, steps=3)
    assert world.unwrapped_positions.tolist() == [[28, -5]]
    assert world.positions.tolist() == [[8, 5]]


def test_another_period_begins_new_paths() -> None:
    world = jostle.World([(9, 5)], 1.0, velocities=[(2, 0)], period=10)
    world.step(0.5, steps=26)
    world.gravity = (0, 0)
    assert world.unwrapped_positions.tolist() == [[35, 5]]
    world.period = 20
    assert world.unwrapped_positions.tolist() == world.positions.tolist()


def test_merged_particles_continue_the_path_of_the_smaller_id() -> None:
    # The first has travelled three periods before it hits the second.
    world = jostle.World(
        [(5, 5), (5, 1)], 0.5, velocities=[(10, 0), (0, 0)], period=10, on_touch="merge"
    )
    world.step(0.1, steps=32)
    assert world.unwrapped_positions[0] == pytest.approx((37, 5), abs=1e-4)
    world.set(1, positions=(1, 5), masses=1e6)
    world.step(0.1, steps=8)
    assert world.ids.tolist() == [0]
    # It is where the heavy one was: at the image in front of the light one.
    assert world.unwrapped_positions[0] == pytest.approx((41, 5), abs=1e-2)


def test_they_are_kept_by_copies_snapshots_and_refused_steps(tmp_path) -> None:
    world = gas()
    world.step(1 / 30, steps=30)
    before = world.unwrapped_positions
    assert np.abs(before - world.positions).max() > 20
    world.save(tmp_path / "world.jostle")
    others = [
        copy.copy(world),
        jostle.World.restore(world.snapshot()),
        jostle.World.load(tmp_path / "world.jostle"),
    ]
    for other in others:
        np.testing.assert_array_equal(other.unwrapped_positions, before)
        other.step(1 / 30, steps=5)
    world.set(0, velocities=(1e17, 0))
    with pytest.raises(ValueError):
        world.step(1e6)
    np.testing.assert_array_equal(world.unwrapped_positions, before)


def test_they_do_not_change_the_state() -> None:
    """Nothing that moves depends on the number of periods travelled."""
    world = gas()
    world.step(1 / 30, steps=30)
    fresh = gas()
    fresh.step(1 / 30, steps=30)
    fresh.period = SIDES * 2
    fresh.period = SIDES  # forgets the periods
    assert not np.array_equal(world.unwrapped_positions, fresh.unwrapped_positions)
    assert world.state_hash() == fresh.state_hash()
    for each in (world, fresh):
        each.step(1 / 30, steps=10)
    assert world.state_hash() == fresh.state_hash()


def test_they_are_read_only() -> None:
    world = jostle.World([(1, 1)], 0.5, period=10)
    with pytest.raises(AttributeError):
        world.unwrapped_positions = [(0, 0)]
    with pytest.raises(ValueError, match="read-only"):
        world.unwrapped_positions[0] = (0, 0)
