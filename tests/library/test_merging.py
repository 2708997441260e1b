"""Merging of particles that touch: the impulses of the merged one, and the order of adding."""

import numpy as np
import pytest

import jostle


def merged_at_a_wall(order: list[int]) -> jostle.World:
    """Two overlapping discs of unequal masses that hit a wall and merge in one step."""
    positions = np.array([(0.0, 8.9), (1.9, 8.9)])[order]
    velocities = np.array([(0.5, 3.0), (-0.5, 6.0)])[order]
    masses = np.array([1.0, 5.0])[order]
    world = jostle.World(
        positions,
        1.0,
        velocities=velocities,
        masses=masses,
        restitution=0.5,
        on_touch="merge",
        walls=[[[-10, 10], [10, 10]]],
    )
    world.step(0.1)
    assert len(world) == 1
    return world


def test_impulses_of_walls_on_merged_particles_are_added_up() -> None:
    """Both discs hit the wall before they merge: (1 + e) m v of each."""
    for order in ([0, 1], [1, 0]):
        impulses = merged_at_a_wall(order).last_step.wall_contacts.normal_impulses
        assert impulses == pytest.approx([1.5 * (1 * 3 + 5 * 6)])


@pytest.mark.parametrize("seed", [649942235, 931641966, *range(20)])
def test_the_order_of_adding_does_not_show_where_some_have_no_room(seed: int) -> None:
    """One disc has no room between walls, so it has too many events; others merge on a torus."""
    rng = np.random.default_rng(seed)
    positions, velocities = rng.uniform(0, 10, (30, 2)), rng.normal(0, 6, (30, 2))
    radii = np.array([1.05] + 29 * [0.3])
    positions[0], velocities[0] = (5, 5), (0, 3)

    def after_steps(order: np.ndarray) -> tuple[list[int], np.ndarray]:
        world = jostle.World(
            positions[order],
            radii[order],
            velocities=velocities[order],
            gravity=(0, 1),
            restitution=0.5,
            period=(10, 10),
            walls=[[[2, 4], [8, 4]], [[2, 6], [8, 6]]],
            on_touch="merge",
        )
        unresolved = []
        for _ in range(3):
            world.step(0.5)
            unresolved.append(world.last_step.unresolved)
        return unresolved, world.positions[np.lexsort(world.positions.T)]

    (counts, places), (other_counts, other_places) = (
        after_steps(order) for order in (np.arange(30), rng.permutation(30))
    )
    assert counts == other_counts
    assert np.array_equal(places, other_places)


@pytest.mark.parametrize("far", [0, 3])
@pytest.mark.parametrize("steps", [1, 5])
def test_a_disc_pulled_by_a_spring_merges_with_what_it_passes(far: int, steps: int) -> None:
    """It then meets the immovable one at the other end. Fast discs far away make no difference."""
    positions = [(0, 0), (10, 0), (5, 0), *((0, 1000 + 50 * k) for k in range(far))]
    velocities = [(0, 0)] * 3 + [(100, 0)] * far
    movable = [True, False, True] + [True] * far
    world = jostle.World(positions, 0.2, velocities=velocities, movable=movable, on_touch="merge")
    world.forces = [jostle.Springs([(0, 1)], lengths=0.5, stiffness=40.0)]
    world.step(0.4 / steps, steps)
    assert len(world) - far == 1


def test_a_refused_step_keeps_the_record_of_merged_particles() -> None:
    """As it keeps events."""
    world = jostle.World(
        [(0, 0), (3, 0), (9, 0)], 0.6, velocities=[(2, 0), (-1, 0), (0, 0)], on_touch="merge"
    )
    world.step(0.1, 20)
    before = world.renumbered
    assert before.tolist() == [0, 0, 2]
    with pytest.raises(ValueError, match="dt"):
        world.step(1e30)
    assert np.array_equal(world.renumbered, before)
    world.step(0.1)
    assert world.renumbered is None


def test_given_accelerations_of_removed_particles_do_not_act() -> None:
    """Otherwise the step would have four sub-steps instead of one."""

    def after(accelerated: bool) -> bytes:
        world = jostle.World(
            [(0, 0), (3, 0.3), (90, 0)], 1.0, velocities=[(1, 0), (-1, 0), (0, 0)], drag=0.3
        )
        if accelerated:
            world.apply_force([2], [(1, 0)])
        world.remove([2])
        world.step(0.5)
        return world.state_hash()

    assert after(True) == after(False)
