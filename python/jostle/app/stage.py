"""The ground, the walls and the discs: what every picture begins with."""

from __future__ import annotations

import numpy as np
import pygame
from numpy.typing import NDArray

import jostle
from jostle.app.camera import Camera
from jostle.app.painter import Painter
from jostle.app.palette import FIXED, GROUND, STAGE, WALL
from jostle.app.simulation import Container, Frame, Rect
from jostle.app.walls import bounds

WALL_WIDTH = 2
NEARLY = 1.05  # radii, within which immovable discs count as one wall
MOST_LINKS = 2_000  # between them; more are drawn as discs alone
FAR = 30_000  # pixels; what lies beyond is clipped to this before it becomes whole pixels


def draw_stage(painter: Painter, container: Container, camera: Camera) -> None:
    """Clear the canvas and draw the walls."""
    painter.fill(GROUND)
    walls = bounds(container)
    if walls is None:
        painter.fill(STAGE)
    elif isinstance(container, jostle.Circle):
        (x,), (y,) = camera.to_screen(np.array([container.center], np.float64))
        radius = container.radius * camera.scale
        painter.circle((x, y), radius + WALL_WIDTH, WALL)
        painter.circle((x, y), radius, STAGE)
    else:
        inside = rect_on_screen(walls, camera)
        both = np.array(
            [_corners(inside.inflate(2 * WALL_WIDTH, 2 * WALL_WIDTH)), _corners(inside)]
        )
        painter.rects(both, np.array([WALL, STAGE], np.uint8), filled=True)


def draw_discs(painter: Painter, frame: Frame, shades: NDArray[np.uint8], camera: Camera) -> None:
    """Draw the particles."""
    x, y = camera.to_screen(frame.positions)
    painter.discs(x, y, frame.radii.astype(np.float64) * camera.scale, shades)


class Beads:
    """Immovable discs in a row: drawn as one wall, not as a string of beads.

    Which of them touch is asked again only when they have changed.
    """

    def __init__(self) -> None:
        self._asked = np.empty((0, 3), np.float32)
        self._pairs = np.empty((0, 2), np.uint32)

    def draw(self, painter: Painter, frame: Frame, camera: Camera) -> None:
        """Fill the gaps between immovable discs that touch, but for their outer corners."""
        if frame.movable.all():
            return
        fixed = np.flatnonzero(~frame.movable)
        asked = np.column_stack([frame.positions[fixed], frame.radii[fixed]])
        if not np.array_equal(asked, self._asked):
            reach = asked[:, 2] * np.float32(NEARLY)
            self._asked, self._pairs = asked, jostle.find_pairs(asked[:, :2], reach)
        if len(self._pairs) == 0 or len(self._pairs) > MOST_LINKS:
            return
        x, y = camera.to_screen(asked[:, :2])
        first, second = self._pairs[:, 0], self._pairs[:, 1]
        widths = 2 * np.minimum(asked[first, 2], asked[second, 2]) * camera.scale
        ends = np.column_stack([x[first], y[first], x[second], y[second]])
        seen = (np.abs(ends) < FAR).all(axis=1) & (widths >= 1)
        for width in np.unique(np.rint(widths[seen])).tolist():
            mine = ends[seen & (np.rint(widths) == width)]
            painter.lines(mine, np.tile(np.array(FIXED, np.uint8), (len(mine), 1)), width)


def rect_on_screen(rect: Rect, camera: Camera) -> pygame.Rect:
    """Return a rectangle in whole pixels, clipped far outside of every screen."""
    x0, y0, x1, y1 = (max(-FAR, min(FAR, round(c))) for c in camera.rect_to_screen(rect))
    return pygame.Rect(x0, y0, x1 - x0, y1 - y0)


def _corners(rect: pygame.Rect) -> Rect:
    """Return the corners such that a filled rectangle covers the whole of it."""
    return rect.left, rect.top, rect.right + 1, rect.bottom + 1
