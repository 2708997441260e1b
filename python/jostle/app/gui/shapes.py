"""Glyphs, boxes and polygons with premultiplied alpha, antialiased and cached."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

FINE = 4  # sample rows per row of pixels, for the edges of polygons
THIN = 6.0  # pixels; a box up to this width is a line
MANY = 4  # more polygons of one colour are a plot, which changes every frame and is not cached
KEPT = 4000  # glyphs, and shapes, before the cache is cleared
GLYPH, BOX, POLYGON = range(3)

LARGEST = 3000.0  # pixels
WHITE = (255, 255, 255)

Floats = NDArray[np.float32]
Indices = NDArray[np.intp]
Shade = NDArray[np.uint8]  # red, green, blue, alpha
Vertices = NDArray[np.void]  # rows of `gui_software.VERTEX`


@dataclass(frozen=True)
class Outlines:
    """Convex shapes, merged from fans of triangles.

    Outline k consists of `count[k] - 2` triangles from row `start[k]` on; those with four corners
    have them in `quads[k]`, in order.
    """

    triangles: Indices
    start: Indices
    count: Indices
    quads: Indices

    def __len__(self) -> int:
        return len(self.start)

    def corners(self, k: int) -> Indices:
        """Return the vertices of an outline, in order."""
        fan = self.triangles[self.start[k] : self.start[k] + self.count[k] - 2]
        return np.concatenate([fan[0, :2], fan[:, 2]])


def outlines_of(triangles: Indices) -> Outlines:
    """Merge triangles, at least one, that are the fan of one convex shape.

    They share its first vertex, and each begins where the previous one ends. ImPlot's boxes are two
    triangles with a common diagonal; the first is reversed, which makes them a fan.
    """
    halves = np.flatnonzero((triangles[1:, :2] == triangles[:-1, :2]).all(axis=1))
    triangles = triangles.copy()
    triangles[halves, 1:] = triangles[halves, :0:-1]
    goes_on = (triangles[1:, 0] == triangles[:-1, 0]) & (triangles[1:, 1] == triangles[:-1, 2])
    start = np.flatnonzero(np.concatenate([[True], ~goes_on]))
    count = np.diff(np.append(start, len(triangles))) + 2
    last = triangles[np.minimum(start + 1, len(triangles) - 1), 2]
    quads = np.column_stack([triangles[start], last])
    return Outlines(triangles, start, count, quads)


class Shapes:
    """Draws outlines, with a cache of glyphs and antialiased shapes."""

    def __init__(self) -> None:
        self._atlases: dict[int, NDArray[np.uint8]] = {}
        self._glyphs: dict[bytes, pygame.Surface] = {}
        self._polygons: dict[bytes, pygame.Surface] = {}

    def set_font_atlas(self, texture: int, alpha: NDArray[np.uint8]) -> None:
        """Set the font atlas, (height, width); if its size changes, glyphs are made again."""
        before = self._atlases.get(texture)
        if before is None or before.shape != alpha.shape:
            self._glyphs.clear()
        self._atlases[texture] = alpha

    def draw(
        self, target: pygame.Surface, texture: int, vertices: Vertices, outlines: Outlines
    ) -> None:
        """Draw outlines in order, successive ones of a kind together."""
        kinds = _kinds(vertices, outlines)
        for run in _runs(kinds):
            if kinds[run[0]] == GLYPH:
                self._write(target, texture, vertices[outlines.quads[run]])
            elif kinds[run[0]] == BOX:
                _fill_boxes(target, vertices[outlines.quads[run]])
            else:
                self._fill_polygons(target, vertices, outlines, run)

    def _write(self, target: pygame.Surface, texture: int, quads: Vertices) -> None:
        """Draw glyphs: boxes with a part of the font atlas."""
        if len(self._glyphs) > KEPT:
            self._glyphs.clear()
        low, high = quads["at"].min(axis=1), quads["at"].max(axis=1)
        sizes = np.maximum(np.rint(high - low), 1).astype(np.int32)
        parts = quads["uv"][:, :3].reshape(len(quads), -1), sizes, quads["colour"][:, 0]
        keys = np.concatenate(
            [np.ascontiguousarray(part).view(np.uint8).reshape(len(quads), -1) for part in parts],
            axis=1,
        )
        places = np.rint(low).astype(np.intp).tolist()
        blits = []
        for number, (row, place) in enumerate(zip(keys, places, strict=True)):
            key = row.tobytes()
            glyph = self._glyphs.get(key)
            if glyph is None:
                glyph = self._glyph(texture, quads[number], sizes[number].tolist())
                self._glyphs[key] = glyph
            blits.append((glyph, place))
        target.fblits(blits, pygame.BLEND_PREMULTIPLIED)

    def _glyph(self, texture: int, quad: Vertices, size: list[int]) -> pygame.Surface:
        """Cut out a glyph; vertical text is rotated."""
        atlas = self._atlases[texture]
        whole = np.rint(quad["uv"] * atlas.shape[::-1]).astype(int)
        (left, top), (right, bottom) = whole.min(axis=0), whole.max(axis=0)
        picture = _tinted(atlas[top:bottom, left:right].T, quad["colour"][0])
        if abs(quad["at"][1, 0] - quad["at"][0, 0]) < 0.5:
            picture = pygame.transform.rotate(picture, 90)
        if picture.get_size() != tuple(size) and min(picture.get_size()) > 0:
            picture = pygame.transform.smoothscale(picture, size)
        return picture

    def _fill_polygons(
        self, target: pygame.Surface, vertices: Vertices, outlines: Outlines, run: Indices
    ) -> None:
        """Fill convex polygons: few from the cache, the many of a plot in one call."""
        colours = vertices["colour"][outlines.quads[run, 0]]
        for part in _runs(np.ascontiguousarray(colours).view(np.uint32).ravel()):
            colour, members = colours[part[0]], run[part]
            if len(part) > MANY:
                four = outlines.count[members] == 4
                others = [vertices["at"][outlines.corners(k)] for k in members[~four]]
                _fill_at_once(target, vertices["at"][outlines.quads[members[four]]], others, colour)
                continue
            for k in members:
                self._fill_polygon(target, vertices["at"][outlines.corners(k)], colour)

    def _fill_polygon(self, target: pygame.Surface, shape: Floats, colour: Shade) -> None:
        corner = np.floor(shape.min(axis=0))
        if (np.ptp(shape, axis=0) > LARGEST).any():
            return  # ImGui draws no shape of this size
        local = np.rint((shape - corner) * 8).astype(np.int32)
        key = local.tobytes() + colour.tobytes()
        picture = self._polygons.get(key)
        if picture is None:
            if len(self._polygons) > KEPT // 4:
                self._polygons.clear()
            picture = _tinted(coverage(local / 8), colour)
            self._polygons[key] = picture
        target.blit(picture, corner.tolist(), special_flags=pygame.BLEND_PREMULTIPLIED)


def coverage(corners: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the coverage of each pixel by a convex polygon, (width, height) in 0..255."""
    width, height = (int(np.ceil(top)) + 1 for top in corners.max(axis=0))
    y = (np.arange(height * FINE) + 0.5) / FINE
    (x0, y0), (x1, y1) = corners.T, np.roll(corners, -1, axis=0).T
    with np.errstate(divide="ignore", invalid="ignore"):
        x = x0[:, None] + (y - y0[:, None]) * ((x1 - x0) / (y1 - y0))[:, None]
    crossed = (np.minimum(y0, y1)[:, None] <= y) & (y < np.maximum(y0, y1)[:, None])
    left = np.where(crossed, x, np.inf).min(axis=0).astype(np.float32)
    right = np.where(crossed, x, -np.inf).max(axis=0).astype(np.float32)
    pixels = np.arange(width, dtype=np.float32)[:, None]
    inside = np.minimum(pixels + 1, right) - np.maximum(pixels, left)
    mean = np.clip(inside, 0.0, 1.0).reshape(width, height, FINE).mean(axis=2)
    share: NDArray[np.uint8] = np.rint(mean * 255).astype(np.uint8)
    return share


