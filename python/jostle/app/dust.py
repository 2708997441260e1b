"""Discs smaller than a pixel, written straight into the pixels: a million at a time."""

from __future__ import annotations

import numpy as np
import pygame
from numpy.typing import NDArray

from jostle.app.palette import DISCS

_COLOURS = np.array(DISCS, np.float32)
LEAST = 0.35  # even the smallest disc lights its pixel this much, or sparse dust would vanish


def scatter(
    target: pygame.Surface,
    centers: NDArray[np.float64],
    radii: NDArray[np.floating],
    shades: NDArray[np.uint8],
) -> None:
    """Light the pixel under each disc by the share of it that the disc covers.

    `centers` and `radii` are in pixels; centres outside the target are left out. Several discs in
    a pixel add up to full cover, and the last one gives the colour.
    """
    width, height = target.get_size()
    whole = np.floor(centers).astype(np.int64)
    inside = ((whole >= 0) & (whole < (width, height))).all(axis=1)
    if not inside.any():
        return
    at = whole[inside, 0] + whole[inside, 1] * width
    area = np.maximum(np.pi * radii[inside] ** 2, LEAST)
    cover = np.bincount(at, weights=area, minlength=width * height)
    colour = np.zeros(width * height, np.uint8)
    colour[at] = shades[inside]
    lit = np.flatnonzero(cover)
    x, y = lit % width, lit // width
    pixels = pygame.surfarray.pixels3d(target)
    back = pixels[x, y].astype(np.float32)
    share = np.minimum(cover[lit], 1.0).astype(np.float32)[:, None]
    pixels[x, y] = np.rint(back + (_COLOURS[colour[lit]] - back) * share).astype(np.uint8)
