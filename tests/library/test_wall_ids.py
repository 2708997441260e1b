"""`World.walls`: ids, columns, errors, what rests on walls, and snapshots."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import jostle

SEGMENTS = [((-9, 0), (9, 0)), ((9, 0), (9, 5)), ((0, 9), (1, 9))]


def test_ids_are_never_used_again() -> None:
    walls = jostle.World(walls=SEGMENTS).walls
    walls.remove(0)
    assert walls.ids.tolist() == [1, 2] and 0 not in walls and 2 in walls and len(walls) == 2
    assert walls.rows([[2], [1]]).tolist() == [[1], [0]]
    assert walls.add(((0, 8), (1, 8))) == 3
    walls.remove(walls.ids)
    assert walls.add([((0, 8), (1, 8))]).tolist() == [4]


def test_columns_are_assigned_and_set() -> None:
    walls = jostle.World(walls=SEGMENTS).walls
    walls.friction = [0.25, None, 0.5]
    walls.set([2, 0], restitution=[None, 0.5], categories=2)
    assert np.isnan(walls.friction[1]) and walls.restitution[0] == 0.5
    assert walls.categories.tolist() == [2, 1, 2]
    again = walls.get([0, 2]).to_dict()
    assert walls.get(walls.add(**again)) == walls.get([0, 2])


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda walls: walls.remove(7), "ids is 7; no wall has this id; ids are below 3"),
        (lambda walls: walls.set([1, 1], friction=1), r"ids\[1\] is 1; it is given twice"),
        (lambda walls: walls.add([SEGMENTS[0], ((1, 1), (1, 1))]), r"segments\[1\] is .* differ"),
        (lambda walls: walls.set([1, 2], restitution=[0.5, 2]), r"restitution\[1\] is 2"),
        (lambda walls: walls.set([2], velocities=[(0, 1e19)]), r"velocities\[0\]"),
        (lambda walls: walls.add(SEGMENTS[0], fricton=1), "did you mean 'friction'"),
    ],
)
def test_bad_input_changes_nothing(call, text) -> None:
    walls = jostle.World(walls=SEGMENTS).walls
    before = walls.get(walls.ids)
    with pytest.raises((ValueError, TypeError), match=text):
        call(walls)
    assert walls.get(walls.ids) == before and walls.add(SEGMENTS[0]) == 3


def test_what_rests_on_a_removed_wall_wakes_and_falls() -> None:
    world = jostle.World([(0, 1)], 1.0, gravity=(0, -10), restitution=0, walls=SEGMENTS[:1])
    world.step(1 / 60, steps=120)
    assert world.asleep.all()
    world.walls.remove(0)
    assert not world.asleep.any()
    world.step(1 / 60, steps=30)
    assert world.positions[0, 1] < 0


def test_ids_are_in_snapshots_pickles_and_copies() -> None:
    world = jostle.World([(0, 3)], 1.0, walls=SEGMENTS)
    world.walls.remove(1)
    restored = jostle.World.restore(world.snapshot())
    for again in (restored, pickle.loads(pickle.dumps(world)), copy.copy(world)):
        assert again.walls.ids.tolist() == [0, 2]
        assert again.walls.get([2, 0]) == world.walls.get([2, 0])
        assert again.walls.add(SEGMENTS[1]) == 3


def test_forces_name_walls_by_id_and_forget_removed_ones() -> None:
    world = jostle.World(walls=SEGMENTS)
    world.walls.remove(0)
    world.forces = [jostle.Motor(walls=[2], velocity=(0, 1)), jostle.ThermalWalls(1, walls=[1])]
    world.walls.remove(1)
    assert len(world.forces) == 1
    world.step(0.5)
    assert world.walls.get(2).segments[0, 1] == 9.5


def test_the_number_of_threads_changes_nothing() -> None:
    def end(threads: int) -> int:
        draw = np.random.default_rng(1)
        places, ways = draw.random((500, 2)) * 50, draw.normal(size=(500, 2))
        box = jostle.Box(0, 0, 50, 50)
        world = jostle.World(places, 0.5, velocities=ways, container=box, threads=threads)
        world.walls.remove(world.walls.add(draw.random((20, 2, 2)) * 50)[::3])
        world.step(1 / 60, steps=30)
        return world.state_hash()

    assert end(1) == end(2)
