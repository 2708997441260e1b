"""The columns of `jostle.World`: reading, assigning, adding and removing particles."""

from typing import Any

import numpy as np
import pytest
from results import fields
from worlds import COLUMNS, NEW, columns, gas, three

import jostle


def test_columns_are_float32_in_the_order_of_adding() -> None:
    world = three()
    assert len(world) == 3
    types = {name: (column.dtype, column.shape) for name, column in columns(world).items()}
    assert types == {
        "positions": (np.float32, (3, 2)),
        "velocities": (np.float32, (3, 2)),
        "radii": (np.float32, (3,)),
        "masses": (np.float32, (3,)),
        "restitution": (np.float32, (3,)),
        "movable": (np.bool_, (3,)),
        "friction": (np.float32, (3,)),
        "angles": (np.float32, (3,)),
        "angular_velocities": (np.float32, (3,)),
    }
    assert all(getattr(world, name).flags.c_contiguous for name in COLUMNS)
    assert world.positions.tolist() == [[0, 0], [10, 0], [20, 5]]
    assert world.velocities.tolist() == [[1, 0], [0, 2], [0, 0]]
    assert world.radii.tolist() == [1, 2, 3]
    assert world.masses.tolist() == [1, 4, 9]  # radius squared
    assert world.restitution.tolist() == [1, 1, 1]
    assert world.friction.tolist() == world.angles.tolist() == [0, 0, 0]
    assert world.movable.tolist() == [True, True, False]


def test_the_order_stays_while_the_particles_move() -> None:
    world = gas()
    marks = np.linspace(1, 2, len(world), dtype=np.float32)
    world.masses = marks
    before = world.positions
    world.step(0.01, steps=5)
    np.testing.assert_array_equal(world.masses, marks)
    assert np.abs(world.positions - before).max() < 2  # of a box of 30


def test_the_world_keeps_its_own_copy() -> None:
    positions = np.zeros((2, 2), np.float32)
    world = jostle.World(positions, 1.0, velocities=positions)
    positions[:] = 7
    assert world.positions.tolist() == [[0, 0], [0, 0]]


@pytest.mark.parametrize("dtype", ["f4", ">f4", "f8", "f2", "i2", ">i8", "u1"])
def test_other_numbers_are_converted(dtype: str) -> None:
    vectors = np.array([(1, 2), (30, 4)], dtype)
    world = jostle.World(np.asfortranarray(vectors), vectors[:, 0], velocities=vectors[::1, ::-1])
    assert world.positions.tolist() == [[1, 2], [30, 4]]
    assert world.velocities.tolist() == [[2, 1], [4, 30]]
    assert world.radii.tolist() == [1, 30]


def test_one_number_for_all() -> None:
    world = jostle.World([(0, 0), (9, 0)], 2, masses=3, movable=False, velocities=(1, 2))
    assert world.radii.tolist() == [2, 2]
    assert world.masses.tolist() == [3, 3]
    assert world.velocities.tolist() == [[1, 2], [1, 2]]
    assert world.movable.tolist() == [False, False]


def test_a_number_is_the_array_of_that_number() -> None:
    worlds = [gas(restitution=of) for of in (0.5, np.full(len(gas()), 0.5))]
    for world in worlds:
        world.step(0.1, steps=20)
    assert worlds[0].state_hash() == worlds[1].state_hash() != gas().state_hash()


def test_what_cannot_be_pushed_keeps_its_velocity() -> None:
    world = three(velocities=[(1, 0), (0, 2), (3, 3)])
    world.step(0.5)
    assert world.velocities.tolist() == [[1, 0], [0, 2], [3, 3]]
    world.movable = [False, True, True]
    assert world.velocities.tolist() == [[1, 0], [0, 2], [3, 3]]


