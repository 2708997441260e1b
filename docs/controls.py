"""Write docs/controls.md from the keymap of the simulator: `python docs/controls.py`."""

import os
from pathlib import Path

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

from jostle_lab.gui.keymap import GROUPS


def as_markdown() -> str:
    """Return the keymap as the text of the document."""
    lines = [
        "# Mouse and keys of the simulator",
        "",
        "The simulator shows the same list: press H. This page is written by",
        "`docs/controls.py`.",
    ]
    for group, controls in GROUPS.items():
        lines += ["", f"## {group}", "", "| | |", "|---|---|"]
        lines += [f"| **{control.label}** | {control.meaning} |" for control in controls]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    Path(__file__).with_suffix(".md").write_text(as_markdown(), encoding="utf-8")
