"""The window on the desktop: its OpenGL, the painter of its scene, and its icon."""

import moderngl
import pygame

from jostle_lab.draw import palette
from jostle_lab.draw.camera import Size
from jostle_lab.draw.opengl import OpenGLPainter
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.software import SoftwarePainter

ICON = 64  # pixels, the side of the icon of the window
FINE = 4 * ICON  # drawn larger and reduced, so that all edges are smooth
ADVICE = "Mesa has one that needs no graphics card (Debian: libgl1-mesa-dri)"


class NoOpenGLError(Exception):
    """There is no OpenGL for a window; the message says why."""


class Screen:
    """A window, which OpenGL shows, and the painter of the scene in it.

    Sizes of the window and mouse positions are in points, sizes of the canvas in pixels. Without
    OpenGL 3.3 a NoOpenGLError is raised.
    """

    def __init__(self, size: Size) -> None:
        pygame.display.init()
        # Before the window, because some systems show the first icon only, and after it, because
        # pygame gives an OpenGL window an icon of its own.
        pygame.display.set_icon(icon())
        self.full = False  # whether it fills the screen
        self.opengl = _open(size)
        pygame.display.set_icon(icon())
        # The painter of videos is two to three times as fast as OpenGL in software.
        self.painter: Painter = self.opengl
        if self.opengl.emulated:
            self.painter = SoftwarePainter(self.opengl.size)

    @property
    def size(self) -> Size:
        """Return the size of the window in points."""
        return pygame.display.get_window_size()

    @property
    def scale(self) -> float:
        """Return the pixels per point: more than 1 on a high-density screen."""
        return self.painter.size[0] / max(self.size[0], 1)

    def toggle_full(self) -> None:
        """Fill the screen, or end that."""
        self.full = not self.full
        pygame.display.toggle_fullscreen()

    def fit(self) -> bool:
        """Adopt the present size of the window; return whether it has changed."""
        if self.size == self.painter.size:
            return False
        self.opengl.resize(self.size)
        if self.painter is not self.opengl:
            self.painter.resize(self.size)
        return True

    def end_scene(self) -> None:
        """Hand the scene over to OpenGL, which draws the panels over it."""
        if self.painter is not self.opengl:
            self.opengl.copy(self.painter.canvas())

    def canvas(self) -> pygame.Surface:
        """Return a copy of the window's contents."""
        return self.opengl.canvas()

    def show(self) -> None:
        self.opengl.show()
        pygame.display.flip()

    def close(self) -> None:
        self.opengl.release()
        pygame.display.quit()


def _open(size: Size) -> OpenGLPainter:
    """Open a window and return the painter for it."""
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
        raise NoOpenGLError(f"there is no OpenGL 3.3 here: {error}; {ADVICE}") from error
    raise NoOpenGLError(f"OpenGL is {context.version_code / 100:.1f}, and 3.3 is needed; {ADVICE}")


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
