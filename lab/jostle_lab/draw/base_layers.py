"""The background, the walls and the discs, which are the lowest layers of every picture."""

from __future__ import annotations

import numpy as np
import pygame
from numpy.typing import NDArray

import jostle
from jostle_lab.draw import palette
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter, on_canvas
from jostle_lab.simulate.containers import bounds, wall_images
from jostle_lab.simulate.frame import Container, Frame, Rect

CONTAINER_WIDTH = 2
SEGMENT_WIDTH = 3
NEARLY = 1.05  # diameters, up to which neighbouring immovable discs form a wall
STRAIGHT = 1 - 1e-7  # cosine between segments of a row; less in a ring of up to 14,000 discs
MOST_SENSORS = 2_000  # drawn
FAR = 30_000  # pixels; larger coordinates are clipped before they are rounded


def draw_container(painter: Painter, container: Container, camera: Camera) -> None:
    """Clear the canvas and draw the container."""
    painter.fill(palette.GROUND)
    walls = bounds(container)
    if walls is None:
        painter.fill(palette.STAGE)
    elif isinstance(container, jostle.Circle):
        (x,), (y,) = camera.to_screen(np.array([container.center], np.float64))
        radius = container.radius * camera.scale
        painter.circle((x, y), radius + CONTAINER_WIDTH, palette.WALL)
        painter.circle((x, y), radius, palette.STAGE)
    else:
        inside = rect_on_screen(walls, camera)
        outside = inside.inflate(2 * CONTAINER_WIDTH, 2 * CONTAINER_WIDTH)
        both = np.array([_corners(outside), _corners(inside)])
        painter.rects(both, np.array([palette.WALL, palette.STAGE], np.uint8), filled=True)


def draw_discs(painter: Painter, frame: Frame, shades: NDArray[np.uint8], camera: Camera) -> None:
    x, y = camera.to_screen(frame.positions)
    radii = frame.radii.astype(np.float64) * camera.scale
    if frame.sensors is None:
        painter.discs(x, y, radii, shades)
        return
    solid = frame.sensors == 0
    painter.discs(x[solid], y[solid], radii[solid], shades[solid])
    seen = ~solid & on_canvas(painter.size, x, y, radii)
    for row in np.flatnonzero(seen)[:MOST_SENSORS]:
        colour = palette.SENSOR if frame.sensors[row] == 1 else palette.TOUCHED_SENSOR
        painter.circle((float(x[row]), float(y[row])), float(radii[row]), colour, 1.5)


def draw_walls(
    painter: Painter, walls: NDArray[np.floating], container: Container, camera: Camera
) -> None:
    """Draw line segments, (m, 2, 2) in world units; on a torus their images inside it."""
    if len(walls) == 0:
        return
    images, _ = wall_images(container, walls)
    x, y = camera.to_screen(images.reshape(-1, 2).astype(np.float64))
    ends = _clipped(np.column_stack([x, y]).reshape(-1, 2, 2), (-FAR, -FAR, FAR, FAR))
    rect = bounds(container)
    if rect is not None and isinstance(container, jostle.Torus):
        ends = _clipped(ends, camera.rect_to_screen(rect))
    painter.lines(ends.reshape(-1, 4), palette.FIXED, SEGMENT_WIDTH)


def _clipped(ends: NDArray[np.float64], rect: Rect) -> NDArray[np.float64]:
    """Return the parts of segments in a rectangle."""
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    low, high = np.array(rect[:2]), np.array(rect[2:])
    with np.errstate(divide="ignore", invalid="ignore"):
        first, last = (low - start) / along, (high - start) / along
    enter = np.fmax(np.fmin(first, last).max(axis=1), 0.0)
    leave = np.fmin(np.fmax(first, last).min(axis=1), 1.0)
    inside = (enter < leave) & ((along != 0) | (low <= start) & (start <= high)).all(axis=1)
    shares = np.stack([enter, leave], axis=1)[inside]
    clipped: NDArray[np.float64] = start[inside, None] + shares[..., None] * along[inside, None]
    return clipped


def draw_wall_discs(painter: Painter, frame: Frame, camera: Camera) -> None:
    """Draw each straight row of touching immovable discs of equal size as one thick line."""
    solid = True if frame.sensors is None else frame.sensors == 0
    fixed = np.flatnonzero(~frame.movable & solid)
    if len(fixed) < 2:
        return
    places, radii = frame.positions[fixed].astype(np.float64), frame.radii[fixed]
    steps = np.diff(places, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    linked = (lengths > 0) & (lengths <= NEARLY * 2 * radii[1:]) & (radii[1:] == radii[:-1])
    directions = steps / np.maximum(lengths, 1e-30)[:, None]
    straight = (directions[1:] * directions[:-1]).sum(axis=1) > STRAIGHT
    goes_on = linked[1:] & linked[:-1] & straight
    first = np.flatnonzero(linked & ~np.append(False, goes_on))
    last = np.flatnonzero(linked & ~np.append(goes_on, False)) + 1
    ends = camera.lines_to_screen(places[first], places[last])
    widths = np.rint(2 * radii[first] * camera.scale)
    seen = (np.abs(ends) < FAR).all(axis=1) & (widths >= 1)
    for width in np.unique(widths[seen]).tolist():
        painter.lines(ends[seen & (widths == width)], palette.FIXED, width)


def rect_on_screen(rect: Rect, camera: Camera) -> pygame.Rect:
    """Return a rectangle in whole pixels, clipped to `FAR`."""
    x0, y0, x1, y1 = (max(-FAR, min(FAR, round(c))) for c in camera.rect_to_screen(rect))
    return pygame.Rect(x0, y0, x1 - x0, y1 - y0)


def _corners(rect: pygame.Rect) -> Rect:
    """Return the corners that a painter fills completely."""
    return rect.left, rect.top, rect.right + 1, rect.bottom + 1
