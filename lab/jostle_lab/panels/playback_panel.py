"""The time: pause, step, restart, previous and next scene; a slider over the last 30 s."""

from __future__ import annotations

from jostle_lab.gui.host import Gui
from jostle_lab.gui.keymap import HANDLERS, key_of
from jostle_lab.panels.sliders import Moved, Range, slider
from jostle_lab.panels.widgets import choice, hint, in_rows, soft
from jostle_lab.session import Session

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
MEGABYTE = 2**20
SHORTEST = 0.05  # seconds of history below which the slider is disabled


def build(session: Session, gui: Gui) -> None:
    paused, can_go_back = session.runner.paused, session.runner.history.can_go_back
    for (name, icon), across in in_rows(ICONS.items(), len(ICONS)):
        held = name == "pause" and paused
        reason = "There is no earlier state." if name == "step back" and not can_go_back else ""
        if choice(gui, name, PLAY if held else icon, across, chosen=held, reason=reason):
            HANDLERS[name](session)
        if not reason:
            hint(f"{'Resume' if held else name.capitalize()}  ({key_of(name)})")


def build_rewind(session: Session, gui: Gui) -> None:
    """Build the slider; its right end is the latest state."""
    history = session.runner.history
    reason = "" if history.span > SHORTEST else "There is no earlier state yet."
    span = Range(-max(history.span, SHORTEST), 0.0)
    moved, value = slider(gui, "moment", span, -history.back, _ago, reason=reason)
    if moved is not Moved.NOT:
        session.runner.rewind(-value)
    steps = "each step" if history.stride == 1 else f"every {history.stride} steps"
    soft(f"{history.span:.1f} s · snapshot {steps} · {history.bytes / MEGABYTE:.1f} MB")
    hint(
        f"Snapshots take up to {history.budget / MEGABYTE:.0f} MB. Steps without a snapshot are "
        "re-simulated, with the same bits."
    )


def _ago(value: float) -> str:
    return f"\u2212{-value:.1f} s" if value < -SHORTEST else "now"
