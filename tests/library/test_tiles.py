"""`jostle.tiles` covers exactly the tiles of a map."""

import re

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
    ("arguments", "error", "words"),
    [
        (([1, 0],), ValueError, "grid has shape (2,)"),
        (([[0.5]],), TypeError, "grid must hold booleans or integers, not float64"),
        (([[1], [1, 0]],), ValueError, "grid is no array"),
        (([[1]], 0), ValueError, "size is (0.0, 0.0); both must be above 0"),
        (([[1]], (1, 2, 3)), ValueError, "size has shape (3,)"),
        (([[1]], [1, [2]]), ValueError, "size is no array"),
        (([[1]], "a"), TypeError, "size must hold real numbers"),
        (([[1]], float("nan")), ValueError, "size is nan; it must be finite"),
        (([[1]], 1, (0, float("inf"))), ValueError, "origin is (0, inf)"),
        (([[1]], 1, None), TypeError, "origin must hold real numbers"),
    ],
)
def test_bad_arguments(arguments, error, words) -> None:
    with pytest.raises(error, match="^" + re.escape(words)):
        jostle.tiles(*arguments)


TMX = """<?xml version="1.0" encoding="UTF-8"?>
<map version="1.10" orientation="orthogonal" renderorder="right-down" width="4" height="3"
 tilewidth="16" tileheight="16" infinite="0" nextlayerid="2" nextobjectid="1">
 <tileset firstgid="1" name="tiles" tilewidth="16" tileheight="16" tilecount="2" columns="2">
  <image source="none.png" width="32" height="16"/>
 </tileset>
 <layer id="1" name="walls" width="4" height="3"><data encoding="csv">
0,0,0,2,
1,0,0,2,
1,1,1,1
</data></layer>
</map>
"""


def test_a_map_of_tiled(tmp_path) -> None:
    """The line of the documents, with pytmx."""
    pytmx = pytest.importorskip("pytmx")
    path = tmp_path / "map.tmx"
    path.write_text(TMX, encoding="utf-8")
    tiled = pytmx.TiledMap(str(path), load_all_tiles=True)
    boxes = jostle.tiles(tiled.get_layer_by_name("walls").data, (tiled.tilewidth, tiled.tileheight))
    assert boxes.tolist() == [[48, 0, 64, 48], [0, 16, 16, 48], [16, 32, 48, 48]]
