"""World to screen and back, pan and zoom."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle.app.simulation import Point, Rect

Size = tuple[int, int]

ZOOM_OUT_LIMIT = 1e-3  # of the scale at which the scene fits
ZOOM_IN_LIMIT = 1e5
MARGIN = 24  # pixels left free around the scene


class Camera:
    """A centre in the world and a scale in pixels a world unit, over a screen.

    Parameters
    ----------
    size
        Width and height of the screen in pixels.
    view
        The part of the world to show, as min_x, min_y, max_x, max_y.
    left, right
        Pixels at the edges that the scene shall stay clear of (the panels).
    """

    def __init__(self, size: Size, view: Rect, left: int = 0, right: int = 0) -> None:
        self.size = size
        self.left, self.right = left, right
        self._view = view
        self.home()

    def look_at(self, view: Rect) -> None:
        """Show another part of the world."""
        self._view = view
        self.home()

    def home(self) -> None:
        """Show the whole view, as large as fits between the panels."""
        min_x, min_y, max_x, max_y = self._view
        width, height = max(max_x - min_x, 1e-9), max(max_y - min_y, 1e-9)
        left = self.left if self.left < self.size[0] / 2 else 0
        right = self.right if left + self.right < 0.7 * self.size[0] else 0
        free = max(self.size[0] - left - right - 2 * MARGIN, 16), max(self.size[1] - 2 * MARGIN, 16)
        self.scale = min(free[0] / width, free[1] / height)
        self._fit_scale = self.scale
        self.center = (
            (min_x + max_x) / 2 - (left - right) / 2 / self.scale,
            (min_y + max_y) / 2,
        )
        self._at_home = True

    def keep_clear(self, left: int, right: int) -> None:
        """Leave other edges free from now on; a view at home stays at home."""
        if (left, right) != (self.left, self.right):
            self.left, self.right = left, right
            if self._at_home:
                self.home()

    def resize(self, size: Size) -> None:
        """Take a new screen size; a view at home stays at home."""
        self.size = size
        if self._at_home:
            self.home()

    def to_screen(
        self, points: NDArray[np.floating]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the columns x and y, in pixels, of (n, 2) world points.

        In float64: float32 would jitter in a view zoomed in far.
        """
        x = (points[:, 0].astype(np.float64) - self.center[0]) * self.scale + self.size[0] / 2
        y = (points[:, 1].astype(np.float64) - self.center[1]) * self.scale + self.size[1] / 2
        return x, y

    def to_world(self, pixel: Point) -> Point:
        """Return the world point under a pixel."""
        return (
            (pixel[0] - self.size[0] / 2) / self.scale + self.center[0],
            (pixel[1] - self.size[1] / 2) / self.scale + self.center[1],
        )

    def pan(self, pixels: Point) -> None:
        """Move the camera by pixels of the screen."""
        self._at_home = False
        self.center = (
            self.center[0] + pixels[0] / self.scale,
            self.center[1] + pixels[1] / self.scale,
        )

    def zoom_at(self, pixel: Point, factor: float) -> None:
        """Scale by `factor`; the world point under `pixel` stays there."""
        self._at_home = False
        before = self.to_world(pixel)
        low, high = self._fit_scale * ZOOM_OUT_LIMIT, self._fit_scale * ZOOM_IN_LIMIT
        self.scale = min(max(self.scale * factor, low), high)
        after = self.to_world(pixel)
        self.center = (
            self.center[0] + before[0] - after[0],
            self.center[1] + before[1] - after[1],
        )

    def rect_to_screen(self, rect: Rect) -> Rect:
        """Return a world rectangle in pixels."""
        (x0, x1), (y0, y1) = self.to_screen(np.array([rect[:2], rect[2:]], np.float64))
        return float(x0), float(y0), float(x1), float(y1)
