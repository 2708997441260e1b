"""Rewind: a slider over the last 30 s, and its memory."""

from __future__ import annotations

from jostle.app.gui.host import Gui
from jostle.app.panels.sliders import Moved, Range, slider
from jostle.app.panels.widgets import hint, soft
from jostle.app.session import Session

MEGABYTE = 2**20
SHORTEST = 0.05  # seconds; the slider is disabled below


def build(session: Session, gui: Gui) -> None:
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
