"""The layout of the window: the widths of the panels."""

from __future__ import annotations

from dataclasses import dataclass

from jostle.app.session import Session

COLUMN, STATISTICS = 290.0, 296.0  # points
NARROW = 0.42  # largest fraction of the window's width for the column
LEAST_COLUMN = 220.0  # in a narrower window there is no column
STATISTICS_FROM = 1180.0  # in a narrower window the statistics are in the column


@dataclass(frozen=True)
class Layout:
    """Widths of the panels in points, 0 if hidden, and the size of the window."""

    column: float
    statistics: float
    width: float
    height: float


def layout(session: Session, width: float, height: float) -> Layout:
    """Return the layout of a window of a size in points."""
    column = min(COLUMN, NARROW * width)
    if column < LEAST_COLUMN or not session.view_options.panels:
        return Layout(0.0, 0.0, width, height)
    return Layout(column, STATISTICS if width >= STATISTICS_FROM else 0.0, width, height)


def arrange(session: Session, width: float, height: float, scale: float) -> Layout:
    """Set the camera's margins to the panels; `scale` is pixels per point."""
    widths = layout(session, width, height)
    statistics = widths.statistics if session.view_options.statistics else 0.0
    session.camera.set_margins(round(widths.column * scale), round(statistics * scale))
    return widths
