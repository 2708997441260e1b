"""Sides of a container, and line segments for walls."""

from __future__ import annotations

import enum

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Side", "polyline"]


class Side(enum.IntEnum):
    """The sides of a container, in columns of walls: of contacts, hits and forces.

    The walls of a world have numbers from 0, and -1 is none.

    See Also
    --------
    WallContacts : The walls and sides that particles touched.
    jostle.Box, jostle.Circle : The containers.

    Examples
    --------
    >>> box = jostle.Box(0, 0, 9, 9)
    >>> world = jostle.World([(5, 2)], 1.0, velocities=[(0, -4)], container=box)
    >>> world.step(0.5)
    >>> world.last_step.wall_contacts.walls == jostle.Side.MIN_Y
    array([ True])
    """

    MIN_X = -2
    """The side of a `Box` at min_x."""
    MAX_X = -3
    """The side of a `Box` at max_x."""
    MIN_Y = -4
    """The side of a `Box` at min_y."""
    MAX_Y = -5
    """The side of a `Box` at max_y."""
    RIM = -6
    """The wall of a `Circle`."""


def polyline(points: ArrayLike, *, closed: bool = False) -> NDArray[np.floating]:
    """Return the line segments between consecutive points.

    Points that equal the one before are left out, so no segment has length 0.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        In units of length.
    closed : bool, default False
        Whether there is a segment from the last point to the first.

    Returns
    -------
    ndarray of float32 if `points` has this type, otherwise of float64, shape (m, 2, 2)
        Start and end of each segment: walls of a `World`, which rounds them to float32 and refuses
        those whose ends are equal then, or `segments` of a `Space`, of a `Quadtree` or of
        `find_pairs`. `numpy.concatenate` joins several polylines.

    Raises
    ------
    ValueError
        If the shape is wrong or a coordinate is not finite.

    See Also
    --------
    jostle.World.walls : The walls of a world.
    jostle.Space.add : Takes segments, along which `move_and_slide` moves other shapes.

    Examples
    --------
    >>> jostle.polyline([(0, 0), (4, 0), (4, 3)]).tolist()
    [[[0.0, 0.0], [4.0, 0.0]], [[4.0, 0.0], [4.0, 3.0]]]
    >>> jostle.polyline([(0, 0), (4, 0), (4, 3)], closed=True).shape
    (3, 2, 2)
    """
    rows = np.asarray(points)
    if rows.dtype != np.float32:
        rows = np.asarray(points, np.float64)
    if rows.size == 0:
        return np.empty((0, 2, 2), rows.dtype)
    if rows.ndim != 2 or rows.shape[1] != 2:
        raise ValueError(f"points has shape {rows.shape}; it must be (n, 2)")
    if not (finite := np.isfinite(rows).all(axis=1)).all():
        index = int(np.argmin(finite))
        x, y = rows[index]
        raise ValueError(f"points[{index}] is ({x}, {y}); both coordinates must be finite")
    if closed:
        rows = np.concatenate([rows, rows[:1]])
    walls = np.stack([rows[:-1], rows[1:]], axis=1)
    kept: NDArray[np.floating] = walls[(walls[:, 0] != walls[:, 1]).any(axis=1)]
    return kept
