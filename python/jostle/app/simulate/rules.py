"""What values a setting may have, and the sentence that refuses the others."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Rule:
    """What a value must be, in words and as a test."""

    words: str
    fits: Callable[[Any], bool]


def check(name: str, value: object, rule: Rule) -> str | None:
    """Return why a value is refused, or None."""
    if rule.fits(value):
        return None
    shown = str(value).lower() if isinstance(value, bool) else repr(value)
    return f"{name} is {shown}; it must be {rule.words}"


def unknown(name: str, what: str, known: Iterable[str]) -> str:
    """Return why a name is refused, with the known one that is most like it."""
    known = list(known)
    alike = difflib.get_close_matches(name, known, 1, 0.5)
    hint = f"did you mean {alike[0]}?" if alike else f"there are {', '.join(known)}"
    return f"{name} is not {what}; {hint}"


def real(low: float = -math.inf, high: float = math.inf) -> Rule:
    """Return the rule of a finite number between two others."""
    return Rule(
        "a number" + _bounds(low, high), lambda value: _is_number(value) and low <= value <= high
    )


def whole(low: int, high: int) -> Rule:
    """Return the rule of an integer between two others."""
    return Rule(
        f"a whole number from {low:,} to {high:,}",
        lambda value: isinstance(value, int) and _is_number(value) and low <= value <= high,
    )


def one_of(*names: str) -> Rule:
    """Return the rule of one of several words."""
    return Rule(f"one of {', '.join(names)}", lambda value: value in names)


def pair(names: str) -> Rule:
    """Return the rule of two numbers."""
    return Rule(f"two finite numbers [{names}]", _is_pair)


def range_of(low: float) -> Rule:
    """Return the rule of one number, or of two from the smallest to the largest."""

    def fits(value: Any) -> bool:
        if _is_number(value):
            return bool(value >= low)
        return _is_pair(value) and low <= value[0] <= value[1]

    return Rule(f"a number of at least {low:g}, or two [smallest, largest] in this order", fits)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _is_pair(value: Any) -> bool:
    return isinstance(value, list | tuple) and len(value) == 2 and all(map(_is_number, value))


def _bounds(low: float, high: float) -> str:
    if low > -math.inf and high < math.inf:
        return f" from {low:g} to {high:g}"
    return f" of at least {low:g}" if low > -math.inf else ""
