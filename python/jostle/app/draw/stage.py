"""The background, the walls and the discs, which are the lowest layers of every picture."""

from __future__ import annotations

import numpy as np
import pygame
from numpy.typing import NDArray

import jostle
from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import FIXED, GROUND, SENSOR, STAGE, TOUCHED_SENSOR, WALL
from jostle.app.simulate.simulation import Container, Frame, Rect
from jostle.app.simulate.walls import bounds

WALL_WIDTH = 2
SEGMENT_WIDTH = 3
NEARLY = 1.05  # diameters, within which immovable discs count as one wall
STRAIGHT = 0.9999  # cosine between the first step of a run and any other
MOST_SENSORS = 2_000  # drawn
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
    radii = frame.radii.astype(np.float64) * camera.scale
    if frame.sensors is None:
        painter.discs(x, y, radii, shades)
        return
    solid = frame.sensors == 0
    painter.discs(x[solid], y[solid], radii[solid], shades[solid])
    inside = (x + radii > 0) & (x - radii < camera.size[0])
    inside &= (y + radii > 0) & (y - radii < camera.size[1])
    for row in np.flatnonzero(~solid & inside)[:MOST_SENSORS]:
        colour = SENSOR if frame.sensors[row] == 1 else TOUCHED_SENSOR
        painter.circle((float(x[row]), float(y[row])), float(radii[row]), colour, 1.5)


def draw_walls(painter: Painter, walls: NDArray[np.floating], camera: Camera) -> None:
    """Draw line segments, (m, 2, 2) in world units."""
    if len(walls) == 0:
        return
    x, y = camera.to_screen(walls.reshape(-1, 2).astype(np.float64))
    ends = _clipped(np.column_stack([x, y]).reshape(-1, 2, 2))
    colours = np.tile(np.array(FIXED, np.uint8), (len(ends), 1))
    painter.lines(ends.reshape(-1, 4), colours, SEGMENT_WIDTH)


def _clipped(ends: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the parts of segments within `FAR` of the origin; others are left out."""
    start, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        first, last = (np.array([-FAR, FAR])[:, None, None] - start) / way
    enter = np.fmax(np.fmin(first, last).max(axis=1), 0.0)
    leave = np.fmin(np.fmax(first, last).min(axis=1), 1.0)
    inside = (enter < leave) & ((way != 0) | (np.abs(start) <= FAR)).all(axis=1)
    shares = np.stack([enter, leave], axis=1)[inside]
    clipped: NDArray[np.float64] = start[inside, None] + shares[..., None] * way[inside, None]
    return clipped


class Beads:
    """Immovable discs in a row: drawn as one wall, not as a string of beads.

    Where they lie in a row is looked for again only when they have changed.
    """

    def __init__(self) -> None:
        self._asked = np.empty((0, 3), np.float32)
        self._runs: list[tuple[int, int]] = []

    def draw(self, painter: Painter, frame: Frame, camera: Camera) -> None:
        """Draw each straight run of immovable discs as one thick line over them."""
        if frame.movable.all():
            return
        solid = True if frame.sensors is None else frame.sensors == 0
        fixed = np.flatnonzero(~frame.movable & solid)
        asked = np.column_stack([frame.positions[fixed], frame.radii[fixed]])
        if not np.array_equal(asked, self._asked):
            self._asked, self._runs = asked, _runs(asked)
        if not self._runs:
            return
        first, last = np.array(self._runs).T
        x, y = camera.to_screen(asked[:, :2])
        ends = np.column_stack([x[first], y[first], x[last], y[last]])
        widths = np.rint(2 * asked[first, 2] * camera.scale)
        seen = (np.abs(ends) < FAR).all(axis=1) & (widths >= 1)
        for width in np.unique(widths[seen]).tolist():
            mine = ends[seen & (widths == width)]
            painter.lines(mine, np.tile(np.array(FIXED, np.uint8), (len(mine), 1)), width)


def _runs(discs: NDArray[np.float32]) -> list[tuple[int, int]]:
    """Return the first and last of all that lie in a row, each touching the next, equal in size."""
    steps = np.diff(discs[:, :2].astype(np.float64), axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    radii = discs[:, 2]
    linked = (lengths > 0) & (lengths <= NEARLY * 2 * radii[1:]) & (radii[1:] == radii[:-1])
    ways = steps / np.maximum(lengths, 1e-30)[:, None]
    runs: list[tuple[int, int]] = []
    way: tuple[float, float] | None = None  # of the run that ends at this disc
    for k, (joined, (x, y)) in enumerate(zip(linked.tolist(), ways.tolist(), strict=True)):
        if not joined:
            way = None
        elif way is not None and way[0] * x + way[1] * y > STRAIGHT:
            runs[-1] = runs[-1][0], k + 1
        else:
            way = x, y
            runs.append((k, k + 1))
    return runs


def rect_on_screen(rect: Rect, camera: Camera) -> pygame.Rect:
    """Return a rectangle in whole pixels, clipped far outside of every screen."""
    x0, y0, x1, y1 = (max(-FAR, min(FAR, round(c))) for c in camera.rect_to_screen(rect))
    return pygame.Rect(x0, y0, x1 - x0, y1 - y0)


def _corners(rect: pygame.Rect) -> Rect:
    """Return the corners such that a filled rectangle covers the whole of it."""
    return rect.left, rect.top, rect.right + 1, rect.bottom + 1
