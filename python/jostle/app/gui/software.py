"""ImGui's output on a canvas without a graphics card.

Each of ImGui's draw lists, about one per panel, becomes a surface, which is cached while the list
does not change. An unchanged panel takes one blit per frame. ImGui's own backend on OpenGL in
software takes two to three times the processor time for a changed panel, and ten times for an
unchanged one.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np
import pygame
from imgui_bundle import imgui

from jostle.app.draw.painter import Painter
from jostle.app.gui.shapes import Shapes, outlines_of

VERTEX = np.dtype([("at", "<f4", 2), ("uv", "<f4", 2), ("colour", "u1", 4)])
INDEX = np.dtype("<u4" if imgui.INDEX_SIZE == 4 else "<u2")


@dataclass
class _Sheet:
    surface: pygame.Surface
    place: tuple[int, int]


class SoftwareGui:
    """Draws on the canvas of a painter; caches glyphs, shapes and surfaces."""

    def __init__(self, painter: Painter) -> None:
        self._painter = painter
        io = imgui.get_io()
        io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
        style = imgui.get_style()  # antialiasing is done here
        style.anti_aliased_fill = style.anti_aliased_lines = False
        self._shapes = Shapes()
        self._sheets: dict[bytes, _Sheet] = {}

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
        self.again()

    def again(self) -> None:
        """Draw the last frame again."""
        canvas = self._painter.canvas()
        for sheet in self._sheets.values():
            canvas.blit(sheet.surface, sheet.place, special_flags=pygame.BLEND_PREMULTIPLIED)

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
    ) -> _Sheet:
        """Draw a list on a surface of the size of its contents."""
        vertex_bytes, index_bytes = _bytes(commands)
        vertices = np.frombuffer(vertex_bytes, VERTEX).copy()
        indices = np.frombuffer(index_bytes, INDEX).astype(np.intp)
        origin = np.array([data.display_pos.x, data.display_pos.y], np.float32)
        scale = np.array([data.framebuffer_scale.x, data.framebuffer_scale.y], np.float32)
        vertices["at"] = at = (vertices["at"] - origin) * scale
        area = pygame.Rect(0, 0, 0, 0)
        if len(at):
            low, high = np.floor(at.min(axis=0)) - 1, np.ceil(at.max(axis=0)) + 1
            low, high = np.maximum(low, -1e4), np.minimum(high, 1e4)
            area = pygame.Rect(*low.tolist(), *(high - low).tolist()).clip(screen)
        surface = pygame.Surface(area.size, pygame.SRCALPHA, 32)
        vertices["at"] -= np.array(area.topleft, np.float32)
        for command in commands.cmd_buffer:
            if command.elem_count == 0:
                continue
            clip = command.clip_rect
            corners = np.array([[clip.x, clip.y], [clip.z, clip.w]]) - origin
            low, high = corners * scale - np.array(area.topleft)
            surface.set_clip(pygame.Rect(*low.tolist(), *np.maximum(high - low, 0).tolist()))
            mine = indices[command.idx_offset : command.idx_offset + command.elem_count]
            outlines = outlines_of(mine.reshape(-1, 3) + command.vtx_offset)
            self._shapes.draw(surface, command.get_tex_id(), vertices, outlines)
        surface.set_clip(None)
        return _Sheet(surface, area.topleft)


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