@pytest.mark.parametrize("nothing", [[], np.empty((0, 2))])
def test_an_empty_world(nothing: Any) -> None:
    world = jostle.World(nothing, [], velocities=nothing)
    assert len(world) == 0
    world.step(0.1)
    assert {name: column.shape for name, column in columns(world).items()} == {
        name: (0, 2) if name in ("positions", "velocities") else (0,) for name in COLUMNS
    }
    assert [part.shape for part in fields(world.last_step.contacts)] == [
        (0, 2),
        (0, 2),
        (0,),
        (0,),
        (0,),
        (0, 2),
    ]
    at_walls = [part.shape for part in fields(world.last_step.wall_contacts)]
    assert at_walls == [(0,), (0,), (0, 2), (0,), (0,), (0,), (0, 2)]
    assert [*world.momentum(), world.kinetic_energy(), world.potential_energy()] == [0] * 4
    assert world.add([(1, 1)], 1).tolist() == [0]


@pytest.mark.parametrize("name", COLUMNS)
def test_a_whole_column_may_be_assigned(name: str) -> None:
    world = three()
    before, column = columns(world), getattr(world, name)
    setattr(world, name, NEW[name])
    np.testing.assert_array_equal(getattr(world, name), NEW[name])
    np.testing.assert_array_equal(column, before[name])  # a copy, which stays as it was
    assert (column != getattr(world, name)).any()
    untouched = {*COLUMNS} - {name, "velocities" if name == "movable" else name}
    for other in untouched:
        np.testing.assert_array_equal(getattr(world, other), before[other])


@pytest.mark.parametrize(
    ("name", "value"),
    [("radii", 2), ("masses", 5.5), ("restitution", 0), ("movable", True), ("friction", 3)],
)
def test_one_number_may_be_assigned_to_a_column(name: str, value: Any) -> None:
    world = three()
    setattr(world, name, value)
    assert getattr(world, name).tolist() == [value] * 3
    world.set([2, 0], **{name: value})
    assert getattr(world, name).tolist() == [value] * 3


@pytest.mark.parametrize("name", COLUMNS)
def test_a_column_is_read_only(name: str) -> None:
    world = three()
    column = getattr(world, name)
    before = column.tolist()
    with pytest.raises(ValueError, match="read-only"):
        column[0] = 1
    with pytest.raises(ValueError, match="read-only"):
        exec(f"world.{name} {'|=' if name == 'movable' else '*='} 2", {"world": world})
    with pytest.raises(ValueError, match="WRITEABLE"):
        column.flags.writeable = True
    assert getattr(world, name).tolist() == before
    copy = column.copy()
    copy[0] = 1
    setattr(world, name, copy)
    assert getattr(world, name).tolist() == copy.tolist()
    assert "set" in getattr(jostle.World, name).__doc__


def test_what_became_of_ids_is_told_until_the_next_step() -> None:
    positions = [(0, 0), (9, 0), (1, 0), (20, 0)]
    world = jostle.World(positions, 1.0, on_touch="merge")
    world.step(0.1)
    new = world.renumbered
    assert new is not None
    assert (new.dtype, new.tolist(), new.flags.writeable) == (np.int64, [0, 1, 0, 3], False)
    with pytest.raises(ValueError, match="dt"):
        world.step(-1)
    world.add([(50, 50)], 1)
    world.remove([0, 1])
    assert world.renumbered is not None
    assert world.renumbered.tolist() == [-1, -1, -1, 3, 4]
    world.step(0.1)
    assert world.renumbered is None


def test_setting_nothing_changes_nothing() -> None:
    world = three()
    before = world.state_hash()
    world.set([0, 1])
    world.set([], radii=[], positions=[])
    assert world.state_hash() == before


def test_add_appends_rows() -> None:
    world = three()
    ids = world.add(
        [(30, 0), (40, 0)],
        [1, 2],
        velocities=[(0, 1), (1, 0)],
        masses=[2, 8],
        restitution=[0.5, 1],
        movable=[True, False],
    )
    assert ids.dtype == np.int64
    assert ids.tolist() == [3, 4]
    assert world.positions[ids].tolist() == [[30, 0], [40, 0]]
    assert world.velocities[ids].tolist() == [[0, 1], [1, 0]]
    assert world.masses.tolist() == [1, 4, 9, 2, 8]
    assert world.restitution.tolist() == [1, 1, 1, 0.5, 1]
    assert world.movable.tolist() == [True, True, False, True, False]
    assert world.add([(60, 0)], 1, masses=11).tolist() == [5]
    assert world.masses[5] == 11
    assert world.add([], [], velocities=[]).shape == (0,)
    assert len(world) == 6


