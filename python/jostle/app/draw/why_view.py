"""An answer to why two particles touch or do not, drawn over the scene."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pygame

from jostle.app.act.explain import Why
from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import ACCENT, TEXT, TEXT_SOFT
from jostle.app.draw.text import BODY, font, panel, write
from jostle.app.simulate.simulation import Rect

PAD = 14
EDGE = 12  # pixels to the top of the picture
LEADING = 3  # pixels between two lines
LEAVES = 24  # so many are drawn at most; the article's may be many more


def draw_why(painter: Painter, why: Why, camera: Camera) -> None:
    """Draw leaves, boxes and the line between the centres, and write the sentences."""
    for leaf in why.leaves[:LEAVES]:
        _frame(painter, camera.rect_to_screen(leaf.box))
    corners = np.array([camera.rect_to_screen(box) for box in why.boxes])
    painter.rects(corners, np.array([TEXT, TEXT], np.uint8), filled=False)
    (x0, x1), (y0, y1) = camera.to_screen(np.array(why.centres))
    painter.lines(np.array([[x0, y0, x1, y1]]), np.array([ACCENT], np.uint8), 2.0)
    sheet = _sheet(why.lines)
    if sheet.get_width() + 2 * EDGE <= painter.size[0]:
        middle = camera.left + (painter.size[0] - camera.left - camera.right) / 2
        left = min(max(middle - sheet.get_width() / 2, EDGE), painter.size[0] - sheet.get_width())
        painter.sheet(sheet, (round(left), EDGE))


def _frame(painter: Painter, rect: Rect) -> None:
    """Outline a leaf, bolder than the tree does."""
    x0, y0, x1, y1 = rect
    ends = np.array([[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]])
    painter.lines(ends, np.array([ACCENT] * 4, np.uint8), 2.0)


@lru_cache(maxsize=4)
def _sheet(lines: tuple[str, ...]) -> pygame.Surface:
    """Return the sentences on a card, the verdict in the brighter colour."""
    face = font(BODY)
    line = face.get_linesize() + LEADING
    width = max(face.size(text)[0] for text in lines)
    sheet = panel((width + 2 * PAD, len(lines) * line + 2 * PAD - LEADING))
    for k, text in enumerate(lines):
        write(sheet, (PAD, PAD + k * line), text, TEXT if k == 0 else TEXT_SOFT)
    return sheet
