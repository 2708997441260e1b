"""The layout of the window: the panels leave most of it to the scene."""

from __future__ import annotations

from dataclasses import dataclass

from jostle.app.session import Session

COLUMN, FIGURES = 290.0, 296.0  # points
NARROW = 0.42  # of a small window, at most, for the column
LEAST_COLUMN = 220.0  # what is narrower cannot be used; there is no column then
ROOM_FOR_FIGURES = 1180.0  # below it the statistics move into the column


@dataclass(frozen=True)
class Layout:
    """Widths of the panels in points, 0 for what is not there, and the size of the window."""

    column: float
    figures: float
    width: float
    height: float


def layout(session: Session, width: float, height: float) -> Layout:
    """Return who gets which part of a window of a size in points."""
    column = min(COLUMN, NARROW * width)
    if column < LEAST_COLUMN or not session.shown.panels:
        return Layout(0.0, 0.0, width, height)
    return Layout(column, FIGURES if width >= ROOM_FOR_FIGURES else 0.0, width, height)


def arrange(session: Session, width: float, height: float, scale: float) -> Layout:
    """Let the camera keep clear of the panels; `scale` is pixels a point."""
    room = layout(session, width, height)
    figures = room.figures if session.shown.statistics else 0.0
    session.camera.keep_clear(round(room.column * scale), round(figures * scale))
    return room
