"""Categories and masks of walls: which walls stop which discs, also at joints and at any speed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import jostle

SIDE = 40.0


def scattered(seed: int, discs: int = 40, walls: int = 25) -> dict[str, Any]:
    """Discs that ignore each other among walls at random places, with random filters."""
    draw = np.random.default_rng(seed)
    starts = draw.uniform(0, SIDE, (walls, 2))
    return {
        "positions": draw.uniform(0, SIDE, (discs, 2)),
        "radii": draw.uniform(0.1, 0.5, discs),
        "velocities": draw.normal(scale=30, size=(discs, 2)),
        "categories": draw.integers(0, 8, discs) << 8,  # no disc has them in its mask
        "masks": draw.integers(0, 8, discs),
        "segments": np.stack([starts, starts + draw.normal(scale=8, size=(walls, 2))], 1),
        "of_walls": draw.integers(0, 8, walls),
        "masks_of_walls": draw.integers(0, 8, walls) << 8,
    }


def world_of(scene: dict[str, Any], **settings: Any) -> jostle.World:
    names = ("positions", "radii", "velocities", "categories", "masks")
    walls = {"categories": scene["of_walls"], "masks": scene["masks_of_walls"]}
    walls["segments"] = scene["segments"]
    return jostle.World(**{name: scene[name] for name in names}, walls=walls, **settings)


def meeting(scene: dict[str, Any]) -> NDArray[np.bool_]:
    """Whether disc i and wall w may meet, by the rule for each pair."""
    there = scene["categories"][:, None] & scene["masks_of_walls"]
    back = scene["masks"][:, None] & scene["of_walls"]
    meet: NDArray[np.bool_] = (there != 0) & (back != 0)
    return meet


@pytest.mark.parametrize("dt", [0.01, 1.0])
def test_each_disc_moves_as_if_only_the_walls_that_stop_it_were_there(dt: float) -> None:
    """Also if it leaves its bounds in long steps; the oracle has no filters."""
    some = 0
    for seed in range(6):
        scene = scattered(seed)
        world = world_of(scene, container=jostle.Box(0, 0, SIDE, SIDE))
        world.step(dt, steps=20)
        for disc, stops in enumerate(meeting(scene)):
            alone = jostle.World(
                scene["positions"][[disc]], scene["radii"][[disc]],
                velocities=scene["velocities"][[disc]], walls=scene["segments"][stops],
                container=jostle.Box(0, 0, SIDE, SIDE),
            )  # fmt: skip
            alone.step(dt, steps=20)
            assert (alone.positions[0] == world.positions[disc]).all(), (seed, disc)
            some += alone.last_call.wall_collisions > 0
    assert some > 60


def test_neither_method_nor_threads_show() -> None:
    hashes = set()
    for method, threads in (("quadtree", 1), ("quadtree", 2), ("brute", 2)):
        scene = scattered(9, discs=400, walls=60)
        scene["categories"] = scene["categories"] | 7  # discs collide, too
        world = world_of(scene, method=method, threads=threads, period=SIDE)
        world.step(1 / 60, steps=40)
        hashes.add(world.state_hash())
    assert len(hashes) == 1


LEFT, RIGHT = ((-5.0, 0.0), (0.0, 0.0)), ((0.0, 0.0), (5.0, -1.0))


@pytest.mark.parametrize("order", [(LEFT, RIGHT), (RIGHT, LEFT)])
@pytest.mark.parametrize("bits", [(1, 2), (2, 1), (3, 1), (1, 3), (3, 3)])
def test_no_disc_falls_through_the_joint_of_walls_that_stop_different_discs(order, bits) -> None:
    """One that only one of them stops moves as if the other were not there."""
    columns = {"segments": order, "categories": bits}
    for x in np.linspace(-0.95, 0.95, 39):
        for mask in (1, 2):
            stops = [wall for wall, bit in zip(order, bits, strict=True) if bit & mask]
            among, alone = (
                jostle.World([(x, 3)], 1.0, velocities=[(0, -4)], masks=bit, walls=walls)
                for bit, walls in ((mask, columns), (1, np.reshape(stops, (-1, 2, 2))))
            )
            for world in (among, alone):
                world.step(1.0)
            np.testing.assert_allclose(among.positions, alone.positions, atol=1e-5)
            assert among.last_call.wall_collisions == alone.last_call.wall_collisions
            assert alone.last_call.wall_collisions == 1 or len(stops) != 1


def test_a_disc_rolls_over_the_joint_of_walls_with_the_same_filter() -> None:
    walls = {"segments": jostle.polyline([(-9, 0), (0, 0), (9, 0)]), "categories": 6, "masks": 5}
    world = jostle.World(
        [(-5, 1)], 1.0, velocities=[(4, 0)], gravity=(0, -10), restitution=0, masks=2, walls=walls
    )
    world.step(1 / 60, steps=120)
    assert world.positions[0] == pytest.approx([3, 1], abs=1e-3)
    assert world.velocities[0] == pytest.approx([4, 0], abs=1e-3)


def test_a_fast_disc_passes_walls_that_do_not_stop_it_and_no_other() -> None:
    """Thousands of its radii in a step, beyond the bounds in which walls are searched."""
    fence = [((x, -5), (x, 5)) for x in range(1, 2000)]
    bits = np.where(np.arange(1, 2000) == 1500, 2, 1)
    world = jostle.World(
        [(0, 0)], 0.25, velocities=[(2500, 0)], masks=2,
        walls={"segments": fence, "categories": bits},
    )  # fmt: skip
    world.step(1.0)
    assert world.positions[0, 0] == pytest.approx(2 * (1500 - 0.25) - 2500, rel=1e-5)
    assert world.last_step.wall_contacts.walls.tolist() == [1499]


def test_what_rests_on_a_wall_wakes_and_falls_when_it_no_longer_stops_it() -> None:
    for change in ({"categories": 4}, {"masks": 4}, {"segments": ((20, 0), (30, 0))}):
        world = jostle.World(
            [(0, 1), (5, 1)], 1.0, gravity=(0, -10), restitution=0, masks=[3, 7],
            walls={"segments": [((-9, 0), (9, 0))], "masks": 7}, categories=[1, 5],
        )  # fmt: skip
        world.step(1 / 60, steps=120)
        assert world.asleep.all()
        world.walls.set(0, **change)
        assert not world.asleep.any()
        world.step(1 / 60, steps=60)
        falls = [True, "segments" in change]
        assert (world.positions[:, 1] < 0).tolist() == falls


def test_a_world_goes_on_after_edits_as_one_that_begins_with_these_walls() -> None:
    scene = scattered(3)
    world = world_of(scene, container=jostle.Box(0, 0, SIDE, SIDE))
    world.step(0.02, steps=10)
    draw = np.random.default_rng(8)
    world.walls.remove(draw.choice(world.walls.ids, 9, replace=False))
    world.walls.set(world.walls.ids[::3], masks=5, velocities=(1, -2))
    world.walls.add(draw.uniform(0, SIDE, (4, 2, 2)), categories=[1, 2, 3, 4])
    again = jostle.World(
        world.positions, world.radii, velocities=world.velocities, categories=world.categories,
        masks=world.masks, walls=world.walls.get(world.walls.ids).to_dict(),
        container=world.container,
    )  # fmt: skip
    for one in (world, again):
        one.step(0.02, steps=20)
    # What rounding removed from the positions is not in the second one.
    np.testing.assert_allclose(world.positions, again.positions, atol=0.1)
    np.testing.assert_array_equal(world.walls.segments, again.walls.segments)
    assert world.walls.ids[-1] == 28 and again.walls.ids[-1] == 19


def test_thermal_walls_and_motors_act_on_what_their_walls_stop() -> None:
    walls = {"segments": [((-9, 0), (9, 0))], "categories": 2}
    world = jostle.World(
        [(-5, 2), (5, 2)], 1.0, velocities=(0, -1), masks=[2, 4], walls=walls,
        forces=[jostle.ThermalWalls(9.0, walls=[0]), jostle.Motor(walls=[0], velocity=(0, 0.5))],
    )  # fmt: skip
    world.step(1.0)
    assert world.velocities[0, 1] > 0 and world.velocities[1].tolist() == [0, -1]
    assert world.positions[1].tolist() == [5, 1]
