"""`jostle.tiles` covers exactly the tiles of a map."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import jostle


@given(arrays.arrays(bool, st.tuples(st.integers(0, 12), st.integers(0, 12))))
def test_boxes_cover_each_tile_once_and_nothing_else(grid) -> None:
    cover = np.zeros(grid.shape, int)
    for left, top, right, bottom in jostle.tiles(grid).astype(int):
        cover[top:bottom, left:right] += 1
    np.testing.assert_array_equal(cover, grid)


@given(arrays.arrays(bool, (9, 9)), st.sampled_from([0.1, 1 / 3, 16, (0.7, 1e-3)]))
def test_boxes_touch_exactly(grid, size) -> None:
    boxes = jostle.tiles(grid, size, origin=(0.1, -7.3))
    assert len(jostle.find_pairs(boxes=boxes)) == 0


def test_few_boxes() -> None:
    assert len(jostle.tiles(np.ones((300, 400), bool))) == 1
    room = np.pad(np.zeros((30, 40), bool), 1, constant_values=True)
    assert len(jostle.tiles(room)) == 4


def test_kinds_are_merged_apart() -> None:
    grid = np.array([[1, 1, 2], [1, 1, 2]])
    assert jostle.tiles(grid == 2, 10).tolist() == [[20, 0, 30, 20]]


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (([1, 0],), ValueError),
        (([[0.5]],), TypeError),
        (([[1]], 0), ValueError),
        (([[1]], (1, 2, 3)), ValueError),
        (([[1]], float("nan")), ValueError),
        (([[1]], 1, (0, float("inf"))), ValueError),
    ],
)
def test_bad_arguments(arguments, error) -> None:
    with pytest.raises(error):
        jostle.tiles(*arguments)
