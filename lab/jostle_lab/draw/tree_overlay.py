"""The boxes of the tree: outlined, filled by level, or filled by occupancy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import HEAT, STAGE, blend, level_colour
from jostle_lab.draw.text import Legend

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
    painter.rects(corners, np.array(filled, np.uint8)[tree.depths[shown]], filled=True)
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
    corners, shown = _on_screen(tree, camera, np.ones(len(tree.depths), np.bool_))
    if len(shown) == 0:
        return None
    levels = tree.depths[shown]
    edges, owner = _edges(corners, levels)
    levels, sides = levels[owner], np.ptp(corners[:, [0, 2]], axis=1)[owner]
    depth = max(int(tree.depths.max()), 1)
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
    depth = int(tree.depths.max(initial=0))
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
