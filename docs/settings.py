"""Write docs/settings.md, the table of the simulator's settings, from their declarations.

python docs/settings.py          writes docs/settings.md
python docs/settings.py --check  fails if it is out of date
"""

import difflib
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.schema import FARTHEST, Group, Polyline, Settings
from jostle_lab.storage.config import Window

PAGE = Path(__file__).with_suffix(".md")
HEAD = """\
# The settings of the simulator

This page is written by `python docs/settings.py`; do not edit it.

The settings are the entries of [files in TOML](files.md#scenes-that-you-write-toml), the lines of
the panel, and the options of `jostle run`, such as `--leaf-capacity 8`, `-n 500` and
`--gravity 0,100`. `jostle sweep --set` varies those that are one number, and gravity. Numbers
without limits must be within ±1e18. A setting without a default has that of the scene or of the
library.
"""
PARTS = {
    "Scene": Settings,
    "`[[particles]]`, once for each group": Group,
    "`[[walls]]`, once for each polyline": Polyline,
    "`[shown]`": ViewOptions,
    "`[window]`": Window,
}


def page() -> str:
    """Return the text of the page."""
    return "\n".join([HEAD, *(section(title, kind) for title, kind in PARTS.items())])


def section(title: str, kind: Any) -> str:
    """Return the heading and the table of one class."""
    head = [f"## {title}", "", "| entry | value | default | |", "|---|---|---|---|"]
    return "\n".join([*head, *rows(TypeAdapter(kind).json_schema()), ""])


def rows(schema: dict[str, Any]) -> Iterator[str]:
    """Yield the line of each field."""
    for name, field in schema["properties"].items():
        unit = field.get("unit")
        about = field.get("description", "") + (f"; in {unit}" if unit else "")
        default = field.get("default")
        given = "" if default in (None, []) else f"`{json.dumps(default)}`"
        cells = f"`{name}`", values(field, schema.get("$defs", {})), given, about
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


NAMES = {
    "integer": "whole number",
    "number": "number",
    "boolean": "`true`, `false`",
    "string": "text",
    "object": "table",
}


def values(schema: dict[str, Any], classes: dict[str, Any], plural: str = "") -> str:
    """Return the values that a JSON schema allows, in words; `plural` is their ending."""
    if "$ref" in schema:
        schema = classes[schema["$ref"].rpartition("/")[2]]
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    ways = schema.get("anyOf", schema.get("oneOf"))
    if ways:
        kinds = [way for way in ways if way.get("type") != "null"]
        return ", or ".join(values(kind, classes) for kind in kinds)
    if schema["type"] == "array":
        return f"list{plural} of {entries(schema, classes)}"
    return NAMES[schema["type"]] + plural + limits(schema)


def entries(schema: dict[str, Any], classes: dict[str, Any]) -> str:
    """Return what a list has, in words."""
    if "prefixItems" in schema:
        kinds = schema["prefixItems"]
        return f"{len(kinds)} {values(kinds[0], classes, 's')}"
    most = f"up to {schema['maxItems']:,} " if "maxItems" in schema else ""
    return most + values(schema["items"], classes, "s")


def limits(schema: dict[str, Any]) -> str:
    """Return the limits of a number, without those of all numbers."""
    low, high = schema.get("minimum", -FARTHEST), schema.get("maximum", FARTHEST)
    if low > -FARTHEST and high < FARTHEST:
        return f" from {shown(low)} to {shown(high)}"
    return f" of at least {shown(low)}" if low > -FARTHEST else ""


def shown(number: float) -> str:
    return f"{number:,}" if isinstance(number, int) else f"{number:g}"


def main() -> int:
    """Write the page, or report how it differs."""
    new = page()
    if "--check" not in sys.argv[1:]:
        PAGE.write_text(new, encoding="utf-8")
        return 0
    old = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
    lines = difflib.unified_diff(old.splitlines(), new.splitlines(), PAGE.name, "settings", n=0)
    print("\n".join(lines))
    if new != old:
        print(f"{PAGE.name} is out of date: run python docs/{Path(__file__).name}")
    return int(new != old)


if __name__ == "__main__":
    sys.exit(main())
