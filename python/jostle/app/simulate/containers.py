"""Containers: their bounds, another kind or size, and positions inside."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle.app.simulate.settings import CONTAINERS, PARTICLES
from jostle.app.simulate.simulation import Container, Rect
from jostle.app.simulate.validation import FARTHEST, limited, one_of, or_none, rect

Floats = NDArray[np.floating]

# A scene may be scaled by up to 100; its view must then still be within the limits.
_RECT = rect(FARTHEST / 1_000)


def bounds(container: Container) -> Rect | None:
    if container is None:
        return None
    if isinstance(container, jostle.Torus):
        return 0.0, 0.0, container.width, container.height
    if isinstance(container, jostle.Circle):
        (x, y), radius = container.center, container.radius
        return x - radius, y - radius, x + radius, y + radius
    return container.min_x, container.min_y, container.max_x, container.max_y


def minimum_image(container: Container, offsets: Floats) -> Floats:
    """Return the shortest periodic images of offsets, (2,) or (n, 2)."""
    if isinstance(container, jostle.Torus):
        sides = np.array([container.width, container.height])
        offsets = offsets - sides * np.round(offsets / sides)
    return offsets


def crosses(container: Container, starts: Floats, ends: Floats) -> NDArray[np.bool_]:
    """Return which lines are longer than half a side of a torus: they cross its boundary."""
    if not isinstance(container, jostle.Torus):
        return np.zeros(len(starts), np.bool_)
    sides = np.array([container.width, container.height])
    over = np.abs(ends - starts) > sides / 2
    return over[:, 0] | over[:, 1]


def wall_images(
    container: Container, ends: Floats, margin: float = 0.0
) -> tuple[Floats, NDArray[np.intp]]:
    """Return the line segments that act inside a container, and the wall of each.

    On a torus these are the periodic images of walls that are nearer to it than `margin`.
    """
    if not isinstance(container, jostle.Torus) or len(ends) == 0:
        return ends, np.arange(len(ends))
    sides = np.array([container.width, container.height])
    home = ends - (np.floor(ends.mean(axis=1) / sides) * sides)[:, None]
    shifts = np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)]) * sides
    images = home[:, None] + shifts[:, None]
    near = (images.max(axis=2) >= -margin) & (images.min(axis=2) <= sides + margin)
    walls, which = np.nonzero(near.all(axis=2))
    return images[walls, which], walls


def diagonal(rect: Rect) -> float:
    width, height = rect[2] - rect[0], rect[3] - rect[1]
    return math.sqrt(width * width + height * height)


def kind_of(container: Container) -> str:
    return "none" if container is None else type(container).__name__.lower()


def scaled(rect: Rect, factor: float, around: Rect) -> Rect:
    """Return a rectangle scaled about the centre of another."""
    x, y = (around[0] + around[2]) / 2, (around[1] + around[3]) / 2
    return (
        x + (rect[0] - x) * factor,
        y + (rect[1] - y) * factor,
        x + (rect[2] - x) * factor,
        y + (rect[3] - y) * factor,
    )


@dataclass(frozen=True)
class InitialRegion:
    """The initial container, view and number of particles of a scene."""

    view: Rect = limited(_RECT)
    rect: Rect = limited(_RECT)  # bounds of the container; the view if there is none
    kind: str = limited(one_of(*CONTAINERS))
    n: int | None = limited(or_none(PARTICLES))

    @classmethod
    def of(cls, container: Container, view: Rect, n: int | None) -> InitialRegion:
        """Return those of a scene."""
        return cls(view, bounds(container) or view, kind_of(container), n)

    def fitted(self, kind: str | None, factor: float) -> tuple[Container, Rect]:
        """Return a container of a kind (None: the scene's own), scaled, and its view.

        A circle in place of a rectangle has the same centre and area, and vice versa. A torus
        begins at the origin.
        """
        kind = kind or self.kind
        container = _container_of(kind, scaled(self.rect, factor, self.rect), self.kind)
        walls = bounds(container)
        if kind not in (self.kind, "none") and walls is not None:
            return container, walls
        shift = np.array(center_of(walls or self.rect)) - np.array(center_of(self.rect))
        view = np.array(scaled(self.view, factor, self.rect)).reshape(2, 2) + shift
        (x0, y0), (x1, y1) = view.tolist()
        return container, (x0, y0, x1, y1)


def center_of(rect: Rect) -> tuple[float, float]:
    return (rect[0] + rect[2]) / 2, (rect[1] + rect[3]) / 2


def _container_of(kind: str, rect: Rect, initial: str) -> Container:
    width, height, center = rect[2] - rect[0], rect[3] - rect[1], center_of(rect)
    if kind == "none":
        return None
    if kind == "circle":
        same = width / 2 if initial == "circle" else math.sqrt(width * height / math.pi)
        return jostle.Circle(center, same)
    if initial == "circle":
        width = height = width / 2 * math.sqrt(math.pi)
    if kind == "torus":
        return jostle.Torus(width, height)
    (x, y), (across, down) = center, (width / 2, height / 2)
    return jostle.Box(x - across, y - down, x + across, y + down)


def moved_inside(positions: Floats, radii: Floats, container: Container) -> Floats:
    """Return the nearest positions inside the container."""
    if isinstance(container, jostle.Circle):
        away = positions - np.array(container.center)
        distance = np.sqrt(away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1])
        farthest = np.maximum(container.radius - radii, 0.0)
        share = farthest / np.maximum(distance, 1e-30)
        near = np.array(container.center) + away * share[:, None]
        # Those inside are not computed from their offset, whose rounding would move them.
        return np.where((distance > farthest)[:, None], near, positions)
    if isinstance(container, jostle.Torus):
        wrapped: Floats = np.mod(positions, np.array([container.width, container.height]))
        return wrapped
    if isinstance(container, jostle.Box):
        low = np.array([container.min_x, container.min_y]) + radii[:, None]
        high = np.array([container.max_x, container.max_y]) - radii[:, None]
        middle = (low + high) / 2
        return np.clip(positions, np.minimum(low, middle), np.maximum(high, middle))
    return positions


def are_inside(positions: Floats, radii: Floats, container: Container) -> NDArray[np.bool_]:
    """Return which positions are inside the container."""
    inside: NDArray[np.bool_] = moved_inside(positions, radii, container) == positions
    return inside.all(axis=1)
