"""The columns of `jostle.World`: reading, assigning, adding and removing particles."""

import pickle
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
    assert world.masses.tolist() == [1, 4, 9]  # density 1 times radius squared
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
    world = jostle.World([(0, 0), (9, 0)], 2, densities=3, movable=False)
    assert world.radii.tolist() == [2, 2]
    assert world.masses.tolist() == [12, 12]
    assert world.movable.tolist() == [False, False]


def test_masses_come_from_densities_unless_given() -> None:
    assert three(densities=[1, 2, 3]).masses.tolist() == [1, 8, 27]
    assert three(masses=[7, 8, 9], densities=5).masses.tolist() == [7, 8, 9]
    assert three(masses=0.5).masses.tolist() == [0.5, 0.5, 0.5]


def test_restitution_is_of_the_world_or_of_each() -> None:
    world = three(restitution=0.9)
    assert (world.restitution, world.restitution.tolist()) == (0.9, [1, 1, 1])
    world = three(restitution=[0.5, 0.25, 1])
    assert (world.restitution, world.restitution.tolist()) == (1, [0.5, 0.25, 1])


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
    assert [part.shape for part in fields(world.contacts)] == [(0, 2), (0, 2), (0,), (0,), (0,)]
    at_walls = [part.shape for part in fields(world.wall_contacts)]
    assert at_walls == [(0,), (0,), (0, 2), (0,), (0,), (0,)]
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
        densities=2,
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


MATERIALS: dict[str, Any] = {"radii": 0.5, "masses": 3, "friction": 0.25}


def test_new_particles_have_the_numbers_that_all_were_given() -> None:
    world = jostle.World([(0, 0), (5, 0)], **MATERIALS, restitution=0.5)
    world = pickle.loads(pickle.dumps(world))
    one = world.add((10, 0))
    many = world.add([(20, 0), (30, 0)], friction=[0, 1])
    world.add((40, 0), 2, masses=5, restitution=0.1)
    world.add((50, 0), 2, densities=0.5)  # a density replaces the mass
    assert (one, many.tolist()) == (2, [3, 4])
    assert world.radii.tolist() == [0.5] * 5 + [2, 2]
    assert world.masses.tolist() == [3] * 5 + [5, 2]
    assert world.friction.tolist() == [0.25] * 3 + [0, 1] + [0.25] * 2
    # The world's own coefficient of restitution is not that of a particle.
    np.testing.assert_array_equal(world.restitution, np.float32([1] * 5 + [0.1, 1]))


def test_new_particles_have_the_density_that_all_were_given() -> None:
    world = jostle.World([(0, 0)], [2], densities=3, movable=False)
    world.add((10, 0), 1)
    assert world.masses.tolist() == [12, 3]
    assert world.movable.tolist() == [False, True]


def test_one_number_that_is_assigned_is_for_new_particles_too() -> None:
    world = jostle.World([(0, 0), (9, 0)], [1, 2])
    with pytest.raises(TypeError, match=r"^add needs radii: no number was given for all"):
        world.add((20, 0))
    world.radii, world.masses, world.friction, world.restitution = 2.0, 7.0, 0.75, 0.5
    world.add((20, 0))
    assert [world.radii[2], world.masses[2]] == [2, 7]
    assert [world.friction[2], world.restitution[2]] == [0.75, 0.5]
    with pytest.raises(ValueError, match="friction is -1"):
        world.friction = -1
    world.friction = [0, 0.5, 1]  # not one for all
    world.set(0, friction=0)
    world.add((30, 0))
    assert world.friction.tolist() == [0, 0.5, 1, 0.75]


def test_new_grains_of_a_heap_have_its_friction() -> None:
    world = jostle.scenes.create("heap", n=50)
    world.add((0, -900), 1.0)
    assert world.friction[0] > 0
    assert (world.friction == world.friction[0]).all()


def test_contacts_after_adding() -> None:
    world = jostle.World([(50, 0), (51.5, 0)], 1.0)
    world.step(0.01)
    world.add([(-9, 0), (99, 0)], 1.0)
    assert world.contacts.pairs.tolist() == [[0, 1]]
    world.step(0.01)
    assert world.contacts.pairs.tolist() == [[0, 1]]
