"""Horizontal and vertical lines with alpha.

pygame draws no translucent lines, but blits many translucent surfaces fast. So each colour has one
long strip, and a line is a part of it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pygame
from numpy.typing import NDArray

LONGEST = 8192  # pixels


@lru_cache(maxsize=256)
def _strip(colour: tuple[int, int, int, int], upright: bool) -> pygame.Surface:
    strip = pygame.Surface((1, LONGEST) if upright else (LONGEST, 1), pygame.SRCALPHA, 32)
    strip.fill(colour)
    return strip


def draw_axis_lines(
    target: pygame.Surface, ends: NDArray[np.floating], colours: NDArray[np.uint8]
) -> None:
    """Draw lines of one pixel along the axes: (k, 4) as x0, y0, x1, y1, and (k, 4) colours."""
    width, height = target.get_size()
    first, last = np.minimum(ends[:, :2], ends[:, 2:]), np.maximum(ends[:, :2], ends[:, 2:])
    low = np.floor(np.clip(first, -2, [width + 2, height + 2])).astype(np.intp)
    high = np.floor(np.clip(last, -2, [width + 2, height + 2])).astype(np.intp)
    upright = ends[:, 0] == ends[:, 2]
    columns = low.tolist(), high.tolist(), upright.tolist(), colours.tolist()
    pieces = []
    for (x0, y0), (x1, y1), stands, (red, green, blue, alpha) in zip(*columns, strict=True):
        length = min(max(x1 - x0, y1 - y0) + 1, LONGEST)
        piece = (0, 0, 1, length) if stands else (0, 0, length, 1)
        pieces.append((_strip((red, green, blue, alpha), stands), (x0, y0), piece))
    target.blits(pieces, doreturn=False)
