"""A cache of small pictures of discs, one per radius, colour and sub-pixel position.

Blitting a picture takes a fraction of the time of drawing a circle. With sub-pixel positions slow
discs move smoothly.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pygame
from numpy.typing import NDArray

from jostle.app.draw.painter import Floats, Shades
from jostle.app.draw.palette import DISCS

MAX_RADIUS = 48.0  # pixels; larger discs are drawn as circles
STEPS = 8  # radii per pixel
PLACES = 4  # sub-pixel positions per axis for small discs
FINE_BELOW, COARSE_BELOW = 12.0, 24.0  # radius: 4 positions, then 2, then 1
RIM_FROM = 3.0  # radius; larger discs have a darker rim
RIM_SHADE, RIM_WIDTH = 0.68, 1.4
BATCH = 4096  # discs per call; between calls other threads may run
MEMORY_LIMIT = 96 * 2**20  # bytes of stamps, then the cache is cleared

_BUCKETS = int(MAX_RADIUS * STEPS) + 1
_SHADES = len(DISCS)
_CELLS = PLACES * PLACES


class Stamps:
    """The cache, filled on demand."""

    def __init__(self) -> None:
        radii = np.arange(_BUCKETS) / STEPS
        self._places = np.select([radii < FINE_BELOW, radii < COARSE_BELOW], [PLACES, 2], 1)
        self._half = np.ceil(radii).astype(np.intp) + 1
        self._clear()

    def _clear(self) -> None:
        not_yet = pygame.Surface((1, 1), pygame.SRCALPHA, 32)
        self._table = np.full(_BUCKETS * _SHADES * _CELLS, not_yet, object)
        self._have = np.zeros(len(self._table), np.bool_)
        self.bytes = 0  # memory of all stamps

    def blit(
        self, target: pygame.Surface, x: Floats, y: Floats, radii: Floats, shades: Shades
    ) -> None:
        """Draw discs with radii up to MAX_RADIUS, in pixels."""
        if self.bytes > MEMORY_LIMIT:
            self._clear()
        buckets = np.rint(radii * STEPS).astype(np.intp)
        places, half = self._places[buckets], self._half[buckets]
        column, row = np.floor(x).astype(np.intp), np.floor(y).astype(np.intp)
        across = ((x - column) * places).astype(np.intp)
        down = ((y - row) * places).astype(np.intp)
        keys = (buckets * _SHADES + shades) * _CELLS + down * places + across
        self._fill(keys)
        left, top = column - half, row - half
        for start in range(0, len(keys), BATCH):
            part = slice(start, start + BATCH)
            stamps = self._table[keys[part]].tolist()
            corners = zip(left[part].tolist(), top[part].tolist(), strict=True)
            # An iterator: making a list of tuples would take as long as the blits.
            target.fblits(zip(stamps, corners, strict=True), pygame.BLEND_PREMULTIPLIED)

    def _fill(self, keys: NDArray[np.intp]) -> None:
        """Make the missing stamps."""
        missing = keys[~self._have[keys]]
        for key in np.unique(missing).tolist():
            rest, cell = divmod(key, _CELLS)
            bucket, shade = divmod(rest, _SHADES)
            places = int(self._places[bucket])
            offset = (cell % places + 0.5) / places, (cell // places + 0.5) / places
            stamp = _white_disc(bucket / STEPS, int(self._half[bucket]), offset).copy()
            stamp.fill(DISCS[shade], special_flags=pygame.BLEND_RGB_MULT)
            self._table[key] = stamp
            self.bytes += stamp.get_pitch() * stamp.get_height()
        self._have[missing] = True


@lru_cache(maxsize=1024)
def _white_disc(radius: float, half: int, offset: tuple[float, float]) -> pygame.Surface:
    """Return an antialiased white disc, premultiplied; its centre is `half + offset`."""
    pixels = np.arange(2 * half) + 0.5 - half
    distance = np.hypot((pixels - offset[0])[:, None], (pixels - offset[1])[None, :])
    coverage = np.clip(radius + 0.5 - distance, 0.0, 1.0)
    light = np.ones_like(distance)
    if radius >= RIM_FROM:
        inside = np.clip((radius - distance) / RIM_WIDTH, 0.0, 1.0)
        light = RIM_SHADE + (1 - RIM_SHADE) * inside
    surface = pygame.Surface((2 * half, 2 * half), pygame.SRCALPHA, 32)
    pygame.surfarray.pixels3d(surface)[:] = np.rint(255 * coverage * light)[:, :, None]
    pygame.surfarray.pixels_alpha(surface)[:] = np.rint(255 * coverage)
    return surface
