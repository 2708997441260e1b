"""The choice of the painter: the graphics card if there is one, else the processor.

OpenGL in software is slower than the software painter, so it is used only on request.
"""

import os

import moderngl
import pygame

from jostle_lab.draw import palette
from jostle_lab.draw.camera import Size
from jostle_lab.draw.opengl import OpenGLPainter
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.software import SoftwarePainter

# Exceptions of drawing when an OpenGL context is lost.
FAILURES = (pygame.error, moderngl.Error)
ICON = 64  # pixels, the side of the icon of the window
FINE = 4 * ICON  # drawn larger and reduced, so that all edges are smooth


class NoRendererError(Exception):
    """The requested renderer is not available; the message says why."""


class Screen:
    """The window on the desktop, and the painter of its canvas.

    Sizes of the window and mouse positions are in points, sizes of the canvas in pixels. A
    renderer, one of `settings.RENDERERS`, that is not available raises a NoRendererError.
    """

    def __init__(self, size: Size, renderer: str = "auto") -> None:
        pygame.display.init()
        # Before the window, because some systems show the first icon only, and after it, because
        # pygame gives an OpenGL window an icon of its own.
        pygame.display.set_icon(icon())
        self.painter = _open(size, renderer)
        pygame.display.set_icon(icon())

    @property
    def size(self) -> Size:
        """Return the size of the window in points."""
        return pygame.display.get_window_size()

    @property
    def scale(self) -> float:
        """Return the pixels per point: more than 1 on a high-density screen."""
        return self.painter.size[0] / max(self.size[0], 1)

    def fit(self) -> bool:
        """Adopt the present size of the window; return whether it has changed."""
        size = self.size
        window = pygame.display.get_surface()
        if window is not None and self.painter.name == "software":
            size = window.get_size()  # that of an OpenGL window does not change
        if size == self.painter.size:
            return False
        self.painter.resize(size)
        return True

    def show(self) -> None:
        self.painter.show()
        pygame.display.flip()

    def fall_back(self) -> None:
        """Switch to the software painter after the graphics card has failed."""
        self.painter = _open_software(self.size)
        pygame.display.set_icon(icon())

    def close(self) -> None:
        self.painter.release()
        pygame.display.quit()


def _open(size: Size, renderer: str) -> Painter:
    """Open a window and return the painter for it."""
    if renderer != "software":
        try:
            painter = _open_opengl(size)
            if renderer == "opengl" or not painter.emulated:
                return painter
            painter.release()
        except NoRendererError:
            if renderer == "opengl":
                raise
    return _open_software(size)


def _open_software(size: Size) -> Painter:
    # Otherwise SDL copies each frame through OpenGL, which is slow in software.
    os.environ.setdefault("SDL_FRAMEBUFFER_ACCELERATION", "0")
    return SoftwarePainter(pygame.display.set_mode(size, pygame.RESIZABLE).get_size())


def _open_opengl(size: Size) -> OpenGLPainter:
    for attribute, value in (
        (pygame.GL_CONTEXT_MAJOR_VERSION, 3),
        (pygame.GL_CONTEXT_MINOR_VERSION, 3),
        (pygame.GL_CONTEXT_PROFILE_MASK, pygame.GL_CONTEXT_PROFILE_CORE),
        (pygame.GL_CONTEXT_FORWARD_COMPATIBLE_FLAG, 1),
    ):
        pygame.display.gl_set_attribute(attribute, value)
    flags = pygame.OPENGL | pygame.DOUBLEBUF | pygame.RESIZABLE
    try:
        try:
            screen = pygame.display.set_mode(size, flags, vsync=1)
        except pygame.error:  # vsync is not always available
            screen = pygame.display.set_mode(size, flags)
        moderngl.init_context()  # of the new window; earlier contexts are lost
        context = moderngl.get_context()
        if context.version_code >= 330:
            return OpenGLPainter(screen.get_size(), context)
    except Exception as error:  # exceptions depend on the driver
        raise NoRendererError(f"there is no OpenGL 3.3 here: {error}") from error
    raise NoRendererError(f"OpenGL is {context.version_code / 100:.1f}, and 3.3 is needed")


def icon() -> pygame.Surface:
    """Return the icon, `ICON` pixels wide and high: two discs that touch, in two quadrants."""
    surface = pygame.Surface((FINE, FINE), pygame.SRCALPHA)
    whole, middle = surface.get_rect(), FINE // 2
    pygame.draw.rect(surface, palette.GROUND, whole, border_radius=FINE // 6)
    for start, end in (((middle, 0), (middle, FINE)), ((0, middle), (FINE, middle))):
        pygame.draw.line(surface, palette.WALL, start, end, FINE // 32)
    # The distance of the centres is the sum of the radii, 0.42 of the size.
    pygame.draw.circle(surface, palette.ACCENT, (0.355 * FINE, 0.355 * FINE), 0.24 * FINE)
    lower = (0.355 + 0.42 / 2**0.5) * FINE
    pygame.draw.circle(surface, palette.ATTRACTOR, (lower, lower), 0.18 * FINE)
    return pygame.transform.smoothscale(surface, (ICON, ICON))
