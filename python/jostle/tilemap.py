"""Boxes of a tile map."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["tiles"]


def tiles(
    grid: ArrayLike, size: float | Sequence[float] = 1.0, origin: Sequence[float] = (0.0, 0.0)
) -> NDArray[np.float64]:
    """Merge the tiles of a map into few boxes.

    Rectangles of tiles are merged greedily: row by row, each tile that is left is extended
    to the right, then downwards. The boxes cover exactly the tiles, and none overlap. Where they
    share a side they have the same number, so ``boxes=`` of `Space` and `Quadtree` treats them as
    touching.

    Parameters
    ----------
    grid : array_like of bool or int, shape (rows, columns)
        The tiles that are not 0. To merge equal tiles only, call it with ``grid == kind``.
    size : float or (float, float), default 1.0
        Width and height of a tile, in units of length.
    origin : (float, float), default (0, 0)
        The corner of the tile in row 0 and column 0 with the smallest coordinates.

    Returns
    -------
    ndarray of float64, shape (m, 4)
        Corners of each box as min_x, min_y, max_x, max_y, by row, then by column of its first tile.

    Raises
    ------
    TypeError
        If `grid` holds neither booleans nor integers, or another argument does not hold numbers.
    ValueError
        If `grid` is not two-dimensional, or a number is not finite or a size not above 0.

    See Also
    --------
    jostle.Space.move_and_slide : Moves characters among the boxes.

    Examples
    --------
    >>> jostle.tiles([[1, 1, 0], [1, 1, 1]], size=16)
    array([[ 0.,  0., 32., 32.],
           [32., 16., 48., 32.]])
    """
    filled = _array("grid", grid)
    if filled.ndim != 2:
        raise ValueError(f"grid has shape {filled.shape}; it must be (rows, columns)")
    if filled.size and filled.dtype.kind not in "biu":
        raise TypeError(f"grid must hold booleans or integers, not {filled.dtype}")
    width, height = _pair("size", size)
    left, top = _pair("origin", origin)
    if not (width > 0 and height > 0):
        raise ValueError(f"size is ({width}, {height}); both must be above 0")
    cells = np.array(_rectangles(filled != 0), np.int64).reshape(-1, 4)
    scale, shift = (width, height, width, height), (left, top, left, top)
    return np.asarray(cells * scale + shift, np.float64)


def _pair(name: str, value: float | Sequence[float]) -> tuple[float, float]:
    """Two finite numbers; one number stands for both."""
    pair = _array(name, value)
    if pair.size and pair.dtype.kind not in "fiu":
        raise TypeError(f"{name} must hold real numbers, not {pair.dtype}")
    if pair.shape not in ((), (2,)):
        raise ValueError(f"{name} has shape {pair.shape}; it must be a number or (2,)")
    if not np.isfinite(pair).all():
        raise ValueError(f"{name} is {value}; it must be finite")
    x, y = np.broadcast_to(pair, 2)
    return float(x), float(y)


def _array(name: str, value: ArrayLike) -> NDArray[Any]:
    """An array of the value of an argument."""
    try:
        return np.asarray(value)
    except ValueError as error:  # rows of different lengths
        raise ValueError(f"{name} is no array: {error}") from None


def _rectangles(left: NDArray[np.bool_]) -> list[tuple[int, int, int, int]]:
    """First column, first row, last column + 1, last row + 1 of each rectangle.

    The runs of each row are extended downwards as long as the row below has the same tiles left.
    """
    rows = left.shape[0]
    left = left.copy()
    found = []
    for row in range(rows):
        edges = np.flatnonzero(np.diff(left[row], prepend=False, append=False))
        for start, end in edges.reshape(-1, 2):
            below = row + 1
            while below < rows and left[below, start:end].all():
                left[below, start:end] = False
                below += 1
            found.append((int(start), row, int(end), below))
    return found
