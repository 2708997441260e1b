"""`jostle.pyqtree.Index` has the results of the package pyqtree."""

import copy
import math
import sys
from collections import Counter
from fractions import Fraction
from typing import Any

import numpy as np
import pyqtree
import pytest
from copies import by_pickle
from hypothesis import example, given
from hypothesis import strategies as st

from jostle.pyqtree import Index

AREA = (0, 0, 16, 16)

# Few values, so that edges coincide, and adjacent numbers, so that they almost do.
places = st.integers(-3, 20) | st.integers(0, 64).map(lambda k: k / 4)
next_to_them = st.builds(math.nextafter, places, st.sampled_from([-math.inf, math.inf]))
floats = [0.1, 0.3, 5e-324, 1e-30, 1e30, -1e30, 1e200, 1.7e308, math.inf, -math.inf, math.nan]
others = [2**53 + 1, 2**1023, Fraction(1, 3), np.float64(0.1), True]
hard = st.sampled_from([*floats, *others])
numbers = places | next_to_them | st.floats(-40, 40) | hard
boxes = st.tuples(numbers, numbers, numbers, numbers) | st.tuples(numbers, numbers)
# Equal objects, identical objects, and objects that are not hashable.
ITEMS: list[Any] = [1, 1.0, "duck", [1], [1], {}, None, (1000,), 10**30, 10**30 + 0]
steps = st.tuples(
    st.sampled_from(["insert"] * 5 + ["remove", "remove", "query", "query many"]),
    st.integers(0, len(ITEMS) - 1),
    boxes,
)


class Both:
    """An index of either kind, with the same calls."""

    def __init__(self, **settings: Any) -> None:
        self.theirs, self.ours = pyqtree.Index(AREA, **settings), Index(AREA, **settings)
        self.inserted: list[tuple[Any, Any]] = []

    def insert(self, item: Any, box: Any) -> None:
        self.theirs.insert(item, box)
        self.ours.insert(item, box)
        self.inserted.append((item, box))

    def remove(self, item: Any, box: Any) -> None:
        refused = []
        for index in (self.theirs, self.ours):
            try:
                index.remove(item, box)
            except ValueError:
                refused.append(index)
        # After a split, pyqtree does not refuse to remove an unknown box of NaN.
        nan = any(value != value for value in box)
        assert refused in ([], [self.theirs, self.ours]) or (nan and refused == [self.ours])

    def query(self, box: Any) -> None:
        expected = Counter(map(id, self.theirs.intersect(box)))
        found = self.ours.intersect(box)
        assert Counter(map(id, found)) == expected
        assert max(expected.values(), default=1) == 1


@given(st.lists(steps, max_size=40), boxes, st.integers(1, 5), st.integers(0, 6))
@example([("insert", 0, (0.1, 0, 0.3, 0))] * 9, (math.nextafter(0.3, 1), 0), 1, 6)
@example([("insert", 0, (0.1, 0, 0.3, 0))] * 9, (0.3, 0), 1, 6)
def test_the_same_calls_give_the_same_answers(
    script: list[Any], last: Any, max_items: int, max_depth: int
) -> None:
    both = Both(max_items=max_items, max_depth=max_depth)
    for act, which, box in script:
        if act == "insert":
            both.insert(ITEMS[which], box)
        elif act == "remove" and both.inserted:
            both.remove(*both.inserted[which % len(both.inserted)])
        elif act == "query":
            both.query(box)
        else:
            queries = [box, last, *(box for _, box in both.inserted)]
            assert both.ours.intersect_many(queries) == [both.ours.intersect(b) for b in queries]
    for _ in range(6):  # before and after the tree is built again
        both.query(last)
    for _, box in both.inserted:
        both.query(box)


@pytest.mark.parametrize("unit", [1.0, 0.1, 0.3])
def test_many_boxes_on_a_grid(unit: float) -> None:
    """Enough for several levels, every edge aligned with others."""
    rng = np.random.default_rng(0)
    corners = rng.integers(0, 40, (300, 2))
    table = np.hstack([corners, corners + rng.integers(0, 4, (300, 2))]) * unit
    both = Both(max_depth=5)  # pyqtree copies eleven equal lines into thousands of quads
    for number, box in enumerate(table.tolist()):
        both.insert(number, box)
    for box in table[::3].tolist():
        both.query(box)
    assert both.ours.intersect_many(table.tolist()) == [
        sorted(both.theirs.intersect(box)) for box in table.tolist()
    ]


@pytest.mark.parametrize("n", [3, 60])
def test_what_just_does_not_touch_is_left_out(n: int) -> None:
    """The centre of such a box is rounded, so the tree alone would find it."""
    index = Index(AREA)
    for number in range(n):
        index.insert(number, (-3.0, 0, -2.6, 0))
    beside = (math.nextafter(-2.6, 0), 0)
    for _ in range(6):
        assert index.intersect(beside) == []
        assert index.intersect((-2.6, 0)) == list(range(n))
    assert index.intersect_many([beside, (-2.6, 0)]) == [[], list(range(n))]


