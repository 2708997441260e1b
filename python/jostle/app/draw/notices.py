"""Messages at the lower edge of the window."""

from __future__ import annotations

from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import RECORDING, TEXT, TEXT_SOFT
from jostle.app.draw.text import BODY, font, panel, word, write

HINT = "H help"
EDGE = 12  # pixels to the edge of the canvas
DOT = 5.0  # pixels: radius of the mark of a recording


def draw_notice(painter: Painter, notice: str, middle: float | None = None) -> None:
    """Draw a message at the lower edge, centred at an x or in the window."""
    width, height = font(BODY).size(notice)
    sheet = panel((width + 32, height + 18))
    write(sheet, (16, 9), notice, TEXT)
    left = (painter.size[0] / 2 if middle is None else middle) - sheet.get_width() / 2
    painter.sheet(sheet, (left, painter.size[1] - 2 * EDGE - sheet.get_height()))


def draw_hint(painter: Painter, right: int = 0) -> None:
    """Draw the hint on the help in a corner, `right` pixels from the edge."""
    hint = word(HINT, TEXT_SOFT, BODY)
    width, height = painter.size[0] - right, painter.size[1]
    painter.sheet(hint, (width - EDGE - hint.get_width(), height - EDGE - hint.get_height()))


def draw_recording(painter: Painter, seconds: float, right: int = 0) -> None:
    """Draw the length of the recording to the left of the hint."""
    minutes, rest = divmod(int(seconds), 60)
    clock = word(f"{minutes}:{rest:02}", TEXT, BODY)
    bottom = painter.size[1] - EDGE
    left = painter.size[0] - right - EDGE - word(HINT, TEXT_SOFT, BODY).get_width() - 24
    left -= clock.get_width()
    painter.sheet(clock, (left, bottom - clock.get_height()))
    painter.circle((left - 14, bottom - clock.get_height() / 2), DOT, RECORDING)
