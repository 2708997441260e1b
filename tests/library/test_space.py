"""`jostle.Space`: shapes that are added, moved, changed and removed; events and ids."""

import itertools
import re
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from numpy.typing import NDArray
from oracle import ALL_BITS, DTYPES, Shapes, may_pair, overlaps, uniform
from signals import lets_others_run

import jostle

Pair = tuple[int, int]

coordinates = st.integers(-6, 6).map(float) | st.floats(-10, 10, width=32) | st.just(1e30)
sizes = st.sampled_from([0.0, 0.5, 1.0, 2.0, 50.0]) | st.floats(2**-59, 3, width=32)
bits = st.sampled_from([ALL_BITS, 1, 2, 3, 0])
maybe_a_size = st.none() | sizes
maybe_bits = st.tuples(st.none() | bits, st.none() | bits)
points = st.tuples(coordinates, coordinates)
new_shapes = st.tuples(points, sizes, st.tuples(sizes, sizes) | st.just((0.0, 0.0)), bits, bits)
masks = st.none() | st.sampled_from([1, 2, ALL_BITS])


class LivingSpace(RuleBasedStateMachine):
    """A space, a plain dict of its shapes, and the set of pairs of the last update."""

    @initialize(
        dtype=st.sampled_from(DTYPES), capacity=st.integers(1, 8), threads=st.integers(1, 2)
    )
    def begin(self, dtype: Any, capacity: int, threads: int) -> None:
        self.dtype = np.dtype(dtype)
        self.space = jostle.Space(dtype=self.dtype, leaf_capacity=capacity, threads=threads)
        self.shapes: dict[int, tuple[Any, ...]] = {}
        self.gone: list[int] = []
        self.before: set[Pair] = set()
        self.events: jostle.Events | None = None
        self.entered: set[Pair] = set()

    def columns(self) -> tuple[list[int], Shapes, NDArray[Any], NDArray[Any]]:
        """Return ids, shapes, categories and masks of the model."""
        ids = sorted(self.shapes)
        rows = [self.shapes[id] for id in ids]
        column = [np.array([row[k] for row in rows], self.dtype) for k in range(3)]
        filters = [np.array([row[k] for row in rows], np.uint32) for k in (3, 4)]
        pairs = (column[0].reshape(-1, 2), column[1], column[2].reshape(-1, 2))
        return ids, Shapes(*pairs), *filters

    def touching(self) -> set[Pair]:
        """Return all current pairs, by brute force."""
        ids, shapes, own, wanted = self.columns()
        hits = np.triu(overlaps(shapes, shapes) & may_pair(own, wanted, own, wanted), k=1)
        return {(ids[i], ids[j]) for i, j in np.argwhere(hits)}

    def some(self, data: st.DataObject) -> list[int]:
        """Draw ids of existing shapes, each once, in any order."""
        if not self.shapes:
            return []
        return data.draw(st.lists(st.sampled_from(sorted(self.shapes)), unique=True, max_size=12))

    @rule(new=st.lists(new_shapes, max_size=12), plain=st.booleans())
    def add(self, new: list[Any], plain: bool) -> None:
        if plain:  # circles without filters have fewer columns
            new = [(center, radius, (0.0, 0.0), 1, ALL_BITS) for center, radius, *_ in new]
            ids = self.space.add([row[0] for row in new], [row[1] for row in new])
        else:
            centers, radii, halves, own, wanted = ([row[k] for row in new] for k in range(5))
            halves = np.array(halves).reshape(-1, 2)
            ids = self.space.add(centers, radii, halves, categories=own, masks=wanted)
        assert ids.dtype == np.int64 and ids.shape == (len(new),)
        for id, row in zip(ids.tolist(), new, strict=True):
            assert id not in self.shapes and id not in self.gone
            self.shapes[id] = row

    @rule(new=new_shapes)
    def add_one(self, new: Any) -> None:
        id = self.space.add(*new[:3], categories=new[3], masks=new[4])
        assert isinstance(id, int) and id not in self.shapes and id not in self.gone
        self.shapes[id] = new

    @rule(data=st.data())
    def move(self, data: st.DataObject) -> None:
        ids = self.some(data)
        to = data.draw(st.lists(points, min_size=len(ids), max_size=len(ids)))
        self.space.set(ids, positions=to)
        for id, center in zip(ids, to, strict=True):
            self.shapes[id] = (center, *self.shapes[id][1:])

    @precondition(lambda self: self.shapes)
    @rule(data=st.data(), to=points)
    def move_one(self, data: st.DataObject, to: Any) -> None:
        id = data.draw(st.sampled_from(sorted(self.shapes)))
        self.space.set(id, positions=to)
        self.shapes[id] = (to, *self.shapes[id][1:])

    @rule(data=st.data(), size=st.tuples(maybe_a_size, maybe_a_size), filters=maybe_bits)
    def change(self, data: st.DataObject, size: Any, filters: Any) -> None:
        ids, (radius, half), (own, wanted) = self.some(data), size, filters
        self.space.set(ids, radii=radius, half_sizes=half, categories=own, masks=wanted)
        for id in ids:
            given = (None, radius, half if half is None else (half, half), own, wanted)
            rows = zip(given, self.shapes[id], strict=True)
            self.shapes[id] = tuple(old if new is None else new for new, old in rows)

    @rule(data=st.data(), everything=st.sampled_from([False] * 7 + [True]))
    def remove(self, data: st.DataObject, everything: bool) -> None:
        ids = self.space.ids if everything else self.some(data)
        self.space.remove(ids)
        for id in map(int, ids):
            del self.shapes[id]
            self.gone.append(id)

    @rule()
    def update(self) -> None:
        now = self.touching()
        old, self.events = self.events, self.space.update()
        self.entered = now - self.before
        assert self.events.entered.tolist() == [list(pair) for pair in sorted(self.entered)]
        assert self.events.exited.tolist() == [list(pair) for pair in sorted(self.before - now)]
        self.before = now
        if old is not None and not hasattr(self, "was_asked"):
            with pytest.raises(RuntimeError, match="read it before the next update"):
                _ = old.stayed
        self.__dict__.pop("was_asked", None)

    @precondition(lambda self: self.events is not None)
    @rule()
    def stayed(self) -> None:
        """It compares the states at the updates, whatever has changed since."""
        expected = sorted(self.before - self.entered)
        assert self.events.stayed.tolist() == [list(pair) for pair in expected]
        self.was_asked = True

    @rule()
    def pairs(self) -> None:
        expected = sorted(self.touching())
        assert self.space.pairs(sort=True).tolist() == [list(pair) for pair in expected]
        assert sorted(map(tuple, self.space.pairs().tolist())) == expected
        if expected:
            with pytest.raises(ValueError, match="more than max_pairs"):
                self.space.pairs(max_pairs=len(expected) - 1)
        assert len(self.space.pairs(max_pairs=len(expected))) == len(expected)

    @rule(mask=st.sampled_from([0, 1, 2, 5]))
    def pairs_of_some(self, mask: int) -> None:
        ours = {id for id, row in self.shapes.items() if row[3] & mask}
        expected = sorted(pair for pair in self.touching() if ours.issuperset(pair))
        found = self.space.pairs(sort=True, mask=mask, max_pairs=len(expected))
        assert found.tolist() == [list(pair) for pair in expected]

    @rule(at=points, size=st.floats(0.125, 8), mask=masks)
    def query(self, at: Any, size: float, mask: int | None) -> None:
        """A tree of the same shapes has the same answers."""
        ids, shapes, own, wanted = self.columns()
        tree = jostle.Quadtree(*shapes, categories=own, masks=wanted)
        named = np.array([*ids, -1])
        rect = (at[0] - size, at[1] - size, at[0] + size, at[1] + 2 * size)
        triangle = [(0, 0), (size, 0), (0, size)]
        for name, question in {
            "query_rect": (rect,),
            "query_circle": (at, size),
            "query_point": (at,),
            "query_polygon": (triangle,),
        }.items():
            found = getattr(self.space, name)(*question, mask=mask)
            expected = named[getattr(tree, name)(*question, mask=mask)]
            np.testing.assert_array_equal(found, expected, name)
        found = self.space.query_circle([at, (0, 0)], size, mask=mask)
        expected = tree.query_circle([at, (0, 0)], size, mask=mask)
        np.testing.assert_array_equal(found.offsets, expected.offsets)
        np.testing.assert_array_equal(found.ids, named[expected.ids])
        for k in (1, 5):
            near, expected = (index.nearest(at, k, mask=mask) for index in (self.space, tree))
            np.testing.assert_array_equal(near.distances, expected.distances)
            np.testing.assert_array_equal(near.ids, named[expected.ids])
            assert near.distances.dtype == self.dtype
        for radius in (0, size):
            hit, expected = (
                index.shape_cast(at, (1, -size), radii=radius, mask=mask)
                for index in (self.space, tree)
            )
            assert (hit.id, hit.distance) == (named[expected.id], expected.distance)

    @rule(data=st.data(), last=st.sampled_from([-1, 1 << 40, (1 << 63) - 1, 1 << 32]))
    def name_what_is_not_there(self, data: st.DataObject, last: int) -> None:
        wrong = data.draw(st.sampled_from([*self.gone, last]))
        if wrong in self.shapes:
            return
        assert wrong not in self.space
        ids = [*self.space.ids, wrong]
        message = re.escape(f"ids[{len(ids) - 1}] is {wrong}; ")
        for call in (
            lambda: self.space.set(ids, positions=np.zeros((len(ids), 2))),
            lambda: self.space.set(ids, radii=7.0),
            lambda: self.space.set(ids, categories=0),
            lambda: self.space.remove(ids),
            lambda: self.space.get(ids).positions,
        ):
            with pytest.raises(ValueError, match=message):
                call()

    @precondition(lambda self: self.shapes)
    @rule(data=st.data())
    def give_what_cannot_be(self, data: st.DataObject) -> None:
        ids = self.space.ids
        row = data.draw(st.integers(0, len(ids) - 1))
        centers, radii, halves = np.zeros((len(ids), 2)), np.ones(len(ids)), np.ones((len(ids), 2))
        centers[row, 1], radii[row], halves[row, 0] = np.nan, -1, np.inf
        for name, call in {
            "positions": lambda: self.space.set(ids, positions=centers),
            "radii": lambda: self.space.set(ids, radii=radii),
            "half_sizes": lambda: self.space.set(ids, radii=1.0, half_sizes=halves),
        }.items():
            with pytest.raises(ValueError, match=rf"^{name}\[{row}\] is "):
                call()
        with pytest.raises(ValueError, match=rf"^radii\[{row}\] is -1"):
            self.space.add(np.zeros((len(ids), 2)), radii)
        with pytest.raises(ValueError, match=rf"^ids\[{len(ids)}\] is {ids[row]}; it is given"):
            self.space.remove([*ids, ids[row]])

    @invariant()
    def the_space_is_the_model(self) -> None:
        if not hasattr(self, "space"):
            return
        ids, shapes, own, wanted = self.columns()
        assert len(self.space) == len(ids)
        np.testing.assert_array_equal(self.space.get(ids).positions, shapes.centers)
        assert self.space.ids.tolist() == list(self.shapes)  # in the order of adding
        rows = self.space.rows(ids)
        for column, expected in (
            (self.space.positions, shapes.centers),
            (self.space.radii, shapes.radii),
            (self.space.half_sizes, shapes.half_sizes),
            (self.space.categories, own),
            (self.space.masks, wanted),
        ):
            np.testing.assert_array_equal(column[rows], expected)


