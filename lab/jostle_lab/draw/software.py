"""The painter without a graphics card.

Discs are circles, stamps or points, depending on their radius in pixels. pygame draws no
translucent lines, but blits many translucent surfaces fast. So lines along the axes are parts of
one long strip for each colour.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pygame
from numpy.typing import NDArray

from jostle_lab.draw.camera import Size
from jostle_lab.draw.discs import MAX_POINT, MAX_STAMP, RIM_SHADE, RIM_WIDTH, Stamps, scatter
from jostle_lab.draw.painter import Colours, Floats, Shades, on_canvas, whole_pixels
from jostle_lab.draw.palette import DISCS, STAGE, Colour, blend

LONGEST = 8192  # pixels
CIRCLE_LIMIT = 4000.0  # pixels; pygame's circles cost time in proportion to their radius


def empty_canvas(size: Size) -> pygame.Surface:
    """Return a canvas with the same byte order, and so the same videos, on every machine."""
    return pygame.Surface(size, 0, 32, (0xFF0000, 0xFF00, 0xFF, 0))


@lru_cache(maxsize=256)
def _strip(colour: tuple[int, int, int, int], upright: bool) -> pygame.Surface:
    strip = pygame.Surface((1, LONGEST) if upright else (LONGEST, 1), pygame.SRCALPHA, 32)
    strip.fill(colour)
    return strip


def draw_axis_lines(
    target: pygame.Surface, ends: NDArray[np.floating], colours: NDArray[np.uint8]
) -> None:
    """Draw lines of one pixel along the axes: (k, 4) as x0, y0, x1, y1, and (k, 4) colours."""
    low, high = np.minimum(ends[:, :2], ends[:, 2:]), np.maximum(ends[:, :2], ends[:, 2:])
    whole = whole_pixels(target.get_size(), np.column_stack([low, high]))
    columns = whole.tolist(), (ends[:, 0] == ends[:, 2]).tolist(), colours.tolist()
    pieces = []
    for (x0, y0, x1, y1), upright, (red, green, blue, alpha) in zip(*columns, strict=True):
        length = min(max(x1 - x0, y1 - y0) + 1, LONGEST)
        piece = (0, 0, 1, length) if upright else (0, 0, length, 1)
        pieces.append((_strip((red, green, blue, alpha), upright), (x0, y0), piece))
    target.blits(pieces, doreturn=False)


class SoftwarePainter:
    """A surface to draw on, with a cache of stamps."""

    name = "software"

    def __init__(self, size: Size) -> None:
        self._stamps = Stamps()
        self.resize(size)

    def resize(self, size: Size) -> None:
        self.size = max(size[0], 1), max(size[1], 1)
        self._canvas = empty_canvas(self.size)

    def canvas(self) -> pygame.Surface:
        return self._canvas

    def clip(self, rect: pygame.Rect | None) -> None:
        self._canvas.set_clip(rect)

    def fill(self, colour: Colour) -> None:
        self._canvas.fill(colour)

    def discs(self, x: Floats, y: Floats, radii: Floats, shades: Shades) -> None:
        seen = on_canvas(self.size, x, y, radii)
        if not seen.all():
            x, y, radii, shades = x[seen], y[seen], radii[seen], shades[seen]
        kind = np.digitize(radii, (MAX_POINT, MAX_STAMP), right=True)
        for number, draw in ((2, _draw_large), (1, self._stamps.blit), (0, scatter)):
            mine = kind == number
            if mine.all():
                draw(self._canvas, x, y, radii, shades)
            elif mine.any():
                draw(self._canvas, x[mine], y[mine], radii[mine], shades[mine])

    def circle(
        self, center: tuple[float, float], radius: float, colour: Colour, width: float = 0.0
    ) -> None:
        if width <= 0:
            _draw_circle(self._canvas, center, radius, colour)
        elif 0 < radius <= CIRCLE_LIMIT:
            pygame.draw.aacircle(self._canvas, colour, center, radius, max(round(width), 1))

    def rects(self, corners: Floats, colours: Colours, *, filled: bool) -> None:
        if len(corners) == 0:
            return
        whole = whole_pixels(self.size, corners).tolist()
        for (x0, y0, x1, y1), colour in zip(whole, colours.tolist(), strict=True):
            if filled:
                self._canvas.fill(colour, (x0, y0, max(x1 - x0 - 1, 1), max(y1 - y0 - 1, 1)))
            else:
                pygame.draw.rect(self._canvas, colour, (x0, y0, x1 - x0 + 1, y1 - y0 + 1), 1)

    def lines(self, ends: Floats, colours: Colours | Colour, width: float = 1.0) -> None:
        """Draw lines; those along the axes are blended, others mixed with the background."""
        tints = np.broadcast_to(colours, (len(ends), np.shape(colours)[-1]))
        if tints.shape[1] == 4:
            along = (ends[:, :2] == ends[:, 2:]).any(axis=1) & (width <= 1)
            if along.any():
                draw_axis_lines(self._canvas, ends[along], tints[along])
                ends, tints = ends[~along], tints[~along]
            mixed = STAGE + (tints[:, :3] - np.array(STAGE, float)) * (tints[:, 3:] / 255)
            tints = np.rint(mixed).astype(np.uint8)
        thick = max(round(width), 1)
        for (x0, y0, x1, y1), colour in zip(ends.tolist(), tints.tolist(), strict=True):
            pygame.draw.aaline(self._canvas, colour, (x0, y0), (x1, y1), thick)

    def sheet(self, surface: pygame.Surface, place: tuple[float, float]) -> None:
        self._canvas.blit(surface, (round(place[0]), round(place[1])))

    def show(self) -> None:
        window = pygame.display.get_surface()
        if window is not None:
            window.blit(self._canvas, (0, 0))

    def release(self) -> None:
        """Release nothing: there is only memory."""


def _draw_large(
    target: pygame.Surface, x: Floats, y: Floats, radii: Floats, shades: Shades
) -> None:
    columns = x.tolist(), y.tolist(), radii.tolist(), shades.tolist()
    for at_x, at_y, radius, shade in zip(*columns, strict=True):
        colour = DISCS[shade]
        _draw_circle(target, (at_x, at_y), radius, blend((0, 0, 0), colour, RIM_SHADE))
        _draw_circle(target, (at_x, at_y), radius - RIM_WIDTH, colour)


def _draw_circle(
    target: pygame.Surface, center: tuple[float, float], radius: float, colour: Colour
) -> None:
    """Draw a filled circle of any size."""
    if radius <= CIRCLE_LIMIT:
        if radius > 0:
            pygame.draw.aacircle(target, colour, center, radius)
        return
    # Very large: its edge is almost straight, so each pixel is tested.
    width, height = target.get_size()
    x = np.arange(width) + 0.5 - center[0]
    y = np.arange(height) + 0.5 - center[1]
    inside = (x * x)[:, None] + (y * y)[None, :] <= radius * radius
    pygame.surfarray.pixels3d(target)[inside] = colour
