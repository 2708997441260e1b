"""The background, the walls and the discs; and the boxes of the tree: outlined or filled."""

import numpy as np
import pygame
from numpy.typing import NDArray

import jostle
from jostle_lab.draw import palette
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter, on_canvas
from jostle_lab.draw.palette import HEAT, STAGE, blend, level_colour
from jostle_lab.draw.text import Legend
from jostle_lab.simulate.containers import bounds, wall_images
from jostle_lab.simulate.frame import Frame, Rect
from jostle_lab.simulate.region import Container, Torus

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
        (x,), (y,) = camera.to_screen(container.center[None])
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
    if rect is not None and isinstance(container, Torus):
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


SMALLEST = 3.0  # pixels; smaller boxes are not drawn
WHOLE = 40.0  # pixels; smaller boxes are fainter
STRONGEST, WEAKEST = 0.9, 0.28  # alpha of the root's outline, and of the deepest level's
FILL_SHARE = 0.36  # fraction of the level's colour in a filled leaf
FULLEST = 0.98  # quantile of the counts at the last colour

Boxes = NDArray[np.float64]


def draw_filled(painter: Painter, tree: jostle.Nodes, camera: Camera) -> Legend | None:
    """Fill the leaves by their level."""
    corners, shown = _on_screen(tree, camera, tree.is_leaf)
    filled = [blend(STAGE, (r, g, b), FILL_SHARE) for r, g, b in _colours(tree).tolist()]
    painter.rects(corners, np.array(filled, np.uint8)[tree.levels[shown]], filled=True)
    return None


def draw_heat(painter: Painter, tree: jostle.Nodes, camera: Camera) -> Legend | None:
    """Fill the leaves by their number of particles; return the legend."""
    corners, shown = _on_screen(tree, camera, tree.is_leaf)
    counts = tree.counts[tree.is_leaf]
    if len(counts) == 0:
        return None
    top = max(float(np.quantile(counts, FULLEST)), 1.0)
    step = np.clip(tree.counts[shown] / top * len(HEAT), 0, len(HEAT) - 1).astype(np.intp)
    painter.rects(corners, np.array(HEAT, np.uint8)[step], filled=True)
    return Legend("particles in a leaf", "0", f"{top:,.0f}", tuple(HEAT))


def draw_outline(painter: Painter, tree: jostle.Nodes, camera: Camera) -> Legend | None:
    """Outline every box; deep levels and small boxes are fainter."""
    corners, shown = _on_screen(tree, camera, np.ones(len(tree.levels), np.bool_))
    if len(shown) == 0:
        return None
    levels = tree.levels[shown]
    edges, owner = _edges(corners, levels)
    levels, sides = levels[owner], np.ptp(corners[:, [0, 2]], axis=1)[owner]
    depth = max(int(tree.levels.max()), 1)
    strength = STRONGEST + (WEAKEST - STRONGEST) * np.sqrt(levels / depth)
    strength *= np.clip((sides - SMALLEST) / (WHOLE - SMALLEST), 0.12, 1.0)
    alpha = np.rint(16 * strength) * 255 / 16  # few colours, which painters can cache
    colours = np.column_stack([_colours(tree)[levels], alpha]).astype(np.uint8)
    lines, first = _joined(edges, levels * 256 + alpha.astype(np.intp))
    order = np.argsort(-levels[first], kind="stable")  # large boxes last
    painter.lines(lines[order], colours[first[order]])
    return None


def _joined(edges: Boxes, tones: NDArray[np.intp]) -> tuple[Boxes, NDArray[np.intp]]:
    """Join collinear adjacent edges of one colour: one long line is drawn faster than many.

    Returns the lines, and for each the first of its edges.
    """
    level = edges[:, 1] == edges[:, 3]
    begin, fixed = np.where(level, edges[:, :2].T, edges[:, 1::-1].T)
    end = np.where(level, edges[:, 2], edges[:, 3])
    order = np.lexsort((begin, tones, fixed, level))
    goes_on = begin[order[1:]] == end[order[:-1]]
    for column in (level, fixed, tones):
        goes_on &= column[order[1:]] == column[order[:-1]]
    first = order[np.append(True, ~goes_on)]
    last = order[np.append(~goes_on, True)]
    return np.concatenate([edges[first, :2], edges[last, 2:]], axis=1), first


def _edges(corners: Boxes, levels: NDArray[np.intp]) -> tuple[Boxes, NDArray[np.intp]]:
    """Return the edges of boxes in whole pixels, and the box of each.

    An edge that two neighbours share is returned once.
    """
    x0, y0, x1, y1 = np.clip(np.floor(corners), -4, 16_000).T
    sides = (x0, y0, x1, y0), (x0, y1, x1, y1), (x0, y0, x0, y1), (x1, y0, x1, y1)
    edges = np.concatenate([np.column_stack(ends) for ends in sides])
    owner = np.tile(np.arange(len(corners)), 4)
    order = np.argsort(levels[owner], kind="stable")  # of equal edges, that of the largest box
    numbers = (edges[order] + 4).astype(np.int64)
    keys = numbers @ np.array([1 << 48, 1 << 32, 1 << 16, 1])
    once = order[np.unique(keys, return_index=True)[1]]
    return edges[once], owner[once]


def _colours(tree: jostle.Nodes) -> NDArray[np.uint8]:
    depth = int(tree.levels.max(initial=0))
    return np.array([level_colour(level, depth) for level in range(depth + 1)], np.uint8)


def _on_screen(
    tree: jostle.Nodes, camera: Camera, wanted: NDArray[np.bool_]
) -> tuple[Boxes, NDArray[np.intp]]:
    """Return the wanted boxes in the view, in pixels, and their rows."""
    (x0, y0), (x1, y1) = camera.to_screen(tree.boxes[:, :2]), camera.to_screen(tree.boxes[:, 2:])
    width, height = camera.size
    seen = wanted & (x1 >= 0) & (y1 >= 0) & (x0 <= width) & (y0 <= height)
    seen &= np.maximum(x1 - x0, y1 - y0) >= SMALLEST
    return np.stack([x0, y0, x1, y1], axis=1)[seen], np.flatnonzero(seen)
