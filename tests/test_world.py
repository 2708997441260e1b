"""`jostle.World` as an object: its columns, settings, results and errors.

The physics is tested in test_exact_step.py, test_resting.py, test_gas.py and in crates/jostle.
"""

from __future__ import annotations

import inspect
import pickle
import re
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from signals import reaction_to_ctrl_c

import jostle

COLUMNS = ["positions", "velocities", "radii", "masses", "restitutions", "movable"]
COLUMNS += ["friction", "angles", "angular_velocities"]


def three(**settings: Any) -> jostle.World:
    """Three discs that do not touch; the last is immovable."""
    arguments: dict[str, Any] = {
        "positions": [(0, 0), (10, 0), (20, 5)],
        "velocities": [(1, 0), (0, 2), (0, 0)],
        "radii": [1, 2, 3],
        "movable": [True, True, False],
    }
    return jostle.World(**{**arguments, **settings})


def columns(world: jostle.World) -> dict[str, Any]:
    return {name: getattr(world, name).copy() for name in COLUMNS}


def gas(n: int = 400, **settings: Any) -> jostle.World:
    """Discs of radius 0.5 that collide a lot."""
    rng = np.random.default_rng(3)
    side = np.sqrt(n * np.pi * 0.25 / 0.4)
    walls = jostle.Box(0, 0, side + 2, side + 2)
    positions, velocities = rng.uniform(1, side + 1, (n, 2)), rng.normal(size=(n, 2))
    return jostle.World(positions, velocities, 0.5, container=walls, **settings)


# ---- columns -------------------------------------------------------------------------------------


