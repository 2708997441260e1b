"""The help overlay: the table of controls as a panel in the middle of the screen."""

from __future__ import annotations

import pygame

from jostle.app.controls import CONTROLS
from jostle.app.painter import Painter
from jostle.app.palette import ACCENT, PANEL_EDGE, TEXT
from jostle.app.text import BODY, TITLE, font, panel, write

PAD = 22
KEY_COLUMN = 104


def draw_help(painter: Painter) -> None:
    """Draw the list of keys."""
    line = font(BODY).get_linesize() + 7
    widest = max(font(BODY).size(control.meaning)[0] for control in CONTROLS)
    breadth = 2 * PAD + KEY_COLUMN + widest
    top = PAD + font(TITLE).get_linesize() + 12
    sheet = panel((breadth, top + len(CONTROLS) * line + PAD - 6))
    write(sheet, (PAD, PAD), "Keys and mouse", TEXT, TITLE)
    pygame.draw.line(sheet, PANEL_EDGE, (PAD, top - 5), (breadth - PAD, top - 5))
    for row, control in enumerate(CONTROLS):
        y = top + row * line + 3
        write(sheet, (PAD, y), control.label, ACCENT)
        write(sheet, (PAD + KEY_COLUMN, y), control.meaning, TEXT)
    (width, height), (wide, high) = painter.size, sheet.get_size()
    painter.sheet(sheet, ((width - wide) / 2, (height - high) / 2))
