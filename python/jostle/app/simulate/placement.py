"""Random directions, and free positions at which discs can be added without touching others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle.app.simulate.containers import are_inside, bounds, moved_inside, wall_images
from jostle.app.simulate.simulation import Container, Frame, Rect
from jostle.app.simulate.wall_segments import Ends, clear_of

Floats = NDArray[np.floating]

TRIES = 8  # points in a square; with probability 1/220,000 none of them is in the disc
ROUNDS = 24
ATTEMPTS, LEAST, MOST = 16, 1_000, 200_000  # per disc, and per round
NEAR = 1.02  # times the radius, as the least distance


def in_disc(tries: Floats) -> Floats:
    """Return points distributed evenly over the disc of radius 1, from points in a square.

    Of each row of `tries`, (n, `TRIES`, 2) from 0 to 1, the first that is in the disc is used.
    """
    points = 2 * tries - 1
    inside: NDArray[np.bool_] = (points * points).sum(axis=2) <= 1
    first = points[np.arange(len(points)), inside.argmax(axis=1)]
    found = inside.any(axis=1)
    chosen: Floats = first * np.where(found, 1.0, 0.5)[:, None]
    return chosen


def random_in_disc(rng: np.random.Generator, count: int) -> Floats:
    """Return random points distributed evenly over the disc of radius 1."""
    return in_disc(rng.random((count, TRIES, 2)))


def directions(rng: np.random.Generator, count: int) -> Floats:
    """Return random vectors of length 1."""
    points = random_in_disc(rng, count)
    lengths: Floats = np.sqrt((points * points).sum(axis=1))
    points[lengths == 0], lengths[lengths == 0] = (1, 0), 1
    return points / lengths[:, None]


def free_positions(
    taken: Floats,
    taken_radii: Floats,
    radii: Floats,
    container: Container,
    view: Rect,
    seed: int,
    walls: Ends,
) -> tuple[Floats, NDArray[np.intp]]:
    """Return random free positions for discs, and the rows of the discs that have one."""
    rng = np.random.default_rng([seed, len(taken), len(radii)])
    rect = np.array(common(bounds(container), view)).reshape(2, 2)
    places = np.zeros((len(radii), 2))
    found = np.zeros(len(radii), np.bool_)
    images, _ = wall_images(container, walls, float(np.max(radii, initial=0.0)))
    there, sizes = np.asarray(taken, np.float64), np.asarray(taken_radii, np.float64)
    for _ in range(ROUNDS):
        left = np.flatnonzero(~found)
        if len(left) == 0:
            break
        who = np.resize(left, min(max(ATTEMPTS * len(left), LEAST), MOST))
        tries = moved_inside(rng.uniform(rect[0], rect[1], (len(who), 2)), radii[who], container)
        clear = _clear_of(tries, radii[who], there, sizes)
        free = np.flatnonzero(clear & clear_of(tries, radii[who], images))
        _, first = np.unique(who[free], return_index=True)
        taken_now = free[first]  # one position per disc
        taken_now = taken_now[_apart(tries[taken_now], radii[who[taken_now]])]
        if len(taken_now) == 0:
            break
        chosen = who[taken_now]
        places[chosen], found[chosen] = tries[taken_now], True
        there = np.concatenate([there, tries[taken_now]])
        sizes = np.concatenate([sizes, radii[chosen]])
    return places[found], np.flatnonzero(found)


def free_among(places: Floats, radius: float, frame: Frame) -> NDArray[np.intp]:
    """Return the rows of the places at which a disc overlaps nothing, and none of these rows."""
    radii = np.full(len(places), radius)
    images, _ = wall_images(frame.container, frame.walls, radius)
    free = are_inside(places, radii, frame.container)
    free &= _clear_of(
        places, radii, frame.positions.astype(np.float64), frame.radii.astype(np.float64)
    )
    rows = np.flatnonzero(free & clear_of(places, radii, images))
    return rows[_apart(places[rows], radii[rows])]


def _clear_of(tries: Floats, radii: Floats, there: Floats, sizes: Floats) -> NDArray[np.bool_]:
    """Return which tries overlap no disc."""
    clear = np.ones(len(tries), np.bool_)
    if len(there):
        new, old = jostle.Quadtree(tries, radii * NEAR), jostle.Quadtree(there, sizes * NEAR)
        clear[new.pairs(old)[:, 0].astype(np.intp)] = False
    return clear


def _apart(places: Floats, radii: Floats) -> NDArray[np.bool_]:
    """Return which positions overlap none before them."""
    apart = np.ones(len(places), np.bool_)
    apart[jostle.find_pairs(places, radii * NEAR)[:, 1].astype(np.intp)] = False
    return apart


def common(walls: Rect | None, view: Rect) -> Rect:
    """Return the intersection of both rectangles; the walls if it is empty."""
    if walls is None:
        return view
    low_x, low_y = max(walls[0], view[0]), max(walls[1], view[1])
    high_x, high_y = min(walls[2], view[2]), min(walls[3], view[3])
    return (low_x, low_y, high_x, high_y) if low_x < high_x and low_y < high_y else walls
