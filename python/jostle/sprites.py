"""What `jostle.pygame` keeps in mind between finding sprites and answering; knows no pygame."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from operator import itemgetter
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["Collided", "Near", "Radii"]

Collided: TypeAlias = Callable[[Any, Any], object]


class Radii:
    """Radii of sprites that had none, to be stored in them when pygame would."""

    def __init__(self) -> None:
        self._made: dict[int, tuple[Any, float]] = {}

    def __call__(self, sprite: Any) -> float:
        """Return the radius that pygame makes of a rect."""
        rect = sprite.rect
        radius: float = 0.5 * ((rect.width**2 + rect.height**2) ** 0.5)
        self._made[id(sprite)] = (sprite, radius)
        return radius

    def store(self, sprites: Iterable[Any]) -> None:
        """Give these sprites their radius."""
        if not self._made:
            return
        for sprite in sprites:
            if made := self._made.pop(id(sprite), None):
                sprite.radius = made[1]


class Near(NamedTuple):
    """Pairs of rows, sorted, that meet or that have to be asked."""

    pairs: NDArray[np.uint32]
    sure: NDArray[np.bool_] | None
    radii: Radii

    def decided(
        self, left: Sequence[Any], right: Sequence[Any], collided: Collided | None
    ) -> NDArray[np.uint32]:
        """Return the pairs that meet; asks where that is not sure."""
        if self.sure is None or collided is None:
            return self.pairs
        meet = self.sure.copy()
        doubtful = np.flatnonzero(~meet)
        for place, (i, j) in zip(doubtful.tolist(), self.pairs[doubtful].tolist(), strict=True):
            meet[place] = bool(collided(left[i], right[j]))
        return self.pairs[meet]

    def by_left(self) -> Iterator[tuple[int, Iterator[tuple[int, int, bool]]]]:
        """Yield each row of the left with its (row, other row, whether that is sure)."""
        rows = self.pairs.tolist()
        sure = [True] * len(rows) if self.sure is None else self.sure.tolist()
        triples = ((i, j, is_sure) for (i, j), is_sure in zip(rows, sure, strict=True))
        return groupby(triples, key=itemgetter(0))
