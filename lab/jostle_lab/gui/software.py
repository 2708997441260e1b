"""ImGui's output on a canvas without a graphics card.

Each of ImGui's draw lists, about one per panel, becomes a surface, which is cached while the list
does not change. An unchanged panel takes one blit per frame. ImGui's own backend on OpenGL in
software takes two to three times the processor time for a changed panel, and ten times for an
unchanged one. SDL's software renderer rounds corners to whole pixels, so that glyphs lose rows.
ImGui's triangles are merged into glyphs, boxes and polygons, which are antialiased here.
"""

import ctypes
from dataclasses import dataclass

import numpy as np
import pygame
from imgui_bundle import imgui
from numpy.typing import NDArray

from jostle_lab.draw.painter import Painter

VERTEX = np.dtype([("at", "<f4", 2), ("uv", "<f4", 2), ("colour", "u1", 4)])
INDEX = np.dtype("<u4" if imgui.INDEX_SIZE == 4 else "<u2")

FINE = 4  # scale at which polygons are drawn, for antialiasing
THIN = 6.0  # pixels; a box up to this width is a line
MANY = 4  # more polygons of one colour are a plot, which changes often and is not cached
KEPT = 4000  # glyphs, and polygons, before the cache is cleared
LARGEST = 3000.0  # pixels; ImGui draws no larger shape
GLYPH, BOX, POLYGON = range(3)

Floats = NDArray[np.floating]
Indices = NDArray[np.intp]
Vertices = NDArray[np.void]  # rows of `VERTEX`
Sheet = tuple[pygame.Surface, tuple[int, int]]  # the picture of a draw list, and its corner


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
        corners = quads["at"].min(axis=1)
        quads["at"] = np.rint(quads["at"] - corners[:, None])
        blits = []
        for quad, place in zip(quads, np.rint(corners).astype(np.intp).tolist(), strict=True):
            key = quad.tobytes()
            glyph = self._glyphs.get(key)
            if glyph is None:
                glyph = _remember(self._glyphs, key, self._glyph(texture, quad))
            blits.append((glyph, place))
        target.fblits(blits, pygame.BLEND_PREMULTIPLIED)

    def _glyph(self, texture: int, quad: Vertices) -> pygame.Surface:
        """Cut out a glyph of the font atlas, at the size of its box."""
        atlas = self._atlases[texture]
        whole = np.rint(quad["uv"] * atlas.shape[::-1]).astype(int)
        (left, top), (right, bottom) = whole.min(axis=0), whole.max(axis=0)
        picture = _tinted(atlas[top:bottom, left:right].T, quad["colour"][0])
        size = np.maximum(np.ptp(quad["at"], axis=0), 1).tolist()
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


class SoftwareGui:
    """Draws on the canvas of a painter; caches glyphs, shapes and surfaces."""

    def __init__(self, painter: Painter) -> None:
        self._painter = painter
        io = imgui.get_io()
        io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
        style = imgui.get_style()  # antialiasing is done here
        style.anti_aliased_fill = style.anti_aliased_lines = False
        self._shapes = Shapes()
        self._sheets: dict[bytes, Sheet] = {}

    def begin(self) -> None:
        """Prepare a frame; there is nothing to do."""

    def draw(self, data: imgui.ImDrawData) -> None:
        """Draw a frame over the canvas; unchanged draw lists come from the cache."""
        self.update_font_atlas(data)
        screen = self._painter.canvas().get_rect()
        keys = {_key(commands, data): commands for commands in data.cmd_lists}
        self._sheets = {
            key: self._sheets.get(key) or self._paint(commands, data, screen)
            for key, commands in keys.items()
        }
        self._painter.canvas().fblits(list(self._sheets.values()), pygame.BLEND_PREMULTIPLIED)

    def close(self) -> None:
        for texture in imgui.get_platform_io().textures:
            texture.set_tex_id(0)
            texture.set_status(imgui.ImTextureStatus.destroyed)
        self._sheets.clear()

    def update_font_atlas(self, data: imgui.ImDrawData) -> None:
        """Copy the font atlases that ImGui has made or changed."""
        states = imgui.ImTextureStatus
        for texture in data.textures:
            if texture.status in (states.want_create, states.want_updates):
                if texture.status == states.want_create:
                    texture.set_tex_id(texture.unique_id + 1)
                    self._sheets.clear()
                pixels = texture.get_pixels_array().reshape(texture.height, texture.width, -1)
                self._shapes.set_font_atlas(texture.get_tex_id(), pixels[:, :, -1].copy())
                texture.set_status(states.ok)
            elif texture.status == states.want_destroy:
                texture.set_tex_id(0)
                texture.set_status(states.destroyed)

    def _paint(
        self, commands: imgui.ImDrawList, data: imgui.ImDrawData, screen: pygame.Rect
    ) -> Sheet:
        """Draw a list on a surface of the size of its contents."""
        vertex_bytes, index_bytes = _bytes(commands)
        vertices = np.frombuffer(vertex_bytes, VERTEX).copy()
        indices = np.frombuffer(index_bytes, INDEX).astype(np.intp)
        if len(vertices) == 0:
            return pygame.Surface((0, 0)), (0, 0)
        scale = data.framebuffer_scale.x  # pixels per point
        vertices["at"] *= scale
        low, high = vertices["at"].min(axis=0), vertices["at"].max(axis=0)
        low, high = np.maximum(np.floor(low) - 1, -1e4), np.minimum(np.ceil(high) + 1, 1e4)
        area = pygame.Rect(*low.tolist(), *(high - low).tolist()).clip(screen)
        surface = pygame.Surface(area.size, pygame.SRCALPHA, 32)
        vertices["at"] -= np.array(area.topleft, np.float32)
        for command in commands.cmd_buffer:
            if command.elem_count == 0:
                continue
            clip = command.clip_rect
            corners = np.array([[clip.x, clip.y], [clip.z, clip.w]])
            low, high = corners * scale - np.array(area.topleft)
            surface.set_clip(pygame.Rect(*low.tolist(), *np.maximum(high - low, 0).tolist()))
            mine = indices[command.idx_offset : command.idx_offset + command.elem_count]
            outlines = outlines_of(mine.reshape(-1, 3) + command.vtx_offset)
            self._shapes.draw(surface, command.get_tex_id(), vertices, outlines)
        surface.set_clip(None)
        return surface, area.topleft


def _bytes(commands: imgui.ImDrawList) -> tuple[bytes, bytes]:
    """Return copies of the vertices and the indices."""
    corners, order = commands.vtx_buffer, commands.idx_buffer
    if corners.size() == 0 or order.size() == 0:
        return b"", b""
    return (
        ctypes.string_at(corners.data_address(), corners.size() * imgui.VERTEX_SIZE),
        ctypes.string_at(order.data_address(), order.size() * imgui.INDEX_SIZE),
    )


def _key(commands: imgui.ImDrawList, data: imgui.ImDrawData) -> bytes:
    """Return the cache key of a list."""
    whole = [data.display_size.x, data.display_size.y, data.framebuffer_scale.x]
    for command in commands.cmd_buffer:
        clip = command.clip_rect
        whole += [clip.x, clip.y, clip.z, clip.w, command.elem_count]
    return b"".join((*_bytes(commands), np.array(whole).tobytes()))
