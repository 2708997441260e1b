"""Expected results of queries: the formulas for every shape, in plain NumPy.

Each function takes one query and returns for all shapes whether they are found, or their
distances, in the dtype of the shapes.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from oracle import Shapes

QUIET = {"over": "ignore", "under": "ignore", "invalid": "ignore", "divide": "ignore"}

# Beyond these, squares overflow or underflow: numbers are multiplied by a power of two, which does
# not round them.
RANGES = {"float32": (2.0**50, 2.0**-50, 2.0**90), "float64": (2.0**500, 2.0**-500, 2.0**600)}


def into_range(largest: NDArray[Any]) -> NDArray[Any]:
    """Return the factor of numbers up to `largest` before they are squared."""
    large, small, step = RANGES[str(largest.dtype)]
    factor = np.where(largest > large, 1 / step, np.where(largest < small, step, 1.0))
    return factor.astype(largest.dtype)


def halves(shapes: Shapes) -> NDArray[Any]:
    """Half sizes, 0 for circles."""
    return np.zeros_like(shapes.centers) if shapes.half_sizes is None else shapes.half_sizes


def open_overlap(gap: NDArray[Any], reach: NDArray[Any]) -> NDArray[np.bool_]:
    outside = np.maximum(gap, 0)
    near = outside[:, 0] ** 2 + outside[:, 1] ** 2 < reach**2
    return near | (gap < 0).all(axis=1)


def in_rect(shapes: Shapes, rect: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether each shape overlaps a rectangle."""
    with np.errstate(**QUIET):
        gap = np.maximum(rect[:2] - shapes.centers, shapes.centers - rect[2:]) - halves(shapes)
        return open_overlap(gap, shapes.radii)


def in_circle(shapes: Shapes, center: NDArray[Any], radius: Any) -> NDArray[np.bool_]:
    """Whether each shape overlaps a disc."""
    with np.errstate(**QUIET):
        return open_overlap(np.abs(shapes.centers - center) - halves(shapes), shapes.radii + radius)


def _within(outside: NDArray[Any], radii: NDArray[Any]) -> NDArray[np.bool_]:
    squares = outside[:, 0] ** 2 + outside[:, 1] ** 2 <= radii**2
    return np.where(radii == 0, outside.max(axis=1, initial=0) == 0, squares)


def at_point(shapes: Shapes, point: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether a point is in each shape; rectangles are open on the right and below."""
    half = halves(shapes)
    with np.errstate(**QUIET):
        offset = point - shapes.centers
        outside = np.maximum(np.abs(offset) - half, 0)
        closed = _within(outside, shapes.radii)
        half_open = ((offset >= -half) & (offset < half)).all(axis=1)
    rectangle = (shapes.radii == 0) & (half > 0).any(axis=1)
    return np.where(rectangle, half_open, closed)


def distance(shapes: Shapes, point: NDArray[Any]) -> NDArray[Any]:
    """Return the distance of a point from the surface of each shape; 0 inside."""
    with np.errstate(**QUIET):
        outside = np.maximum(np.abs(shapes.centers - point) - halves(shapes), 0)
        into = into_range(outside.max(axis=1, initial=0))
        x, y = outside[:, 0] * into, outside[:, 1] * into
        return np.maximum(np.sqrt(x**2 + y**2) * (1 / into) - shapes.radii, 0)


def along_ray(
    shapes: Shapes, origin: NDArray[Any], direction: NDArray[Any], radius: Any
) -> NDArray[Any]:
    """Return the distance along a ray to each shape, enlarged by a radius; infinity for a miss."""
    dtype = shapes.centers.dtype
    half, nothing = halves(shapes), dtype.type(0)
    with np.errstate(**QUIET):
        scaled = direction / np.abs(direction).max()
        u = scaled / np.sqrt(scaled[0] ** 2 + scaled[1] ** 2)
        m = origin - shapes.centers
        reach = shapes.radii + radius
        inside = _within(np.maximum(np.abs(m) - half, 0), reach)
        largest = np.maximum(np.abs(m).max(axis=1, initial=0), half.max(axis=1, initial=0))
        into = into_range(np.maximum(largest, reach))
        half, reach = half * into[:, None], reach * into
        m = origin * into[:, None] - shapes.centers * into[:, None]
        ways = [
            to_box(m, m, u, half + np.stack([reach, np.zeros_like(reach)], axis=1)),
            to_box(m, m, u, half + np.stack([np.zeros_like(reach), reach], axis=1)),
        ]
        corners = [(-1, -1), (1, -1), (-1, 1), (1, 1)]
        ways += [to_circle(m - half * np.array(c, dtype), u, reach) for c in corners]
        rounded = np.minimum.reduce(ways)
        circle = (half == 0).all(axis=1)
        far = np.where(circle, to_circle(m, u, reach), rounded)
        far = np.where(~circle & (reach == 0), to_box(m, m, u, half), far)
        return np.where(inside, nothing, far * (1 / into))


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
