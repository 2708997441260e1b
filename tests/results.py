"""The fields of results of the library, and the choice of pairs by categories."""

from collections.abc import Sequence
from typing import Any


def fields(result: Any) -> tuple[Any, ...]:
    """Return the values of all fields, in their order."""
    return tuple(getattr(result, name) for name in result.__slots__)


def chosen(pair: Sequence[int], categories: Sequence[int], a: int, b: int) -> list[int] | None:
    """Return a pair as `between` should, or None."""
    (i, j), (own, other) = pair, categories
    if own & a and other & b:
        return [i, j]
    return [j, i] if other & a and own & b else None
