"""How much room the panels have: they leave the scene the better part of every window."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import imgui

from jostle.app.session import Session

COLUMN, FIGURES = 290.0, 296.0  # points
NARROW = 0.42  # of a small window, at most, for the column
LEAST_COLUMN = 220.0  # what is narrower cannot be used; there is no column then
ROOM_FOR_FIGURES = 1180.0  # below it the statistics move into the column
TAB = 34.0  # height of the statistics when they are folded


@dataclass(frozen=True)
class Layout:
    """Widths in points; 0 for what is not there."""

    column: float
    figures: float
    width: float
    height: float


def layout(session: Session) -> Layout:
    """Return who gets which part of the window."""
    size = imgui.get_io().display_size
    column = min(COLUMN, NARROW * size.x)
    column = column if column >= LEAST_COLUMN else 0.0
    figures = FIGURES if column and size.x >= ROOM_FOR_FIGURES else 0.0
    if not session.shown.panels:
        column = figures = 0.0
    return Layout(column, figures, size.x, size.y)


def arrange(session: Session) -> None:
    """Let the camera keep clear of the panels."""
    room, scale = layout(session), imgui.get_io().display_framebuffer_scale.x
    figures = room.figures if session.shown.statistics else 0.0
    session.camera.keep_clear(round(room.column * scale), round(figures * scale))