def _runs(values: NDArray[np.integer]) -> list[Indices]:
    """Return the numbers 0 to n − 1, split where the value changes."""
    return np.split(np.arange(len(values)), np.flatnonzero(np.diff(values)) + 1)


def _kinds(vertices: Vertices, outlines: Outlines) -> Indices:
    """Tell atlas and upright boxes from everything else."""
    four = outlines.count == 4
    quads = vertices[outlines.quads]
    at, uv = quads["at"], quads["uv"]
    low, high = at.min(axis=1, keepdims=True), at.max(axis=1, keepdims=True)
    upright = ((np.abs(at - low) < 0.01) | (np.abs(at - high) < 0.01)).all(axis=(1, 2))
    kinds = np.full(len(outlines), POLYGON)
    whole = np.abs(at - np.rint(at)).max(axis=(1, 2)) < 0.05
    kinds[four & upright & (whole | (np.ptp(at, axis=1).min(axis=1) > THIN))] = BOX
    kinds[four & (uv[:, 0] != uv[:, 2]).all(axis=1)] = GLYPH
    return kinds


def _fill_boxes(target: pygame.Surface, quads: Vertices) -> None:
    """Fill axis-aligned boxes on whole pixels."""
    corners = np.rint(quads["at"].min(axis=1)).astype(np.intp)
    sizes = np.maximum(np.rint(quads["at"].max(axis=1)).astype(np.intp) - corners, 1)
    bounds = target.get_clip()
    colours = quads["colour"][:, 0].tolist()
    for (x, y), size, colour in zip(corners.tolist(), sizes.tolist(), colours, strict=True):
        box = pygame.Rect(x, y, *size).clip(bounds)
        if colour[3] == 255:
            target.fill(colour, box)
        elif colour[3] and box.size != (0, 0):
            overlay = pygame.Surface(box.size, pygame.SRCALPHA, 32)
            overlay.fill(_premultiplied(colour))
            target.blit(overlay, box, special_flags=pygame.BLEND_PREMULTIPLIED)


