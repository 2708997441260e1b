"""Short sentences at the foot of the picture."""

from __future__ import annotations

from jostle.app.painter import Painter
from jostle.app.palette import TEXT, TEXT_SOFT
from jostle.app.text import BODY, font, panel, word, write

HINT = "H help"
EDGE = 12  # pixels to the edge of the picture


def draw_notice(painter: Painter, notice: str) -> None:
    """Show a sentence at the foot of the picture."""
    width, height = font(BODY).size(notice)
    sheet = panel((width + 32, height + 18))
    write(sheet, (16, 9), notice, TEXT)
    left = (painter.size[0] - sheet.get_width()) / 2
    painter.sheet(sheet, (left, painter.size[1] - 2 * EDGE - sheet.get_height()))


def draw_hint(painter: Painter) -> None:
    """Say in a corner that there is help."""
    hint = word(HINT, TEXT_SOFT, BODY)
    width, height = painter.size
    painter.sheet(hint, (width - EDGE - hint.get_width(), height - EDGE - hint.get_height()))
