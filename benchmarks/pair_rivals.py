"""The compared libraries that find overlapping pairs, each a function of a few lines.

A function takes `Shapes` and returns the pairs as an (m, 2) array, in any order. Building and
conversion are included. It raises `Unable` for shapes that it does not support.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain, combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from shapes import Floats, Shapes

import jostle

__all__ = ["RIVALS", "Pairs", "Rival", "Unable"]

Pairs = NDArray[Any]


class Unable(Exception):
    """The library does not support these shapes; the text says why."""


@dataclass(frozen=True)
class Rival:
    """A function that finds pairs.

    The best of `settings` is chosen before timing; `most` is the largest number of shapes, limited
    by memory.
    """

    name: str
    package: str
    find: Callable[..., Pairs]
    manner: str = "exact"
    threads: tuple[int, ...] = (1,)
    settings: tuple[Mapping[str, Any], ...] = field(default=({},))
    most: int = 10_000_000


# ---- jostle --------------------------------------------------------------------------------------


def jostle_double(shapes: Shapes, threads: int) -> Pairs:
    """In float64."""
    return jostle.find_pairs(shapes.centers, shapes.radii, shapes.half_sizes, threads=threads)


def jostle_single(shapes: Shapes, threads: int) -> Pairs:
    """In float32; conversion is included."""
    halves = None if shapes.half_sizes is None else shapes.half_sizes.astype(np.float32)
    radii = np.asarray(shapes.radii, np.float32)
    return jostle.find_pairs(shapes.centers.astype(np.float32), radii, halves, threads=threads)


def jostle_brute(shapes: Shapes, threads: int) -> Pairs:
    """Test all pairs, in the same core."""
    return jostle.find_pairs(
        shapes.centers, shapes.radii, shapes.half_sizes, method="brute", threads=threads
    )


# ---- SciPy ---------------------------------------------------------------------------------------


def scipy_pairs(shapes: Shapes, threads: int, **setting: Any) -> Pairs:
    """Equal discs: centres closer than two radii."""
    from scipy.spatial import cKDTree

    if not shapes.equal:
        raise Unable("one radius for all")
    tree = cKDTree(shapes.centers, **setting)
    return np.asarray(tree.query_pairs(2 * shapes.radii, output_type="ndarray"))


def scipy_balls(shapes: Shapes, threads: int, **setting: Any) -> Pairs:
    """Discs: one query per disc for centres within twice its radius; smaller discs are kept."""
    from scipy.spatial import cKDTree

    if shapes.half_sizes is not None:
        raise Unable("discs only")
    tree, radii = cKDTree(shapes.centers, **setting), shapes.column()
    near = tree.query_ball_point(shapes.centers, 2 * radii, workers=threads, return_sorted=False)
    i, j = _flattened(near)
    first = (radii[i] > radii[j]) | ((radii[i] == radii[j]) & (i < j))
    return _touching(shapes, i[first], j[first])


SCIPY_SETTINGS = tuple(
    {"leafsize": leafsize, "balanced_tree": balanced, "compact_nodes": compact}
    for leafsize in (8, 16, 32)
    for balanced, compact in ((True, True), (False, True), (False, False))
)


# ---- shapely -------------------------------------------------------------------------------------


def shapely_boxes(shapes: Shapes, threads: int) -> Pairs:
    """Boxes that overlap, in bulk, each pair twice; discs are tested afterwards."""
    import shapely

    boxes = shapely.box(*shapes.boxes().T)
    i, j = shapely.STRtree(boxes).query(boxes)
    once = i < j
    return _touching(shapes, i[once], j[once])


def shapely_within(shapes: Shapes, threads: int) -> Pairs:
    """Discs: one query per disc for centres within twice its radius; smaller discs are kept."""
    import shapely

    if shapes.half_sizes is not None:
        raise Unable("discs only")
    places, radii = shapely.points(shapes.centers), shapes.column()
    i, j = shapely.STRtree(places).query(places, predicate="dwithin", distance=2 * radii)
    first = (radii[i] > radii[j]) | ((radii[i] == radii[j]) & (i < j))
    return _touching(shapes, i[first], j[first])


# ---- neighbour lists of chemistry ----------------------------------------------------------------


MATSCIPY_CELLS = 3e7
"""More cells than this take gigabytes."""

VESIN_CELLS = 95_000
"""Where vesin 0.6 comes to 100,000 cells in a layer, it divides by zero and ends the program."""


def matscipy_list(shapes: Shapes, threads: int) -> Pairs:
    """A cell list in three dimensions, with one layer; a radius for each shape."""
    from matscipy.neighbours import neighbour_list

    places, sides, widest = _layer(shapes)
    cutoff = 2 * shapes.radii if shapes.equal else shapes.column()
    sides[2] = widest
    if sides[0] * sides[1] / widest**2 > MATSCIPY_CELLS:
        raise Unable("its grid would need too much memory in so wide a world")
    i, j = neighbour_list(
        "ij", positions=places, cutoff=cutoff, cell=np.diag(sides), pbc=[False] * 3
    )
    once = i < j
    return np.column_stack([i[once], j[once]])


def vesin_list(shapes: Shapes, threads: int, algorithm: str) -> Pairs:
    """A cell list in three dimensions with one cutoff; other radii are tested afterwards."""
    from vesin import NeighborList

    places, sides, widest = _layer(shapes)
    if sides[0] * sides[1] / widest**2 > VESIN_CELLS:
        raise Unable("it ends the program where one layer has more than 100,000 cells")
    neighbours = NeighborList(
        cutoff=widest, full_list=False, algorithm=algorithm, n_threads=threads
    )
    pairs = np.asarray(neighbours.compute(places, np.diag(sides), False, "P")[0])
    return pairs if shapes.equal else _touching(shapes, pairs[:, 0], pairs[:, 1])


def _layer(shapes: Shapes) -> tuple[Floats, Floats, float]:
    """Return the centres as points of a flat box from 0 to `sides`, and the largest diameter."""
    if shapes.half_sizes is not None:
        raise Unable("discs only")
    low_x, low_y, high_x, high_y = shapes.bounds()
    places = np.zeros((len(shapes), 3))
    places[:, :2] = shapes.centers - (low_x, low_y)
    widest = 2 * float(np.max(shapes.radii))
    return places, np.array([high_x - low_x, high_y - low_y, 2 * widest]), widest


# ---- quadtrees with one query per shape ----------------------------------------------------------


def fastquadtree_queries(shapes: Shapes, threads: int, capacity: int) -> Pairs:
    """One query per shape: points for equal discs, boxes for others; bounds are fixed."""
    from fastquadtree import QuadTree, RectQuadTree

    boxes = shapes.boxes()
    kind = QuadTree if shapes.equal else RectQuadTree
    tree = kind(shapes.bounds(), capacity, dtype="f64")
    tree.insert_many_np(shapes.centers if shapes.equal else boxes)
    if shapes.equal:  # a centre within the square of two radii
        boxes = np.hstack([shapes.centers - 2 * shapes.radii, shapes.centers + 2 * shapes.radii])
    i, j = _flattened(tree.query_np(tuple(box))[0] for box in boxes.tolist())
    once = i < j
    return _touching(shapes, i[once], j[once])


def pyqtree_queries(shapes: Shapes, threads: int, max_items: int) -> Pairs:
    """One insertion and one query per box; bounds are fixed."""
    from pyqtree import Index

    tree, boxes = Index(shapes.bounds(), max_items=max_items), shapes.boxes().tolist()
    for number, box in enumerate(boxes):
        tree.insert(number, box)
    i, j = _flattened(list(tree.intersect(box)) for box in boxes)
    once = i < j
    return _touching(shapes, i[once], j[once])


# ---- the article's tree, and no tree -------------------------------------------------------------

ARTICLE_MAXIMUM = 3


def article_tree(shapes: Shapes, threads: int) -> Pairs:
    """The tree of 2015 in plain Python, without its rounding errors.

    A box of more than three shapes splits; each child contains all shapes that overlap it. The
    depth limit, 5 for the article's 500, grows with the number of shapes.
    """
    boxes, limit = shapes.boxes().tolist(), 5
    while 4**limit < 2 * len(shapes):
        limit += 1
    found: set[tuple[int, int]] = set()

    def build(x0: float, y0: float, x1: float, y1: float, level: int, members: list[int]) -> None:
        if len(members) <= ARTICLE_MAXIMUM or level == limit:
            for i, j in combinations(members, 2):
                a, b = boxes[i], boxes[j]
                if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]:
                    found.add((i, j))
            return
        x, y = (x0 + x1) / 2, (y0 + y1) / 2
        for a, b, c, d in ((x0, y0, x, y), (x, y0, x1, y), (x0, y, x, y1), (x, y, x1, y1)):
            inside = [
                i
                for i in members
                if boxes[i][0] <= c and a <= boxes[i][2] and boxes[i][1] <= d and b <= boxes[i][3]
            ]
            build(a, b, c, d, level + 1, inside)

    build(*shapes.bounds(), 0, list(range(len(shapes))))
    pairs = np.array(sorted(found), np.int64).reshape(-1, 2)
    return _touching(shapes, pairs[:, 0], pairs[:, 1])


def numpy_brute(shapes: Shapes, threads: int) -> Pairs:
    """Test all pairs in NumPy, without a library."""
    i, j = np.triu_indices(len(shapes), 1)
    return _touching(shapes, i, j)


# ---- shared functions ----------------------------------------------------------------------------


def _flattened(hits: Iterable[Any]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the hits of query 0, 1, … as two columns: query and hit."""
    lists = list(hits)
    counts = np.fromiter(map(len, lists), np.int64, len(lists))
    total = int(counts.sum())
    if total and isinstance(lists[0], np.ndarray):
        hit = np.concatenate(lists).astype(np.int64)
    else:
        hit = np.fromiter(chain.from_iterable(lists), np.int64, total)
    return np.repeat(np.arange(len(lists)), counts), hit


