"""Periodic planes and searches within a distance, against minimum images in plain NumPy."""

import copy
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracle import DTYPES, open_overlap
from scipy.spatial import cKDTree

import jostle

PERIODS = [(10.0, 10.0), (10.0, 0.0), (0.0, 7.0), (0.75, 16.0), (1e4, 3.0), (0.0, 0.0)]


@st.composite
def planes(draw: st.DrawFn) -> tuple[dict[str, Any], tuple[float, float]]:
    """Shapes as arguments of `find_pairs`, and a period."""
    dtype = draw(st.sampled_from(DTYPES))
    n = draw(st.integers(0, 40))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    on_grid = draw(st.booleans())
    centers = rng.integers(-60, 60, (n, 2)) / 4 if on_grid else rng.uniform(-15, 15, (n, 2))
    radii = rng.integers(0, 5, n) / 4 if draw(st.booleans()) else np.zeros(n)
    halves = rng.integers(0, 9, (n, 2)) / 4
    kind = draw(st.sampled_from(["circles", "rounded", "boxes"]))
    arguments: dict[str, Any] = {"radii": radii.astype(dtype)}
    if kind == "boxes":
        arguments["boxes"] = np.hstack([centers, centers + halves]).astype(dtype)
    else:
        arguments["positions"] = centers.astype(dtype)
        if kind == "rounded":
            arguments["half_sizes"] = halves.astype(dtype)
    return arguments, draw(st.sampled_from(PERIODS))


