"""The choice of pairs by the categories of both shapes, for the methods `between` of results."""

from __future__ import annotations

import operator
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import NDArray


def _bits(name: str, value: SupportsIndex) -> np.uint32:
    """Return a set of 32 bits; a negative integer stands for its low bits."""
    try:
        bits = operator.index(value)
        if isinstance(value, bool):
            raise TypeError
    except TypeError:
        raise TypeError(f"{name} must be an integer, not {type(value).__name__}") from None
    if not -(2**32) <= bits < 2**32:
        raise ValueError(
            f"{name} is {bits}; it must be a set of 32 bits: between 0 and 4294967295, "
            "or a negative integer from -4294967296 as ~bits gives it"
        )
    return np.uint32(bits & 0xFFFFFFFF)


class Choice:
    """The pairs of which one has a category in `a` and the other one in `b`.

    Those that fit only in the other order are turned, unless pairs are `directed`.
    """

    def __init__(
        self,
        categories: NDArray[np.uint32],
        a: SupportsIndex,
        b: SupportsIndex,
        *,
        directed: bool = False,
    ) -> None:
        first, second = (_bits(name, value) for name, value in (("a", a), ("b", b)))
        in_first, in_second = (categories & first) != 0, (categories & second) != 0
        straight = in_first[:, 0] & in_second[:, 1]
        turned = ~straight & in_first[:, 1] & in_second[:, 0] & (not directed)
        self._rows = np.flatnonzero(straight | turned)
        self._turned = turned[self._rows]

    def of(self, column: NDArray[Any]) -> NDArray[Any]:
        """Return the rows of a column that are kept."""
        return column[self._rows]

    def pairs(self, column: NDArray[Any]) -> NDArray[Any]:
        """Return those of a column of pairs, turned."""
        kept = column[self._rows]
        kept[self._turned] = kept[self._turned, ::-1]
        return kept

    def normals(self, column: NDArray[Any]) -> NDArray[Any]:
        """Return those of a column of normals, turned."""
        kept = column[self._rows]
        kept[self._turned] = 0 - kept[self._turned]  # and not -0
        return kept
