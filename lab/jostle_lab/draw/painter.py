"""The interface of painters.

All coordinates are pixels of the canvas, x to the right and y down, as columns of numbers.
"""

from typing import Protocol

import numpy as np
import pygame
from numpy.typing import NDArray

from jostle_lab.draw.camera import Size
from jostle_lab.draw.palette import Colour

Floats = NDArray[np.floating]
Shades = NDArray[np.uint8]
Colours = NDArray[np.uint8]


def on_canvas(size: Size, x: Floats, y: Floats, radii: Floats) -> NDArray[np.bool_]:
    """Return which discs touch the canvas, with a pixel around each for its smooth edge."""
    (width, height), reach = size, radii + 1
    touching: NDArray[np.bool_] = (x > -reach) & (x < width + reach)
    return touching & (y > -reach) & (y < height + reach)


def whole_pixels(size: Size, corners: Floats) -> NDArray[np.intp]:
    """Return rectangles, (k, 4), in whole pixels; edges far outside the canvas are moved nearer."""
    near = np.clip(corners, -2.0, [size[0] + 2.0, size[1] + 2.0] * 2)
    return np.floor(near).astype(np.intp)


class Painter(Protocol):
    """A canvas; later operations draw over earlier ones."""

    size: Size

    def resize(self, size: Size) -> None:
        """Set the size of the canvas in pixels; its contents are lost."""

    def clip(self, rect: pygame.Rect | None) -> None:
        """Restrict drawing to a rectangle; None for the whole canvas."""

    def fill(self, colour: Colour) -> None:
        """Fill the canvas, or the clip, with a colour."""

    def discs(self, x: Floats, y: Floats, radii: Floats, shades: Shades) -> None:
        """Draw filled discs, coloured by the ramp of the palette."""

    def circle(
        self, center: tuple[float, float], radius: float, colour: Colour, width: float = 0.0
    ) -> None:
        """Draw one circle: filled, or a ring of a width."""

    def rects(self, corners: Floats, colours: Colours, *, filled: bool) -> None:
        """Draw rectangles: (k, 4) as min_x, min_y, max_x, max_y and (k, 3) colours."""

    def lines(self, ends: Floats, colours: Colours | Colour, width: float = 1.0) -> None:
        """Draw lines: (k, 4) as x0, y0, x1, y1; (k, 3) colours, or (k, 4) with alpha, or one.

        Whole numbers are pixel centres.
        """

    def sheet(self, surface: pygame.Surface, place: tuple[float, float]) -> None:
        """Blend a surface over the canvas."""

    def canvas(self) -> pygame.Surface:
        """Return the contents: a view that later operations change, or a copy."""