def test_columns_are_float32_in_the_order_of_adding() -> None:
    world = three()
    assert len(world) == 3
    types = {name: (column.dtype, column.shape) for name, column in columns(world).items()}
    assert types == {
        "positions": (np.float32, (3, 2)),
        "velocities": (np.float32, (3, 2)),
        "radii": (np.float32, (3,)),
        "masses": (np.float32, (3,)),
        "restitutions": (np.float32, (3,)),
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
    assert world.restitutions.tolist() == [1, 1, 1]
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


@pytest.mark.parametrize("name", COLUMNS)
def test_columns_are_copies(name: str) -> None:
    world = three()
    column = getattr(world, name)
    before = column.copy()
    setattr(world, name, NEW[name])
    np.testing.assert_array_equal(column, before)
    assert (getattr(world, name) != before).any()


def test_the_world_keeps_its_own_copy() -> None:
    positions = np.zeros((2, 2), np.float32)
    world = jostle.World(positions, positions, 1.0)
    positions[:] = 7
    assert world.positions.tolist() == [[0, 0], [0, 0]]


@pytest.mark.parametrize("dtype", ["f4", ">f4", "f8", "f2", "i2", ">i8", "u1"])
def test_other_numbers_are_converted(dtype: str) -> None:
    vectors = np.array([(1, 2), (30, 4)], dtype)
    world = jostle.World(np.asfortranarray(vectors), vectors[::1, ::-1], vectors[:, 0])
    assert world.positions.tolist() == [[1, 2], [30, 4]]
    assert world.velocities.tolist() == [[2, 1], [4, 30]]
    assert world.radii.tolist() == [1, 30]


def test_one_number_for_all() -> None:
    world = jostle.World([(0, 0), (9, 0)], [(0, 0), (0, 0)], 2, densities=3, movable=False)
    assert world.radii.tolist() == [2, 2]
    assert world.masses.tolist() == [12, 12]
    assert world.movable.tolist() == [False, False]


def test_masses_come_from_densities_unless_given() -> None:
    assert three(densities=[1, 2, 3]).masses.tolist() == [1, 8, 27]
    assert three(masses=[7, 8, 9], densities=5).masses.tolist() == [7, 8, 9]
    assert three(masses=0.5).masses.tolist() == [0.5, 0.5, 0.5]


def test_restitution_is_of_the_world_or_of_each() -> None:
    world = three(restitution=0.9)
    assert (world.restitution, world.restitutions.tolist()) == (0.9, [1, 1, 1])
    world = three(restitution=[0.5, 0.25, 1])
    assert (world.restitution, world.restitutions.tolist()) == (1, [0.5, 0.25, 1])


def test_what_cannot_be_pushed_keeps_its_velocity() -> None:
    world = three(velocities=[(1, 0), (0, 2), (3, 3)])
    world.step(0.5)
    assert world.velocities.tolist() == [[1, 0], [0, 2], [3, 3]]
    world.movable = [False, True, True]
    assert world.velocities.tolist() == [[1, 0], [0, 2], [3, 3]]


@pytest.mark.parametrize("nothing", [[], np.empty((0, 2))])
def test_an_empty_world(nothing: Any) -> None:
    world = jostle.World(nothing, nothing, [])
    assert len(world) == 0
    world.step(0.1)
    assert {name: column.shape for name, column in columns(world).items()} == {
        name: (0, 2) if name in ("positions", "velocities") else (0,) for name in COLUMNS
    }
    assert [part.shape for part in world.contacts] == [(0, 2), (0, 2), (0,), (0,), (0,)]
    assert [part.shape for part in world.wall_contacts] == [(0,), (0,), (0, 2), (0,), (0,), (0,)]
    assert (world.momentum, world.kinetic_energy, world.potential_energy) == ((0, 0), 0, 0)
    assert world.add([(1, 1)], [(0, 0)], 1).tolist() == [0]


# ---- changing columns ----------------------------------------------------------------------------

NEW = {
    "positions": [(1, 1), (11, 1), (21, 6)],
    "velocities": [(5, 5), (6, 6), (0, 0)],
    "radii": [0.5, 0.25, 0.125],
    "masses": [3, 2, 1],
    "restitutions": [0, 0.5, 1],
    "movable": [True, False, False],
    "friction": [0.5, 0, 2],
    "angles": [1, -2, 3],
    "angular_velocities": [-1, 7, 0],
}


@pytest.mark.parametrize("name", COLUMNS)
def test_a_whole_column_may_be_assigned(name: str) -> None:
    world = three()
    before = columns(world)
    setattr(world, name, NEW[name])
    np.testing.assert_array_equal(getattr(world, name), NEW[name])
    untouched = {*COLUMNS} - {name, "velocities" if name == "movable" else name}
    for other in untouched:
        np.testing.assert_array_equal(getattr(world, other), before[other])


@pytest.mark.parametrize(
    ("name", "value"),
    [("radii", 2), ("masses", 5.5), ("restitutions", 0), ("movable", True), ("friction", 3)],
)
def test_one_number_may_be_assigned_to_a_column(name: str, value: Any) -> None:
    world = three()
    setattr(world, name, value)
    assert getattr(world, name).tolist() == [value] * 3
    world.set([2, 0], **{name: value})
    assert getattr(world, name).tolist() == [value] * 3


def test_columns_may_be_reckoned_with() -> None:
    world = three()
    world.positions = world.positions + 1
    world.velocities = world.velocities * 2
    assert world.positions.tolist() == [[1, 1], [11, 1], [21, 6]]
    assert world.velocities.tolist() == [[2, 0], [0, 4], [0, 0]]


@given(st.permutations(range(3)), st.integers(0, 3), st.sampled_from(COLUMNS))
def test_set_changes_some_rows_of_some_columns(order: list[int], k: int, name: str) -> None:
    world, ids = three(), order[:k]
    expected = columns(world)
    expected[name][ids] = np.array(NEW[name])[ids]
    world.set(ids, **{name: np.array(NEW[name])[ids]})
    for other, column in columns(world).items():
        np.testing.assert_array_equal(column, expected[other])


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


def test_columns_of_springs_are_read_only() -> None:
    springs = jostle.Springs([(0, 1)], 1, 2)
    for name in ("pairs", "lengths", "stiffness", "damping", "max_stretch"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(springs, name)[0] = 1


def test_removing_changes_no_id() -> None:
    world = three()
    marks = world.masses
    world.remove([1])
    assert world.renumbered is None
    assert world.ids.tolist() == [0, 2]
    assert (world.masses == marks[world.ids]).all()
    with pytest.raises(ValueError, match="ids"):
        world.remove([1])
    assert "ids" in (jostle.World.remove.__doc__ or "").splitlines()[0]


def test_what_became_of_ids_is_told_until_the_next_step() -> None:
    positions = [(0, 0), (9, 0), (1, 0), (20, 0)]
    world = jostle.World(positions, [(0, 0)] * 4, 1.0, on_touch="merge")
    world.step(0.1)
    new = world.renumbered
    assert new is not None
    assert (new.dtype, new.tolist(), new.flags.writeable) == (np.int64, [0, 1, 0, 3], False)
    with pytest.raises(ValueError, match="dt"):
        world.step(-1)
    world.add([(50, 50)], [(0, 0)], 1)
    world.remove([0, 1])
    assert world.renumbered is not None
    assert world.renumbered.tolist() == [-1, -1, -1, 3, 4]
    world.step(0.1)
    assert world.renumbered is None


def test_set_changes_several_columns_at_once() -> None:
    world = three()
    world.set(np.array([1, 0], np.uint8), positions=[(5, 5), (6, 6)], radii=0.5, masses=[8, 9])
    assert world.positions.tolist() == [[6, 6], [5, 5], [20, 5]]
    assert world.radii.tolist() == [0.5, 0.5, 3]
    assert world.masses.tolist() == [9, 8, 9]


def test_the_mass_stays_when_the_radius_changes() -> None:
    world = three()
    world.radii = 7
    assert world.masses.tolist() == [1, 4, 9]


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
        [(0, 1), (1, 0)],
        [1, 2],
        densities=2,
        restitutions=[0.5, 1],
        movable=[True, False],
    )
    assert ids.dtype == np.int64
    assert ids.tolist() == [3, 4]
    assert world.positions[ids].tolist() == [[30, 0], [40, 0]]
    assert world.velocities[ids].tolist() == [[0, 1], [1, 0]]
    assert world.masses.tolist() == [1, 4, 9, 2, 8]
    assert world.restitutions.tolist() == [1, 1, 1, 0.5, 1]
    assert world.movable.tolist() == [True, True, False, True, False]
    assert world.add([(60, 0)], [(0, 0)], 1, masses=11).tolist() == [5]
    assert world.masses[5] == 11
    assert world.add([], [], []).shape == (0,)
    assert len(world) == 6


def test_add_takes_one_particle() -> None:
    world = three()
    id = world.add((30, 0), velocities=(0, 1), radii=2, friction=0.5)
    assert (type(id), id) == (int, 3)
    assert world.positions[3].tolist() == [30, 0]
    assert world.velocities[3].tolist() == [0, 1]
    assert (world.radii[3], world.masses[3], world.friction[3]) == (2, 4, 0.5)
    assert world.add(np.array([40, 0]), np.zeros(2), [1]) == 4
    assert world.add([[50, 0]], [[0, 0]], 1).tolist() == [5]
    world.remove(id)
    assert world.add((30, 0), (0, 1), 1) == 6


MATERIALS: dict[str, Any] = {"radii": 0.5, "masses": 3, "friction": 0.25}


def test_new_particles_have_the_numbers_that_all_were_given() -> None:
    world = jostle.World([(0, 0), (5, 0)], [(0, 0)] * 2, **MATERIALS, restitution=0.5)
    world = pickle.loads(pickle.dumps(world))
    one = world.add((10, 0), (0, 0))
    many = world.add([(20, 0), (30, 0)], [(0, 0)] * 2, friction=[0, 1])
    world.add((40, 0), (0, 0), 2, masses=5, restitutions=0.1)
    world.add((50, 0), (0, 0), 2, densities=0.5)  # a density replaces the mass
    assert (one, many.tolist()) == (2, [3, 4])
    assert world.radii.tolist() == [0.5] * 5 + [2, 2]
    assert world.masses.tolist() == [3] * 5 + [5, 2]
    assert world.friction.tolist() == [0.25] * 3 + [0, 1] + [0.25] * 2
    # The world's own coefficient of restitution is not that of a particle.
    np.testing.assert_array_equal(world.restitutions, np.float32([1] * 5 + [0.1, 1]))


def test_new_particles_have_the_density_that_all_were_given() -> None:
    world = jostle.World([(0, 0)], [(0, 0)], radii=[2], densities=3, movable=False)
    world.add((10, 0), (0, 0), radii=1)
    assert world.masses.tolist() == [12, 3]
    assert world.movable.tolist() == [False, True]


def test_one_number_that_is_assigned_is_for_new_particles_too() -> None:
    world = jostle.World([(0, 0), (9, 0)], [(0, 0)] * 2, radii=[1, 2])
    with pytest.raises(TypeError, match=r"^add needs radii: no number was given for all"):
        world.add((20, 0), (0, 0))
    world.radii, world.masses, world.friction, world.restitutions = 2.0, 7.0, 0.75, 0.5
    world.add((20, 0), (0, 0))
    assert [world.radii[2], world.masses[2]] == [2, 7]
    assert [world.friction[2], world.restitutions[2]] == [0.75, 0.5]
    with pytest.raises(ValueError, match="friction is -1"):
        world.friction = -1
    world.friction = [0, 0.5, 1]  # not one for all
    world.set(0, friction=0)
    world.add((30, 0), (0, 0))
    assert world.friction.tolist() == [0, 0.5, 1, 0.75]


def test_new_grains_of_a_heap_have_its_friction() -> None:
    world = jostle.scenes.create("heap", n=50)
    world.add((0, -900), (0, 0), radii=1.0)
    assert world.friction[0] > 0
    assert (world.friction == world.friction[0]).all()


@given(st.sets(st.integers(0, 9)), st.randoms(use_true_random=False))
def test_remove_closes_the_gaps(gone: set[int], random: Any) -> None:
    world = jostle.World([(3 * i, 0) for i in range(10)], [(0, 0)] * 10, 1, masses=np.arange(1, 11))
    world.step(0.1)
    ids = [*gone]
    random.shuffle(ids)
    world.remove(ids)
    left = [i for i in range(10) if i not in gone]
    assert world.masses.tolist() == [i + 1 for i in left]
    np.testing.assert_array_equal(world.positions[:, 0], np.float32(3) * np.array(left, np.float32))
    world.step(0.1)
    assert len(world) == len(left)


def test_contacts_go_with_either_particle() -> None:
    world = jostle.World([(0, 0), (50, 0), (51.5, 0)], [(0, 0)] * 3, 1.0)
    world.step(0.01)
    assert world.contacts.pairs.tolist() == [[1, 2]]
    world.remove([0])
    assert world.contacts.pairs.tolist() == [[1, 2]]
    world.remove([1])
    assert world.contacts.pairs.shape == (0, 2)
    world.remove([2])
    assert world.contacts.pairs.shape == (0, 2)
    world.step(0.01)
    assert world.contacts.pairs.shape == (0, 2)


def test_contacts_after_adding() -> None:
    world = jostle.World([(50, 0), (51.5, 0)], [(0, 0)] * 2, 1.0)
    world.step(0.01)
    world.add([(-9, 0), (99, 0)], [(0, 0)] * 2, 1.0)
    assert world.contacts.pairs.tolist() == [[0, 1]]
    world.step(0.01)
    assert world.contacts.pairs.tolist() == [[0, 1]]


# ---- settings ------------------------------------------------------------------------------------


def test_settings_and_their_defaults() -> None:
    world = three()
    found = {name: getattr(world, name) for name in SETTINGS}
    assert found == {name: default for name, (default, _) in SETTINGS.items()}
    signature = inspect.signature(jostle.World)
    for name, value in found.items():
        assert signature.parameters[name].default == value


SETTINGS: dict[str, tuple[Any, Any]] = {
    "gravity": ((0, 0), (0.1, -9.81)),
    "drag": (0, 0.3),
    "restitution": (1, 0.7),
    "container": (None, jostle.Box(-50, -50, 50, 50)),
    "on_touch": ("bounce", "merge"),
    "method": ("quadtree", "brute"),
    "threads": (None, 2),
    "leaf_capacity": (jostle.World([], [], []).leaf_capacity, 5),
    "max_depth": (4096, 3),
}


@pytest.mark.parametrize("name", SETTINGS)
def test_settings_may_be_given_or_assigned(name: str) -> None:
    default, value = SETTINGS[name]
    assert getattr(three(**{name: value}), name) == value
    world = three()
    setattr(world, name, value)
    assert getattr(world, name) == value
    others = {other for other in SETTINGS if other != name}
    assert all(getattr(world, other) == SETTINGS[other][0] for other in others)
    setattr(world, name, default)
    assert getattr(world, name) == default


def test_substeps_are_as_many_as_the_scene_needs_unless_given() -> None:
    assert inspect.signature(jostle.World).parameters["substeps"].default is None
    assert three().substeps == 1
    assert three(restitution=0.5).substeps == 1  # no particles are pressed against each other
    assert three(restitution=0.5, gravity=(0, 1)).substeps == 4
    assert three(gravity=(0, 1)).substeps == 1
    assert three(forces=[jostle.Gravitation(1.0)]).substeps == 4
    world = three(substeps=2)
    assert world.substeps == 2
    world.substeps = None
    assert world.substeps == 1


def test_gravity_may_be_an_array() -> None:
    assert three(gravity=np.array([1, 2])).gravity == (1, 2)


# ---- a step --------------------------------------------------------------------------------------


def test_time_passes() -> None:
    world = three()
    world.step(0.25, steps=3)
    assert world.time == 0.75
    world.step(np.float32(0.25))
    world.step(1, 0)
    assert world.time == 1
    assert world.positions[0].tolist() == pytest.approx([1, 0])


def test_many_steps_are_as_many_single_ones() -> None:
    once, often = gas(), gas()
    once.step(1 / 60, steps=30)
    for _ in range(30):
        often.step(1 / 60)
    assert once.state_hash() == often.state_hash()


@pytest.mark.parametrize("method", ["quadtree", "brute"])
def test_what_a_step_leaves_behind(method: Any) -> None:
    world = gas(method=method)
    assert world.stats == (0, 0, 0, 0, 0)
    assert len(world.contacts.pairs) == 0
    assert world.profile == dict.fromkeys(STAGES, 0.0)
    world.step(1 / 60, steps=2)
    contacts, stats = world.contacts, world.stats
    assert isinstance(contacts, jostle.WorldContacts)
    assert isinstance(stats, jostle.WorldStats)
    pairs, normals, depths, *_ = contacts
    assert len(pairs) > 0
    assert (pairs.dtype, normals.dtype, depths.dtype) == (np.int64, np.float32, np.float32)
    assert (pairs[:, 0] < pairs[:, 1]).all()
    assert (pairs < len(world)).all()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-5)
    offset = world.positions[pairs[:, 1]] - world.positions[pairs[:, 0]]
    assert ((offset * normals).sum(axis=1) > 0).all()
    everything = len(world) * (len(world) - 1) // 2
    assert len(pairs) <= stats.tests
    assert stats.tests == everything if method == "brute" else stats.tests < everything / 4
    assert list(world.profile) == STAGES
    assert all(isinstance(time, float) and time >= 0 for time in world.profile.values())
    assert sum(world.profile.values()) > 0


