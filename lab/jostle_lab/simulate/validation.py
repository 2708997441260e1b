"""Rules for the values of settings and files, and the error messages for other values.

A rule is a `Rule` for one value, `Fields` for named values, or `Many` for a list. The fields of a
dataclass declare their rules with `limited`, and `fields_of` collects them: one declaration serves
the command line, TOML, scene files and panels. `refusals` compares values with a rule, and `read`
returns them as the program uses them.
"""

from __future__ import annotations

import dataclasses
import difflib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

FARTHEST = 1e18  # the largest coordinate, velocity and force of the library
SMALLEST = 1e-6  # the shortest side of a view, as a share of its coordinates
LONGEST = 60  # characters of a value in a message

Key = tuple[str | int, ...]  # names of fields, and numbers within lists
Refusals = Iterator[tuple[Key, str]]


@dataclass(frozen=True)
class Rule:
    """A condition for a value, in words and as a test; `read` converts a value that fits."""

    words: str
    fits: Callable[[Any], bool]
    read: Callable[[Any], Any] = lambda value: value


@dataclass(frozen=True)
class Fields:
    """A table of named values, each with its own rule."""

    rules: Mapping[str, AnyRule]
    what: str = "a field"  # description of a known name, for errors
    words: str = "a table"  # description of the table, for errors
    required: Iterable[str] | None = None  # the names that must be given; all if None
    make: Callable[..., Any] = dict  # makes the result of `read` from the values by name
    # Yields further refusals of a table whose values all fit.
    also: Callable[[Mapping[str, Any]], Refusals] = lambda table: iter(())


@dataclass(frozen=True)
class Many:
    """A list of at most `most` values with one rule."""

    rule: AnyRule
    words: str = "a list"
    most: int = 100_000


AnyRule = Rule | Fields | Many


def limited(rule: AnyRule, default: Any = dataclasses.MISSING) -> Any:
    """Return a field of a dataclass with a rule for its values; required without a default."""
    return dataclasses.field(default=default, metadata={"rule": rule})


def fields_of(kind: Any, what: str = "a field", words: str = "a table", **more: Any) -> Fields:
    """Return the table of the fields of a dataclass; it is read as an object of that class."""
    fields = dataclasses.fields(kind)
    rules = {field.name: field.metadata["rule"] for field in fields}
    required = [field.name for field in fields if field.default is dataclasses.MISSING]
    return Fields(rules, what, words, required, kind, **more)


def check(name: str, value: object, rule: AnyRule) -> str | None:
    """Return why a value is refused, or None."""
    return next((f"{name} {why}" for _, why in refusals(value, rule)), None)


def read(value: Any, rule: AnyRule) -> Any:
    """Return a value as the program uses it; raise a ValueError with the first wrong field."""
    for key, why in refusals(value, rule):
        raise ValueError(f"{dotted(key)} {why}".lstrip())
    return converted(value, rule)


def converted(value: Any, rule: AnyRule) -> Any:
    """Return a value that obeys its rule as the program uses it."""
    if isinstance(rule, Rule):
        return rule.read(value)
    if isinstance(rule, Many):
        return tuple(converted(one, rule.rule) for one in value)
    return rule.make(**{name: converted(one, rule.rules[name]) for name, one in value.items()})


def refusals(value: Any, rule: AnyRule, key: Key = ()) -> Refusals:
    """Yield each field that breaks its rule: its key, and the message after its name."""
    if isinstance(rule, Rule):
        if not rule.fits(value):
            yield key, _must_be(value, rule.words)
    elif isinstance(rule, Many):
        yield from _in_list(value, rule, key)
    elif not isinstance(value, Mapping):
        yield key, _must_be(value, rule.words)
    else:
        wrong = list(_in_table(value, rule))
        for inner, why in wrong or rule.also(value):
            yield (*key, *inner), why


def _in_table(value: Mapping[str, Any], rule: Fields) -> Refusals:
    for name, one in value.items():
        if name in rule.rules:
            yield from refusals(one, rule.rules[name], (name,))
        else:
            yield (name,), unknown(name, rule.what, rule.rules)
    for name in rule.rules if rule.required is None else rule.required:
        if name not in value:
            yield (name,), "is missing"


