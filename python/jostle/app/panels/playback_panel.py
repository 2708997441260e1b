"""The playback buttons: pause, step, restart, previous and next scene."""

from __future__ import annotations

from jostle.app.gui.host import Gui
from jostle.app.gui.keymap import HANDLERS, key_of
from jostle.app.panels.widgets import choice, hint, in_rows
from jostle.app.session import Session

# Commands of the keymap, and their icons in Font Awesome.
ICONS = {
    "previous scene": "\uf049",
    "step back": "\uf048",
    "pause": "\uf04c",
    "step": "\uf051",
    "next scene": "\uf050",
    "restart": "\uf2f9",
}
PLAY = "\uf04b"


def build(session: Session, gui: Gui) -> None:
    """Build the row of buttons."""
    paused, can_go_back = session.runner.paused, session.runner.history.can_go_back
    for (name, icon), across in in_rows(ICONS.items(), len(ICONS)):
        held = name == "pause" and paused
        reason = "There is no earlier state." if name == "step back" and not can_go_back else ""
        if choice(gui, name, PLAY if held else icon, across, chosen=held, reason=reason):
            HANDLERS[name](session)
        if not reason:
            hint(f"{'Resume' if held else name.capitalize()}  ({key_of(name)})")
