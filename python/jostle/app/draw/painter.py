"""The interface of painters: the operations that draw every picture.

Everything is in pixels of the canvas, x to the right and y down, as columns of numbers: which
discs and lines there are is decided once, above; a painter only puts them on the screen.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import pygame
from numpy.typing import NDArray

from jostle.app.draw.camera import Size
from jostle.app.draw.palette import Colour

Floats = NDArray[np.floating]
Shades = NDArray[np.uint8]
Colours = NDArray[np.uint8]


class Painter(Protocol):
    """A canvas and the strokes on it; later strokes cover earlier ones."""

    name: str
    size: Size

    def resize(self, size: Size) -> None:
        """Take a new size of the canvas in pixels; what was drawn is lost."""

    def clip(self, rect: pygame.Rect | None) -> None:
        """Draw only inside a rectangle from now on; None for the whole canvas."""

    def fill(self, colour: Colour) -> None:
        """Cover the canvas, or the clip, with a colour."""

    def discs(self, x: Floats, y: Floats, radii: Floats, shades: Shades) -> None:
        """Draw filled discs of any size and number, coloured by the ramp of the palette."""

    def circle(
        self, center: tuple[float, float], radius: float, colour: Colour, width: float = 0.0
    ) -> None:
        """Draw one circle of any size: filled, or a ring of a width."""

    def rects(self, corners: Floats, colours: Colours, *, filled: bool) -> None:
        """Draw rectangles: (k, 4) as min_x, min_y, max_x, max_y and (k, 3) colours."""

    def lines(self, ends: Floats, colours: Colours, width: float = 1.0) -> None:
        """Draw lines: (k, 4) as x0, y0, x1, y1; (k, 3) colours, or (k, 4) with alpha.

        Whole numbers are the middles of pixels.
        """

    def sheet(self, surface: pygame.Surface, place: tuple[float, float]) -> None:
        """Lay a surface, with its alpha, over the canvas."""

    def canvas(self) -> pygame.Surface:
        """Return what has been drawn; a view that the next stroke changes, or a copy."""

    def show(self) -> None:
        """Put the canvas on the window, which has its size."""

    def release(self) -> None:
        """Give everything back; the painter is not used again."""