TestLivingSpace = LivingSpace.TestCase


def test_one_shape_at_a_time() -> None:
    space = jostle.Space()
    first, second = space.add((0, 0), 1.0), space.add(np.array([5.0, 0]), 1.0, (1, 2))
    assert (first, second) == (0, 1)
    space.set(first, positions=(4, 0))
    space.set(second, radii=0.5)
    space.set(first, categories=3, masks=5)
    np.testing.assert_array_equal(space.get(first).positions, [4, 0])
    one, other = space.get(first), space.get(second)
    assert (other.radii, one.categories, one.masks) == (0.5, 3, 5)
    np.testing.assert_array_equal(space.get(second).half_sizes, [1, 2])
    assert isinstance(space.get(second).radii, float) and isinstance(space.get(0).masks, int)
    assert space.update().entered.tolist() == [[0, 1]]
    space.remove(np.int64(0))
    assert space.ids.tolist() == [1]


def test_membership_and_length() -> None:
    space = jostle.Space()
    ids = space.add([(0, 0), (1, 1)])
    assert ids[0] in space and 1 in space and np.uint8(1) in space
    for other in (2, -1, 1 << 70, "0", None, 0.5, True):
        assert other not in space
    with pytest.raises(TypeError, match="must be one id"):
        assert ids in space
    assert len(space) == 2
    assert repr(space) == "<jostle.Space of 2 shapes, float64>"