STAGES = ["bounds", "build", "pairs", "contacts", "resting", "events", "correction", "store"]


def test_the_profile_is_of_the_last_step() -> None:
    world = gas(4000)
    start = time.perf_counter()
    world.step(1 / 60, steps=50)
    taken = 1000 * (time.perf_counter() - start)
    assert 0 < sum(world.profile.values()) < taken / 5
    before = world.profile
    world.step(1 / 60, steps=0)
    assert world.profile == before


def test_forces_have_a_stage_of_their_own() -> None:
    world = gas(4000, forces=[jostle.Gravitation(0.1)])
    assert world.profile == dict.fromkeys([*STAGES, "forces"], 0.0)
    world.step(1 / 60)
    # Nothing rests in an elastic gas.
    assert all((time > 0) == (stage != "resting") for stage, time in world.profile.items())
    world.forces = ()
    assert list(world.profile) == STAGES


def test_sums() -> None:
    world = three(gravity=(0, 10))
    assert world.momentum == (1, 8)
    assert world.kinetic_energy == 0.5 * 1 * 1 + 0.5 * 4 * 4
    assert world.potential_energy == 0  # only the immovable one is off the line y = 0
    world.positions = [(0, -2), (10, 0), (20, 5)]
    assert world.potential_energy == 20


