"""Queries against a prebuilt tree: 10,000 at once, compared with other libraries, on one thread.

The trees are built beforehand; the time of building is a column of its own. All answers are
compared before they are timed: the ids in each rectangle, the distances of the neighbours. Rays
traverse the whole scene and hit nothing. No other library has them: a hundred are compared with
brute force, and the result is the growth of their time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from machine import Row, version_of
from numpy.typing import NDArray
from timing import interleaved

import jostle

COUNTS = (10_000, 100_000, 1_000_000)
QUESTIONS = 10_000
WANTED = 8
"""Mean number of points in a rectangle, and number of neighbours."""

# Numbers that float32 represents exactly, points on a grid and the sides of rectangles between its
# lines: no point is on an edge, and answers do not depend on the precision.
GRID, BETWEEN = 2.0**-22, 2.0**-23

Points = NDArray[Any]


class Rival(NamedTuple):
    """A library: how it builds and queries, and the ids of its answer to each query."""

    name: str
    package: str
    manner: str
    build: Callable[[Points], Any]
    ask: Callable[[Any, Points], Any]
    ids: Callable[[Any], list[Any]]


def scene(count: int, seed: int) -> Points:
    """Points of the unit square."""
    return np.floor(np.random.default_rng(seed).random((count, 2)) / GRID) * GRID


def rectangles(count: int) -> Points:
    """Squares of about `WANTED` points."""
    side = np.ceil(np.sqrt(WANTED / count) * 2**19) / 2**19
    corners = np.floor(scene(QUESTIONS, 1) * 2**20) / 2**20 + BETWEEN
    return np.hstack([corners, corners + side])


def rays() -> tuple[Points, Points]:
    """Origins on the left edge, directions to the right one."""
    left, right = scene(QUESTIONS, 2).T
    directions = np.column_stack([np.ones(QUESTIONS), right - left])
    return np.column_stack([np.zeros(QUESTIONS), left]), directions


# ---- the libraries -------------------------------------------------------------------------------


def ours(points: Points) -> jostle.Quadtree:
    return jostle.Quadtree(points, threads=1)


def ours_single(points: Points) -> jostle.Quadtree:
    return jostle.Quadtree(points.astype(np.float32), threads=1)


def scipy_tree(points: Points) -> Any:
    from scipy.spatial import cKDTree

    return cKDTree(points)


def scipy_squares(tree: Any, rects: Points) -> Any:
    """Query balls of the maximum norm, which are squares."""
    half = (rects[0, 2] - rects[0, 0]) / 2
    return tree.query_ball_point(rects[:, :2] + half, half, p=np.inf, workers=1)


def fast_tree(points: Points) -> Any:
    from fastquadtree import QuadTree

    tree = QuadTree((-1.0, -1.0, 2.0, 2.0), 16, dtype="f64")
    tree.insert_many_np(points)
    return tree


def fast_rects(tree: Any, rects: Points) -> Any:
    return [tree.query_np(tuple(rect))[0] for rect in rects.tolist()]


def shapely_tree(points: Points) -> Any:
    import shapely

    return shapely.STRtree(shapely.points(points))


def shapely_rects(tree: Any, rects: Points) -> Any:
    import shapely

    return tree.query(shapely.box(*rects.T))


def shapely_ids(found: Any) -> list[Any]:
    questions, ids = found
    counts = np.bincount(questions, minlength=QUESTIONS)
    return np.split(ids[np.argsort(questions, kind="stable")], np.cumsum(counts)[:-1])


def our_ids(hits: jostle.IdLists) -> list[Any]:
    return list(hits)


def inside(tree: jostle.Quadtree, rects: Points) -> jostle.IdLists:
    hits = tree.query_rect(rects)
    assert isinstance(hits, jostle.IdLists)
    return hits


def nearest(wanted: int) -> tuple[Rival, ...]:
    """Return the libraries with a query for this number of neighbours."""

    def near(tree: jostle.Quadtree, points: Points) -> jostle.Neighbors:
        return tree.nearest(points, wanted)

    def scipy_near(tree: Any, points: Points) -> Any:
        return tree.query(points, wanted)

    def scipy_ids(found: Any) -> list[Any]:
        return list(found[1].reshape(-1, wanted))

    def fast_near(tree: Any, points: Points) -> Any:
        return [tree.nearest_neighbors_np(tuple(point), wanted)[0] for point in points.tolist()]

    one_by_one = "nearest_neighbors_np one by one"
    return (
        Rival("jostle", "jostle", "", ours, near, lambda found: list(found.ids)),
        Rival("jostle, float32", "jostle", "", ours_single, near, lambda found: list(found.ids)),
        Rival("SciPy cKDTree", "scipy", "query", scipy_tree, scipy_near, scipy_ids),
        Rival("fastquadtree", "fastquadtree", one_by_one, fast_tree, fast_near, list),
    )


RIVALS = {
    "rectangles": (
        Rival("jostle", "jostle", "", ours, inside, our_ids),
        Rival("jostle, float32", "jostle", "", ours_single, inside, our_ids),
        Rival("SciPy cKDTree", "scipy", "query_ball_point", scipy_tree, scipy_squares, list),
        Rival("shapely STRtree", "shapely", "query", shapely_tree, shapely_rects, shapely_ids),
        Rival("fastquadtree", "fastquadtree", "query_np one by one", fast_tree, fast_rects, list),
    ),
    "nearest one": nearest(1),
    "nearest": nearest(WANTED),
}


# ---- timing --------------------------------------------------------------------------------------


def race(rounds: int, largest: int) -> Iterator[list[Row]]:
    """Yield the rows of each kind of query and each number of points."""
    for count in (count for count in COUNTS if count <= largest):
        points = scene(count, 0)
        yield timed("rectangles", points, rectangles(count), rounds, same_ids)
        asked = scene(QUESTIONS, 1)
        for kind in ("nearest one", "nearest"):
            yield timed(kind, points, asked, rounds, partial(same_distances, points, asked))
        yield cast(points, rounds)


def timed(
    kind: str, points: Points, asked: Points, rounds: int, compare: Callable[..., None]
) -> list[Row]:
    """Compare the answers of all installed libraries, and time them."""
    rivals = [rival for rival in RIVALS[kind] if version_of(rival.package)]
    calls, built, expected = [], [], None
    for rival in rivals:
        start = time.perf_counter()
        tree = rival.build(points)
        built.append(time.perf_counter() - start)
        ids = rival.ids(rival.ask(tree, asked))
        if expected is None:
            expected = ids
        compare(rival.name, expected, ids)
        calls.append(partial(rival.ask, tree, asked))
    rows = []
    for rival, build, timing in zip(rivals, built, interleaved(calls, rounds), strict=True):
        rows.append(row(kind, len(points), rival, build, timing.columns()))
    return rows


def row(kind: str, count: int, rival: Rival, build: float, columns: Row) -> Row:
    """Return the row of one library."""
    return {
        "scene": kind,
        "count": count,
        "name": rival.name,
        "version": version_of(rival.package),
        "manner": rival.manner,
        "threads": 1,
        "questions": QUESTIONS,
        "build_s": f"{build:.4g}",
        **columns,
    }


def same_ids(name: str, expected: list[Any], found: list[Any]) -> None:
    """Raise an exception if the answers to a query differ."""
    for question, (ours, theirs) in enumerate(zip(expected, found, strict=True)):
        if not np.array_equal(ours, np.sort(np.asarray(theirs, np.int64))):
            raise SystemExit(f"{name} finds other points in rectangle {question}")


def same_distances(
    points: Points, asked: Points, name: str, expected: list[Any], found: list[Any]
) -> None:
    """Raise an exception if the distances of neighbours differ; of equal distances any is right."""
    away = [
        np.hypot(*np.moveaxis(points[np.array(ids, np.int64)] - asked[:, None], 2, 0))
        for ids in (expected, found)
    ]
    if not np.allclose(*away, rtol=1e-5, atol=1e-9):
        raise SystemExit(f"{name} finds other neighbours")


def cast(points: Points, rounds: int) -> list[Row]:
    """Time rays that hit nothing."""
    tree, (origins, directions) = ours(points), rays()
    along = directions[:100] / np.hypot(*directions[:100].T)[:, None]
    for origin, direction in zip(origins[:100], along, strict=True):
        aside = np.abs((points - origin) @ np.array([direction[1], -direction[0]])).min()
        assert aside > 0, "a ray goes through a point"
    assert (tree.raycast(origins[:100], directions[:100]).ids == -1).all()
    [timing] = interleaved([partial(tree.raycast, origins, directions)], rounds)
    ray = Rival("jostle", "jostle", "raycast", ours, lambda tree, rays: None, list)
    return [row("rays", len(points), ray, 0.0, timing.columns())]