@pytest.mark.parametrize("dtype", DTYPES)
def test_the_dtype_decides_the_arithmetic(dtype: Any) -> None:
    """1 + 1e-9 is 1 in float32, so there the two only touch."""
    space = jostle.Space(dtype=dtype)
    assert space.dtype == np.dtype(dtype).name
    space.add(np.array([(0, 0), (2, 0)]), np.array([1, 1 + 1e-9]))
    assert len(space.pairs()) == (dtype == np.float64)
    assert space.positions.dtype == space.radii.dtype == dtype
    assert jostle.Space().dtype == "float64"


@pytest.mark.parametrize(
    ("error", "wrong"),
    [
        *((ValueError, one) for one in ("float16", np.int64, "i4")),
        *((TypeError, one) for one in ("seven", None, 3.5)),
    ],
)
def test_other_dtypes_are_refused(error: Any, wrong: Any) -> None:
    with pytest.raises(error, match="must be 'float32' or 'float64'"):
        jostle.Space(dtype=wrong)


def test_of_shapes_as_near_the_smaller_id_comes_first() -> None:
    """In whichever trees they are."""
    space = jostle.Space()
    space.add([(0, 0)] * 500, 1.0)
    space.update()
    space.set([3, 250], positions=[(0.0, 1e-300)] * 2)  # fresh
    space.update()
    space.set(4, positions=(0, -1e-300))
    assert space.nearest((5, 0), k=6).ids.tolist() == [0, 1, 2, 3, 4, 5]
    assert space.raycast((5, 0), (-1, 0)).id == 0
    assert space.query_point((0, 0)).tolist() == list(range(500))


