"""Glyphs, boxes and polygons with premultiplied alpha, antialiased and cached."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

FINE = 4  # scale at which polygons are drawn, for antialiasing
THIN = 6.0  # pixels; a box up to this width is a line
MANY = 4  # more polygons of one colour are a plot, which changes often and is not cached
KEPT = 4000  # glyphs, and polygons, before the cache is cleared
LARGEST = 3000.0  # pixels; ImGui draws no larger shape
GLYPH, BOX, POLYGON = range(3)

Floats = NDArray[np.floating]
Indices = NDArray[np.intp]
Vertices = NDArray[np.void]  # rows of `software.VERTEX`


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
    """Draws outlines, with a cache of glyphs and polygons."""

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
        """Draw outlines in order, successive ones of a kind and colour together."""
        kinds = _kinds(vertices, outlines)
        colours = np.ascontiguousarray(vertices["colour"][outlines.quads[:, 0]]).view(np.uint32)
        for run in _runs(kinds):
            if kinds[run[0]] == GLYPH:
                self._write(target, texture, vertices[outlines.quads[run]])
            elif kinds[run[0]] == BOX:
                _fill_boxes(target, vertices[outlines.quads[run]])
            else:
                for part in _runs(colours[run].ravel()):
                    self._fill(target, vertices, outlines, run[part])

    def _write(self, target: pygame.Surface, texture: int, quads: Vertices) -> None:
        """Draw glyphs: boxes with a part of the font atlas."""
        low, high = quads["at"].min(axis=1), quads["at"].max(axis=1)
        sizes = np.maximum(np.rint(high - low), 1).astype(np.int32)
        parts = quads["uv"][:, :3].reshape(len(quads), -1), sizes, quads["colour"][:, 0]
        keys = np.concatenate(
            [np.ascontiguousarray(part).view(np.uint8).reshape(len(quads), -1) for part in parts],
            axis=1,
        )
        blits = []
        for row, key, place in zip(quads, keys, np.rint(low).astype(np.intp).tolist(), strict=True):
            glyph = self._glyphs.get(key.tobytes())
            if glyph is None:
                glyph = _remember(self._glyphs, key.tobytes(), self._glyph(texture, row))
            blits.append((glyph, place))
        target.fblits(blits, pygame.BLEND_PREMULTIPLIED)

    def _glyph(self, texture: int, quad: Vertices) -> pygame.Surface:
        """Cut out a glyph of the font atlas, at the size of its box."""
        atlas = self._atlases[texture]
        whole = np.rint(quad["uv"] * atlas.shape[::-1]).astype(int)
        (left, top), (right, bottom) = whole.min(axis=0), whole.max(axis=0)
        picture = _tinted(atlas[top:bottom, left:right].T, quad["colour"][0])
        size = np.maximum(np.rint(np.ptp(quad["at"], axis=0)), 1).tolist()
        if picture.get_size() != tuple(size) and min(picture.get_size()) > 0:
            picture = pygame.transform.smoothscale(picture, size)
        return picture

    def _fill(
        self, target: pygame.Surface, vertices: Vertices, outlines: Outlines, members: Indices
    ) -> None:
        """Fill convex polygons of one colour as one shape; few of them come from the cache."""
        shapes = [vertices["at"][outlines.corners(k)] for k in members]
        points, colour = np.concatenate(shapes), vertices["colour"][outlines.quads[members[0], 0]]
        low, high = np.floor(points.min(axis=0)), np.ceil(points.max(axis=0)) + 1
        if (high - low > LARGEST).any():
            return
        key = (points - low).astype("<f4").tobytes() + colour.tobytes()
        picture = self._polygons.get(key)
        if picture is None:
            width, height = (high - low).astype(int).tolist()
            picture = _tinted(coverage([shape - low for shape in shapes], (width, height)), colour)
            if len(members) <= MANY:
                _remember(self._polygons, key, picture)
        target.blit(picture, low.tolist(), special_flags=pygame.BLEND_PREMULTIPLIED)


def _remember(
    cache: dict[bytes, pygame.Surface], key: bytes, picture: pygame.Surface
) -> pygame.Surface:
    if len(cache) > KEPT:
        cache.clear()
    cache[key] = picture
    return picture


def coverage(shapes: list[Floats], size: tuple[int, int]) -> NDArray[np.uint8]:
    """Return the coverage of each pixel by convex polygons, (width, height) in 0..255."""
    mask = pygame.Surface((FINE * size[0], FINE * size[1]), 0, 32)
    for shape in shapes:
        # pygame fills the pixels of the corners, too: each is moved to the next centre inside.
        points = FINE * shape - 0.5
        middle = (points[0] + points[len(points) // 2]) / 2
        inner = np.where(points < middle, np.ceil(points), np.floor(points))
        pygame.draw.polygon(mask, (255, 255, 255), inner.tolist())
    return pygame.surfarray.array_red(pygame.transform.smoothscale(mask, size))


def _runs(values: NDArray[np.integer]) -> list[Indices]:
    """Return the numbers 0 to n − 1, split where the value changes."""
    return np.split(np.arange(len(values)), np.flatnonzero(np.diff(values)) + 1)


def _kinds(vertices: Vertices, outlines: Outlines) -> Indices:
    """Distinguish glyphs, upright boxes, and everything else."""
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


def _tinted(cover: NDArray[np.uint8], colour: NDArray[np.uint8]) -> pygame.Surface:
    """Return a colour times its coverage, premultiplied; `cover` is (width, height)."""
    surface = pygame.Surface(cover.shape, pygame.SRCALPHA, 32)
    if cover.size:
        pygame.surfarray.pixels3d(surface)[:] = cover[:, :, None]
        pygame.surfarray.pixels_alpha(surface)[:] = cover
        surface.fill(_premultiplied(colour.tolist()), special_flags=pygame.BLEND_RGBA_MULT)
    return surface


def _premultiplied(colour: list[int]) -> tuple[int, int, int, int]:
    red, green, blue, alpha = colour
    return red * alpha // 255, green * alpha // 255, blue * alpha // 255, alpha
