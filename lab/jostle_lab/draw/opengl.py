"""The painter on a graphics card: each method is one draw call for any number of discs.

It draws into a texture, which can be read at any time; `show` copies it to the window.
"""

from typing import Any

import moderngl
import numpy as np
import pygame
from numpy.typing import NDArray

from jostle_lab.draw import shaders
from jostle_lab.draw.camera import Size
from jostle_lab.draw.painter import Colours, Floats, Shades, on_canvas, whole_pixels
from jostle_lab.draw.palette import DISCS, Colour
from jostle_lab.draw.software import MAX_POINT, empty_canvas, least_radius

_DISC = np.dtype([("x", "f4"), ("y", "f4"), ("radius", "f4"), ("shade", "u1"), ("", "V3")])
_BOX = np.dtype([("box", "f4", 4), ("tint", "u1", 3), ("", "V1")])
_LINE = np.dtype([("ends", "f4", 4), ("tint", "u1", 4)])
# Names of software renderers in GL_RENDERER.
_EMULATORS = ("llvmpipe", "softpipe", "swiftshader", "swrast", "gdi generic", "basic render")
_KEPT = 16  # textures for surfaces


class OpenGLPainter:
    """A canvas in the memory of a graphics card.

    The context is of OpenGL 3.3 or later, and present in this thread.
    """

    def __init__(self, size: Size, context: moderngl.Context) -> None:
        self.context = context
        self.renderer: str = context.info["GL_RENDERER"]  # its name
        # Whether OpenGL runs in software.
        self.emulated = any(name in self.renderer.lower() for name in _EMULATORS)
        self._corners = context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], "f4"))
        self._buffer = context.buffer(reserve=2**16, dynamic=True)
        self._textures: dict[Size, moderngl.Texture] = {}
        self._disc = self._form(shaders.DISC, "3f4 u1 3x1", "disc", "shade")
        self._box = self._form(shaders.BOX, "4f4 3f1 1x1", "box", "tint")
        self._line = self._form(shaders.LINE, "4f4 4f1", "ends", "tint")
        self._circle, self._sheet = self._form(shaders.CIRCLE), self._form(shaders.SHEET)
        _set(self._disc, ramp=[tuple(c / 255 for c in colour) for colour in DISCS])
        self._picture = context.texture((1, 1), 4)
        self.target = context.framebuffer([self._picture])  # the framebuffer of the canvas
        self.resize(size)

    def resize(self, size: Size) -> None:
        self.size = max(size[0], 1), max(size[1], 1)
        self.target.release()
        self._picture.release()
        self._picture = self.context.texture(self.size, 4)
        self.target = self.context.framebuffer([self._picture])
        self.target.clear()
        self._upload = pygame.Surface(self.size, 0, 32, (0xFF, 0xFF00, 0xFF0000, 0))  # as its bytes
        for form in (self._disc, self._box, self._line, self._circle, self._sheet):
            _set(form, size=self.size)
        self._clip: tuple[int, int, int, int] | None = None

    def canvas(self) -> pygame.Surface:
        """Return a copy of the picture."""
        pixels = self.target.read(components=4)
        surface = empty_canvas(self.size)
        surface.blit(pygame.image.frombytes(pixels, self.size, "RGBX", True), (0, 0))
        return surface

    def clip(self, rect: pygame.Rect | None) -> None:
        if rect is None:
            self._clip = None
            return
        inside = rect.clip(pygame.Rect((0, 0), self.size))
        self._clip = inside.x, self.size[1] - inside.bottom, inside.width, inside.height

    def fill(self, colour: Colour) -> None:
        red, green, blue = (channel / 255 for channel in colour)
        part = self._clip or (0, 0, *self.size)  # without it, the last clip of a draw call is used
        if min(part[2:]) > 0:
            self.target.clear(red, green, blue, 1.0, viewport=part)

    def discs(self, x: Floats, y: Floats, radii: Floats, shades: Shades) -> None:
        seen = on_canvas(self.size, x, y, radii)
        rows = np.empty(int(np.count_nonzero(seen)), _DISC)
        if len(rows) == 0:
            return
        for name, column in (("x", x), ("y", y), ("radius", radii), ("shade", shades)):
            rows[name] = column[seen]
        fine = rows["radius"] <= MAX_POINT
        if fine.any() and not fine.all():
            rows = np.concatenate([rows[~fine], rows[fine]])
        least = least_radius(int(fine.sum()), self.size)
        _set(self._disc, least=least)
        self._draw(self._disc, rows)

    def circle(
        self, center: tuple[float, float], radius: float, colour: Colour, width: float = 0.0
    ) -> None:
        if radius > 0:
            shade = tuple(channel / 255 for channel in colour)
            _set(self._circle, disc=(*center, radius), width=max(width, 0.0), colour=shade)
            self._draw(self._circle)

    def rects(self, corners: Floats, colours: Colours, *, filled: bool) -> None:
        if len(corners) == 0:
            return
        x0, y0, x1, y1 = whole_pixels(self.size, corners).T
        if filled:
            boxes = [(x0, y0, np.maximum(x1 - 1, x0 + 1), np.maximum(y1 - 1, y0 + 1))]
        else:  # four sides, each one pixel wide
            boxes = [(x0, y0, x1 + 1, y0 + 1), (x0, y1, x1 + 1, y1 + 1)]
            boxes += [(x0, y0, x0 + 1, y1 + 1), (x1, y0, x1 + 1, y1 + 1)]
        rows = np.empty((len(corners), len(boxes)), _BOX)
        rows["box"] = np.stack([np.stack(box, axis=-1) for box in boxes], axis=1)
        rows["tint"] = colours[:, None, :3]
        self._draw(self._box, rows.ravel())

    def lines(self, ends: Floats, colours: Colours | Colour, width: float = 1.0) -> None:
        if len(ends) == 0:
            return
        rows = np.empty(len(ends), _LINE)
        rows["ends"] = ends + 0.5  # from pixel centre to pixel centre
        rows["tint"] = 255
        rows["tint"][:, : np.shape(colours)[-1]] = colours
        _set(self._line, width=width)
        self._draw(self._line, rows)

    def sheet(self, surface: pygame.Surface, place: tuple[float, float]) -> None:
        size = surface.get_size()
        if 0 in size:
            return
        texture = self._textures.get(size)
        if texture is None:
            while len(self._textures) >= _KEPT:
                self._textures.pop(next(iter(self._textures))).release()
            texture = self._textures[size] = self.context.texture(size, 4)
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
        texture.write(pygame.image.tobytes(surface, "RGBA"))
        x, y = round(place[0]), round(place[1])
        texture.use(0)
        _set(self._sheet, box=(x, y, x + size[0], y + size[1]))
        self._draw(self._sheet)

    def copy(self, canvas: pygame.Surface) -> None:
        """Replace the picture by a surface of the same size."""
        self._upload.blit(pygame.transform.flip(canvas, False, True), (0, 0))
        self._picture.write(self._upload.get_view("0"))

    def show(self) -> None:
        """Copy the canvas to the window, which has its size."""
        self.target.scissor = None  # type: ignore[assignment]  # the stub does not know None
        self.context.copy_framebuffer(self.context.screen, self.target)

    def release(self) -> None:
        self.context.release()

    def _form(
        self, sources: tuple[str, str], layout: str = "", *names: str
    ) -> moderngl.VertexArray:
        """Return a program and its input: corners of a quad and, with a layout, an instance."""
        content: list[tuple[Any, ...]] = [(self._corners, "2f4", "corner")]
        if layout:
            content.append((self._buffer, f"{layout}/i", *names))
        return self.context.vertex_array(self.context.program(*sources), content)

    def _draw(self, form: moderngl.VertexArray, rows: NDArray[np.void] | None = None) -> None:
        """Draw one instance, or one for each row."""
        if rows is not None:
            self._buffer.orphan(max(rows.nbytes, 2**16))
            self._buffer.write(rows)
        self.target.use()
        self.context.enable_only(moderngl.BLEND)
        self.context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        self.context.scissor = self._clip
        form.render(moderngl.TRIANGLE_STRIP, instances=1 if rows is None else len(rows))


def _set(form: moderngl.VertexArray, **uniforms: Any) -> None:
    for name, value in uniforms.items():
        if name in form.program:
            form.program[name] = value