def test_events_are_kept() -> None:
    space = jostle.Space()
    space.add([(0, 0), (1, 0), (9, 0)], 1.0)
    events = space.update()
    entered, stayed, left = events.entered, events.stayed, events.exited
    assert entered.tolist() == [[0, 1]] and stayed.tolist() == [] and left.tolist() == []
    assert {part.dtype for part in (entered, stayed, left)} == {np.dtype(np.int64)}
    assert stayed.shape == left.shape == (0, 2)
    space.set(2, positions=(2, 0))
    events = space.update()
    assert repr(events) == "<jostle.Events: 1 entered, 0 exited>"
    assert events.entered is events.entered and events.stayed is events.stayed
    space.remove(0)
    space.update()
    assert events.stayed.tolist() == [[0, 1]]  # it was read in time


@pytest.mark.parametrize("updates", [False, True])
def test_endless_coming_and_going(updates: bool) -> None:
    """With large ids the answers are right."""
    space = jostle.Space()
    still = space.add(uniform(300), 0.5)
    for round in range(200):
        ids = space.add(uniform(100, seed=round), 0.5)
        if updates and round % 2:
            space.update()
        space.remove(ids)
    assert space.ids.tolist() == still.tolist()
    expected = jostle.find_pairs(uniform(300), 0.5, sort=True)
    np.testing.assert_array_equal(space.pairs(sort=True), expected)
    space.update()
    assert len(space.update().stayed) == len(expected)


