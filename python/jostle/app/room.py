"""Free places: where discs can be added without touching any other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle.app.simulation import Container, Rect
from jostle.app.walls import bounds, brought_in

ROUNDS = 12  # of looking for free places
NEAR = 1.02  # free is what lies this many radii apart

Floats = NDArray[np.floating]


def free_places(
    taken: Floats,
    taken_radii: Floats,
    radii: Floats,
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
        tries = brought_in(chance.uniform(rect[0], rect[1], (len(left), 2)), radii[left], container)
        free = _free(tries, radii[left], there, sizes)
        chosen = left[free]
        places[chosen], found[chosen] = tries[free], True
        there = np.concatenate([there, tries[free]])
        sizes = np.concatenate([sizes, radii[chosen]])
    return places[found], np.flatnonzero(found)


def _free(
    tries: Floats,
    radii: Floats,
    there: Floats,
    sizes: Floats,
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
