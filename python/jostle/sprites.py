"""Data of `jostle.pygame` between the search for pairs and the answer; independent of pygame."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby, repeat
from operator import itemgetter
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["Collided", "Near", "Prefilter", "Radii", "rows_of"]

Collided: TypeAlias = Callable[[Any, Any], object]
_AT_A_TIME = 1 << 16  # rows


def rows_of(array: NDArray[Any]) -> Iterator[Any]:
    """Yield the rows as numbers or lists of Python, so that Ctrl-C ends long loops soon."""
    for start in range(0, len(array), _AT_A_TIME):
        yield from array[start : start + _AT_A_TIME].tolist()


class Prefilter:
    """A `collided` that calls another one only for sprites whose rects are near.

    `jostle.pygame.prefilter` makes it. Calling it tests the rects and then calls
    `collided`, so pygame's own functions give the same answers with it, only slower.

    Parameters
    ----------
    collided : callable
        Called for sprites whose rects are near.
    reach : float
        Largest gap between two rects, along x and along y, in units of length.
    """

    __slots__ = ("collided", "reach")

    def __init__(self, collided: Collided, reach: float) -> None:
        if not callable(collided):
            raise TypeError(f"collided must be callable, not {type(collided).__name__}")
        if isinstance(reach, bool) or not hasattr(reach, "__float__"):
            raise TypeError(f"reach must be a number, not {type(reach).__name__}")
        self.collided, self.reach = collided, float(reach)
        if not (math.isfinite(self.reach) and self.reach >= 0):
            raise ValueError(f"reach is {reach}; it must be finite and at least 0")

    def __repr__(self) -> str:
        return f"prefilter({self.collided!r}, reach={self.reach!r})"

    def __call__(self, left: Any, right: Any) -> object:
        """Return False if the rects are not near, otherwise the result of `collided`."""
        a, b = left.rect, right.rect
        gap = max(_gap(a.left, a.right, b.left, b.right), _gap(a.top, a.bottom, b.top, b.bottom))
        return (gap <= self.reach or a.colliderect(b)) and self.collided(left, right)


def _gap(a: float, a_end: float, b: float, b_end: float) -> float:
    """Return the gap between two intervals with ends in any order."""
    return max(min(a, a_end) - max(b, b_end), min(b, b_end) - max(a, a_end))


class Radii:
    """Radii of sprites without one, to be stored in them as pygame does."""

    def __init__(self) -> None:
        self._made: dict[int, tuple[Any, float]] = {}

    def __call__(self, sprite: Any) -> float:
        """Return the radius that pygame computes from a rect."""
        rect = sprite.rect
        radius: float = 0.5 * ((rect.width**2 + rect.height**2) ** 0.5)
        self._made[id(sprite)] = (sprite, radius)
        return radius

    def store(self, sprites: Iterable[Any]) -> None:
        """Store the radii in these sprites."""
        if not self._made:
            return
        for sprite in sprites:
            if made := self._made.pop(id(sprite), None):
                sprite.radius = made[1]


class Near(NamedTuple):
    """Sorted pairs of rows that collide, or for which `collided` has to be called.

    Attributes
    ----------
    pairs : ndarray of uint32, shape (m, 2)
        Rows of the left and of the right sprites.
    sure : ndarray of bool, shape (m,), or None
        Whether each pair collides without a call; None if all do.
    collided : callable or None
        Called for the other pairs.
    radii : Radii
        Radii that were computed during the search.
    """

    pairs: NDArray[np.uint32]
    sure: NDArray[np.bool_] | None
    collided: Collided | None
    radii: Radii

    def decided(self, left: Sequence[Any], right: Sequence[Any]) -> NDArray[np.uint32]:
        """Return the pairs that collide; call `collided` for pairs that are not sure."""
        if self.sure is None or self.collided is None:
            return self.pairs
        collide = self.sure.copy()
        doubtful = np.flatnonzero(~collide)
        pairs = rows_of(self.pairs[doubtful])
        for place, (i, j) in zip(rows_of(doubtful), pairs, strict=True):
            collide[place] = bool(self.collided(left[i], right[j]))
        return self.pairs[collide]

    def by_left(self) -> Iterator[tuple[int, Iterator[tuple[int, int, bool]]]]:
        """Yield each left row with its triples (row, other row, whether the pair is sure)."""
        sure = repeat(True) if self.sure is None else rows_of(self.sure)
        pairs = rows_of(self.pairs)
        triples = ((i, j, is_sure) for (i, j), is_sure in zip(pairs, sure, strict=False))
        return groupby(triples, key=itemgetter(0))