def _touching(shapes: Shapes, i: NDArray[Any], j: NDArray[Any]) -> Pairs:
    """Return the pairs that overlap."""
    apart = shapes.centers[i] - shapes.centers[j]
    if shapes.half_sizes is not None:
        reach = shapes.half_sizes[i] + shapes.half_sizes[j]
        keep = np.all(np.abs(apart) < reach, axis=1)
    else:
        radii = shapes.column()
        keep = np.einsum("ij,ij->i", apart, apart) < (radii[i] + radii[j]) ** 2
    return np.column_stack([i[keep], j[keep]])


def _all() -> Iterator[Rival]:
    both = (1, 2)
    yield Rival("jostle", "jostle", jostle_double, threads=both)
    yield Rival("jostle, float32", "jostle", jostle_single, threads=both)
    yield Rival("SciPy cKDTree", "scipy", scipy_pairs, settings=SCIPY_SETTINGS)
    yield Rival(
        "SciPy cKDTree, ball by ball",
        "scipy",
        scipy_balls,
        "query_ball_point within twice each radius, then an exact filter",
        threads=both,
        settings=SCIPY_SETTINGS,
    )
    yield Rival(
        "shapely STRtree",
        "shapely",
        shapely_boxes,
        "rectangles exactly; discs as boxes, then an exact filter",
    )
    yield Rival(
        "shapely STRtree, dwithin",
        "shapely",
        shapely_within,
        "centres within twice each radius, then an exact filter",
    )
    yield Rival(
        "matscipy", "matscipy", matscipy_list, "a 3D cell list of one layer", most=1_000_000
    )
    yield Rival(
        "vesin",
        "vesin",
        vesin_list,
        "a 3D cell list with one reach; other radii by an exact filter",
        threads=both,
        settings=({"algorithm": "cell_list"}, {"algorithm": "auto"}),
        most=1_000_000,
    )
    yield Rival(
        "fastquadtree",
        "fastquadtree",
        fastquadtree_queries,
        "one query a shape in fixed bounds; discs as boxes, then an exact filter",
        settings=tuple({"capacity": capacity} for capacity in (8, 16, 32, 64)),
    )
    yield Rival(
        "pyqtree",
        "pyqtree",
        pyqtree_queries,
        "one query a shape in fixed bounds; discs as boxes, then an exact filter",
        settings=tuple({"max_items": items} for items in (5, 10, 20)),
    )
    yield Rival(
        "the article's tree",
        "jostle",
        article_tree,
        "plain Python; discs as boxes, then an exact filter",
    )
    yield Rival("jostle, brute force", "jostle", jostle_brute, most=100_000)
    yield Rival("NumPy, brute force", "numpy", numpy_brute, most=5_000)


RIVALS = tuple(_all())
