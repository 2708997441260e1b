"""The painter without a graphics card.

Discs are circles, stamps or points, depending on their radius in pixels. pygame draws no
translucent lines, but blits many translucent surfaces fast. So lines along the axes are parts of
one long strip for each colour.

A stamp is a small picture, one per radius, colour and sub-pixel position. Blitting one takes a
fraction of the time of drawing a circle, and slow discs move smoothly. Discs of up to two pixels
are written into the pixels as arrays: their coverage is summed, and each pixel is blended once.
"""

import math
from functools import lru_cache

import numpy as np
import pygame
from numpy.typing import NDArray

from jostle_lab.draw.camera import Size
from jostle_lab.draw.painter import Colours, Floats, Shades, on_canvas, whole_pixels
from jostle_lab.draw.palette import DISCS, STAGE, Colour, blend

MAX_STAMP = 48.0  # pixels; larger discs are drawn as circles
STEPS = 8  # radii per pixel
PLACES = 4  # sub-pixel positions per axis for small discs
FINE_BELOW, COARSE_BELOW = 12.0, 24.0  # radius: 4 positions, then 2, then 1
RIM_FROM = 3.0  # radius; larger discs have a darker rim
RIM_SHADE, RIM_WIDTH = 0.68, 1.4
BATCH = 4096  # discs per call; between calls other threads may run
MEMORY_LIMIT = 96 * 2**20  # bytes of stamps, then the cache is cleared

_BUCKETS = int(MAX_STAMP * STEPS) + 1
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
        """Draw discs with radii up to MAX_STAMP, in pixels."""
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


# Discs of a pixel or two

MAX_POINT = 1.125  # pixels; larger discs do not fit into the kernels
POINT_RADIUS = 0.5  # a smaller disc covers one pixel
# The smallest radius that is drawn, so that sparse discs stay visible; less if all discs would
# cover more than this fraction of the canvas.
_LEAST_RADIUS, _LEAST_SHARE = 0.6, 0.12
_KERNELS_PER_PIXEL = 16  # radii per pixel
_SUBPIXELS = 4  # sub-pixel positions per axis

Indices = NDArray[np.intp]


def scatter(target: pygame.Surface, x: Floats, y: Floats, radii: Floats, shades: Shades) -> None:
    """Draw discs with `radii` up to MAX_POINT; all measures in pixels.

    `target` has 32 bits per pixel, 0xRRGGBB. Discs in the same pixel add up to full coverage, and
    the last of them gives the colour.
    """
    width, height = target.get_size()
    inside = (x >= -1) & (x < width + 1) & (y >= -1) & (y < height + 1)
    if not inside.all():
        x, y, radii, shades = x[inside], y[inside], radii[inside], shades[inside]
    if len(x) == 0:
        return
    radii = np.maximum(radii, least_radius(len(x), (width, height)))
    # Two pixels of border: one for centres just outside, one for the pixels that they cover.
    wide, high = width + 4, height + 4
    column, row = np.floor(x).astype(np.intp), np.floor(y).astype(np.intp)
    at = (row + 2) * wide + column + 2
    cells, covers = [], []
    colour = np.zeros(wide * high, np.uint8)
    broad = radii >= POINT_RADIUS
    if broad.any():
        key = _kernel_keys(x[broad] - column[broad], y[broad] - row[broad], radii[broad])
        spread = _OFFSETS @ np.array([1, wide])
        around = (spread[:, None] + at[broad]).ravel()
        cells.append(around)
        covers.append(_KERNELS[:, key].ravel())
        colour[around] = np.tile(shades[broad], len(_OFFSETS))
    if not broad.all():
        points = ~broad
        cells.append(at[points])
        covers.append(np.pi * radii[points] ** 2)
        colour[at[points]] = shades[points]
    cover = np.bincount(np.concatenate(cells), np.concatenate(covers), wide * high)
    lit = np.flatnonzero(cover)
    row, column = lit // wide - 2, lit % wide - 2
    shown = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    lit = lit[shown]
    share = np.minimum(cover[lit], 1.0)
    _blend(target, row[shown] * width + column[shown], share, colour[lit])


def least_radius(count: int, size: Size) -> float:
    """Return the smallest radius to draw, for a number of discs on a canvas."""
    even = math.sqrt(_LEAST_SHARE * size[0] * size[1] / (math.pi * max(count, 1)))
    return min(even, _LEAST_RADIUS)


def _blend(target: pygame.Surface, at: Indices, share: Floats, colour: Shades) -> None:
    """Blend colours into pixels; red and blue are computed together."""
    pixels = pygame.surfarray.pixels2d(target).T.reshape(-1)  # rows one after another
    weight = (share * 256).astype(np.uint32)
    back, front = pixels[at], _PACKED[colour]
    mixed = np.zeros_like(back)
    for channels in (np.uint32(0xFF00FF), np.uint32(0x00FF00)):
        both = (back & channels) * (256 - weight) + (front & channels) * weight
        mixed |= (both >> np.uint32(8)) & channels
    pixels[at] = mixed


def _kernel_keys(dx: Floats, dy: Floats, radii: Floats) -> Indices:
    step: Indices = np.rint((radii - POINT_RADIUS) * _KERNELS_PER_PIXEL).astype(np.intp)
    across, down = (dx * _SUBPIXELS).astype(np.intp), (dy * _SUBPIXELS).astype(np.intp)
    return (step * _SUBPIXELS + down) * _SUBPIXELS + across


def _make_kernels() -> tuple[Indices, Floats]:
    """Return the offsets of 3 by 3 pixels, the middle last, and the coverage of each.

    The coverage, (9, radii × sub-pixel positions), is counted on a fine grid.
    """
    reach = np.arange(-1, 2)
    offsets = np.stack(np.meshgrid(reach, reach), axis=-1).reshape(-1, 2)
    offsets = offsets[np.argsort(-(offsets**2).sum(axis=1), kind="stable")]
    fine = (np.arange(8) + 0.5) / 8
    grid = np.stack(np.meshgrid(fine, fine), axis=-1).reshape(-1, 2)
    points = offsets[:, None, :] + grid
    kernels = []
    for radius in np.arange(POINT_RADIUS, MAX_POINT + 1e-9, 1 / _KERNELS_PER_PIXEL):
        for place in range(_SUBPIXELS**2):
            center = (np.array([place % _SUBPIXELS, place // _SUBPIXELS]) + 0.5) / _SUBPIXELS
            distance = np.hypot(*(points - center).transpose(2, 0, 1))
            kernels.append((distance <= radius).mean(axis=1))
    shares = np.array(kernels).T.copy()
    return offsets, shares


_OFFSETS, _KERNELS = _make_kernels()
_PACKED = np.array([red << 16 | green << 8 | blue for red, green, blue in DISCS], np.uint32)


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
