"""World to screen and back, pan and zoom."""

from __future__ import annotations

from copy import copy

import numpy as np
from numpy.typing import NDArray

from jostle_lab.simulate.frame import Point, Rect

Size = tuple[int, int]

ZOOM_OUT_LIMIT = 1e-3  # times the scale at which the scene fits
ZOOM_IN_LIMIT = 1e5
MARGIN = 24  # free pixels around the scene
LONGEST = 20_000  # pixels; longer lines are not drawn
FOOT, FOOT_SHARE = 44, 0.06  # free pixels below it, for legends; less of a small screen
HEADING = 84  # free pixels above it if there are several columns


class Camera:
    """A centre in the world and a scale in pixels per world unit.

    `size` is that of the screen, and `left` and `right` are the margins that panels cover, in
    pixels. `view` is the part of the world to show, as min_x, min_y, max_x, max_y.
    """

    def __init__(self, size: Size, view: Rect, left: int = 0, right: int = 0) -> None:
        self.size = size
        self.left, self.right = left, right
        self.columns = 1  # equal ones between the panels; the first shows the view
        self.at_home = True  # whether it shows the whole view, and follows its changes
        self._view = view
        self.home()

    def look_at(self, view: Rect) -> None:
        self._view = view
        self.home()

    def follow(self, view: Rect) -> None:
        """Update the size of the view; a camera at home shows all of it."""
        if view != self._view:
            self._view = view
            if self.at_home:
                self.home()

    def home(self) -> None:
        """Show the whole view, as large as possible between the panels."""
        min_x, min_y, max_x, max_y = self._view
        width, height = max(max_x - min_x, 1e-9), max(max_y - min_y, 1e-9)
        left, column = self.left_margin, self.column_width
        top = HEADING if self.columns > 1 else 0
        foot = max(min(FOOT, FOOT_SHARE * self.size[1]), MARGIN)
        high = self.size[1] - MARGIN - foot - top
        free = max(column - 2 * MARGIN, 16), max(high, 16)
        self.scale = min(free[0] / width, free[1] / height)
        self._fit_scale = self.scale
        aside = left + column / 2 - self.size[0] / 2  # pixels from the middle of the screen
        self.center = (
            (min_x + max_x) / 2 - aside / self.scale,
            (min_y + max_y) / 2 - (top + MARGIN - foot) / 2 / self.scale,
        )
        self.at_home = True

    def set_margins(self, left: int, right: int) -> None:
        """Set the margins; a camera at home stays at home."""
        if (left, right) != (self.left, self.right):
            self.left, self.right = left, right
            if self.at_home:
                self.home()

    @property
    def left_margin(self) -> int:
        """Return the left margin, or 0 if the window is too narrow."""
        return self.left if self.left < self.size[0] / 2 else 0

    @property
    def column_width(self) -> float:
        """Return the width of one of the columns in pixels."""
        left = self.left_margin
        right = self.right if left + self.right < 0.7 * self.size[0] else 0
        return (self.size[0] - left - right) / self.columns

    def column_edge(self, column: int) -> float:
        """Return the left edge of a column in pixels; 0 for the first."""
        return self.left_margin + column * self.column_width if column else 0.0

    def divide(self, columns: int) -> None:
        """Show the view in the first of a number of columns."""
        self.columns = columns
        self.home()

    def column(self, column: int) -> Camera:
        """Return a camera that shows the same in another column."""
        other = copy(self)
        aside = column * self.column_width / self.scale
        other.center = self.center[0] - aside, self.center[1]
        return other

    def aim(self, center: Point, scale: float) -> None:
        """Centre a world point, at a scale within the limits of the zoom."""
        self.at_home = False
        low, high = self._fit_scale * ZOOM_OUT_LIMIT, self._fit_scale * ZOOM_IN_LIMIT
        self.center, self.scale = center, min(max(scale, low), high)

    def on(self, size: Size) -> Camera:
        """Return a camera that shows the same on a screen of another size, without margins."""
        other = Camera(size, self._view)
        if not self.at_home:
            zoom = min(size[0] / self.size[0], size[1] / self.size[1])
            other.aim(self.center, self.scale * zoom)
        return other

    def resize(self, size: Size) -> None:
        """Set the size of the screen; a camera at home stays at home."""
        self.size = size
        if self.at_home:
            self.home()

    def to_screen(
        self, points: NDArray[np.floating]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the columns x and y, in pixels, of (n, 2) world points.

        In float64: float32 jitters at high zoom.
        """
        x = (points[:, 0].astype(np.float64) - self.center[0]) * self.scale + self.size[0] / 2
        y = (points[:, 1].astype(np.float64) - self.center[1]) * self.scale + self.size[1] / 2
        return x, y

    def lines_to_screen(
        self, starts: NDArray[np.floating], ends: NDArray[np.floating]
    ) -> NDArray[np.float64]:
        """Return lines in pixels, (n, 4) as x0, y0, x1, y1, from (n, 2) world points."""
        return np.column_stack([*self.to_screen(starts), *self.to_screen(ends)])

    def sees(self, lines: NDArray[np.floating]) -> NDArray[np.bool_]:
        """Return which lines, (n, 4) in pixels, are near the screen and of drawable length.

        pygame draws the part outside the screen pixel by pixel, too.
        """
        low = np.minimum(lines[:, :2], lines[:, 2:])
        high = np.maximum(lines[:, :2], lines[:, 2:])
        near: NDArray[np.bool_] = (
            (high >= 0) & (low <= np.array(self.size)) & (high - low < LONGEST)
        ).all(axis=1)
        return near

    def to_world(self, pixel: Point) -> Point:
        """Return the world point under a pixel."""
        return (
            (pixel[0] - self.size[0] / 2) / self.scale + self.center[0],
            (pixel[1] - self.size[1] / 2) / self.scale + self.center[1],
        )

    def pan(self, pixels: Point) -> None:
        """Move the camera by screen pixels."""
        self.at_home = False
        x, y = self.center
        self.center = x + pixels[0] / self.scale, y + pixels[1] / self.scale

    def zoom_at(self, pixel: Point, factor: float) -> None:
        """Multiply the scale by `factor`; the world point under `pixel` stays there."""
        before = self.to_world(pixel)
        self.aim(self.center, self.scale * factor)
        after = self.to_world(pixel)
        x, y = self.center
        self.center = x + before[0] - after[0], y + before[1] - after[1]

    def rect_to_screen(self, rect: Rect) -> Rect:
        (x0, x1), (y0, y1) = self.to_screen(np.array([rect[:2], rect[2:]], np.float64))
        return float(x0), float(y0), float(x1), float(y1)