def test_the_hash_is_of_the_state() -> None:
    world = three()
    assert 0 <= world.state_hash() < 2**64
    assert world.state_hash() == three().state_hash()
    for name in COLUMNS:
        other = three()
        setattr(other, name, NEW[name])
        assert other.state_hash() != world.state_hash()


@pytest.mark.parametrize("settings", [{"threads": 1}, {"threads": 2}, {"method": "brute"}])
def test_settings_that_change_nothing_but_speed(settings: Any) -> None:
    world, other = gas(3000), gas(3000, **settings)
    for each in (world, other):
        each.step(1 / 60, steps=10)
    assert world.state_hash() == other.state_hash()


# ---- touching ------------------------------------------------------------------------------------


def test_what_touches_merges_and_ids_can_be_followed() -> None:
    positions = [(0, 0), (9, 0), (1.5, 0), (20, 0)]
    tie = jostle.Springs([(0, 2), (2, 3)], 18, 0)
    world = jostle.World(positions, [(0, 0)] * 4, 1.0, on_touch="merge", forces=[tie])
    assert world.renumbered is None
    world.step(0.01)
    assert world.renumbered is not None
    assert world.renumbered.tolist() == [0, 1, 0, 3]
    assert world.ids.tolist() == [0, 1, 3]
    assert world.masses.tolist() == [2, 1, 1]
    assert world.positions[0].tolist() == [0.75, 0]
    (springs,) = world.forces
    assert isinstance(springs, jostle.Springs)
    assert springs.pairs.tolist() == [[0, 3]]
    assert world.contacts.pairs.shape == (0, 2)
    world.step(0.01)
    assert world.renumbered is None


