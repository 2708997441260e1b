"""Walls of another kind or size, and room for more particles: what sliders change while it runs."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle.app.simulation import Container, Rect
from jostle.app.stage import bounds

ROUNDS = 12  # of looking for free places
NEAR = 1.02  # free is what lies this many radii apart

Floats = NDArray[np.float64]


def kind_of(container: Container) -> str:
    """Return "box", "circle", "torus" or "none"."""
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


def container_of(kind: str, rect: Rect, *, from_circle: bool = False) -> Container:
    """Return walls of a kind over a rectangle.

    A circle in the place of a rectangle has the same centre and the same area, and a rectangle in
    the place of a circle too, so that all have room in it. A torus begins at the origin.
    """
    min_x, min_y, max_x, max_y = rect
    width, height = max_x - min_x, max_y - min_y
    center = (min_x + max_x) / 2, (min_y + max_y) / 2
    if kind == "circle":
        radius = width / 2 if from_circle else math.sqrt(width * height / math.pi)
        return jostle.Circle(center, radius)
    if from_circle:
        width = height = width / 2 * math.sqrt(math.pi)
    if kind == "torus":
        return jostle.Torus(width, height)
    if kind == "box":
        (x, y), half = center, (width / 2, height / 2)
        return jostle.Box(x - half[0], y - half[1], x + half[0], y + half[1])
    return None


def brought_in(positions: Floats, radii: Floats, container: Container) -> Floats:
    """Return places inside the walls: what is outside goes to the nearest place that is not."""
    if isinstance(container, jostle.Circle):
        away = positions - np.array(container.center)
        distance = np.hypot(away[:, 0], away[:, 1])
        room = np.maximum(container.radius - radii, 0.0)
        share = np.where(distance > room, room / np.maximum(distance, 1e-30), 1.0)
        return np.array(container.center) + away * share[:, None]
    if isinstance(container, jostle.Torus):
        return np.mod(positions, np.array([container.width, container.height]))
    if isinstance(container, jostle.Box):
        low = np.array([container.min_x, container.min_y]) + radii[:, None]
        high = np.array([container.max_x, container.max_y]) - radii[:, None]
        middle = (low + high) / 2
        return np.clip(positions, np.minimum(low, middle), np.maximum(high, middle))
    return positions


def free_places(
    taken: NDArray[np.floating],
    taken_radii: NDArray[np.floating],
    radii: NDArray[np.floating],
    container: Container,
    view: Rect,
    seed: int,
) -> tuple[Floats, NDArray[np.intp]]:
    """Return random places for discs where nothing is, and which of the discs found one."""
    chance = np.random.default_rng([seed, len(taken), len(radii)])
    rect = np.array(_common(bounds(container), view)).reshape(2, 2)
    places = np.zeros((len(radii), 2))
    found = np.zeros(len(radii), np.bool_)
    there, sizes = np.asarray(taken, np.float64), np.asarray(taken_radii, np.float64)
    for _ in range(ROUNDS):
        left = np.flatnonzero(~found)
        if len(left) == 0:
            break
        tries = brought_in(
            chance.uniform(rect[0], rect[1], (len(left), 2)), radii[left], container
        )
        free = _free(tries, radii[left], there, sizes)
        chosen = left[free]
        places[chosen], found[chosen] = tries[free], True
        there = np.concatenate([there, tries[free]])
        sizes = np.concatenate([sizes, radii[chosen]])
    return places[found], np.flatnonzero(found)


def _free(
    tries: Floats,
    radii: NDArray[np.floating],
    there: Floats,
    sizes: NDArray[np.floating],
) -> NDArray[np.bool_]:
    """Return which tries overlap neither what is there nor a try before them."""
    both = np.concatenate([there, tries])
    reach = np.concatenate([sizes, radii]) * NEAR
    pairs = jostle.find_pairs(both, reach)
    later = pairs[:, 1] >= len(there)
    free = np.ones(len(tries), np.bool_)
    free[pairs[later, 1].astype(np.intp) - len(there)] = False
    return free


def _common(walls: Rect | None, view: Rect) -> Rect:
    """Return what both rectangles have in common; the walls alone where that is nothing."""
    if walls is None:
        return view
    low_x, low_y = max(walls[0], view[0]), max(walls[1], view[1])
    high_x, high_y = min(walls[2], view[2]), min(walls[3], view[3])
    return (low_x, low_y, high_x, high_y) if low_x < high_x and low_y < high_y else walls
