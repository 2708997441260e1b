"""The boxes of the tree, coloured by level."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle.app.camera import Camera
from jostle.app.painter import Painter
from jostle.app.palette import STAGE, blend, level_colour
from jostle.app.simulation import TreeBoxes

SMALLEST = 3.0  # pixels: finer boxes would only be a grey haze
FILL_SHARE = 0.36  # how much of the level's colour a filled leaf takes


def draw_filled(painter: Painter, tree: TreeBoxes, camera: Camera) -> None:
    """Fill the leaves."""
    corners, levels = _on_screen(tree, camera, tree.is_leaf)
    colours = _colours(tree)
    filled = [blend(STAGE, (r, g, b), FILL_SHARE) for r, g, b in colours.tolist()]
    painter.rects(corners, np.array(filled, np.uint8)[levels], filled=True)


def draw_outline(painter: Painter, tree: TreeBoxes, camera: Camera) -> None:
    """Outline every box, the deepest first, so that the edges of large boxes stay on top."""
    corners, levels = _on_screen(tree, camera, np.ones(len(tree.levels), np.bool_))
    order = np.argsort(-levels, kind="stable")
    painter.rects(corners[order], _colours(tree)[levels[order]], filled=False)


def _colours(tree: TreeBoxes) -> NDArray[np.uint8]:
    depth = int(tree.levels.max(initial=0))
    return np.array([level_colour(level, depth) for level in range(depth + 1)], np.uint8)


def _on_screen(
    tree: TreeBoxes, camera: Camera, wanted: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return the wanted boxes that the view shows, in pixels, and their levels."""
    (x0, y0), (x1, y1) = camera.to_screen(tree.boxes[:, :2]), camera.to_screen(tree.boxes[:, 2:])
    width, height = camera.size
    seen = wanted & (x1 >= 0) & (y1 >= 0) & (x0 <= width) & (y0 <= height)
    seen &= np.maximum(x1 - x0, y1 - y0) >= SMALLEST
    return np.stack([x0, y0, x1, y1], axis=1)[seen], tree.levels[seen]
