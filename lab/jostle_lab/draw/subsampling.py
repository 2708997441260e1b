"""The choice of a few of many objects to draw: always the same ones, to avoid flicker."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle_lab.draw.camera import Camera

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


def hashed(tags: NDArray[np.integer]) -> NDArray[np.float64]:
    """Return a hash in 0..1 for each tag."""
    state = (tags.astype(np.uint64) + np.uint64(1)) * _GOLDEN
    state = (state ^ (state >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    return (state >> np.uint64(11)) / 2.0**53


def subset(tags: NDArray[np.integer], most: int) -> NDArray[np.intp]:
    """Return the rows of at most `most` of the tags, chosen by their hashes."""
    if len(tags) <= most:
        return np.arange(len(tags))
    numbers = hashed(tags)
    low = np.flatnonzero(numbers < 1.5 * (most + 50) / len(tags))  # so that few are sorted
    if len(low) < most:
        low = np.arange(len(tags))
    return np.sort(low[np.argsort(numbers[low], kind="stable")[:most]])


def in_view(positions: NDArray[np.floating], camera: Camera) -> NDArray[np.intp]:
    """Return the rows of the points on the screen."""
    low, high = camera.to_world((0, 0)), camera.to_world(camera.size)
    x, y = positions[:, 0], positions[:, 1]
    return np.flatnonzero((x > low[0]) & (y > low[1]) & (x < high[0]) & (y < high[1]))