def test_add_takes_one_particle() -> None:
    world = three()
    id = world.add((30, 0), 2, velocities=(0, 1), friction=0.5)
    assert (type(id), id) == (int, 3)
    assert world.positions[3].tolist() == [30, 0]
    assert world.velocities[3].tolist() == [0, 1]
    assert (world.radii[3], world.masses[3], world.friction[3]) == (2, 4, 0.5)
    assert world.add(np.array([40, 0]), [1]) == 4
    assert world.add([[50, 0]], 1).tolist() == [5]
    world.remove(id)
    assert world.add((30, 0), 1, velocities=(0, 1)) == 6


def test_omitted_columns_have_constant_defaults() -> None:
    given = {"masses": 3, "friction": 0.25, "restitution": 0.5, "categories": 2, "masks": 2}
    world = jostle.World([(0, 0), (5, 0)], 0.5, **given)
    world.friction = 0.75
    world.add([(20, 0)], 2)
    assert world.masses.tolist() == [3, 3, 4]
    assert world.friction.tolist() == [0.75, 0.75, 0]
    assert world.restitution.tolist() == [0.5, 0.5, 1]
    assert world.categories.tolist() == [2, 2, 1]
    assert world.masks.tolist() == [2, 2, 2**32 - 1]


def test_a_column_needs_positions() -> None:
    assert len(jostle.World()) == 0
    for name, value in {"radii": 1.0, "velocities": (0, 0), "restitution": 0.5}.items():
        with pytest.raises(TypeError, match=f"needs positions with {name}"):
            jostle.World(**{name: value})
    with pytest.raises(TypeError, match="needs radii with positions"):
        jostle.World([(0, 0)])


SETTABLE = [
    *("positions", "velocities", "radii", "masses", "angles", "angular_velocities", "friction"),
    *("restitution", "movable", "sensors", "kinds", "categories", "masks", "gravity", "drag"),
    *(
        "container",
        "period",
        "forces",
        "on_touch",
        "sleeping",
        "substeps",
        "track_events",
        "method",
        "threads",
    ),
    *("leaf_capacity", "max_depth", "accelerations", "attachment"),
]


@pytest.mark.parametrize("scene", ["pile", "conveyor"])
def test_what_is_read_can_be_assigned_without_a_change(scene: str) -> None:
    """Also what rounding removed from positions and angles stays, and nobody wakes."""
    world, same = (jostle.scenes.create(scene, n=60) for _ in range(2))
    for one in (world, same):
        one.friction = 0.5
        one.step(1 / 60, steps=500)
    asleep = world.asleep
    assert asleep.any() or scene == "conveyor"
    of_walls = (
        "segments",
        "velocities",
        "friction",
        "restitution",
        "one_way",
        "categories",
        "masks",
    )
    for owner, name in [(world, name) for name in SETTABLE] + [
        (world.walls, of) for of in of_walls
    ]:
        setattr(owner, name, getattr(owner, name))
        assert (world.asleep == asleep).all(), name
        assert world.state_hash() == same.state_hash(), name
    for one in (world, same):
        one.step(1 / 60, steps=30)
    assert world.snapshot() == same.snapshot()


def test_contacts_after_adding() -> None:
    world = jostle.World([(50, 0), (51.5, 0)], 1.0)
    world.step(0.01)
    world.add([(-9, 0), (99, 0)], 1.0)
    assert world.last_step.contacts.pairs.tolist() == [[0, 1]]
    world.step(0.01)
    assert world.last_step.contacts.pairs.tolist() == [[0, 1]]