def sides(tree: jostle.Quadtree) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Return min and max of the cores as the tree stores them, and their half sizes."""
    state = tree.__getnewargs_ex__()[1]
    if "boxes" in state:
        return state["boxes"][:, :2], state["boxes"][:, 2:], np.zeros_like(state["boxes"][:, :2])
    centers = state["positions"]
    return centers, centers, state.get("half_sizes", np.zeros_like(centers))


def gaps(tree: jostle.Quadtree, period: tuple[float, float]) -> NDArray[Any]:
    """Return the gap of each shape (row) to each other (column) along each axis."""
    low, high, half = sides(tree)
    centers, side = tree.positions, np.array(period, low.dtype)

    def lowered(a: Any, b: Any) -> Any:
        """Gaps where each row is lower by `a`, and each column by `b`."""
        rows, columns = (low - a, high - a), (low - b, high - b)
        gap = np.maximum(columns[0][None] - rows[1][:, None], rows[0][:, None] - columns[1][None])
        return gap - (half[:, None] + half[None])

    is_row_above = centers[:, None] >= centers[None]
    images = np.where(is_row_above, lowered(side, 0), lowered(0, side))
    return np.where(side > 0, np.minimum(lowered(0, 0), images), lowered(0, 0))


@given(planes(), st.sampled_from([0.0, 0.5, 1.25, 30.0]))
def test_pairs_neighbors_and_contacts(
    plane: tuple[dict[str, Any], tuple[float, float]], distance: float
) -> None:
    arguments, period = plane
    tree = jostle.Quadtree(**arguments, period=period, leaf_capacity=3)
    assert tree.period == period
    gap = gaps(tree, period)
    for reach in (0.0, distance):
        radii = tree.radii + tree.radii.dtype.type(reach) / 2
        found = open_overlap(gap, radii[:, None] + radii[None])
        np.fill_diagonal(found, val=False)
        expected = np.argwhere(np.triu(found))
        for method in ("brute", "quadtree"):
            pairs = jostle.find_pairs(
                **arguments, period=period, distance=reach, method=method, sort=True
            )
            assert np.array_equal(pairs, expected)
        assert np.array_equal(tree.pairs(distance=reach, sort=True), expected)
        both = tree.pairs(tree, distance=reach, sort=True)
        assert np.array_equal(both[both[:, 0] != both[:, 1]], np.argwhere(found))
        near = tree.neighbors(reach)
        assert np.array_equal(near.counts, found.sum(axis=1))
        assert np.array_equal(near.ids, np.nonzero(found)[1])
        space = jostle.Space(dtype=tree.dtype, period=period)
        space.add(**arguments)
        assert np.array_equal(space.pairs(distance=reach, sort=True), expected)
        assert np.array_equal(space.neighbors(reach).ids, near.ids)
    contacts = tree.contacts(sort=True)
    assert np.array_equal(contacts.pairs, tree.pairs(sort=True))
    i, j = contacts.pairs.T
    apart = np.maximum(gap[i, j], 0)
    length = np.hypot(apart[:, 0], apart[:, 1])
    deep = np.where(length > 0, length, gap[i, j].max(axis=1, initial=-np.inf))
    assert contacts.depths == pytest.approx(tree.radii[i] + tree.radii[j] - deep, abs=1e-4)
    assert np.array_equal(space.contacts(sort=True).normals, contacts.normals)


@pytest.mark.parametrize("dtype", DTYPES)
def test_neighbors_are_those_of_a_k_d_tree(dtype: Any) -> None:
    points = np.random.default_rng(3).uniform(0, 1, (5000, 2)).astype(dtype)
    for reach in (0.01, 0.04):
        found = jostle.Quadtree(points, period=1.0).neighbors(reach)
        kd = cKDTree(points.astype(float), boxsize=1.0)
        # Two points can be as far apart as `reach` in one arithmetic and nearer in the other.
        fewer, more = (
            {tuple(pair) for pair in kd.query_pairs(reach * factor)}
            for factor in (1 - 1e-5, 1 + 1e-5)
        )
        rows = found.queries
        ours = {(i, j) for i, j in zip(rows.tolist(), found.ids.tolist(), strict=True) if i < j}
        assert fewer <= ours <= more
        assert 2 * len(ours) == len(found.ids)


@given(planes(), st.integers(0, 2**32 - 1))
def test_queries(plane: tuple[dict[str, Any], tuple[float, float]], seed: int) -> None:
    """Each query finds what it finds among nine copies of the shapes in an infinite plane."""
    arguments, period = plane
    tree = jostle.Quadtree(**arguments, period=period)
    space = jostle.Space(dtype=tree.dtype, period=period)
    space.add(**arguments)
    low, high, half = sides(tree)
    shifts = [
        (x * period[0], y * period[1])
        for x in ((-2, -1, 0, 1, 2) if period[0] else (0,))
        for y in ((-2, -1, 0, 1, 2) if period[1] else (0,))
    ]
    low64, high64 = low.astype(float), high.astype(float)
    copies = jostle.Quadtree(
        boxes=np.vstack(
            [np.hstack([low64 - half + shift, high64 + half + shift]) for shift in shifts]
        ),
        radii=np.tile(tree.radii.astype(float), len(shifts)),
    )
    rng = np.random.default_rng(seed)
    # On a coarse grid, float32 and float64 agree about what touches.
    points = rng.integers(-8, 60, (6, 2)) / 8
    points %= [side or 1e9 for side in period]
    exact = all(side * 8 == int(side * 8) for side in period)
    n = max(len(tree), 1)

    def same(found: jostle.IdLists, expected: jostle.IdLists) -> None:
        for ids, many in zip(found, expected, strict=True):
            assert np.array_equal(ids, np.unique(many % n))

    if exact and np.array_equal(np.round(low64 * 8), low64 * 8):
        rects = np.hstack([points, points + 0.5])
        for index in (tree, space):
            same(index.query_rect(rects), copies.query_rect(rects))
            same(index.query_circle(points, 0.75), copies.query_circle(points, 0.75))
    for index in (tree, space):
        near, far = (each.nearest(points, max_distance=np.arange(6.0)) for each in (index, copies))
        assert near.distances == pytest.approx(far.distances, abs=1e-3)
        rays = rng.normal(0, 1, (6, 2))
        length = 0.9 * min((side for side in period if side), default=9.0)
        hit = index.raycast(points, rays, max_distance=length)
        wide = copies.raycast(points, rays, max_distance=length)
        both = (hit.ids >= 0) & (wide.ids >= 0)
        assert hit.distances[both] == pytest.approx(wide.distances[both], abs=2e-2)
        assert (near.ids >= -1).all()


def test_positions_that_differ_by_a_period_are_equal() -> None:
    tree = jostle.Quadtree([(0.5, 0.5), (9.5, 0.5), (5, 5)], radii=0.75, period=10)
    assert tree.pairs().tolist() == [[0, 1]]
    assert tree.contacts().normals.tolist() == [[-1.0, 0.0]]
    for turn in (-30, 0, 20):
        point = (9.9 + turn, 0.5 - turn)
        assert tree.query_point(point).tolist() == [0, 1]
        assert tree.nearest(point).ids.tolist() == [0]
        assert tree.query_circle(point, 0.2).tolist() == [0, 1]
    assert tree.query_rect((-0.3, 0, 0, 1)).tolist() == [0, 1]
    assert tree.query_rect((-50, -50, 50, 50)).tolist() == [0, 1, 2]
    assert tree.query_polygon([(-1, -1), (1, -1), (0, 1)]).tolist() == [0, 1]
    hit = tree.raycast((8, 0.5), (1, 0), max_distance=40)
    assert (hit.id, hit.distance, hit.normal.tolist()) == (1, 0.75, [-1.0, 0.0])
    assert tree.raycast_all((8, 0.5), (1, 0), max_distance=40).ids.tolist() == [1, 0]
    assert tree.raycast((5, 9), (0, 1), max_distance=10).distance == pytest.approx(5.25)


def test_moving_shapes_enter_across_the_boundary() -> None:
    space = jostle.Space(period=(10, None))
    ids = space.add([(0.5, 0), (5, 0)], radii=1.0)
    assert space.period == (10.0, 0.0)
    assert len(space.update().entered) == 0
    space.set(ids[1], positions=(19.0, 0))
    assert space.get(1).positions.tolist() == [9.0, 0.0]
    assert space.update().entered.tolist() == [[0, 1]]
    twin = copy.deepcopy(space)
    space.set(1, positions=(15.0, 0))
    assert space.update().exited.tolist() == [[0, 1]]
    assert twin.pairs().tolist() == [[0, 1]]
    space.set(1, positions=(-0.5, 10))
    assert len(space.pairs()) == 0, "y is not periodic"


def test_shapes_larger_than_the_period() -> None:
    tree = jostle.Quadtree([(1, 1), (6, 6)], half_sizes=(30, 0.5), period=10)
    assert tree.pairs().tolist() == []
    assert tree.pairs(distance=4.5).tolist() == [[0, 1]]
    assert tree.neighbors(100)[0].tolist() == [1]
    assert tree.query_rect((3, 0.9, 4, 1.1)).tolist() == [0]


REFUSED: list[tuple[Any, type[Exception], str]] = [
    (lambda: jostle.Quadtree([(0, 0)], period=-1), ValueError, r"period\[0\] is -1"),
    (lambda: jostle.Quadtree([(0, 0)], period=(5, np.nan)), ValueError, r"period\[1\] is NaN"),
    (lambda: jostle.Space(period=(1, 2, 3)), ValueError, "period"),
    (lambda: jostle.Space(period="wide"), TypeError, "period must hold real numbers"),
    (lambda: jostle.find_pairs([(0, 0)], distance=-1), ValueError, "distance is -1; it must be"),
    (lambda: jostle.find_pairs([(0, 0)], distance=np.inf), ValueError, "distance is inf"),
    (lambda: jostle.Space().neighbors(-2.0), ValueError, "distance is -2"),
    (lambda: jostle.Quadtree([(0, 0)]).neighbors("far"), TypeError, "distance must be a number"),
    (
        lambda: jostle.Quadtree([(0, 0)], period=9).raycast((0, 0), (1, 0)),
        ValueError,
        r"max_distance is inf; with period=\(9, 9\), it must be at most 1024 periods",
    ),
    (
        lambda: jostle.Quadtree([(0, 0)], period=9).query_polygon([(0, 0), (10, 0), (0, 9)]),
        ValueError,
        "a polygon may be at most one period wide and high",
    ),
    (
        lambda: jostle.Quadtree([(0, 0)], period=9).pairs(jostle.Quadtree([(0, 0)])),
        ValueError,
        r"other has period=\(0.0, 0.0\) and this tree period=\(9.0, 9.0\)",
    ),
]


@pytest.mark.parametrize(("call", "error", "message"), REFUSED)
def test_refusals(call: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        call()


def test_the_threads_change_nothing() -> None:
    points = np.random.default_rng(5).uniform(0, 100, (20_000, 2))
    trees = [jostle.Quadtree(points, 0.3, period=100, threads=threads) for threads in (1, 2)]
    near = [tree.neighbors(1.0) for tree in trees]
    assert np.array_equal(near[0].ids, near[1].ids)
    assert np.array_equal(trees[0].pairs(), trees[1].pairs())
    order = np.random.default_rng(6).permutation(len(points))
    moved = jostle.Quadtree(points[order], 0.3, period=100).neighbors(1.0)
    for new in (0, 7, 9_999):
        ids = np.sort(order[moved[new]])
        old = order[new]
        assert np.array_equal(ids, near[0][old])


@pytest.mark.parametrize("period", [(4.0, 4.0), (3.0, 7.0), (5.0, 0.0), (0.0, 2.0)])
@pytest.mark.parametrize("size", [0.1, 0.4, 0.5, 0.6, 1.0, 1.7, 4.0, 10.0])
def test_casts_of_any_size_are_those_of_all_images(
    period: tuple[float, float], size: float
) -> None:
    """Moving discs and boxes, also thin ones, beside a plane with copies of the shapes."""
    rng = np.random.default_rng(int(10 * size))
    shortest = min(side for side in period if side)
    n, reach = 7, size * shortest
    area = [side or 6.0 for side in period]
    centers, sizes = rng.uniform(0, area, (n, 2)), rng.uniform(0, 0.3, (n, 2)) * shortest
    radii = rng.uniform(0, 0.2, n) * shortest
    boxes = np.hstack([centers - sizes, centers + sizes])
    tree = jostle.Quadtree(boxes=boxes, radii=radii, period=period)
    space = jostle.Space(period=period)
    space.add(boxes=boxes, radii=radii)
    longest = 1.5 * shortest
    turns = [
        np.arange(-k, k + 1) if side else [0]
        for side in period
        for k in [int((reach + longest) / (side or 1.0)) + 3]
    ]
    shifts = np.stack(np.meshgrid(*turns), -1).reshape(-1, 2) * period
    copies = jostle.Quadtree(
        boxes=np.vstack([boxes + np.tile(shift, 2) for shift in shifts]),
        radii=np.tile(radii, len(shifts)),
    )
    count = 40
    origins, ways = rng.uniform(0, area, (count, 2)), rng.normal(0, 1, (count, 2))
    ways[:8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1e-9), (1e-9, 1), (1, 1), (-1, 1)]
    thin = rng.choice([0.0, 0.001, 1.0], (count, 2)) * reach
    for index in (tree, space):
        for size_of_cast in ({"radii": reach}, {"half_sizes": thin}):
            found, wide = (
                each.shape_cast(origins, ways, **size_of_cast, max_distance=longest)
                for each in (index, copies)
            )
            assert found.distances == pytest.approx(wide.distances, abs=1e-9)
            inside = wide.distances == 0
            assert np.array_equal(found.distances == 0, inside)
            assert np.array_equal(found.normals[inside], np.zeros((inside.sum(), 2)))
            # Of a shape that several images of it touch at once, copies have another order.
            sure = ~inside & (wide.ids >= 0)
            assert np.array_equal(found.ids[sure], wide.ids[sure] % n)
    first = index.shape_cast(origins, ways, radii=2 * max(area), max_distance=longest)
    assert (first.ids == 0).all() or 0 in period


@pytest.mark.parametrize("size", [1e5, 1e9, 2.0**32, 1e17])
def test_casts_of_very_large_shapes_answer_at_once(size: float) -> None:
    shapes = np.random.default_rng(2).uniform(0, 10, (9, 2))
    for period in ((10, 10), (10, 0)):
        space = jostle.Space(period=period)
        space.add(shapes, 0.5)
        for index in (space, jostle.Quadtree(shapes, 0.5, period=period)):
            for one in (
                index.shape_cast((1, 2), (1, 0), radii=10 * size, max_distance=1.5),
                index.shape_cast((1, 2), (1, 0), half_sizes=10 * size, max_distance=1e4),
            ):
                assert (one.id, one.distance, one.normal.tolist()) == (0, 0.0, [0.0, 0.0])
            # A thin box meets the highest shape below it, although its centre is far away.
            fall = index.shape_cast((3, 30), (0, -1), half_sizes=(10 * size, 0.0), max_distance=40)
            if period[1] == 0:
                highest = int(shapes[:, 1].argmax())
                assert fall.id == highest
                assert fall.distance == pytest.approx(29.5 - shapes[highest, 1])
        large = jostle.Quadtree([(5, 5), (2, 2)], 10 * size, period=period)
        hit = large.raycast((1, 2), (1, 0), max_distance=10)
        assert (hit.id, hit.distance) == (0, 0.0)
        hits = large.raycast_all((1, 2), (1, 0), max_distance=10)
        assert (hits.ids.tolist(), hits.distances.tolist()) == ([0, 1], [0.0, 0.0])
