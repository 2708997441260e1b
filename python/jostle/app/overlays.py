"""The boxes of the tree, coloured by level."""

from __future__ import annotations

from enum import Enum

import numpy as np
import pygame
from numpy.typing import NDArray

from jostle.app.camera import Camera
from jostle.app.palette import STAGE, Colour, blend, level_colour
from jostle.app.simulation import TreeBoxes

SMALLEST = 3.0  # pixels: finer boxes would only be a grey haze
FILL_SHARE = 0.36  # how much of the level's colour a filled leaf takes


class TreeView(Enum):
    """How the tree is shown."""

    OFF = "off"
    OUTLINE = "outline"
    FILLED = "filled"

    def next(self) -> TreeView:
        """Return the view after this one, in a circle."""
        views = list(TreeView)
        return views[(views.index(self) + 1) % len(views)]


def draw_filled(target: pygame.Surface, tree: TreeBoxes, camera: Camera) -> None:
    """Fill the leaves, each a pixel short of its box so that neighbours stay apart."""
    corners, levels = _on_screen(tree, camera, tree.is_leaf)
    colours = [blend(STAGE, colour, FILL_SHARE) for colour in _colours(tree)]
    for (x0, y0, x1, y1), level in zip(corners.tolist(), levels.tolist(), strict=True):
        target.fill(colours[level], (x0, y0, max(x1 - x0 - 1, 1), max(y1 - y0 - 1, 1)))


def draw_outline(target: pygame.Surface, tree: TreeBoxes, camera: Camera) -> None:
    """Outline every box, the deepest first, so that the edges of large boxes stay on top."""
    corners, levels = _on_screen(tree, camera, np.ones(len(tree.levels), np.bool_))
    order = np.argsort(-levels, kind="stable")
    corners, levels = corners[order], levels[order]
    colours = _colours(tree)
    for (x0, y0, x1, y1), level in zip(corners.tolist(), levels.tolist(), strict=True):
        pygame.draw.rect(target, colours[level], (x0, y0, x1 - x0 + 1, y1 - y0 + 1), 1)


def _colours(tree: TreeBoxes) -> list[Colour]:
    depth = int(tree.levels.max(initial=0))
    return [level_colour(level, depth) for level in range(depth + 1)]


def _on_screen(
    tree: TreeBoxes, camera: Camera, wanted: NDArray[np.bool_]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the wanted boxes in whole pixels, clipped just outside the view, and levels."""
    (x0, y0), (x1, y1) = camera.to_screen(tree.boxes[:, :2]), camera.to_screen(tree.boxes[:, 2:])
    width, height = camera.size
    seen = wanted & (x1 >= 0) & (y1 >= 0) & (x0 <= width) & (y0 <= height)
    seen &= np.maximum(x1 - x0, y1 - y0) >= SMALLEST
    columns = [np.clip(x, -2, width + 2) for x in (x0, x1)]
    rows = [np.clip(y, -2, height + 2) for y in (y0, y1)]
    corners = np.stack([columns[0], rows[0], columns[1], rows[1]], axis=1)[seen]
    return np.floor(corners).astype(np.intp), tree.levels[seen]
