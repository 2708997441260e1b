"""Neighbours of every point within a distance, compared with other libraries, building included.

.venv/bin/python benchmarks/neighbors.py [ROUNDS] [POINTS]

All use float64, except freud, and two threads where they have threads. The numbers of neighbours
are compared before the times are measured.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from machine import Row, version_of
from numpy.typing import NDArray
from timing import interleaved

import jostle

POINTS, ROUNDS, NEIGHBORS = 100_000, 15, 8
# So that rounding decides about no pair, points are on a coarse grid and the squared distances of
# the grid leave out the limit.
GRID = 2.0**-20

Points = NDArray[np.float64]
Call = Callable[[Points, float], Any]


def points_of(count: int) -> Points:
    """Points of the unit square, on a grid."""
    return np.floor(np.random.default_rng(0).random((count, 2)) / GRID) * GRID


def distance_for(count: int) -> float:
    """A distance within which a point has about `NEIGHBORS` others, between those of the grid."""
    steps = np.floor(np.sqrt(NEIGHBORS / (np.pi * count)) / GRID)
    return float((steps + 0.5) * GRID)


def ours(points: Points, distance: float) -> Any:
    return jostle.Quadtree(points).neighbors(distance)


def ours_periodic(points: Points, distance: float) -> Any:
    return jostle.Quadtree(points, period=1.0).neighbors(distance)


def our_pairs(points: Points, distance: float) -> Any:
    return jostle.find_pairs(points, distance=distance)


def our_periodic_pairs(points: Points, distance: float) -> Any:
    return jostle.find_pairs(points, distance=distance, period=1.0)


def scipy_lists(points: Points, distance: float) -> Any:
    from scipy.spatial import cKDTree

    return cKDTree(points).query_ball_point(points, distance, workers=os.cpu_count())


def scipy_periodic_lists(points: Points, distance: float) -> Any:
    from scipy.spatial import cKDTree

    tree = cKDTree(points, boxsize=1.0)
    return tree.query_ball_point(points, distance, workers=os.cpu_count())


def scipy_pairs(points: Points, distance: float) -> Any:
    from scipy.spatial import cKDTree

    return cKDTree(points).query_pairs(distance, output_type="ndarray")


def scipy_periodic_pairs(points: Points, distance: float) -> Any:
    from scipy.spatial import cKDTree

    return cKDTree(points, boxsize=1.0).query_pairs(distance, output_type="ndarray")


def freud_list(points: Points, distance: float) -> Any:
    """Find the neighbours as freud's documents do: in a periodic box around the origin."""
    import freud

    places = np.column_stack([points - 0.5, np.zeros(len(points))]).astype(np.float32)
    # With cells of this width (`LinkCell`) it takes sixty times as long.
    query = freud.locality.AABBQuery(freud.box.Box.square(1.0), places)
    found = query.query(places, {"r_max": distance, "exclude_ii": True})
    return found.toNeighborList()


def _layer(points: Points, distance: float) -> tuple[Points, Points]:
    """Return points of a flat box and its cell, which is high enough for no neighbours above."""
    return np.column_stack([points, np.zeros(len(points))]), np.diag([1.0, 1.0, 3 * distance])


def _matscipy(points: Points, distance: float, *, periodic: bool) -> Any:
    from matscipy.neighbours import neighbour_list

    places, cell = _layer(points, distance)
    return neighbour_list(
        "ij", positions=places, cutoff=distance, cell=cell, pbc=[periodic, periodic, False]
    )


def _vesin(points: Points, distance: float, *, periodic: bool) -> Any:
    from vesin import NeighborList

    places, cell = _layer(points, distance)
    neighbours = NeighborList(cutoff=distance, full_list=True, n_threads=os.cpu_count())
    return neighbours.compute(places, cell, periodic, "ij")


def count_of(found: Any) -> int:
    """Return the number of pairs, each in both orders."""
    if isinstance(found, jostle.IdLists):
        return len(found.ids)
    if isinstance(found, tuple | list):  # the rows and the columns
        return len(found[0])
    if isinstance(found, np.ndarray) and found.dtype == object:
        return sum(map(len, found)) - len(found)  # each point finds itself
    return 2 * len(found) if isinstance(found, np.ndarray) else len(found)


PARTS: dict[str, list[tuple[str, str, Call]]] = {
    "lists": [
        ("jostle, neighbors", "jostle", ours),
        ("SciPy cKDTree, query_ball_point", "scipy", scipy_lists),
        ("matscipy", "matscipy", partial(_matscipy, periodic=False)),
        ("vesin", "vesin", partial(_vesin, periodic=False)),
    ],
    "lists, periodic": [
        ("jostle, neighbors", "jostle", ours_periodic),
        ("SciPy cKDTree, boxsize, query_ball_point", "scipy", scipy_periodic_lists),
        ("freud AABBQuery, float32", "freud-analysis", freud_list),
        ("matscipy", "matscipy", partial(_matscipy, periodic=True)),
        ("vesin", "vesin", partial(_vesin, periodic=True)),
    ],
    "pairs": [
        ("jostle, find_pairs", "jostle", our_pairs),
        ("SciPy cKDTree, query_pairs", "scipy", scipy_pairs),
    ],
    "pairs, periodic": [
        ("jostle, find_pairs", "jostle", our_periodic_pairs),
        ("SciPy cKDTree, boxsize, query_pairs", "scipy", scipy_periodic_pairs),
    ],
}


def race(rounds: int, largest: int) -> Iterator[list[Row]]:
    """Yield the times of all that are installed, for each part."""
    count = min(POINTS, largest)
    points, distance = points_of(count), distance_for(count)
    for part, rivals in PARTS.items():
        there = [rival for rival in rivals if version_of(rival[1])]
        counts = [count_of(call(points, distance)) for _, _, call in there]
        # freud's float32 moves points across the limit.
        if any(abs(found - counts[0]) > 1e-4 * counts[0] for found in counts):
            raise SystemExit(f"{part}: {counts} neighbours")
        calls = [lambda call=call: call(points, distance) for _, _, call in there]
        timings = interleaved(calls, rounds)
        yield [
            {
                "task": part,
                "count": count,
                "rival": name,
                "version": version_of(package),
                "median_s": f"{timing.median:.4g}",
                "neighbors": found,
            }
            for (name, package, _), timing, found in zip(there, timings, counts, strict=True)
        ]


if __name__ == "__main__":
    asked = [int(text) for text in sys.argv[1:]]
    print(f"about {NEIGHBORS} neighbours each, {os.cpu_count()} cores")
    for rows in race(*(asked + [ROUNDS, POINTS][len(asked) :])):
        for row in rows:
            print("  ".join(str(value) for value in row.values()), flush=True)
