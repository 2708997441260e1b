"""Random numbers that are the same on every machine: computed without a library sine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]

TRIES = 8  # points in a square; with probability 1/220,000 none of them is in the disc


def in_disc(tries: Floats) -> Floats:
    """Return points distributed evenly over the disc of radius 1, from points in a square.

    Parameters
    ----------
    tries
        (n, `TRIES`, 2), each from 0 to 1: the first of each row that is in the disc is used.
    """
    points = 2 * tries - 1
    inside: NDArray[np.bool_] = _squares(points) <= 1
    first = points[np.arange(len(points)), inside.argmax(axis=1)]
    found = inside.any(axis=1)
    chosen: Floats = first * np.where(found, 1.0, 0.5)[:, None]
    return chosen


def directions(rng: np.random.Generator, count: int) -> Floats:
    """Return random vectors of length 1."""
    points = in_disc(rng.random((count, TRIES, 2)))
    lengths = np.sqrt(_squares(points))
    points[lengths == 0], lengths[lengths == 0] = (1, 0), 1
    return points / lengths[:, None]


def _squares(points: Floats) -> Floats:
    x, y = points[..., 0], points[..., 1]
    return x * x + y * y
