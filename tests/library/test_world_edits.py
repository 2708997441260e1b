"""`World.get` and `World.set`: some particles, against a model of whole columns."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import jostle

STEP = 1 / 60
COLUMNS = jostle.Particles.__slots__[:-1]  # `World` has no attribute of kinds
DTYPES = {"movable": bool, "sensors": bool, "categories": np.uint32, "masks": np.uint32}


def columns(world: jostle.World) -> dict[str, np.ndarray]:
    return {name: getattr(world, name) for name in COLUMNS}


def busy_world() -> jostle.World:
    """Awake and sleeping discs, some removed, with all columns in use."""
    n = 30
    rng = np.random.default_rng(3)
    grid = np.stack(np.meshgrid(np.arange(6), np.arange(5)), -1).reshape(-1, 2)
    world = jostle.World(
        grid * 2.2 + (1, 1),
        rng.uniform(0.5, 1, n),
        velocities=rng.normal(size=(n, 2)),
        restitution=rng.uniform(0.2, 0.6, n),
        friction=rng.uniform(0, 0.5, n),
        angles=rng.uniform(-3, 3, n),
        angular_velocities=rng.normal(size=n),
        categories=rng.integers(1, 9, n),
        masks=rng.integers(1, 99, n),
        gravity=(0, -9.8),
        container=jostle.Box(0, 0, 14, 30),
    )
    world.set([4, 9], movable=False, velocities=0.0 * world.velocities[:2])
    world.set(11, sensors=True)
    world.remove([0, 17])
    world.step(STEP, steps=1500)
    world.add((7, 25), 0.7, velocities=(1, 0))
    world.step(STEP, steps=3)
    return world


WORLD = busy_world().snapshot()


def test_some_sleep_in_the_world_of_these_tests() -> None:
    asleep = jostle.World.restore(WORLD).asleep
    assert 3 < asleep.sum() < len(asleep) - 3


@given(st.lists(st.integers(0, 28), max_size=12))
def test_read_gives_rows_of_all_columns(rows: list[int]) -> None:
    world = jostle.World.restore(WORLD)
    found = world.get(world.ids[rows])
    assert isinstance(found, jostle.Particles)
    for name, column in columns(world).items():
        read = getattr(found, name)
        assert read.dtype == column.dtype, name
        np.testing.assert_array_equal(read, column[rows], err_msg=name)


@pytest.mark.parametrize("row", [0, 8, 28])
def test_read_of_one_id_gives_single_values(row: int) -> None:
    world = jostle.World.restore(WORLD)
    one = world.get(int(world.ids[row]))
    assert isinstance(one, jostle.Particle)
    for name, column in columns(world).items():
        value: Any = getattr(one, name)
        assert np.asarray(value, column.dtype).tolist() == column[row].tolist(), name
    assert type(one.radii) is float and type(one.movable) is bool and type(one.masks) is int


def test_what_is_read_can_be_added_and_set() -> None:
    world = jostle.World.restore(WORLD)
    one = world.get(5).to_dict() | {"positions": (7, 20)}
    copy = world.add(**one)
    for name, value in world.get(copy).to_dict().items():
        np.testing.assert_array_equal(value, one[name], err_msg=name)
    some = world.get([3, 6])
    world.set([6, 3], **some.to_dict())
    assert world.get([6, 3]) == some


def test_kinds_are_read_added_and_set() -> None:
    force = jostle.PairForce(np.zeros((3, 3, 2)), 5.0)
    world = jostle.World([(0, 0), (9, 0), (18, 0)], 1.0, kinds=[0, 2, 1], forces=[force])
    world.remove(0)
    assert world.get([2, 1]).kinds.tolist() == [1, 2] and world.get(1).kinds == 2
    assert type(world.get(1).kinds) is int and world.get([]).kinds.dtype == np.uint8
    copy = world.add(**world.get(1).to_dict() | {"positions": (30, 0)})
    assert world.get(copy).kinds == 2
    world.set([copy, 1], kinds=[1, 0], masses=2.0)
    assert world.kinds.tolist() == [0, 1, 1]
    world.set(1, kinds=1)
    with pytest.raises(ValueError, match="kinds is 3; the table has 3 kinds, from 0 to 2"):
        world.set(1, kinds=3, masses=5.0)
    assert world.get(1).masses == 2 and world.get(1).kinds == 1
    plain = jostle.World.restore(WORLD)
    assert plain.get(5).kinds == 0
    plain.set(5, kinds=63)
    assert plain.get([5, 8]).kinds.tolist() == [63, 0]
    with pytest.raises(ValueError, match="kinds is 64; it must be a kind, between 0 and 63"):
        plain.set(5, kinds=64)


def test_kinds_belong_to_particles() -> None:
    world = jostle.World([(0, 0), (9, 0)], 1.0, kinds=[2, 0])
    pairs = [jostle.PairForce(np.zeros((3, 3, 2)), 5.0 + k) for k in range(2)]
    world.forces = [*pairs, jostle.Thermostat(1.0, 0.5)]
    world.set(1, kinds=1)
    assert world.kinds.tolist() == [2, 1]
    before = world.forces
    with pytest.raises(ValueError) as error:
        world.forces = [pairs[0], jostle.PairForce(np.zeros((2, 2, 2)), 5.0)]
    assert str(error.value) == "kinds[0] is 2; the table has 2 kinds, from 0 to 1"
    assert world.forces == before
    with pytest.raises(ValueError) as error:
        world.kinds = [0, 3]
    assert str(error.value) == "kinds[1] is 3; the table has 3 kinds, from 0 to 2"
    world.forces = []
    assert world.kinds.tolist() == [2, 1]


def test_ids_that_no_particle_has_are_refused() -> None:
    world = jostle.World.restore(WORLD)
    with pytest.raises(ValueError, match=r"ids\[1\] is 17; no particle has this id any more"):
        world.get([3, 17])
    with pytest.raises(ValueError, match="ids is 99; no particle has this id"):
        world.get(99)
    with pytest.raises(TypeError, match="ids"):
        world.get(0.5)
    before = world.snapshot()
    with pytest.raises(ValueError, match=r"ids\[3\] is 8; it is given twice"):
        world.set([8, 3, 5, 8, 3], masses=1.0)
    assert world.snapshot() == before


VALUES = {
    "positions": st.tuples(st.floats(1, 13, width=32), st.floats(1, 29, width=32)),
    "velocities": st.tuples(st.floats(-3, 3, width=32), st.just(0.0)),
    "radii": st.sampled_from([0.0, 0.5, 1.0]),
    "masses": st.sampled_from([0.5, 2.0]),
    "restitution": st.sampled_from([0.0, 0.25, 1.0]),
    "movable": st.booleans(),
    "friction": st.sampled_from([0.0, 0.25]),
    "angles": st.floats(-3, 3, width=32),
    "angular_velocities": st.sampled_from([0.0, 1.5]),
    "categories": st.sampled_from([1, 6]),
    "masks": st.sampled_from([1, 2**32 - 1]),
    "sensors": st.booleans(),
}


@given(st.data())
def test_set_changes_the_given_values_alone(data: st.DataObject) -> None:
    world = jostle.World.restore(WORLD)
    rows = data.draw(st.lists(st.integers(0, 28), unique=True, max_size=6))
    names = data.draw(st.lists(st.sampled_from(sorted(VALUES)), unique=True, max_size=4))
    expected = {name: column.copy() for name, column in columns(world).items()}
    changes = {}
    for name in names:
        values = [data.draw(VALUES[name]) for _ in rows]
        shape = (len(rows), 2) if expected[name].ndim == 2 else len(rows)
        changes[name] = np.array(values, DTYPES.get(name, np.float32)).reshape(shape)
        if changes[name].dtype == np.float32:
            changes[name] += 0  # -0.0 counts as 0.0, which changes nothing of a particle at rest
        expected[name][rows] = changes[name]
    points = expected["radii"] == 0
    expected["angular_velocities"][points] = 0
    world.set(world.ids[rows], **changes)
    for name, column in columns(world).items():
        np.testing.assert_array_equal(column, expected[name], err_msg=name)
    # The same changes of whole columns give a world that moves on in the same way. Columns of
    # positions and angles are rounded to float32, so that others would change too. A change of an
    # immovable particle wakes all, so `movable` is set last.
    other = jostle.World.restore(WORLD)
    for name in sorted(names, key=lambda name: name == "movable"):
        if name in ("positions", "angles"):
            other.set(other.ids[rows], **{name: changes[name]})
        else:
            setattr(other, name, expected[name])
    assert other.state_hash() == world.state_hash()
    for each in (world, other):
        each.step(STEP, steps=2)
    assert other.state_hash() == world.state_hash()
    np.testing.assert_array_equal(other.asleep, world.asleep)
