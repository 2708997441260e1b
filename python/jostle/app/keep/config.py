"""A scene described in a TOML file, for `jostle run --config`; docs/files.md lists its entries.

Entries that are unknown or wrong are refused by name and line. TOML's own reader gives no lines, so
they are found by reading statement after statement: a statement ends where it can be read alone.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from enum import Enum
from pathlib import Path
from typing import Any

import jostle
from jostle.app.draw.camera import Size
from jostle.app.draw.shown import Shown
from jostle.app.simulate.rules import Rule, check, one_of, unknown, whole
from jostle.app.simulate.settings import GROUP_RULES, RENDERERS, RULES, TRUTH, Settings, settings_of

Key = tuple[str | int, ...]  # names of tables, and numbers within arrays of tables

LARGEST, SMALLEST = 16_384, 64  # pixels

# What the article's programs have no choice of.
OUR_RULES = (
    *("leaf_capacity", "max_depth", "container", "gravity", "drag", "restitution", "substeps"),
    *("threads", "on_touch"),
)

WINDOW_RULES: dict[str, Rule] = {
    "size": Rule(
        f"two whole numbers [width, height] from {SMALLEST} to {LARGEST:,}",
        lambda value: (
            isinstance(value, list)
            and len(value) == 2
            and all(whole(SMALLEST, LARGEST).fits(side) for side in value)
        ),
    ),
    "renderer": one_of(*RENDERERS),
}


class ConfigError(ValueError):
    """What is wrong with a file, in a sentence with its name and the line."""


@dataclass(frozen=True)
class Config:
    """What a file says; what it does not say is left out or None."""

    settings: Settings = field(default_factory=Settings)
    given: frozenset[str] = frozenset()  # the settings that the file names
    shown: Mapping[str, Any] = field(default_factory=dict)
    size: Size | None = None
    renderer: str | None = None

    def show(self, shown: Shown) -> None:
        """Set the switches that the file names."""
        for name, value in self.shown.items():
            setattr(shown, name, value)


def read_config(path: Path) -> Config:
    """Return what a file says; a ConfigError or an OSError says why it cannot be taken."""
    toml = _reader()
    try:
        text = path.read_bytes().decode("utf-8-sig").replace("\r\n", "\n")
        entries = toml.loads(text)
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path.name} is not a text in UTF-8") from error
    except toml.TOMLDecodeError as error:
        raise ConfigError(_syntax(path.name, text, str(error))) from error
    for key, refusal in _refusals(entries):
        line = lines_of(text).get(key)
        where = f"{path.name}, line {line}" if line else path.name
        raise ConfigError(f"{where}: {refusal}")
    window, shown = entries.pop("window", {}), entries.pop("shown", {})
    size = window.get("size")
    return Config(
        settings=settings_of(entries),
        given=frozenset(entries),
        shown={name: _switch(name, value) for name, value in shown.items()},
        size=(size[0], size[1]) if size else None,
        renderer=window.get("renderer"),
    )


def lines_of(text: str) -> dict[Key, int]:
    """Return the line, from 1, on which each key of a text in TOML is set."""
    toml, lines, found = _reader(), text.split("\n"), dict[Key, int]()
    table: Key = ()
    start = 0
    for end in range(1, len(lines) + 1):
        try:
            entries = toml.loads("\n".join(lines[start:end]))
        except toml.TOMLDecodeError:
            continue  # a value goes on in the next line
        if entries and lines[start].lstrip().startswith("["):
            table = _table(entries, found)
            found[table] = start + 1
        else:
            for key in _paths(entries):
                found[table + key] = start + 1
        start = end
    return found


def _table(entries: Mapping[str, Any], found: Mapping[Key, int]) -> Key:
    """Return which table a line such as [a.b] or [[a]] begins."""
    key: Key = ()
    inner: Any = entries
    while inner:
        (name,) = inner
        key, inner = (*key, name), inner[name]
        if isinstance(inner, list):  # one more of an array of tables
            number = 0
            while (*key, number) in found:
                number += 1
            return (*key, number)
    return key


def _paths(entries: Mapping[str, Any]) -> Iterator[Key]:
    """Return every key of nested tables, the outer ones before the inner ones."""
    for name, value in entries.items():
        yield (name,)
        if isinstance(value, Mapping):
            for key in _paths(value):
                yield (name, *key)


def _refusals(entries: Mapping[str, Any]) -> Iterator[tuple[Key, str]]:
    """Return what is wrong, each with its key."""
    known = (*RULES, "particles", "window", "shown")
    for name, value in entries.items():
        if name in RULES:
            yield from _refusal((name,), value, RULES[name])
        elif name not in known:
            yield (name,), unknown(name, "a setting", known)
    scenes = jostle.scenes.names()
    if (scene := entries.get("scene", scenes[0])) not in scenes:
        yield ("scene",), unknown(str(scene), "a scene", scenes)
    if str(entries.get("method")).startswith("article-"):
        for name in OUR_RULES:
            if name in entries:
                yield (name,), f"{name} cannot be set here: the article's rules are fixed"
    groups = entries.get("particles", [])
    if not isinstance(groups, list) or not all(isinstance(group, dict) for group in groups):
        yield ("particles",), "particles is written as [[particles]], once for each group"
    else:
        for number, group in enumerate(groups):
            yield from _wrong(("particles", number), group, GROUP_RULES, "a property of particles")
    yield from _section(entries, "window", WINDOW_RULES, "an entry of [window]")
    yield from _section(entries, "shown", _shown_rules(), "something to show")


def _section(
    entries: Mapping[str, Any], name: str, rules: Mapping[str, Rule], what: str
) -> Iterator[tuple[Key, str]]:
    section = entries.get(name, {})
    if not isinstance(section, dict):
        yield (name,), f"{name} is written as a table, [{name}]"
    else:
        yield from _wrong((name,), section, rules, what)


def _wrong(
    key: Key, entries: Mapping[str, Any], rules: Mapping[str, Rule], what: str
) -> Iterator[tuple[Key, str]]:
    for name, value in entries.items():
        if name in rules:
            yield from _refusal((*key, name), value, rules[name])
        else:
            yield (*key, name), unknown(name, what, rules)


def _refusal(key: Key, value: object, rule: Rule) -> Iterator[tuple[Key, str]]:
    refusal = check(str(key[-1]), value, rule)
    if refusal:
        yield key, refusal


def _shown_rules() -> dict[str, Rule]:
    """Return what each switch may be: true or false, or one of its kinds in lower case."""
    rules = {}
    for switch in fields(Shown):
        default = switch.default
        rules[switch.name] = (
            one_of(*(kind.name.lower() for kind in type(default)))
            if isinstance(default, Enum)
            else TRUTH
        )
    return rules


def _switch(name: str, value: Any) -> Any:
    default = getattr(Shown(), name)
    return type(default)[value.upper()] if isinstance(default, Enum) else value


def _syntax(name: str, text: str, complaint: str) -> str:
    """Return the reader's complaint with the line before it, as all others have it."""
    reason, _, place = complaint.partition(" (at ")
    reason = reason[:1].lower() + reason[1:]
    line = place.removeprefix("line ").split(",")[0]
    if not line.isdigit():  # "end of document"
        line = str(text.rstrip().count("\n") + 1)
    return f"{name}, line {line}: {reason}"


def _reader() -> Any:
    """Return the module that reads TOML: Python's own from 3.11 on."""
    return importlib.import_module("tomllib" if sys.version_info >= (3, 11) else "tomli")
