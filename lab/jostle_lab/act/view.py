"""What is drawn of the user's actions: selection, current drag, and explanation of a contact."""

import math

import numpy as np

from jostle_lab.act.explanation import Explanation
from jostle_lab.act.interaction import Drag, Tool
from jostle_lab.act.selection import Selection
from jostle_lab.draw.base_layers import draw_walls
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import ACCENT, KINDS, TEXT, Colour
from jostle_lab.simulate.frame import Frame, Rect

RING_GAP = 3.0  # pixels from a particle to its ring
WIDE = 2.0  # pixels: width of rings, and of lines of an explanation
CORNERS = 28  # of a ring; all rings are drawn as lines in one call
MOST_RINGS = 400  # more are drawn as one box around them
TARGET = 9.0  # pixels: radius of the ring of an attractor that is being placed


def draw_selection(painter: Painter, frame: Frame, selection: Selection, camera: Camera) -> None:
    """Draw a ring around each selected particle."""
    rows = frame.rows(selection.tags)
    if len(rows) == 0:
        return
    x, y = camera.to_screen(frame.positions[rows])
    radii = frame.radii[rows].astype(np.float64) * camera.scale + RING_GAP
    if len(rows) > MOST_RINGS:
        low_x, low_y = float((x - radii).min()), float((y - radii).min())
        high_x, high_y = float((x + radii).max()), float((y + radii).max())
        _box(painter, (low_x, low_y, high_x, high_y), ACCENT)
        return
    angle = np.linspace(0, 2 * math.pi, CORNERS + 1)
    xs = x[:, None] + radii[:, None] * np.cos(angle)
    ys = y[:, None] + radii[:, None] * np.sin(angle)
    ends = np.stack([xs[:, :-1], ys[:, :-1], xs[:, 1:], ys[:, 1:]], axis=-1).reshape(-1, 4)
    painter.lines(ends, ACCENT, WIDE)


def draw_preview(painter: Painter, preview: Drag, camera: Camera) -> None:
    """Draw the effect that the drag will have."""
    ends = np.array([preview.start, preview.end], np.float64)
    (x0, x1), (y0, y1) = (column.tolist() for column in camera.to_screen(ends))
    if preview.tool is Tool.POINTER:
        _box(painter, camera.rect_to_screen(preview.box), ACCENT)
    elif preview.tool is Tool.WALL:
        draw_walls(painter, ends[None], None, camera)
    elif preview.tool is Tool.BRUSH:
        colour = ACCENT if preview.kind is None else KINDS[preview.kind % len(KINDS)]
        painter.circle((x1, y1), preview.reach * camera.scale, colour, WIDE)
    else:
        painter.circle((x0, y0), TARGET, ACCENT, WIDE)
        painter.circle((x0, y0), 2.5, ACCENT)
        reach = math.dist((x0, y0), (x1, y1))
        if reach > TARGET:
            painter.circle((x0, y0), reach, ACCENT, 1.0)
            painter.lines(np.array([[x0, y0, x1, y1]]), ACCENT, 1.0)


def draw_explanation(painter: Painter, explanation: Explanation, camera: Camera) -> None:
    """Draw the leaves, with wider lines than in the tree, the AABBs, and a line between centres."""
    for leaf in explanation.leaves:
        x0, y0, x1, y1 = camera.rect_to_screen(leaf.box)
        sides = [[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]]
        painter.lines(np.array(sides), ACCENT, WIDE)
    for box in explanation.boxes:
        _box(painter, camera.rect_to_screen(box), TEXT)
    (x0, x1), (y0, y1) = camera.to_screen(np.array(explanation.centres))
    painter.lines(np.array([[x0, y0, x1, y1]]), ACCENT, WIDE)


def _box(painter: Painter, rect: Rect, colour: Colour) -> None:
    painter.rects(np.array([rect]), np.array([colour], np.uint8), filled=False)
