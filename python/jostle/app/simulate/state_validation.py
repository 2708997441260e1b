"""Checks of saved states. A checksum finds damage, but not wrong values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jostle.app.simulate.simulation import Attractor, Tags
from jostle.app.simulate.validation import FARTHEST, Many, fields_of, whole

Arrays = Mapping[str, NDArray[Any]]

COUNT = whole(0, 2**62)  # of tags or steps
ATTRACTORS = Many(fields_of(Attractor))


def particles_of(arrays: Arrays, n: int, next_tag: int) -> tuple[Tags, NDArray[np.float64]]:
    """Return the tags and the times of birth of n particles."""
    tags, born = column(arrays, "tags", "<i8", (n,)), column(arrays, "born", "<f8", (n,))
    within("tags", tags, 0, next_tag - 1)
    falling = np.flatnonzero(np.diff(tags) <= 0)
    if len(falling):
        row = int(falling[0]) + 1
        raise ValueError(f"tags[{row}] is {tags[row]}; it must be above tags[{row - 1}]")
    within("born", born, -FARTHEST, FARTHEST)
    return tags, born


def column(arrays: Arrays, name: str, kind: str, shape: tuple[int, ...]) -> NDArray[Any]:
    """Return an array, after a check of its type and shape."""
    if name not in arrays:
        raise ValueError(f"{name} is missing")
    array = arrays[name]
    if (array.dtype.str, array.shape) != (kind, shape):
        raise ValueError(
            f"{name} is an array {array.shape} of {array.dtype.str}; it must be {shape} of {kind}"
        )
    return array


def bytes_of(arrays: Arrays, name: str) -> bytes:
    """Return an array of bytes."""
    length = arrays[name].size if name in arrays else 0
    return column(arrays, name, "|u1", (length,)).tobytes()


def within(name: str, array: NDArray[Any], low: float, high: float) -> None:
    """Raise a ValueError with the first number of an array that is outside the limits."""
    wrong = np.argwhere(~((array >= low) & (array <= high)))
    if len(wrong):
        at = tuple(wrong[0].tolist())
        where = ", ".join(map(str, at))
        raise ValueError(f"{name}[{where}] is {array[at]}; it must be from {low:g} to {high:g}")
