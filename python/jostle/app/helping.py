"""The help overlay: the table of controls as a panel in the middle of the screen."""

from __future__ import annotations

import pygame

from jostle.app.controls import CONTROLS
from jostle.app.palette import ACCENT, PANEL_EDGE, TEXT
from jostle.app.text import BODY, TITLE, font, panel, write

PAD = 22
KEY_COLUMN = 104


def draw_help(target: pygame.Surface) -> None:
    """Draw the list of keys."""
    line = font(BODY).get_linesize() + 7
    widest = max(font(BODY).size(control.meaning)[0] for control in CONTROLS)
    width = 2 * PAD + KEY_COLUMN + widest
    top = PAD + font(TITLE).get_linesize() + 12
    sheet = panel((width, top + len(CONTROLS) * line + PAD - 6))
    write(sheet, (PAD, PAD), "Keys and mouse", TEXT, TITLE)
    pygame.draw.line(sheet, PANEL_EDGE, (PAD, top - 5), (width - PAD, top - 5))
    for row, control in enumerate(CONTROLS):
        y = top + row * line + 3
        write(sheet, (PAD, y), control.label, ACCENT)
        write(sheet, (PAD + KEY_COLUMN, y), control.meaning, TEXT)
    target.blit(sheet, sheet.get_rect(center=target.get_rect().center))