def test_threads_change_nothing() -> None:
    def run(threads: int) -> list[Any]:
        space = jostle.Space(threads=threads)
        centers = uniform(30_000)
        ids = space.add(centers, 0.5)
        told = [space.update().entered]
        for step in (1, 7, 100):
            centers[::step] += 0.25
            space.set(ids[::step], positions=centers[::step])
            events = space.update()
            told += [events.entered, events.stayed, events.exited, space.pairs()]
        near, found = space.nearest(centers[:2_000], 3), space.query_circle(centers[:999], 2)
        return [*told, near.ids, near.distances, found.ids, found.offsets]

    for one, two in zip(run(1), run(2), strict=True):
        np.testing.assert_array_equal(one, two)


def test_an_empty_space_answers() -> None:
    space = jostle.Space()
    assert space.pairs().shape == (0, 2) and space.ids.shape == (0,)
    assert space.add([]).shape == (0,) and space.add(np.empty((0, 2))).shape == (0,)
    space.set([], positions=[])
    space.remove([])
    assert space.query_rect((0, 0, 1, 1)).shape == (0,)
    assert space.nearest((0, 0)).ids.tolist() == [-1]
    hit = space.raycast((0, 0), (1, 0))
    assert (hit.id, hit.distance) == (-1, np.inf) and np.isnan(hit.point).all()
    assert space.positions.shape == (0, 2) and space.get([]).radii.shape == (0,)


REFUSED: list[tuple[Any, str]] = [
    (lambda s: s.set(9, positions=(0, 0)), "ids is 9; no shape has this id"),
    (lambda s: s.remove(1 << 80), "ids is 1208925819614629174706176; no shape has this id"),
    (lambda s: s.remove(np.array([0, 1 << 63], "u8")), "ids[1] is 9223372036854775808; no"),
    (lambda s: s.set(2, positions=(0, 0)), "ids is 2; its shape has been removed"),
    (lambda s: s.set(0, positions=(0, np.nan)), "positions is (0, NaN); both coordinates must be"),
    (lambda s: s.set(0, positions=[(0, 0)]), "positions has shape (1, 2); it must be (2,), as"),
    (lambda s: s.set([0], positions=(0, 0)), "positions has shape (2,); it must be (1, 2)"),
    (lambda s: s.set([0, 1], positions=[(0, 0)]), "positions has shape (1, 2); it must be (2, 2)"),
    (lambda s: s.set(0, radii=-1), "radii is -1; a radius must be finite and at least 0"),
    (lambda s: s.set([0, 1], radii=[1, -1]), "radii[1] is -1; "),
    (lambda s: s.set([0, 1], radii=[1]), "radii has shape (1,); it must be "),
    (lambda s: s.set(0, categories=1 << 32), "categories is 4294967296; it must be a set of 32"),
    (lambda s: s.add((0, 0), -1.0), "radii is -1; "),
    (lambda s: s.add((0, 0, 0)), "positions has shape (3,); "),
    (lambda s: s.add((1e999, 0)), "positions is (inf, 0); "),
    (lambda s: s.remove([[0]]), "ids has shape (1, 1); it must be an integer or (k,)"),
    (lambda s: s.get([0, 5]).positions, "ids[1] is 5; no shape has this id"),
]


