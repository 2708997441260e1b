"""The last half minute: a slider through it, and what it costs."""

from __future__ import annotations

from jostle.app.gui.host import Gui
from jostle.app.panels.sliders import Moved, Range, slider
from jostle.app.panels.widgets import hint, soft
from jostle.app.session import Session

MEGABYTE = 2**20
SHORTEST = 0.05  # seconds; in less there is nothing to choose


def build(session: Session, gui: Gui) -> None:
    """Build the slider; its right end is the youngest moment."""
    history = session.history
    reason = "" if history.span > SHORTEST else "Nothing has happened yet."
    span = Range(-max(history.span, SHORTEST), 0.0)
    moved, value = slider(gui, "moment", span, -history.back, _ago, reason=reason)
    if moved is not Moved.NOT:
        session.scrub(-value)
    steps = "each step" if history.stride == 1 else f"every {history.stride} steps"
    soft(f"{history.span:.1f} s · a snapshot {steps} · {history.bytes / MEGABYTE:.1f} MB")
    hint(
        f"Snapshots may take {history.budget / MEGABYTE:.0f} MB. The steps between them are made "
        "again when you look at them, with the same result to the last bit."
    )


def _ago(value: float) -> str:
    return f"\u2212{-value:.1f} s" if value < -SHORTEST else "now"
