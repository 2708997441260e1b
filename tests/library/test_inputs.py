"""Arguments: invalid, huge, masked and empty ones, bit sets; and the types of returned ids."""

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from results import fields
from signals import run_child

import jostle

POINTS = np.array([(0.0, 0.0), (1.5, 0.0), (9.0, 9.0)])
TREE = jostle.Quadtree(POINTS, 1.0)


def space() -> jostle.Space:
    """Return a space with the same shapes."""
    space = jostle.Space()
    space.add(POINTS, 1.0)
    return space


RECT = SimpleNamespace(left=0, top=0, right=1, bottom=1)


@pytest.mark.parametrize("query", [TREE.query_rect, space().query_rect])
def test_a_list_that_contains_itself_is_refused(query: Any) -> None:
    endless: list[Any] = [RECT]
    endless.append(endless)
    with pytest.raises((ValueError, TypeError), match=r"^rect "):
        query(endless)
    deep: list[Any] = [RECT]
    for _ in range(50_000):
        deep = [RECT, deep]
    with pytest.raises((ValueError, TypeError), match=r"^rect "):
        query(deep)
    while deep[1:]:  # or freeing it recurses
        deep = deep.pop()


def test_objects_with_sides_are_rectangles() -> None:
    assert TREE.query_rect(RECT).tolist() == [0, 1]
    assert TREE.query_rect([RECT, (8, 8, 9, 9)])[1].tolist() == [2]
    assert TREE.query_rect(jostle.Box(8, 8, 10, 10)).tolist() == [2]
    assert [len(ids) for ids in TREE.query_rect([jostle.Box(8, 8, 10, 10), RECT])] == [1, 2]


MANY = 5_000_000_000
NUMBERS = np.broadcast_to(1.0, (MANY,))
PLACES = np.broadcast_to(1.0, (MANY, 2))
INTEGERS = np.broadcast_to(1, (MANY,))
TOO_MANY = {
    "radius": [
        lambda: TREE.query_circle((0, 0), NUMBERS),
        lambda: space().query_circle((0, 0), NUMBERS),
    ],
    "direction": [lambda: TREE.raycast((0, 0), PLACES)],
    "center": [lambda: TREE.query_circle(PLACES, 1.0)],
    "point": [lambda: TREE.nearest(PLACES), lambda: TREE.query_point(PLACES)],
    "rect": [lambda: TREE.query_rect(np.broadcast_to(1.0, (MANY, 4)))],
    "vertices": [
        lambda: TREE.query_polygon(np.zeros((MANY, 0, 2))),
        lambda: TREE.query_polygon(np.broadcast_to(1.0, (MANY, 3, 2))),
    ],
    "positions": [
        lambda: jostle.find_pairs(PLACES),
        lambda: jostle.Quadtree(PLACES),
        lambda: space().add(PLACES),
        lambda: jostle.World(PLACES, 1.0, velocities=PLACES),
    ],
    "radii": [
        lambda: jostle.find_pairs(POINTS, NUMBERS),
        lambda: TREE.shape_cast((0, 0), (1, 0), radii=NUMBERS),
    ],
    "masks": [lambda: jostle.Quadtree(POINTS, masks=INTEGERS)],
    "ids": [lambda: space().remove(INTEGERS)],
}


@pytest.mark.parametrize("name", TOO_MANY)
def test_too_many_rows_are_refused_before_anything_is_copied(name: str) -> None:
    message = f"{name} has {MANY} rows; it may have at most 2147483647"
    for call in TOO_MANY[name]:
        with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
            call()


def test_polygons_without_corners_need_no_memory() -> None:
    with pytest.raises(
        ValueError, match=r"^vertices\[0\] is a list of 0; a polygon has at least 3"
    ):
        TREE.query_polygon(np.zeros((2_000_000_000, 0, 2)))
    assert TREE.query_polygon(np.zeros((0, 3, 2))).ids.tolist() == []


def test_an_answer_that_does_not_fit_into_memory_is_a_memory_error() -> None:
    program = """
import resource
import numpy as np
import jostle
from results import fields

tree = jostle.Quadtree(np.zeros((3, 2)), 1.0)
many = np.broadcast_to(1.0, (2_000_000_000,))
places = np.broadcast_to(np.float32(1), (2_000_000_000, 2))
bits = np.broadcast_to(1, (2_000_000_000,))
resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))
for name, size, call in [
    ("radius", 16, lambda: tree.query_circle((0, 0), many)),
    ("radii", 16, lambda: tree.shape_cast((0, 0), (1, 0), radii=many)),
    ("direction", 16, lambda: tree.raycast((0, 0), places)),
    ("positions", 16, lambda: jostle.find_pairs(places)),
    ("positions", 32, lambda: jostle.Quadtree(np.broadcast_to(1.0, places.shape))),
    ("ids", 16, lambda: jostle.Space().remove(bits)),
]:
    try:
        call()
    except MemoryError as error:
        assert str(error) == f"{name}: there is no memory for {size}000000000 bytes", error
    else:
        raise AssertionError(name)
print("done")
"""
    assert run_child(program) == "done\n"


