"""The values of settings on the command line."""

import json
from collections.abc import Mapping
from typing import Any

from jostle_lab.schema import wrong

from .refusals import refuse


def given_settings(options: Mapping[str, str | None]) -> dict[str, Any]:
    """Return the settings that were given; a wrong one ends the command with one sentence."""
    values = {name: parsed(text) for name, text in options.items() if text is not None}
    for name, value in values.items():
        if why := wrong(name, value):
            option = "-n" if name == "n" else "--" + name.replace("_", "-")
            refuse(option + why.removeprefix(name))
    return values


def parsed(text: str) -> Any:
    """Return a number, a list of numbers such as 0,100, true, false, or else the text itself."""
    try:
        values = json.loads(f"[{text}]")
    except ValueError:
        return text
    return values[0] if len(values) == 1 else values