def test_ids_are_followed_through_long_calls() -> None:
    world = gas(3000, on_touch="merge")
    masses = world.masses
    world.step(1 / 600, steps=300)  # the call checks for it in between
    ids = world.renumbered
    assert ids is not None
    assert 0 < len(world) < 1000
    assert (np.unique(ids) == world.ids).all()
    sums = np.bincount(ids, weights=masses)[world.ids]
    np.testing.assert_allclose(world.masses, sums, rtol=1e-5)
    world.step(1 / 600, steps=0)
    assert world.renumbered is None


def test_what_touches_may_be_ignored() -> None:
    world = jostle.World([(0, 0), (3, 0)], [(1, 0), (-1, 0)], 1.0, on_touch="ignore")
    world.step(0.1, steps=10)
    pairs, normals, depths, *_ = world.contacts
    assert (pairs.tolist(), normals.tolist()) == ([[0, 1]], [[1, 0]])
    np.testing.assert_allclose(depths, [1], rtol=1e-5)
    world.step(0.1, steps=10)
    np.testing.assert_allclose(world.positions[:, 0], [2, 1], rtol=1e-5)


# ---- threads -------------------------------------------------------------------------------------


def test_other_threads_see_the_world_between_steps() -> None:
    world = gas(2000)
    seen: list[float] = []
    done = threading.Event()

    def look() -> None:
        while not done.is_set():
            moment, positions = world.time, world.positions
            assert np.isfinite(positions).all()
            seen.append(moment)
            time.sleep(0.001)

    thread = threading.Thread(target=look)
    thread.start()
    end = time.perf_counter() + 10
    while len({*seen}) < 4 and time.perf_counter() < end:
        world.step(1 / 60, steps=100)
    done.set()
    thread.join()
    assert len({*seen}) >= 4


def test_a_long_call_can_be_interrupted() -> None:
    world = gas(50)
    assert reaction_to_ctrl_c(lambda: world.step(1 / 60, steps=10**7)) < 1
    assert world.time > 0
    world.step(1 / 60)  # and it is still usable


def test_one_id_may_be_given_instead_of_many() -> None:
    worlds = [jostle.World([(0, 0), (5, 0), (9, 0)], [(0, 0)] * 3, radii=1.0) for _ in range(2)]
    one, many = worlds
    one.set(1, positions=(4, 1), velocities=np.array([2, 3]), radii=0.5, movable=False)
    many.set([1], positions=[(4, 1)], velocities=[(2, 3)], radii=[0.5], movable=[False])
    assert one.positions[1].tolist() == [4, 1]
    assert one.state_hash() == many.state_hash()
    one.remove(np.int64(0))
    many.remove([0])
    assert one.radii.tolist() == [0.5, 1]
    assert one.state_hash() == many.state_hash()


# ---- errors -------------------------------------------------------------------------------------

