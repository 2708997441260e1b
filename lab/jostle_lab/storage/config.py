"""A scene described in a TOML file, for `jostle run --config`; docs/files.md lists its entries.

Entries that are unknown or wrong are refused with name and line. Reading a file takes time
proportional to its length, and finding a line that of reading it some ten times: it is a bisection.
"""

import re
import sys
from bisect import bisect_left
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jostle_lab.draw.camera import Size
from jostle_lab.draw.view_options import OPTION_RULES
from jostle_lab.simulate.settings import RULES, SETTINGS, Settings, unknown_scene
from jostle_lab.simulate.validation import (
    Fields,
    Key,
    Rule,
    converted,
    dotted,
    each,
    refusals,
    whole,
)

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

LARGEST, SMALLEST = 16_384, 64  # pixels
MOST_BYTES = 64 << 20  # of a file

WINDOW_RULES: dict[str, Rule] = {
    "size": each(whole(SMALLEST, LARGEST), "width", "height"),
}
WINDOW = Fields(WINDOW_RULES, "an entry of [window]", "a table, [window]", required=())
SHOWN = Fields(OPTION_RULES, "an entry of [shown]", "a table, [shown]", required=())
ENTRIES = Fields({**RULES, "window": WINDOW, "shown": SHOWN}, SETTINGS.what, required=())


class ConfigError(ValueError):
    """An error in a file; the message contains its name and the line."""


@dataclass(frozen=True)
class Config:
    """The entries of a file; missing ones are omitted or None."""

    name: str | None = None  # of the file
    settings: Settings = field(default_factory=Settings)
    view_options: Mapping[str, Any] = field(default_factory=dict)
    size: Size | None = None


def read_config(path: Path) -> Config:
    """Return the entries of a file; raise a ConfigError or an OSError if it is wrong."""
    with path.open("rb") as file:  # which may be a device without an end
        data = file.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise ConfigError(f"{path.name} has more than {MOST_BYTES >> 20} MiB")
    try:
        text = data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path.name} is not a text in UTF-8") from error
    entries = _parsed(path.name, text)
    for key, refusal in _refusals(entries):
        raise ConfigError(f"{path.name}, line {line_of(text, key)}: {refusal}")
    values = converted(entries, ENTRIES)
    window, shown = values.pop("window", {}), values.pop("shown", {})
    return Config(
        name=path.name,
        settings=Settings(**values),
        view_options=shown,
        size=window.get("size"),
    )


def _refusals(entries: Mapping[str, Any]) -> Iterator[tuple[Key, str]]:
    """Yield the key and the message of each error."""
    for key, why in refusals(entries, ENTRIES):
        yield key, f"{dotted(key)} {why}"
    if unheard := unknown_scene(entries.get("scene", Settings.scene)):
        yield ("scene",), unheard


# ---- TOML ----------------------------------------------------------------------------------------

# Tokens for finding the ends of statements: strings and comments, whose contents are skipped,
# and brackets. An open string extends to the end of the text or line, so no text is
# read twice.
_TOKEN = re.compile(
    r'"""(?:\\.?|[^\\])*?(?:"{3,5}|\Z)'
    r"|'''.*?(?:'{3,5}|\Z)"
    r'|"(?:\\.|[^"\\\n])*"?'
    r"|'[^'\n]*'?"
    r"|\#[^\n]*"
    r"|[\[\]{}\n]",
    re.DOTALL,
)


def _parsed(name: str, text: str) -> dict[str, Any]:
    """Return the entries of a TOML text; raise a ConfigError with the line of an error."""
    try:
        entries: dict[str, Any] = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(_syntax(name, text, str(error))) from error
    except RecursionError as error:
        raise ConfigError(f"{name}: too many brackets are open") from error
    except ValueError as error:  # Python reads no integers of thousands of digits
        raise ConfigError(f"{name}: a number has too many digits") from error
    return entries


# Messages of the reader that do not say what to change.
_PLAIN = {
    "Cannot overwrite a value": "the entry is given twice",
    "Illegal character '\\n'": "a quotation mark is missing at the end of the line",
}


def _syntax(name: str, text: str, complaint: str) -> str:
    """Return the reader's message with the line before it, as in other messages."""
    reason, _, place = complaint.rpartition(" (at ")
    reason = _PLAIN.get(reason, reason[:1].lower() + reason[1:])
    line = place.removeprefix("line ").split(",")[0]
    if not line.isdigit():  # "end of document"
        line = str(text.rstrip().count("\n") + 1)
    return f"{name}, line {line}: {reason}"


def line_of(text: str, key: Key) -> int:
    """Return the line, from 1, that sets a key of a TOML text, or its nearest outer table.

    It is the first line of the statement at whose end the text so far contains the key.
    """
    entries = tomllib.loads(text)
    while not _contains(entries, key):
        key = key[:-1]
    # The end of each statement, blank line or comment, and the line after it.
    ends, line, depth = [], 1, 0
    for token in _TOKEN.finditer(text + "\n"):
        mark = token[0]
        line += mark.count("\n")
        depth += (mark in "[{") - (mark in "]}")
        if mark == "\n" and not depth:
            ends.append((token.end(), line))
    found = bisect_left(ends, True, key=lambda end: _contains(tomllib.loads(text[: end[0]]), key))
    return ends[found - 1][1] if found else 1


def _contains(entries: Any, key: Key) -> bool:
    """Return whether nested tables and lists have an entry with a key."""
    try:
        for part in key:
            entries = entries[part]
    except (KeyError, IndexError, TypeError):
        return False
    return True