@pytest.mark.parametrize(("call", "message"), REFUSED)
def test_errors_name_argument_index_and_value(call: Any, message: str) -> None:
    space = jostle.Space()
    space.add([(0, 0), (5, 5), (9, 9)], 1.0)
    space.remove(2)
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        call(space)
    assert space.ids.tolist() == [0, 1]
    np.testing.assert_array_equal(space.positions, [(0, 0), (5, 5)])
    np.testing.assert_array_equal(space.radii, [1, 1])


@pytest.mark.parametrize("wrong", [1.5, "a", True, [True], [0.5], None])
def test_ids_are_integers(wrong: Any) -> None:
    space = jostle.Space()
    space.add([(0, 0), (1, 1)])
    with pytest.raises(TypeError, match=r"^ids must hold integers"):
        space.remove(wrong)


def test_too_many_pairs_leave_the_last_update_the_last() -> None:
    space = jostle.Space()
    space.add(np.zeros((50, 2)), 1.0)
    with pytest.raises(ValueError, match="more than max_pairs = 1224 pairs overlap"):
        space.update(max_pairs=1224)
    assert len(space.update(max_pairs=1225).entered) == 1225
    # Unchanged and removed shapes are not counted.
    space.set(0, positions=(0.5, 0))
    space.remove(range(40, 50))
    assert len(space.update(max_pairs=39).exited) == 1225 - 780


def test_several_threads_may_use_it_at_the_same_time() -> None:
    space = jostle.Space()

    def work(seed: int) -> None:
        for round in range(20):
            ids = space.add(uniform(500, seed=seed), 0.5)
            space.set(ids, positions=uniform(500, seed=seed + round))
            space.pairs()
            space.update()
            space.remove(ids)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(work, range(4)))  # which raises what a thread has raised
    assert len(space) == 0 and len(space.pairs()) == 0


def test_long_calls_let_other_threads_run() -> None:
    space = jostle.Space(threads=1)
    ids = space.add(uniform(1_500_000), 0.5)
    seeds = itertools.count()

    def move() -> None:
        space.set(ids, positions=uniform(1_500_000, seed=next(seeds)))
        space.update()

    assert lets_others_run(move)


def test_columns_are_read_and_assigned() -> None:
    """What is read can be assigned without an event; a refused column changes nothing."""
    space = jostle.Space()
    ids = space.add(uniform(50), np.linspace(0.1, 1, 50), masks=3)
    tile = space.add(boxes=(0, 0, 0.1, 0.1))
    space.remove(ids[::2])
    space.update()
    names = ("positions", "radii", "half_sizes", "boxes", "categories", "masks")
    before = {name: getattr(space, name) for name in names}
    for name in names:
        setattr(space, name, before[name])
        with pytest.raises(ValueError, match="read-only"):
            getattr(space, name)[0] = 1
        with pytest.raises((ValueError, TypeError), match=f"^{name}"):
            setattr(space, name, before[name][1:])
    events = space.update()
    assert len(events.entered) == len(events.exited) == 0
    for name in names:
        np.testing.assert_array_equal(getattr(space, name), before[name])
        np.testing.assert_array_equal(getattr(space.get(space.ids), name), before[name])
    assert space.ids.tolist() == [*ids[1::2].tolist(), tile]
    assert space.rows([[tile], [ids[1]]]).tolist() == [[25], [0]] and space.rows(tile) == 25
    space.radii = 2.0
    assert (space.radii == 2).all() and space.get(tile).boxes.tolist() == [0, 0, 0.1, 0.1]
    space.positions = np.add(space.positions, (1, 0))
    np.testing.assert_array_equal(space.positions, before["positions"] + (1, 0))
    with pytest.raises(ValueError, match=r"^ids\[1\] is 0; its shape has been removed"):
        space.rows([1, 0])