class Liar(np.ndarray[Any, Any]):
    """An array whose conversions return another length and another type."""

    def astype(self, *_: Any, **__: Any) -> Any:
        return np.arange(900)

    def __array__(self, *_: Any, **__: Any) -> Any:
        return np.zeros((7, 7), complex)

    def __getattribute__(self, name: str) -> Any:
        return (100,) if name == "shape" else super().__getattribute__(name)


@pytest.mark.parametrize("dtype", ["f4", "f8", ">f8", "i2", "f2"])
def test_an_array_with_inconsistent_conversions_is_read_as_it_is(dtype: str) -> None:
    centers, radii = POINTS.astype(dtype).view(Liar), np.ones(3, dtype).view(Liar)
    assert jostle.find_pairs(centers, radii).tolist() == [[0, 1]]
    assert TREE.query_circle(centers, radii)[2].tolist() == [2]
    assert TREE.nearest(centers[::2]).ids.tolist() == [[0], [2]]
    ids = np.array([2, 0]).astype(">i4").view(Liar)
    collection = space()
    collection.remove(ids)
    assert collection.ids.tolist() == [1]
    world = jostle.World(centers, radii, velocities=centers)
    np.testing.assert_array_equal(world.positions, POINTS.astype(dtype).astype(np.float32))


def test_an_object_that_converts_differently_each_time_is_read_once() -> None:
    class Fickle:
        calls = 0

        def __array__(self, *_: Any, **__: Any) -> Any:
            self.calls += 1
            return np.zeros((3 * self.calls, 2))

    centers = Fickle()
    assert len(jostle.find_pairs(centers, 1.0)) == 3
    assert centers.calls == 1


def test_masked_elements_are_refused() -> None:
    centers = np.ma.masked_greater(POINTS, 8)
    radii = np.ma.masked_equal([1.0, 2.0, 1.0], 2.0)
    pieces = [np.ma.array(row) for row in POINTS] + [np.ma.masked_less([1.0, 0.0], 1)]
    calls = {
        "positions[2]": [
            lambda: jostle.find_pairs(centers),
            lambda: space().add(centers),
            lambda: jostle.World(centers, 1.0),
        ],
        "radii[1]": [
            lambda: jostle.Quadtree(POINTS, radii),
            lambda: jostle.World(POINTS, radii),
        ],
        "positions[3]": [lambda: jostle.find_pairs(pieces)],
        "radii": [lambda: jostle.find_pairs(POINTS, np.ma.masked)],
        "point[2]": [lambda: TREE.nearest(centers)],
        "ids[0]": [lambda: space().remove(np.ma.array([1, 2], mask=[True, False]))],
    }
    for name, several in calls.items():
        for call in several:
            with pytest.raises(
                ValueError, match=f"^{re.escape(name)} is masked, and masks are not"
            ):
                call()


def test_a_masked_array_without_masked_elements_is_an_array() -> None:
    assert jostle.find_pairs(np.ma.array(POINTS), np.ma.ones(3)).tolist() == [[0, 1]]
    assert jostle.find_pairs([np.ma.array(row) for row in POINTS], 1.0).tolist() == [[0, 1]]
    assert jostle.find_pairs(np.ma.masked_equal(POINTS, 77), 1.0).tolist() == [[0, 1]]


@pytest.mark.parametrize("dtype", [float, np.int8, object, "U3", bool, complex])
def test_an_array_without_elements_may_have_any_dtype(dtype: Any) -> None:
    nothing = np.array([], dtype)
    collection = space()
    collection.remove(nothing)
    collection.set(nothing, positions=nothing)
    collection.set(nothing, categories=nothing)
    assert len(collection) == 3
    assert collection.get(nothing).positions.shape == (0, 2)
    assert jostle.find_pairs(nothing, nothing).shape == (0, 2)
    assert len(jostle.Quadtree(nothing, masks=nothing)) == 0
    world = jostle.World(POINTS, 1.0)
    world.remove(nothing)
    world.set(nothing, radii=nothing, movable=nothing)
    assert len(world.positions) == 3
    with pytest.raises(ValueError, match=r"^ids has shape \(0, 2\)"):
        world.remove(np.zeros((0, 2), dtype))


SHIP = 2


@pytest.mark.parametrize(
    "inverted",
    [~SHIP, [~SHIP] * 3, np.int8(~SHIP), np.full(3, ~SHIP, np.int16), ~np.uint32(SHIP), -SHIP - 1],
)
def test_all_bits_but_some(inverted: Any) -> None:
    none = jostle.Space().add(POINTS[:0], masks=inverted if np.ndim(inverted) == 0 else [])
    assert none.size == 0
    collection = jostle.Space()
    collection.add(POINTS, 1.0, masks=inverted)
    assert collection.masks.tolist() == [0xFFFFFFFD] * 3
    tree = jostle.Quadtree(POINTS, 1.0, categories=[SHIP, 1, 1 << 31], masks=inverted)
    assert tree.pairs().tolist() == []
    if np.ndim(inverted) == 0:
        assert tree.query_rect((-9, -9, 9, 9), mask=inverted).tolist() == [1, 2]
        assert tree.nearest((0, 0), mask=inverted).ids.tolist() == [1]


