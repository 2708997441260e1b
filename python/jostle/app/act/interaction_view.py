"""The selection, as rings, and the current drag: a selection box, a wall or an attractor."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from jostle.app.act.selection import Selection
from jostle.app.act.tools import Drag, Tool
from jostle.app.draw.base_layers import draw_walls
from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import ACCENT, Colour, repeated
from jostle.app.simulate.simulation import Frame, Rect

RING_GAP = 3.0  # pixels from a particle to its ring
RING_WIDTH = 2.0
CORNERS = 28  # of a ring; all rings are drawn as lines in one call
MOST_RINGS = 400  # more are drawn as one box around them
TARGET = 9.0  # pixels: radius of the ring of an attractor that is being placed


def draw_interaction(
    painter: Painter, frame: Frame, selection: Selection, preview: Drag | None, camera: Camera
) -> None:
    """Draw the selection and the current drag."""
    draw_selection(painter, frame, selection, camera)
    if preview is not None:
        draw_preview(painter, preview, camera)


def draw_selection(painter: Painter, frame: Frame, selection: Selection, camera: Camera) -> None:
    """Draw a ring around each selected particle."""
    rows = frame.rows(selection.tags)
    if len(rows) == 0:
        return
    x, y = camera.to_screen(frame.positions[rows])
    radii = frame.radii[rows].astype(np.float64) * camera.scale + RING_GAP
    if len(rows) <= MOST_RINGS:
        _rings(painter, x, y, radii, ACCENT)
    else:
        low_x, low_y = float((x - radii).min()), float((y - radii).min())
        high_x, high_y = float((x + radii).max()), float((y + radii).max())
        _box(painter, (low_x, low_y, high_x, high_y), ACCENT)


def draw_preview(painter: Painter, preview: Drag, camera: Camera) -> None:
    """Draw the effect that the drag will have."""
    x, y = camera.to_screen(np.array([preview.start, preview.end], np.float64))
    (x0, x1), (y0, y1) = x.tolist(), y.tolist()
    if preview.tool is Tool.POINTER:
        _box(painter, (min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)), ACCENT)
    elif preview.tool is Tool.WALL:
        ends = np.array([preview.start, preview.end], np.float64)
        draw_walls(painter, ends[None], None, camera)
    else:
        painter.circle((x0, y0), TARGET, ACCENT, RING_WIDTH)
        painter.circle((x0, y0), 2.5, ACCENT)
        reach = math.dist((x0, y0), (x1, y1))
        if reach > TARGET:
            painter.circle((x0, y0), reach, ACCENT, 1.0)
            painter.lines(np.array([[x0, y0, x1, y1]]), repeated(ACCENT, 1), 1.0)


def _box(painter: Painter, rect: Rect, colour: Colour) -> None:
    painter.rects(np.array([rect]), repeated(colour, 1), filled=False)


def _rings(
    painter: Painter,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    radii: NDArray[np.float64],
    colour: Colour,
) -> None:
    angle = np.linspace(0, 2 * math.pi, CORNERS + 1)
    xs = x[:, None] + radii[:, None] * np.cos(angle)
    ys = y[:, None] + radii[:, None] * np.sin(angle)
    ends = np.stack([xs[:, :-1], ys[:, :-1], xs[:, 1:], ys[:, 1:]], axis=-1).reshape(-1, 4)
    painter.lines(ends, repeated(colour, len(ends)), RING_WIDTH)