NOTHING_CHANGED: list[tuple[Callable[[Any], Any], type[Exception], str]] = [
    (lambda w: w.step(0), ValueError, "dt is 0; it must be finite and above 0"),
    (lambda w: w.step(-0.1), ValueError, "dt is -0.1; it must be finite and above 0"),
    (
        lambda w: w.step(1e-300),
        ValueError,
        "dt is 1e-300; it must be finite and above 0 in float32",
    ),
    (lambda w: w.step(-1.5e300), ValueError, "dt is -1.5e300; it must be finite and above 0"),
    (lambda w: w.step(np.nan, 0), ValueError, "dt is NaN; it must be finite and above 0"),
    (lambda w: w.step("1"), TypeError, "dt must be a number, not str"),
    (lambda w: w.step(0.1, -1), ValueError, "steps is -1; it must be at least 0"),
    (lambda w: w.step(0.1, 1.5), TypeError, "steps must be an integer, not float"),
    (lambda w: w.add((0, np.nan), (0, 0), 1), ValueError, "positions is (0, NaN); both"),
    (
        lambda w: w.add((0, 1), [(0, 0)], 1),
        ValueError,
        "velocities has shape (1, 2); it must be (2",
    ),
    (lambda w: w.add([(0, 1)], (0, 0), 1), ValueError, "velocities has shape (2,); it must be (1"),
    (
        lambda w: w.add((0, 1, 2), (0, 0), 1),
        ValueError,
        "positions has shape (3,); it must be (2,)",
    ),
    (lambda w: w.add((0, 1), (0, 0), [1, 2]), ValueError, "radii has shape (2,); it must be a num"),
    (lambda w: w.add((0, 1), (0, 0), -1), ValueError, "radii is -1; a radius must be finite"),
    (lambda w: w.add((0, 1), (0, 0), 0), ValueError, "radii is 0; its mass, density times radius"),
    (lambda w: w.add((0, 1), (0, 0)), TypeError, "add needs radii: no number was given for all"),
    (lambda w: w.remove([3]), ValueError, "ids[0] is 3; no particle has this id; ids are below 3"),
    (lambda w: w.remove([0, 1, 0]), ValueError, "ids[2] is 0; it is given twice"),
    (lambda w: w.remove([0, -1]), ValueError, "ids[1] is -1; no particle has this id"),
    (lambda w: w.remove(-1), ValueError, "ids is -1; no particle has this id"),
    (lambda w: w.remove(3), ValueError, "ids is 3; no particle has this id; ids are below 3"),
    (lambda w: w.remove(2**70), ValueError, "ids is 1180591620717411303424; no particle has"),
    (lambda w: w.remove(True), TypeError, "ids must hold integers, not bool"),
    (lambda w: w.remove(1.0), TypeError, "ids must hold integers, not float"),
    (lambda w: w.remove([[0, 1]]), ValueError, "ids has shape (1, 2); it must be an integer or"),
    (lambda w: w.set(1, positions=[(1, 2)]), ValueError, "positions has shape (1, 2); it must be"),
    (lambda w: w.set(1, velocities=(0, np.nan)), ValueError, "velocities is (0, NaN); both"),
    (lambda w: w.remove([0.5]), TypeError, "ids must hold integers, not float64"),
    (lambda w: w.remove([True, False, True]), TypeError, "ids must hold integers, not bool"),
    (lambda w: w.set([1, 7], radii=1), ValueError, "ids[1] is 7; no particle has this id"),
    (lambda w: w.set([1, 1], radii=1), ValueError, "ids[1] is 1; it is given twice"),
    (lambda w: w.set([1], radii=[1, 2]), ValueError, "radii has shape (2,); it must be a number"),
    (lambda w: w.set([1], positions=(1, 2)), ValueError, "positions has shape (2,); it must be (1"),
    (lambda w: w.set([1, 0], radii=[1, -2]), ValueError, "radii[1] is -2; a radius must be finite"),
    (lambda w: w.set([1], radii=np.inf), ValueError, "radii is inf; a radius must be finite"),
    (lambda w: w.set([1], velocities=[(0, np.nan)]), ValueError, "velocities[0] is (0, NaN); both"),
    (lambda w: w.set([1], movable=[1]), TypeError, "movable must hold booleans, not int64"),
    (lambda w: w.set([1], masses=-1), ValueError, "masses is -1; a mass must lie between"),
    (
        lambda w: w.set([1], radii=1, restitutions=2),
        ValueError,
        "restitutions is 2; a restitution must lie between 0 and 1",
    ),
    (lambda w: w.set(1, friction=-1), ValueError, "friction is -1; a coefficient of friction must"),
    (
        lambda w: w.set([1, 0], friction=[1, np.inf]),
        ValueError,
        "friction[1] is inf; a coefficient of friction must be finite and at least 0",
    ),
    (lambda w: setattr(w, "angles", np.nan), ValueError, "angles is NaN; an angle must be finite"),
    (
        lambda w: setattr(w, "angular_velocities", [0, 1e30, 0]),
        ValueError,
        "angular_velocities[1] is 1e30; an angular velocity must be finite and lie within ±1e18",
    ),
    (lambda w: w.add([(1, 1)], [(0, 0)], -1), ValueError, "radii is -1; a radius must be finite"),
    (
        lambda w: w.add([(1, 1)], [(0, 0)], 0),
        ValueError,
        "radii[0] is 0; its mass, density times",
    ),
    (lambda w: w.add([(1, 1)], [], 1), ValueError, "velocities has shape (0,); it must be (1, 2)"),
    (
        lambda w: w.add([(1, 1)], [(0, 0)], 1, densities=0),
        ValueError,
        "densities is 0; a density must be finite and above 0",
    ),
    (
        lambda w: w.add([(1, 1)] * 2, [(0, 0)] * 2, 1, densities=[1, np.nan]),
        ValueError,
        "densities[1] is NaN; a density must be finite and above 0",
    ),
    (lambda w: w.add([(0, 1e30)], [(0, 0)], 1), ValueError, "positions[0] is (0"),
    (
        lambda w: setattr(w, "positions", [(0, 0)]),
        ValueError,
        "positions has shape (1, 2); it must",
    ),
    (lambda w: setattr(w, "radii", [1, 2, -3]), ValueError, "radii[2] is -3; a radius must be"),
    (lambda w: setattr(w, "radii", None), TypeError, "radii must hold real numbers, not NoneType"),
    (lambda w: setattr(w, "movable", [1, 0, 1]), TypeError, "movable must hold booleans, not int"),
    (lambda w: setattr(w, "gravity", 9.81), ValueError, "gravity has shape (); it must be (2,)"),
    (lambda w: setattr(w, "gravity", (0, np.inf)), ValueError, "gravity is (0, inf); both"),
    (lambda w: setattr(w, "drag", -1), ValueError, "drag is -1; it must be finite and at least 0"),
    (lambda w: setattr(w, "drag", None), TypeError, "drag must be a number, not NoneType"),
    (lambda w: setattr(w, "restitution", 1.5), ValueError, "restitution is 1.5; it must lie"),
    (lambda w: setattr(w, "restitution", [1] * 3), TypeError, "restitution must be a number, not"),
    (lambda w: setattr(w, "method", "auto"), ValueError, "method is 'auto'; it must be 'quadtree'"),
    (lambda w: setattr(w, "method", None), TypeError, "method must be 'quadtree' or 'brute', not"),
    (lambda w: setattr(w, "on_touch", "stick"), ValueError, "on_touch is 'stick'; it must be 'bo"),
    (lambda w: setattr(w, "on_touch", 1), TypeError, "on_touch must be 'bounce', 'merge' or 'ign"),
    (lambda w: setattr(w, "threads", 0), ValueError, "threads is 0; it must be at least 1"),
    (lambda w: setattr(w, "leaf_capacity", 0), ValueError, "leaf_capacity is 0; it must be at"),
    (lambda w: setattr(w, "max_depth", -1), ValueError, "max_depth is -1; it must be at least 0"),
    (lambda w: setattr(w, "substeps", 0), ValueError, "substeps is 0; it must be at least 1"),
    (lambda w: setattr(w, "substeps", 9999), ValueError, "substeps is 9999; it must lie between"),
    (
        lambda w: setattr(w, "container", "box"),
        TypeError,
        "container must be a jostle.Box, jostle.Circle, jostle.Torus or None, not str",
    ),
    (
        lambda w: setattr(w, "container", jostle.Box(0, 0, 4, 4)),
        ValueError,
        "radii[2] is 3; it must fit between the walls (at most 2)",
    ),
    (lambda w: setattr(w, "time", 1), AttributeError, "attribute 'time' of 'jostle.World'"),
    (lambda w: setattr(w, "own", 1), AttributeError, "'jostle.World' object has no attribute"),
]