def test_the_highest_bit_can_be_left_out_and_all_can() -> None:
    collection = jostle.Space()
    collection.add(POINTS, masks=[~(1 << 31), ~0xFFFFFFFF, ~0])
    assert collection.masks.tolist() == [0x7FFFFFFF, 0, 0xFFFFFFFF]


@pytest.mark.parametrize("name", ["categories", "masks"])
@pytest.mark.parametrize("bits", [2**32, -(2**32) - 1, 2**64, -(2**63)])
def test_more_than_32_bits_are_refused(bits: int, name: str) -> None:
    rule = "it must be a set of 32 bits: between 0 and 4294967295, or a negative integer from"
    with pytest.raises(ValueError, match=f"^{name} is {bits}; {rule}"):
        jostle.Quadtree(POINTS, **{name: bits})
    with pytest.raises(ValueError, match=f"^mask is {bits}; {rule}"):
        TREE.query_point((0, 0), mask=bits)
    if abs(bits) < 2**63:
        with pytest.raises(ValueError, match=rf"^{name}\[1\] is {bits}; {rule}"):
            jostle.Quadtree(POINTS, **{name: [1, bits, 1]})


def test_every_id_is_an_int64() -> None:
    world = jostle.World(POINTS, 1.0, on_touch="merge")
    added = world.add([(50, 50)], 1.0)
    world.step(1.0)
    other = jostle.World(POINTS, 1.0)
    other.step(1e-3)
    collection = space()
    events = collection.update()
    boxes = TREE.nodes()
    answers = {
        "find_pairs": jostle.find_pairs(POINTS, 1.0),
        "find_pairs of one type": jostle.find_pairs(POINTS.astype("f4"), 1.0, method="quadtree"),
        "pairs": TREE.pairs(),
        "pairs with another": TREE.pairs(TREE),
        "contacts": TREE.contacts().pairs,
        "query_rect": TREE.query_rect((0, 0, 1, 1)),
        "hits": TREE.query_rect([(0, 0, 1, 1)]).ids,
        "offsets": TREE.query_rect([(0, 0, 1, 1)]).offsets,
        "nearest": TREE.nearest((0, 0)).ids,
        "rays": TREE.raycast([(0, 0)], (1, 0)).ids,
        "levels": boxes.levels,
        "counts": boxes.counts,
        "space": collection.ids,
        "space's pairs": collection.pairs(),
        "entered": events.entered,
        "World.add": added,
        "World.ids": world.ids,
        "World.rows": world.rows([0]),
        "World.renumbered": world.renumbered,
        "WorldContacts.pairs": other.last_step.contacts.pairs,
        "Springs.pairs": jostle.Springs([(0, 1)], lengths=1.0, stiffness=1.0).pairs,
    }
    assert {name: ids.dtype.name for name, ids in answers.items()} == dict.fromkeys(
        answers, "int64"
    )
    assert all(ids.size for ids in answers.values())
    pairs = answers["find_pairs"]
    assert (pairs[:, 0] - pairs[:, 1]).tolist() == [-1]


def test_too_many_neighbours_are_refused_with_both_numbers() -> None:
    message = "k is 70000; for 2000 points that is 140000000 neighbours, more than 134217728"
    with pytest.raises(ValueError, match=f"^{message}; ask for fewer at a time$"):
        TREE.nearest(np.zeros((2000, 2)), k=70_000)
    with pytest.raises(ValueError, match=r"^k is 4294967296; for 1 point that is 4294967296 "):
        TREE.nearest((0, 0), k=2**32)


def test_coincident_shapes_are_in_one_box() -> None:
    tree = jostle.Quadtree(np.full((1000, 2), 5.0))
    boxes, depths, counts, is_leaf = fields(tree.nodes())
    assert len(boxes) == 1
    assert (depths.tolist(), counts.tolist(), is_leaf.tolist()) == ([0], [1000], [True])
    assert tree.stats == jostle.Stats(1, 1, 0, 0)
    apart = jostle.Quadtree(np.vstack([np.full((1000, 2), 5.0), np.zeros((3, 2))]), leaf_capacity=2)
    boxes, depths, counts, is_leaf = fields(apart.nodes())
    assert sorted(counts.tolist()) == [3, 1000, 1003]
    assert len(np.unique(boxes, axis=0)) == 3
    assert depths.tolist() == [0, 1, 1]
    assert apart.stats == jostle.Stats(3, 2, 1, 0)
