"""Expected results of queries: the formulas for every shape, in plain NumPy.

Each function takes one query and returns for all shapes whether they are found, or their
distances, in the dtype of the shapes.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from oracle import Shapes, open_overlap

QUIET = {"over": "ignore", "under": "ignore", "invalid": "ignore", "divide": "ignore"}

# Beyond these, squares overflow or underflow: numbers are multiplied by a power of two, which does
# not round them.
RANGES = {"float32": (2.0**50, 2.0**-50, 2.0**90), "float64": (2.0**500, 2.0**-500, 2.0**600)}


def into_range(largest: NDArray[Any]) -> NDArray[Any]:
    """Return the factor of numbers up to `largest` before they are squared."""
    large, small, step = RANGES[str(largest.dtype)]
    factor = np.where(largest > large, 1 / step, np.where(largest < small, step, 1.0))
    return factor.astype(largest.dtype)


class Cores(NamedTuple):
    """Cores of shapes: boxes from `low` to `high`, larger by `half` on each side; and radii."""

    low: NDArray[Any]
    high: NDArray[Any]
    half: NDArray[Any]
    radii: NDArray[Any]

    def are_points(self) -> NDArray[np.bool_]:
        """Whether each shape is a circle."""
        return ((self.low == self.high) & (self.half == 0)).all(axis=1)


def cores_of(shapes: Shapes) -> Cores:
    """The cores of shapes with centres and half sizes."""
    half = np.zeros_like(shapes.centers) if shapes.half_sizes is None else shapes.half_sizes
    return Cores(shapes.centers, shapes.centers, half, shapes.radii)


def cores_of_boxes(boxes: NDArray[Any], radii: NDArray[Any]) -> Cores:
    """The cores of shapes that are given as boxes."""
    return Cores(boxes[:, :2], boxes[:, 2:], np.zeros_like(boxes[:, :2]), radii)


def gaps(cores: Cores, low: NDArray[Any], high: NDArray[Any]) -> NDArray[Any]:
    """The gap of each core to a rectangle along each axis; negative if they overlap."""
    return np.maximum(low - cores.high, cores.low - high) - cores.half


def in_rect(cores: Cores, rect: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether each shape overlaps a rectangle."""
    with np.errstate(**QUIET):
        return open_overlap(gaps(cores, rect[:2], rect[2:]), cores.radii)


def in_circle(cores: Cores, center: NDArray[Any], radius: Any) -> NDArray[np.bool_]:
    """Whether each shape overlaps a disc."""
    with np.errstate(**QUIET):
        return open_overlap(gaps(cores, center, center), cores.radii + radius)


def _within(outside: NDArray[Any], radii: NDArray[Any]) -> NDArray[np.bool_]:
    squares = outside[:, 0] ** 2 + outside[:, 1] ** 2 <= radii**2
    return np.where(radii == 0, outside.max(axis=1, initial=0) == 0, squares)


def at_point(cores: Cores, point: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether a point is in each shape; rectangles are open on the right and below."""
    low, high, half, radii = cores
    with np.errstate(**QUIET):
        closed = _within(np.maximum(gaps(cores, point, point), 0), radii)
        half_open = ((point - low >= -half) & (point - high < half)).all(axis=1)
    return np.where((radii == 0) & ~cores.are_points(), half_open, closed)


def distance(cores: Cores, point: NDArray[Any]) -> NDArray[Any]:
    """Return the distance of a point from the surface of each shape; 0 inside."""
    with np.errstate(**QUIET):
        outside = np.maximum(gaps(cores, point, point), 0)
        into = into_range(outside.max(axis=1, initial=0))
        x, y = outside[:, 0] * into, outside[:, 1] * into
        return np.maximum(np.sqrt(x**2 + y**2) * (1 / into) - cores.radii, 0)


def along_ray(
    cores: Cores, origin: NDArray[Any], direction: NDArray[Any], radius: Any
) -> NDArray[Any]:
    """Return the distance along a ray to each shape, enlarged by a radius; infinity for a miss."""
    with np.errstate(**QUIET):
        scaled = direction / np.abs(direction).max()
        u = scaled / np.sqrt(scaled[0] ** 2 + scaled[1] ** 2)
        reach = cores.radii + radius
        inside = _within(np.maximum(gaps(cores, origin, origin), 0), reach)
        columns = (origin - cores.low, origin - cores.high, cores.half, reach[:, None])
        into = into_range(np.abs(np.hstack(columns)).max(axis=1, initial=0))[:, None]
        low, high = (origin * into - side * into for side in (cores.low, cores.high))
        half, reach = cores.half * into, (reach[:, None] * into)[:, 0]
        nothing = np.zeros_like(reach)
        ways = [
            to_box(low, high, u, half + np.stack(grown, axis=1))
            for grown in ([reach, nothing], [nothing, reach])
        ]
        first, last = low + half, high - half
        for x in (first[:, 0], last[:, 0]):
            ways += [to_circle(np.stack([x, y], 1), u, reach) for y in (first[:, 1], last[:, 1])]
        far = np.where(reach == 0, to_box(low, high, u, half), np.minimum.reduce(ways))
        far = np.where(cores.are_points(), to_circle(low, u, reach), far)
        return np.where(inside, cores.radii.dtype.type(0), far * (1 / into[:, 0]))


def to_circle(m: NDArray[Any], u: NDArray[Any], radius: NDArray[Any]) -> NDArray[Any]:
    """The distance along a ray from m in the direction u to a circle around the origin."""
    along = m[:, 0] * u[0] + m[:, 1] * u[1]
    aside = m[:, 0] * u[1] - m[:, 1] * u[0]
    half_chord = radius**2 - aside**2
    meets = (along <= 0) & (np.abs(aside) <= radius)
    far = np.maximum(-along - np.sqrt(np.maximum(half_chord, 0)), 0)
    return np.where(meets, far, np.inf).astype(m.dtype)


def to_box(
    low: NDArray[Any], high: NDArray[Any], u: NDArray[Any], half: NDArray[Any]
) -> NDArray[Any]:
    """The distance to a box; `low` and `high` are the offsets of the ray from its corners."""
    enter, leave = np.zeros(len(low), low.dtype), np.full(len(low), np.inf, low.dtype)
    for axis in range(2):
        if u[axis] == 0:
            beside = np.maximum(-low[:, axis], high[:, axis]) > half[:, axis]
            leave = np.where(beside, -np.inf, leave)
            continue
        first = (-half[:, axis] - low[:, axis]) / u[axis]
        second = (half[:, axis] - high[:, axis]) / u[axis]
        enter = np.maximum(enter, np.minimum(first, second))
        leave = np.minimum(leave, np.maximum(first, second))
    return np.where(enter <= leave, enter, np.inf).astype(low.dtype)


def k_nearest(
    distances: NDArray[Any], k: int, max_distance: float
) -> tuple[NDArray[Any], NDArray[np.intp]]:
    """Return the k smallest, the first of equal ones; infinity and -1 if there are fewer."""
    order = np.lexsort((np.arange(len(distances)), distances))[:k]
    order = order[distances[order] <= max_distance]
    ids, far = np.full(k, -1), np.full(k, np.inf, distances.dtype)
    ids[: len(order)], far[: len(order)] = order, distances[order]
    return far, ids
