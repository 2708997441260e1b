"""Containers: their bounds, another kind or size, and free positions inside for discs."""

import math
import re
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator
from pydantic.dataclasses import dataclass

import jostle
from jostle_lab.schema import FARTHEST, FORBID, ContainerKind, Count, Region, fault
from jostle_lab.simulate.frame import Rect
from jostle_lab.simulate.region import Container, Torus, container_of

Floats = NDArray[np.floating]

# A scene may be scaled by up to 100; its view must then still be within the limits.
_LARGEST = FARTHEST / 1_000


def _is_scalable(rect: Rect) -> Rect:
    if max(map(abs, rect)) > _LARGEST:
        raise fault(f"it must be within ±{_LARGEST:g}")
    return rect


_Region = Annotated[Region, AfterValidator(_is_scalable)]


def bounds(container: Container) -> Rect | None:
    if container is None:
        return None
    if isinstance(container, Torus):
        return 0.0, 0.0, container.width, container.height
    min_x, min_y, max_x, max_y = container.bounds.tolist()
    return min_x, min_y, max_x, max_y


def minimum_image(container: Container, offsets: Floats) -> Floats:
    """Return the shortest periodic images of offsets, (2,) or (n, 2)."""
    if isinstance(container, Torus):
        sides = np.array([container.width, container.height])
        offsets = offsets - sides * np.round(offsets / sides)
    return offsets


def crosses(container: Container, starts: Floats, ends: Floats) -> NDArray[np.bool_]:
    """Return which lines are longer than half a side of a torus: they cross its boundary."""
    if not isinstance(container, Torus):
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
    if not isinstance(container, Torus) or len(ends) == 0:
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


def kind_of(container: Container) -> ContainerKind:
    if isinstance(container, jostle.Box):
        return "box"
    if isinstance(container, jostle.Circle):
        return "circle"
    return "none" if container is None else "torus"


def scaled(rect: Rect, factor: float, around: Rect) -> Rect:
    """Return a rectangle scaled about the centre of another."""
    x, y = center_of(around)
    x0, x1 = (x + (side - x) * factor for side in rect[::2])
    y0, y1 = (y + (side - y) * factor for side in rect[1::2])
    return x0, y0, x1, y1


@dataclass(frozen=True, config=FORBID)
class InitialRegion:
    """The initial container, view and number of particles of a scene."""

    view: _Region
    rect: _Region  # bounds of the container; the view if there is none
    kind: ContainerKind
    n: Count | None

    @classmethod
    def of(cls, container: Container, view: Rect, n: int | None) -> "InitialRegion":
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
        return Torus(width, height)
    (x, y), (across, down) = center, (width / 2, height / 2)
    return jostle.Box(x - across, y - down, x + across, y + down)


def moved_inside(positions: Floats, radii: Floats, container: Container) -> Floats:
    """Return the nearest positions inside the container."""
    if isinstance(container, jostle.Circle):
        away = positions - container.center
        distance = np.sqrt(away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1])
        farthest = np.maximum(container.radius - radii, 0.0)
        share = farthest / np.maximum(distance, 1e-30)
        near = container.center + away * share[:, None]
        # Those inside are not computed from their offset, whose rounding would move them.
        return np.where((distance > farthest)[:, None], near, positions)
    if isinstance(container, Torus):
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
    inside: NDArray[np.bool_] = (moved_inside(positions, radii, container) == positions).all(axis=1)
    return inside


# Random directions, and free positions

NEAR = 1.02  # times the radius, as the least distance


def random_in_disc(rng: np.random.Generator, count: int) -> Floats:
    """Return random points distributed evenly over the disc of radius 1."""
    return directions(rng, count) * np.sqrt(rng.random((count, 1)))


def directions(rng: np.random.Generator, count: int) -> Floats:
    """Return random vectors of length 1."""
    points = rng.normal(size=(count, 2))
    ways: Floats = points / np.sqrt((points * points).sum(axis=1, keepdims=True))
    return ways


def free_positions(
    world: jostle.World, radii: Floats, view: Rect, seed: int
) -> tuple[NDArray[np.float32], NDArray[np.intp]]:
    """Return random free positions for discs, and the rows of the discs that have one."""
    x0, y0, x1, y1 = common(bounds(container_of(world)), view)
    around, rows = float(np.min(radii, initial=FARTHEST)), np.argsort(-radii, kind="stable")
    region = jostle.Box(x0 - around, y0 - around, x1 + around, y1 + around)  # of whole discs
    rows = rows[radii[rows] <= around + min(x1 - x0, y1 - y0) / 2]
    while len(rows):  # the library finds room for the largest first, or says for how many
        try:
            return world.free_positions(len(rows), radii[rows], region=region, seed=seed), rows
        except ValueError as error:
            found = re.search(r"there is room for (\d+)", str(error))
            rows = rows[: int(found[1]) if found else 0]
    return np.zeros((0, 2), np.float32), rows


def free_among(world: jostle.World, places: Floats, radius: float) -> NDArray[np.intp]:
    """Return the rows of the places at which a disc overlaps nothing, and none of these rows."""
    radii = np.full(len(places), radius * NEAR)
    free = are_inside(places, radii / NEAR, container_of(world))
    for there in (world, world.walls):
        free &= np.diff(there.query_circle(places, radii).offsets) == 0
    rows = np.flatnonzero(free)
    apart = np.ones(len(rows), np.bool_)
    apart[jostle.find_pairs(places[rows], radii[rows])[:, 1].astype(np.intp)] = False
    return rows[apart]


def common(walls: Rect | None, view: Rect) -> Rect:
    """Return the intersection of both rectangles; the walls if it is empty."""
    if walls is None:
        return view
    low_x, low_y = max(walls[0], view[0]), max(walls[1], view[1])
    high_x, high_y = min(walls[2], view[2]), min(walls[3], view[3])
    return (low_x, low_y, high_x, high_y) if low_x < high_x and low_y < high_y else walls