@pytest.mark.parametrize(("act", "error", "message"), NOTHING_CHANGED)
def test_refused_and_nothing_changed(
    act: Callable[[jostle.World], Any], error: type[Exception], message: str
) -> None:
    world = three(container=jostle.Box(-100, -100, 100, 100))
    world.step(0.01)
    state, settings = world.state_hash(), {name: getattr(world, name) for name in SETTINGS}
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        act(world)
    assert len(world) == 3
    assert world.state_hash() == state
    assert {name: getattr(world, name) for name in SETTINGS} == settings
    assert world.time == 0.01


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"positions": np.zeros((3, 3))}, ValueError, "positions has shape (3, 3); it must be (n"),
        ({"positions": [(0, 0)]}, ValueError, "velocities has shape (3, 2); it must be (1, 2)"),
        ({"velocities": (0, 0)}, ValueError, "velocities has shape (2,); it must be (3, 2)"),
        ({"radii": [1, 2]}, ValueError, "radii has shape (2,); it must be a number or (3,)"),
        ({"masses": [1]}, ValueError, "masses has shape (1,); it must be a number or (3,)"),
        ({"densities": [1]}, ValueError, "densities has shape (1,); it must be a number or (3,)"),
        ({"movable": [True]}, ValueError, "movable has shape (1,); it must be True or False or"),
        ({"restitution": [1]}, ValueError, "restitution has shape (1,); it must be a number or"),
        ({"restitution": [1, 1, -1]}, ValueError, "restitutions[2] is -1; a restitution must"),
        ({"friction": [1]}, ValueError, "friction has shape (1,); it must be a number or (3,)"),
        ({"friction": [1, 1, -1]}, ValueError, "friction[2] is -1; a coefficient of friction"),
        ({"friction": "much"}, TypeError, "friction must hold real numbers, not str"),
        ({"angular_velocities": [0, np.inf, 0]}, ValueError, "angular_velocities[1] is inf; an"),
        ({"restitution": -1}, ValueError, "restitution is -1; it must lie between 0 and 1"),
        ({"positions": [(0, 0), (np.inf, 0), (1, 1)]}, ValueError, "positions[1] is (inf, 0)"),
        ({"velocities": [(0, 0), (0, 0), (1, np.nan)]}, ValueError, "velocities[2] is (1, NaN)"),
        ({"radii": [1, -1, 1]}, ValueError, "radii[1] is -1; a radius must be finite and at"),
        ({"masses": [1, 2, 0]}, ValueError, "masses[2] is 0; a mass must lie between"),
        ({"container": jostle.Circle((0, 0), 2.5)}, ValueError, "radii[2] is 3; it must fit into"),
        ({"container": jostle.Torus(9, 9)}, ValueError, "radii[2] is 3; on a torus it may be at"),
        ({"method": "tree"}, ValueError, "method is 'tree'; it must be 'quadtree' or 'brute'"),
        ({"positions": "here"}, TypeError, "positions must hold real numbers, not str"),
        ({"velocities": None}, TypeError, "velocities must hold real numbers, not NoneType"),
        ({"radii": True}, TypeError, "radii must hold real numbers, not bool"),
        ({"masses": [1j, 2, 3]}, TypeError, "masses must hold real numbers, not complex128"),
        ({"movable": [0, 1, 1]}, TypeError, "movable must hold booleans, not int64"),
        ({"gravity": None}, TypeError, "gravity must hold real numbers, not NoneType"),
        ({"drag": "much"}, TypeError, "drag must be a number, not str"),
        ({"substeps": 1.5}, TypeError, "substeps must be an integer, not float"),
    ],
)
def test_a_wrong_world(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        three(**arguments)


def test_representation() -> None:
    world = three()
    world.step(0.25)
    assert repr(world) == "<jostle.World of 3 particles after 0.250 s>"


def test_signatures() -> None:
    assert str(inspect.signature(jostle.World.step)) == "(self, /, dt, steps=1)"
    assert list(inspect.signature(jostle.World.add).parameters)[1:4] == [
        "positions",
        "velocities",
        "radii",
    ]
    assert "ids, *, positions=None" in str(inspect.signature(jostle.World.set))


def test_given_positions_have_no_residual() -> None:
    """Also if they are equal to the current ones."""
    world = jostle.World([(0, 0), (3, 0)], [(0.1, 0), (0, 0)], radii=1.0)
    world.step(1 / 60, steps=7)
    positions, velocities = world.positions, world.velocities
    same = jostle.World(positions, velocities, radii=1.0)
    assert world.state_hash() != same.state_hash()
    world.positions = positions
    assert world.state_hash() == same.state_hash()
    world.step(1 / 60, steps=7)
    same.step(1 / 60, steps=7)
    assert world.state_hash() == same.state_hash()


@pytest.mark.parametrize("container", [None, jostle.Torus(60, 60)])
def test_the_quadtree_is_that_of_the_particles_as_they_are_now(container: Any) -> None:
    rng = np.random.default_rng(4)
    world = jostle.World(
        rng.uniform(0, 60, (300, 2)),
        rng.normal(size=(300, 2)),
        rng.uniform(0.5, 2, 300),
        container=container,
        on_touch="ignore",
        leaf_capacity=7,
    )
    empty = jostle.World(np.empty((0, 2)), np.empty((0, 2)), 1.0)
    assert len(empty.quadtree()) == 0
    for _ in range(3):
        world.step(1.0)
        tree = world.quadtree()
        other = jostle.Quadtree(world.positions, world.radii, leaf_capacity=7)
        assert tree.pairs(sort=True).tolist() == other.pairs(sort=True).tolist()
        assert tree.query_circle((30, 30), 9).tolist() == other.query_circle((30, 30), 9).tolist()
    before = tree.pairs(sort=True).tolist()
    world.remove([0, 5])
    assert len(tree) == 300 and tree.pairs(sort=True).tolist() == before
    assert len(world.quadtree()) == 298


def test_the_quadtree_has_sleeping_particles_too() -> None:
    world = jostle.World(
        [(0, 1), (5, 1), (9, 5)],
        np.zeros((3, 2)),
        1.0,
        movable=[True, True, False],
        gravity=(0, -9.8),
        restitution=0.3,
        container=jostle.Box(-9, 0, 19, 9),
    )
    world.step(1 / 60, steps=60)
    assert world.asleep.tolist() == [True, True, False]
    assert world.quadtree().query_circle((4, 2), 9).tolist() == [0, 1, 2]
