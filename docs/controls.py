"""Write docs/controls.md from the keymap of the simulator: `python docs/controls.py`."""

import os
from pathlib import Path

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

from jostle.app.gui.keymap import as_markdown

if __name__ == "__main__":
    Path(__file__).with_suffix(".md").write_text(as_markdown(), encoding="utf-8")