def test_numbers_that_no_float_holds() -> None:
    index = Index(AREA)
    index.insert("integer", (2**53 + 1, 0))
    index.insert("fraction", (Fraction(1, 3), 0))
    for _ in range(6):
        assert index.intersect((2**53, 0)) == index.intersect((1 / 3, 0)) == []
        assert index.intersect((2**53 + 1, 0, 2**53 + 2, 0)) == ["integer"]
        assert index.intersect((Fraction(1, 3), 0)) == ["fraction"]
    assert index.intersect_many([(2**53 + 2, 0, 0, 0), (1 / 3, 0)]) == [["integer", "fraction"], []]


def test_changes_and_questions_in_turn() -> None:
    rng = np.random.default_rng(0)
    both = Both(max_depth=5)
    corners = rng.uniform(-5, 20, (2_000, 2))
    table = np.hstack([corners, corners + rng.uniform(-1, 1, (2_000, 2))]).round(1).tolist()
    for number, box in enumerate(table):
        both.insert(number, box)
        both.query(table[number // 2])
        if number % 3 == 0:
            both.remove(number // 3, table[number // 3])
    assert len(both.ours) == 2_000 - 667


def test_answers_come_in_the_order_of_insertion_and_once() -> None:
    index = Index(AREA)
    duck = object()
    for item, box in ((duck, (5, 5, 6, 6)), ("b", (-math.inf, 0, 9, 9)), (duck, (0, 0, 1, 1))):
        index.insert(item, box)
    for _ in range(5):
        assert index.intersect((0, 0, 9, 9)) == [duck, "b"]
        assert index.intersect((0, 0, 1, 1)) == ["b", duck]
        assert index.intersect((0, 0, math.inf, 9)) == [duck, "b"]
        assert index.intersect_many([(0, 0, 9, 9), (0, 0, 1, 1)]) == [[duck, "b"], ["b", duck]]


def test_the_first_of_equal_ones_is_removed() -> None:
    both = Both()
    first, second = [1], [1]
    both.insert(first, (0, 0))
    both.insert(second, (0, 0, 0, 0))
    for index in (both.theirs, both.ours):
        index.remove([1.0], (0.0, 0.0))
        assert index.intersect((0, 0)) == [second]
        assert index.intersect((0, 0))[0] is second


def test_what_is_removed_is_let_go_and_length_counts_what_was_inserted() -> None:
    index = Index(AREA)
    item = object()
    before = sys.getrefcount(item)
    index.insert(item, (1, 1, 2, 2))
    [index.intersect(AREA) for _ in range(6)]
    index.remove(item, (1, 1, 2, 2))
    assert sys.getrefcount(item) == before
    index = Index(AREA, max_items=1)
    for _ in range(5):
        index.insert("duck", (1, 1, 9, 9))
    assert len(index) == 5


def test_iteration_shows_the_quads() -> None:
    index = Index(AREA)
    for k in range(100):
        index.insert("duck", [(1, 1), (15, 1), (1, 15)][k % 3])
    quads = list(index)
    assert len(quads) == 3
    assert all(quad.width > 0 and len(quad.center) == 2 for quad in quads)
    assert (index.center, index.width, index.height) == ((8, 8), 16, 16)


@pytest.mark.parametrize("make", [copy.deepcopy, by_pickle])
def test_copies_answer_the_same(make: Any) -> None:
    index = Index(AREA)
    for k in range(30):
        index.insert(k, (k, k))
        if k == 20:
            [index.intersect(AREA) for _ in range(6)]
            index.remove(3, (3, 3))
    copied = make(index)
    assert copied.intersect(AREA) == index.intersect(AREA)
    copied.remove(4, (4, 4))
    assert index.intersect((4, 4)) == [4]


@pytest.mark.parametrize("kind", [pyqtree.Index, Index])
def test_both_refuse_the_same(kind: Any) -> None:
    for settings in ({}, {"x": 1, "y": 2, "width": 3}):
        with pytest.raises(Exception, match="bbox"):
            kind(**settings)
    index = kind(x=5, y=5, width=10, height=10)
    index.insert("duck", (1, 1, 2, 2))
    for call, *arguments in (
        (kind, (0, 0, 1)),
        (index.remove, "duck", (1, 1, 2, 3)),
        (index.remove, "goose", (1, 1, 2, 2)),
        *((index.insert, "duck", wrong) for wrong in ((1, 2, 3), (1, 2, 3, 4, 5), ())),
        *((index.intersect, wrong) for wrong in ((1, 2, 3), (1, 2, 3, 4, 5), ())),
    ):
        with pytest.raises(ValueError):
            call(*arguments)
    for wrong in (None, 5, (1, None, 2, 3), (1, "a", 2, 3)):
        with pytest.raises(TypeError):
            index.intersect(wrong)
    assert index.intersect((0, 0, 9, 9)) == ["duck"]
