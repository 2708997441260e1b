"""Pictures of worlds: discs and walls, drawn with Pillow, on a dark background."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jostle._core import Circle, World
from jostle.record.films import GROUND, Pixels, extra

Rect = tuple[float, float, float, float]

FINE = 3  # drawn at this multiple of the size, and then averaged
MARGIN = 0.03  # around the world, as a share of its longer side
RIM, RIM_SHADE, RIM_FROM = (
    1.4,
    0.68,
    3.0,
)  # width in pixels, brightness, and the radius that has one
LEAST, HUGE = 0.6, 30_000.0  # pixels; of larger discs only the part near the canvas is drawn
FAST = 2.5  # times the root mean square speed: the speed of the last colour
DECAY = 0.995  # per picture, of that speed

STAGE, WALL, FIXED = (22, 27, 35), (118, 134, 157), (104, 113, 126)
_SPEEDS = "#2f679b #297ea2 #43939d #74a780 #b0b368 #e9c074 #ffd5a7"  # from slow to fast
_KINDS = "#ee5d5d #f2b450 #62cf7a #4cc6dc #6688f5 #be74f2 #f48fb8 #dfe4ea"


def _colours(names: str) -> NDArray[np.float64]:
    return np.array([list(bytes.fromhex(name[1:])) for name in names.split()], np.float64)


def bounds_of(world: World) -> Rect:
    """Return the bounds of the container, of the period, or of all discs and walls."""
    if world.container is not None:
        edges = world.container.bounds
    elif world.period is not None:
        edges = np.array([0, 0, *world.period])
    else:
        discs, reach = world.positions.astype(np.float64), world.radii.astype(np.float64)[:, None]
        ends = world.walls.segments.reshape(-1, 2).astype(np.float64)
        points = np.concatenate([discs - reach, discs + reach, ends])
        points = points if len(points) else np.zeros((1, 2))
        edges = np.concatenate([points.min(axis=0), points.max(axis=0)])
    min_x, min_y, max_x, max_y = edges.tolist()
    return min_x, min_y, max_x, max_y


class Camera:
    """Draws the part of the plane in which a world is at first, on a side of `longest` pixels."""

    def __init__(self, world: World, longest: int) -> None:
        with extra("a picture of a world"):
            from PIL import Image, ImageDraw
        self._image, self._draw = Image, ImageDraw.Draw
        min_x, min_y, max_x, max_y = bounds_of(world)
        margin = MARGIN * max(max_x - min_x, max_y - min_y) or 1.0
        self._corner = np.array([min_x, min_y]) - margin
        width, height = max_x - min_x + 2 * margin, max_y - min_y + 2 * margin
        self._scale = longest / max(width, height)  # pixels per unit
        across, down = (math.ceil(side * self._scale / 2 - 0.01) for side in (width, height))
        self.size = 2 * across, 2 * down
        self._fastest = 1e-9

    def picture(self, world: World) -> Pixels:
        """Return the pixels of the present state, (height, width, 3)."""
        width, height = self.size
        canvas = self._image.new("RGB", (FINE * width, FINE * height), GROUND)
        draw = self._draw(canvas)
        container, period = world.container, world.period
        if container is not None or period is not None:
            low, high = self._pixels(np.array(bounds_of(world)).reshape(2, 2)).tolist()
            shape = draw.ellipse if isinstance(container, Circle) else draw.rectangle
            shape((*low, *high), STAGE, None if container is None else WALL, 2 * FINE)
        self._discs(draw, world)
        for start, end in self._pixels(world.walls.segments).tolist():
            draw.line((*start, *end), WALL, 2 * FINE)
        return np.asarray(canvas.reduce(FINE))

    def _pixels(self, points: NDArray[Any]) -> NDArray[np.float64]:
        """Return places on the canvas."""
        return (points - self._corner) * (self._scale * FINE)

    def _discs(self, draw: Any, world: World) -> None:
        colours = self._colours_of(world)
        rims = (colours * RIM_SHADE).astype(np.uint8)
        size, edge = FINE * np.array(self.size), max(round(RIM * FINE), 1)
        reach = np.maximum(world.radii.astype(np.float64) * self._scale, LEAST) * FINE
        columns = reach, world.sensors, colours.astype(np.uint8), rims
        for shift in _images(world.period):
            centers = self._pixels(world.positions + shift)
            gaps = np.maximum(np.maximum(-centers, centers - size), 0)  # to the canvas
            seen = (gaps < reach[:, None]).all(axis=1)
            rows = [column[seen].tolist() for column in (centers, *columns)]
            for (x, y), radius, sensor, colour, rim in zip(*rows, strict=True):
                box = x - radius, y - radius, x + radius, y + radius
                if radius > HUGE:
                    draw.polygon(_part(x, y, radius, size), tuple(colour))
                elif sensor:
                    draw.ellipse(box, None, tuple(colour), edge)
                elif radius < RIM_FROM * FINE:
                    draw.ellipse(box, tuple(colour))
                else:
                    draw.ellipse(box, tuple(colour), tuple(rim), edge)

    def _colours_of(self, world: World) -> NDArray[np.float64]:
        """Return a colour for each disc: of its kind if there are several, else of its speed."""
        kinds, table = world.kinds, _colours(_KINDS)
        if len(kinds) and kinds.max() > 0:
            colours = table[kinds % len(table)]
        else:
            speeds, table = np.linalg.norm(world.velocities, axis=1), _colours(_SPEEDS)
            usual = math.sqrt(float(np.mean(speeds**2))) if len(speeds) else 0.0
            self._fastest = max(FAST * usual, DECAY * self._fastest)
            share, at = np.minimum(speeds / self._fastest, 1), np.linspace(0, 1, len(table))
            colours = np.stack([np.interp(share, at, channel) for channel in table.T], axis=1)
        return np.where(world.movable[:, None], colours, FIXED)


def _images(period: NDArray[np.float64] | None) -> NDArray[np.float64]:
    """Return the shifts of the periodic images that may be in the picture."""
    if period is None:
        return np.zeros((1, 2))
    near = np.array([-1, 0, 1])
    return np.stack(np.meshgrid(*np.outer(period, near)), axis=-1).reshape(-1, 2)


def _part(x: float, y: float, radius: float, size: NDArray[np.int64]) -> list[tuple[float, float]]:
    """Return the corners of the part of a disc, which is much larger than the canvas, around it."""
    reach = 2.0 * float(size.sum())  # beyond the canvas in any direction
    across, down = size[0] / 2 - x, size[1] / 2 - y
    distance = math.hypot(across, down)
    if distance + reach < radius:  # the canvas is inside
        return [(-reach, -reach), (reach, -reach), (reach, reach), (-reach, reach)]
    way = math.atan2(down, across) + np.linspace(-1, 1, 65) * reach / distance
    ring = np.stack([np.cos(way), np.sin(way)], axis=1)
    inner, outer = ring * max(distance - reach, 0.0), ring[::-1] * radius
    return [(x + dx, y + dy) for dx, dy in np.concatenate([inner, outer]).tolist()]