def _in_list(value: Any, rule: Many, key: Key) -> Refusals:
    if not isinstance(value, list | tuple):
        yield key, _must_be(value, rule.words)
    elif len(value) > rule.most:
        yield key, f"has {len(value):,} entries; there may be at most {rule.most:,}"
    else:
        for number, one in enumerate(value):
            yield from refusals(one, rule.rule, (*key, number))


def unknown(name: str, what: str, known: Iterable[str]) -> str:
    """Return why a name is refused, with the most similar known name; the name comes before it."""
    known = list(known)
    alike = difflib.get_close_matches(shorten(name), known, 1, 0.5)
    hint = f"did you mean {alike[0]}?" if alike else f"there are {', '.join(known)}"
    return f"is not {what}; {hint}"


def _must_be(value: object, words: str) -> str:
    return f"is {shown(value)}; it must be {words}"


def shown(value: object) -> str:
    """Return a value for a message: one line of limited length."""
    if isinstance(value, bool):
        return str(value).lower()
    try:
        return shorten(repr(value))
    except ValueError:  # Python does not convert integers of more than 4,300 digits
        return "a number of thousands of digits"
    except RecursionError:
        return "a deeply nested list"


def shorten(text: str) -> str:
    """Return a text without line breaks, truncated if it is long."""
    text = text if text.isprintable() else repr(text)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def dotted(key: Key) -> str:
    """Return a key in the form settings.particles[0].count."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{shorten(part)}" for part in key)
    return "".join(parts).removeprefix(".")


def real(low: float = -FARTHEST, high: float = FARTHEST) -> Rule:
    """Return the rule of a number between two limits."""
    return Rule(
        f"a number from {low:g} to {high:g}",
        lambda value: _is_number(value) and low <= value <= high,
        float,
    )


def whole(low: int, high: int) -> Rule:
    """Return the rule of an integer between two limits."""
    return Rule(
        f"a whole number from {low:,} to {high:,}",
        lambda value: isinstance(value, int) and _is_number(value) and low <= value <= high,
    )


COUNT = whole(0, 2**62)  # of tags or steps


def one_of(*names: str) -> Rule:
    """Return the rule of one of several names."""
    return Rule(
        f"one of {', '.join(names)}", lambda value: isinstance(value, str) and value in names
    )


def each(rule: Rule, *names: str) -> Rule:
    """Return the rule of a list with one value for each name."""
    return Rule(
        f"[{', '.join(names)}], each {rule.words}",
        lambda value: (
            isinstance(value, list | tuple)
            and len(value) == len(names)
            and all(map(rule.fits, value))
        ),
        lambda value: tuple(map(rule.read, value)),
    )


def either(first: Rule, second: Rule) -> Rule:
    """Return the rule of a value that obeys one of two rules."""
    return Rule(
        f"{first.words}, or {second.words}",
        lambda value: first.fits(value) or second.fits(value),
        lambda value: (first if first.fits(value) else second).read(value),
    )


def or_none(rule: Rule) -> Rule:
    """Return the rule of a value that may be None."""
    return Rule(
        rule.words,
        lambda value: value is None or rule.fits(value),
        lambda value: None if value is None else rule.read(value),
    )


def range_of(low: float, high: float = FARTHEST) -> Rule:
    """Return the rule of one number, or of a pair of the smallest and the largest."""
    one, two = real(low, high), each(real(low, high), "smallest", "largest")
    same = replace(one, read=lambda value: (float(value), float(value)))
    ordered = Rule(
        "two [smallest, largest] in this order",
        lambda value: two.fits(value) and value[0] <= value[1],
        two.read,
    )
    return either(same, ordered)


def rect(farthest: float = FARTHEST, *, least: float = SMALLEST) -> Rule:
    """Return the rule of a rectangle; `least` is the shortest side, as a share of coordinates."""
    corners = each(real(-farthest, farthest), "min_x", "min_y", "max_x", "max_y")

    def fits(value: Any) -> bool:
        if not corners.fits(value):
            return False
        x0, y0, x1, y1 = value
        shortest = least * max(1.0, *map(abs, value))
        return bool(x1 - x0 >= shortest and y1 - y0 >= shortest)

    return Rule(f"{corners.words}, the smaller ones first", fits, corners.read)


def _is_number(value: object) -> bool:
    """Return whether it is a number; the caller refuses infinity and NaN by comparison."""
    return isinstance(value, int | float) and not isinstance(value, bool)
