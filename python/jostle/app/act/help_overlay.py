"""The help overlay: the keymap in two columns, in the middle of the window."""

from __future__ import annotations

from functools import lru_cache

import pygame

from jostle.app.act.keymap import GROUPS
from jostle.app.draw.camera import Size
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import ACCENT, PANEL_EDGE, TEXT, TEXT_SOFT
from jostle.app.draw.text import BODY, SMALL, TITLE, font, panel, write

PAD = 24
GAP = 36  # between the two columns
KEY_GAP = 16  # between a key and its meaning
GROUP_GAP = 12  # above the name of a group
LEADING = 5  # pixels between two lines
LEFT_GROUPS = 3  # groups in the left column
EDGE = 8  # free pixels around the panel


def draw_help(painter: Painter) -> None:
    """Draw the list of keys, smaller in a small window."""
    sheet = _sheet()
    wide, high = painter.size[0] - 2 * EDGE, painter.size[1] - 2 * EDGE
    share = min(wide / sheet.get_width(), high / sheet.get_height(), 1.0)
    if share < 1:
        sheet = _smaller(max(share, 0.1))
    (width, height), (wide, high) = painter.size, sheet.get_size()
    painter.sheet(sheet, ((width - wide) // 2, (height - high) // 2))


@lru_cache(maxsize=4)
def _smaller(share: float) -> pygame.Surface:
    sheet = _sheet()
    size = max(round(sheet.get_width() * share), 1), max(round(sheet.get_height() * share), 1)
    return pygame.transform.smoothscale(sheet, size)


@lru_cache(maxsize=1)
def _sheet() -> pygame.Surface:
    """Return the list as a surface."""
    names = list(GROUPS)
    columns = names[:LEFT_GROUPS], names[LEFT_GROUPS:]
    sizes = [_size(column) for column in columns]
    head = PAD + font(TITLE).get_linesize() + 8
    width = 2 * PAD + GAP + sum(wide for wide, _ in sizes)
    sheet = panel((width, head + max(high for _, high in sizes) + PAD))
    write(sheet, (PAD, PAD), "Mouse and keys", TEXT, TITLE)
    write(sheet, (width - PAD, PAD + 7), "close: H or Esc", TEXT_SOFT, SMALL, flush_right=True)
    pygame.draw.line(sheet, PANEL_EDGE, (PAD, head), (width - PAD, head))
    left = PAD
    for column, (wide, _) in zip(columns, sizes, strict=True):
        _write_column(sheet, (left, head), column)
        left += wide + GAP
    return sheet


def _write_column(sheet: pygame.Surface, place: tuple[int, int], names: list[str]) -> None:
    x, y = place
    keys, line = _key_width(names), _line()
    for name in names:
        y += GROUP_GAP
        write(sheet, (x, y), name, TEXT_SOFT, SMALL)
        y += line
        for control in GROUPS[name]:
            write(sheet, (x, y), control.label, ACCENT)
            write(sheet, (x + keys, y), control.meaning, TEXT)
            y += line


def _size(names: list[str]) -> Size:
    """Return the size of a column."""
    meanings = [control.meaning for name in names for control in GROUPS[name]]
    widest = max(font(BODY).size(meaning)[0] for meaning in meanings)
    lines = len(meanings) + len(names)
    return _key_width(names) + widest, lines * _line() + len(names) * GROUP_GAP


def _key_width(names: list[str]) -> int:
    labels = [control.label for name in names for control in GROUPS[name]]
    return max(font(BODY).size(label)[0] for label in labels) + KEY_GAP


def _line() -> int:
    return font(BODY).get_linesize() + LEADING
