"""The shapes of the explanation of a contact, drawn over the scene."""

from __future__ import annotations

import numpy as np

from jostle.app.act.explanation import Explanation
from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import ACCENT, TEXT
from jostle.app.simulate.simulation import Rect

LEAVES = 24  # drawn at most; the article's tree may have many more


def draw_explanation(painter: Painter, explanation: Explanation, camera: Camera) -> None:
    """Draw the leaves, the AABBs, and the line between the centres."""
    for leaf in explanation.leaves[:LEAVES]:
        _frame(painter, camera.rect_to_screen(leaf.box))
    corners = np.array([camera.rect_to_screen(box) for box in explanation.boxes])
    painter.rects(corners, np.array([TEXT, TEXT], np.uint8), filled=False)
    (x0, x1), (y0, y1) = camera.to_screen(np.array(explanation.centres))
    painter.lines(np.array([[x0, y0, x1, y1]]), np.array([ACCENT], np.uint8), 2.0)


def _frame(painter: Painter, rect: Rect) -> None:
    """Outline a leaf with a wider line than in the tree."""
    x0, y0, x1, y1 = rect
    ends = np.array([[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]])
    painter.lines(ends, np.array([ACCENT] * 4, np.uint8), 2.0)
