"""The explanation of a contact, drawn over the scene."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pygame

from jostle.app.act.explanation import Explanation
from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import ACCENT, TEXT, TEXT_SOFT
from jostle.app.draw.text import BODY, font, panel, wrapped, write
from jostle.app.simulate.simulation import Rect

PAD = 14
EDGE = 12  # pixels to the upper edge
LEADING = 3  # pixels between two lines
LEAVES = 24  # drawn at most; the article's tree may have many more


def draw_explanation(painter: Painter, explanation: Explanation, camera: Camera) -> None:
    """Draw the leaves, the AABBs, the line between the centres, and the sentences."""
    for leaf in explanation.leaves[:LEAVES]:
        _frame(painter, camera.rect_to_screen(leaf.box))
    corners = np.array([camera.rect_to_screen(box) for box in explanation.boxes])
    painter.rects(corners, np.array([TEXT, TEXT], np.uint8), filled=False)
    (x0, x1), (y0, y1) = camera.to_screen(np.array(explanation.centres))
    painter.lines(np.array([[x0, y0, x1, y1]]), np.array([ACCENT], np.uint8), 2.0)
    free = painter.size[0] - camera.left - camera.right
    sheet = _sheet(explanation.lines, free - 2 * EDGE - 2 * PAD)
    if sheet.get_width() + 2 * EDGE <= free:
        painter.sheet(sheet, (round(camera.left + (free - sheet.get_width()) / 2), EDGE))


def _frame(painter: Painter, rect: Rect) -> None:
    """Outline a leaf with a wider line than in the tree."""
    x0, y0, x1, y1 = rect
    ends = np.array([[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]])
    painter.lines(ends, np.array([ACCENT] * 4, np.uint8), 2.0)


@lru_cache(maxsize=4)
def _sheet(sentences: tuple[str, ...], width: int) -> pygame.Surface:
    """Return the sentences on a card, the first in the brighter colour."""
    face = font(BODY)
    line = face.get_linesize() + LEADING
    lines = [(text, k) for k, one in enumerate(sentences) for text in wrapped(one, width)]
    wide = max(face.size(text)[0] for text, _ in lines)
    sheet = panel((wide + 2 * PAD, len(lines) * line + 2 * PAD - LEADING))
    for row, (text, k) in enumerate(lines):
        write(sheet, (PAD, PAD + row * line), text, TEXT if k == 0 else TEXT_SOFT)
    return sheet