def _fill_at_once(
    target: pygame.Surface, quads: Floats, others: list[Floats], colour: Shade
) -> None:
    """Fill polygons of one colour as one shape, drawn at twice the size for antialiasing."""
    points = np.concatenate([quads.reshape(-1, 2), *others])
    low, high = np.floor(points.min(axis=0)) - 1, np.ceil(points.max(axis=0)) + 1
    low, high = np.maximum(low, -LARGEST), np.minimum(high, LARGEST)
    box = pygame.Rect(*low.tolist(), *(high - low).tolist()).clip(target.get_clip())
    if box.size == (0, 0):
        return
    mask = pygame.Surface((2 * box.width, 2 * box.height), 0, 32)
    corner = np.array(box.topleft, np.float32) + 0.25  # pygame's coordinates are pixel centres
    for shape in others:
        pygame.draw.polygon(mask, WHITE, (2 * (shape - corner)).tolist())
    quads = 2 * (quads - corner)
    width = np.hypot(*(quads[:, 3] - quads[:, 0]).T)
    line = width <= 2 * THIN
    for quad in quads[~line].tolist():
        pygame.draw.polygon(mask, WHITE, quad)
    starts, ends = (quads[line, 0] + quads[line, 3]) / 2, (quads[line, 1] + quads[line, 2]) / 2
    widths = np.maximum(np.rint(width[line]), 1).astype(int).tolist()
    for start, end, thick in zip(starts.tolist(), ends.tolist(), widths, strict=True):
        pygame.draw.aaline(mask, WHITE, start, end, thick)
    mask = pygame.transform.smoothscale(mask, box.size)
    picture = _tinted(pygame.surfarray.pixels_red(mask), colour)
    target.blit(picture, box, special_flags=pygame.BLEND_PREMULTIPLIED)


def _tinted(cover: NDArray[np.uint8], colour: Shade) -> pygame.Surface:
    """Return a colour times its coverage, premultiplied; `cover` is (width, height)."""
    surface = pygame.Surface(cover.shape, pygame.SRCALPHA, 32)
    if cover.size:
        shares = np.arange(256)[:, None] * (colour[:3].astype(int) * int(colour[3])) / 255**2
        for channel, pixels in enumerate(
            (
                pygame.surfarray.pixels_red,
                pygame.surfarray.pixels_green,
                pygame.surfarray.pixels_blue,
            )
        ):
            pixels(surface)[:] = np.rint(shares[:, channel]).astype(np.uint8)[cover]
        alpha = np.rint(np.arange(256) * (int(colour[3]) / 255)).astype(np.uint8)
        pygame.surfarray.pixels_alpha(surface)[:] = alpha[cover]
    return surface


def _premultiplied(colour: list[int]) -> tuple[int, int, int, int]:
    red, green, blue, alpha = colour
    return red * alpha // 255, green * alpha // 255, blue * alpha // 255, alpha
