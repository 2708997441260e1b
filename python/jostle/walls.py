"""Walls of a `World`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["polyline"]


def polyline(points: ArrayLike, closed: bool = False) -> NDArray[np.float32]:
    """Return the walls between consecutive points.

    Points that equal the one before are left out.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        In units of length; rounded to float32.
    closed : bool, default False
        Whether there is a wall from the last point to the first.

    Returns
    -------
    ndarray of float32, shape (m, 2, 2)
        The ends of each wall, for `World`; `numpy.concatenate` joins several polylines.

    Raises
    ------
    ValueError
        If the shape is wrong or a coordinate is not finite.

    See Also
    --------
    jostle.World.walls : The walls of a world.

    Examples
    --------
    >>> jostle.polyline([(0, 0), (4, 0), (4, 3)]).tolist()
    [[[0.0, 0.0], [4.0, 0.0]], [[4.0, 0.0], [4.0, 3.0]]]
    >>> jostle.polyline([(0, 0), (4, 0), (4, 3)], closed=True).shape
    (3, 2, 2)
    """
    with np.errstate(over="ignore"):  # refused below
        rows = np.asarray(points, np.float32)
    if rows.size == 0:
        return np.empty((0, 2, 2), np.float32)
    if rows.ndim != 2 or rows.shape[1] != 2:
        raise ValueError(f"points has shape {rows.shape}; it must be (n, 2)")
    if not (finite := np.isfinite(rows).all(axis=1)).all():
        index = int(np.argmin(finite))
        x, y = rows[index]
        raise ValueError(f"points[{index}] is ({x}, {y}); both coordinates must be finite")
    if closed:
        rows = np.concatenate([rows, rows[:1]])
    walls = np.stack([rows[:-1], rows[1:]], axis=1)
    kept: NDArray[np.float32] = walls[(walls[:, 0] != walls[:, 1]).any(axis=1)]
    return kept
