"""The queries of `jostle.Quadtree`: regions, neighbours, rays and moving discs."""

import re
from functools import partial
from typing import Any

import numpy as np
import oracle_queries as oracle
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracle import DTYPES, Shapes, any_shapes, coordinates, may_pair, pairs_within, sizes
from oracle_queries import Cores
from results import fields

import jostle

capacities = st.integers(1, 20)
masks = st.none() | st.sampled_from([0, 1, 2, 6, 0xFFFFFFFF])
directions = st.sampled_from(
    [(1, 0), (0, -1), (-2, 0), (1, 1), (-3, 1e-3), (1e-9, 1), (1e30, -1e30), (0.3, -0.7)]
) | st.tuples(st.floats(-9, 9, width=32), st.floats(0.5, 9, width=32))
places = st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=6)

SCALES = (1.0, 1.0, 1.0, 1e-30, 1e-24, 1e-12, 1e12, 1e25, 1e30)


def scaled(shapes: Shapes, scale: Any) -> Shapes:
    """Return shapes in another unit, with radii that float32 allows."""
    centers, radii, half_sizes = (None if x is None else x * scale for x in shapes)
    dtype = shapes.centers.dtype.type
    radii = np.where(radii > 0, radii.clip(dtype(1e-18), dtype(1e18)), dtype(0))
    return Shapes(centers, radii, half_sizes)


@st.composite
def searches(draw: st.DrawFn) -> tuple[Cores, NDArray[Any] | None, int | None, NDArray[Any], Any]:
    """Cores of shapes, their categories, a mask, points of the same dtype, and a tree."""
    shapes = draw(any_shapes())
    scale = shapes.centers.dtype.type(draw(st.sampled_from(SCALES)))
    if scale != 1 and max(np.abs(x).max(initial=0) for x in shapes if x is not None) < 1e6:
        shapes = scaled(shapes, scale)
    else:
        scale = shapes.centers.dtype.type(1)
    categories = None
    if draw(st.booleans()):
        rng = np.random.default_rng(draw(st.integers(0, 99)))
        categories = rng.integers(0, 8, len(shapes.radii)).astype(np.uint32)
    tree = jostle.Quadtree(*shapes, categories=categories, leaf_capacity=draw(capacities))
    points = np.array(draw(places), np.float64).astype(shapes.centers.dtype)
    points *= scale if np.abs(points).max() < 1e6 else 1
    if len(shapes.radii):  # Some of them exactly on a shape.
        points[0] = shapes.centers[draw(st.integers(0, len(shapes.radii) - 1))]
    return oracle.cores_of(shapes), categories, draw(masks), points, tree


def selected(cores: Cores, categories: NDArray[Any] | None, mask: int | None) -> NDArray[Any]:
    """Return which shapes a query with this mask includes."""
    if mask is None:
        return np.ones(len(cores.radii), bool)
    of = np.ones(len(cores.radii), np.uint32) if categories is None else categories
    return (of & np.uint32(mask)) != 0


def assert_hits(query: Any, expected: list[NDArray[np.bool_]], *questions: NDArray[Any]) -> None:
    """Compare the answers of single queries and of all in one call."""
    hits = query(*questions)
    assert isinstance(hits, jostle.IdLists)
    assert hits.offsets[0] == 0 and hits.offsets[-1] == len(hits.ids)
    for q, hit in enumerate(expected):
        ids = np.flatnonzero(hit)
        np.testing.assert_array_equal(hits[q], ids)
        np.testing.assert_array_equal(query(*(column[q] for column in questions)), ids)


@given(searches(), st.lists(st.tuples(sizes, sizes), min_size=6, max_size=6))
def test_query_rect(search: Any, spans: Any) -> None:
    cores, categories, mask, points, tree = search
    spans = np.array(spans[: len(points)], np.float64).astype(points.dtype)
    rects = np.hstack([points, points + spans])
    ours = selected(cores, categories, mask)
    expected = [oracle.in_rect(cores, rect) & ours for rect in rects]
    assert_hits(partial(tree.query_rect, mask=mask), expected, rects)


@given(searches(), st.lists(sizes, min_size=6, max_size=6))
def test_query_circle(search: Any, radii: Any) -> None:
    cores, categories, mask, points, tree = search
    radii = np.array(radii[: len(points)], np.float64).astype(points.dtype)
    ours = selected(cores, categories, mask)
    expected = [oracle.in_circle(cores, *disc) & ours for disc in zip(points, radii, strict=True)]
    assert_hits(partial(tree.query_circle, mask=mask), expected, points, radii)


@given(searches())
def test_query_point(search: Any) -> None:
    cores, categories, mask, points, tree = search
    ours = selected(cores, categories, mask)
    expected = [oracle.at_point(cores, point) & ours for point in points]
    assert_hits(partial(tree.query_point, mask=mask), expected, points)


@pytest.mark.parametrize("dtype", DTYPES)
def test_query_polygon_equals_shapely_away_from_the_edges(dtype: Any) -> None:
    shapely = pytest.importorskip("shapely")
    rng = np.random.default_rng(3)
    centers, radii = rng.uniform(0, 100, (3000, 2)).astype(dtype), rng.uniform(0, 2, 3000)
    half_sizes = rng.uniform(0, 2, (3000, 2))
    half_sizes[::2] = 0
    tree = jostle.Quadtree(centers, radii.astype(dtype), half_sizes.astype(dtype))
    boxes = shapely.box(*(centers - half_sizes).T, *(centers + half_sizes).T)
    for _ in range(40):
        hull = shapely.MultiPoint(rng.uniform(0, 100, (5, 2)).astype(dtype)).convex_hull
        gap = shapely.distance(boxes, hull) - radii
        found = np.isin(np.arange(3000), tree.query_polygon(hull.exterior.coords[:-1]))
        clear = np.abs(gap) > 1e-3
        np.testing.assert_array_equal(found[clear], (gap < 0)[clear])


def test_many_polygons_and_either_direction_of_turning() -> None:
    tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
    triangle = [(1, 2), (5, 0.5), (5, 2)]
    assert tree.query_polygon(triangle).tolist() == [2]
    hits = tree.query_polygon([triangle, triangle[::-1]])
    assert (hits.offsets.tolist(), hits.ids.tolist()) == ([0, 1, 2], [2, 2])


def test_an_axis_parallel_polygon_is_a_rectangle() -> None:
    rng = np.random.default_rng(5)
    tree = jostle.Quadtree(rng.integers(0, 30, (900, 2)), 0.5, rng.integers(0, 2, (900, 2)))
    for x, y in rng.integers(0, 28, (30, 2)):
        corners = [(x, y), (x + 2, y), (x + 2, y + 3), (x, y + 3)]
        expected = tree.query_rect((x, y, x + 2, y + 3))
        np.testing.assert_array_equal(tree.query_polygon(corners), expected)


@given(searches(), st.integers(1, 12), sizes | st.just(np.inf))
def test_nearest(search: Any, k: int, max_distance: float) -> None:
    cores, categories, mask, points, tree = search
    max_distance = float(points.dtype.type(max_distance))
    ours = selected(cores, categories, mask)
    found = tree.nearest(points, k, max_distance=max_distance, mask=mask)
    assert found.distances.shape == found.ids.shape == (len(points), k)
    assert found.distances.dtype == points.dtype
    for q, point in enumerate(points):
        rows = np.flatnonzero(ours)
        far, nearest = oracle.k_nearest(oracle.distance(cores, point)[rows], k, max_distance)
        ids = np.where(nearest < 0, -1, rows[nearest] if len(rows) else -1)
        np.testing.assert_array_equal(found.ids[q], ids)
        np.testing.assert_array_equal(found.distances[q], far)
        one = tree.nearest(point, k, max_distance=max_distance, mask=mask)
        np.testing.assert_array_equal(one.ids, ids)


def test_nearest_equals_scipy() -> None:
    scipy_spatial = pytest.importorskip("scipy.spatial")
    rng = np.random.default_rng(1)
    points, queries = rng.random((5000, 2)), rng.random((500, 2))
    far, ids = scipy_spatial.cKDTree(points).query(queries, 8)
    found = jostle.Quadtree(points).nearest(queries, 8)
    np.testing.assert_array_equal(found.ids, ids)
    np.testing.assert_allclose(found.distances, far, rtol=1e-12)


@given(
    searches(),
    st.lists(directions, min_size=6, max_size=6),
    st.just(0.0) | sizes,
    sizes | st.just(np.inf),
)
def test_rays_and_thrown_discs(search: Any, ways: Any, radius: float, reach: float) -> None:
    cores, categories, mask, points, tree = search
    dtype = points.dtype.type
    ways = np.array(ways[: len(points)], np.float64).astype(dtype)
    radius, reach = float(dtype(radius)), float(dtype(reach))
    ours = selected(cores, categories, mask)
    options = {"max_distance": reach, "mask": mask}
    found = tree.shape_cast(points, ways, radii=radius, **options)
    if radius == 0:
        plain = tree.raycast(points, ways, **options)
        np.testing.assert_array_equal(plain.ids, found.ids)
        np.testing.assert_array_equal(plain.distances, found.distances)
    for q, (point, way) in enumerate(zip(points, ways, strict=True)):
        far = np.where(ours, oracle.along_ray(cores, point, way, dtype(radius)), np.inf)
        far = np.where(far <= reach, far, np.inf)
        first = int(np.argmin(far)) if len(far) and far.min() < np.inf else -1
        assert found.ids[q] == first
        assert found.distances[q] == (far[first] if first >= 0 else np.inf)
        one = tree.shape_cast(point, way, radii=radius, **options)
        assert (one.id, one.distance) == (first, found.distances[q])


@pytest.mark.parametrize("radius", [0.0, 0.7])
@pytest.mark.parametrize("boxes", [False, True])
def test_the_first_hit_is_the_first(boxes: bool, radius: float) -> None:
    """Steps along each ray: no shape is touched before the hit, and one is just after it."""
    rng = np.random.default_rng(8)
    half_sizes = rng.uniform(0, 1, (300, 2)) if boxes else None
    tree = jostle.Quadtree(rng.uniform(0, 50, (300, 2)), rng.uniform(0.1, 1, 300), half_sizes)
    origins, angles = rng.uniform(0, 50, (200, 2)), rng.uniform(0, 2 * np.pi, 200)
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    hits = tree.shape_cast(origins, ways * 5, radii=radius)
    for origin, way, hit, far in zip(origins, ways, hits.ids, hits.distances, strict=True):
        end = far if hit >= 0 else 80.0
        before = origin + np.outer(np.arange(0, max(end - 1e-6, 0), 0.05), way)
        if len(before) and far > 0:
            assert tree.nearest(before).distances.min() >= radius - 1e-9
        if hit >= 0:
            touching = tree.query_circle(origin + (far + 1e-7) * way, radius + 1e-6)
            assert hit in touching


def test_one_origin_many_directions_and_the_other_way_round() -> None:
    tree = jostle.Quadtree([(0, 0), (3, 0), (5, 0)], radii=1.0)
    fan = tree.raycast((1.5, 0), [(1, 0), (0, 1), (-1, 0)])
    assert fan.ids.tolist() == [1, -1, 0]
    assert fan.distances.tolist() == [0.5, np.inf, 0.5]
    assert tree.raycast([(-4, 0), (9, 0)], (1, 0)).ids.tolist() == [0, -1]
    assert tree.shape_cast((-4, 1.5), (1, 0), radii=[0.1, 0.6]).ids.tolist() == [-1, 0]


def test_a_limit_counts_only_pairs_of_the_categories_asked_for() -> None:
    categories = np.where(np.arange(600) % 30 == 0, 1, 2)
    tree = jostle.Quadtree(np.zeros((600, 2)), 1.0, categories=categories)
    assert len(tree.pairs(mask=1, max_pairs=190)) == 190
    with pytest.raises(ValueError, match="more than max_pairs = 189"):
        tree.pairs(mask=1, max_pairs=189)


@given(any_shapes(), capacities, st.sampled_from([1, 2, 6]))
def test_pairs_of_some_categories(shapes: Shapes, capacity: int, mask: int) -> None:
    n = len(shapes.radii)
    categories = np.random.default_rng(n).integers(0, 8, n).astype(np.uint32)
    tree = jostle.Quadtree(*shapes, categories=categories, leaf_capacity=capacity)
    everything = np.full(n, 0xFFFFFFFF, np.uint32)
    allowed = may_pair(categories, everything, categories, everything)
    ours = (categories & mask) != 0
    expected = pairs_within(shapes, allowed & ours[:, None] & ours[None])
    np.testing.assert_array_equal(tree.pairs(sort=True, mask=mask), expected)
    other = tree.pairs(tree, sort=True, mask=mask)
    np.testing.assert_array_equal(other[other[:, 0] < other[:, 1]], expected)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_change_nothing_and_answers_keep_the_order(threads: int) -> None:
    rng = np.random.default_rng(0)
    centers, points = rng.random((20_000, 2)) * 100, rng.random((3000, 2)) * 100
    tree = jostle.Quadtree(centers, 0.2, threads=threads)
    hits = tree.query_circle(points, 0.5)
    for q in range(0, 3000, 97):
        alone = tree.query_circle(points[q], 0.5)
        np.testing.assert_array_equal(hits[q], alone)
        assert tree.nearest(points, 3).ids[q].tolist() == tree.nearest(points[q], 3).ids.tolist()
    ways = points[::-1] - 50.3
    one, many = tree.raycast(points[99], ways[99]), tree.raycast(points, ways)
    assert one == jostle.RayHit(*(column[99] for column in fields(many)))


@pytest.mark.parametrize("n", [0, 1])
def test_hardly_any_shapes_or_queries(n: int) -> None:
    tree = jostle.Quadtree(np.zeros((n, 2)), 1.0)
    assert len(tree.query_rect((-1, -1, 1, 1))) == n
    assert tree.nearest((3, 0), 2).ids.tolist() == [0, -1][-n - 1 :] + [-1] * (1 - n)
    hit = tree.raycast((3, 0), (-1, 0))
    assert (hit.id, hit.distance) == ((0, 2.0) if n else (-1, np.inf))
    for hits in (tree.query_rect(np.zeros((0, 4))), tree.query_circle(np.zeros((0, 2)), 1.0)):
        assert hits.offsets.tolist() == [0] and list(hits) == []
    near = tree.neighbors(1.0), jostle.Space().neighbors(1.0)
    assert [len(lists) for lists in near] == [n, 0]
    assert tree.nearest(np.zeros((0, 2)), 3).ids.shape == (0, 3)
    assert len(tree.raycast(np.zeros((0, 2)), (1, 0)).ids) == 0


def test_work_grows_slowly() -> None:
    """A query of a few shapes needs the same tests among a hundred times as many."""
    rng = np.random.default_rng(2)

    def tests(n: int) -> list[int]:
        tree = jostle.Quadtree(rng.random((n, 2)) * np.sqrt(n))
        middle = np.sqrt(n) / 2
        counts = []
        tree.query_rect((middle, middle, middle + 2, middle + 2))
        counts.append(tree.stats.tests)
        tree.nearest((middle, middle), 8)
        counts.append(tree.stats.tests)
        tree.raycast((0, middle), (1, 0))
        return [*counts, tree.stats.tests]

    few, many = tests(4000), tests(400_000)
    assert many[0] < 3 * few[0] + 400 and many[1] < 3 * few[1] + 400
    assert many[2] < 30 * few[2]


TREE = jostle.Quadtree([(0, 0), (3, 0)], radii=1.0)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: TREE.query_rect((0, 0, 1)), "rect has shape (3,); it must be (4,) or (k, 4)"),
        (lambda: TREE.query_rect((3, 0, 2, 1)), "rect is (3, 0, 2, 1); it must be (min_x, "),
        (lambda: TREE.query_rect([(0, 0, 1, 1), (0, 0, 1, np.nan)]), "rect[1] is (0, 0, 1, NaN)"),
        (lambda: TREE.query_circle((0, 0), -1), "radius is -1; a radius must be finite and"),
        (lambda: TREE.query_circle([(0, 0), (1, 1)], [1, -2]), "radius[1] is -2; a radius must"),
        (lambda: TREE.query_circle([(0, 0), (1, 1)], [1, 2, 3]), "radius has shape (3,); it must"),
        (lambda: TREE.query_point((0, np.inf)), "point is (0, inf); both coordinates must be"),
        (
            lambda: TREE.query_polygon([(0, 0), (1, 1)]),
            "vertices is a list of 2; a polygon has at least 3",
        ),
        (
            lambda: TREE.query_polygon([(0, 0), (4, 0), (1, 1), (0, 4)]),
            "vertices[2] is (1, 1); the polygon is not convex there",
        ),
        (
            lambda: TREE.query_polygon([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (2, 2)]]),
            "vertices[1] is (0, 0); corner 0 of the polygon: the polygon is not convex there",
        ),
        (lambda: TREE.nearest((0, 0), 0), "k is 0; it must be at least 1"),
        (lambda: TREE.nearest((0, 0), max_distance=-1), "max_distance is -1; it must be at least"),
        (lambda: TREE.nearest((0, 0), max_distance=np.nan), "max_distance is NaN; it must be at"),
        (lambda: TREE.raycast((0, 0), (0, 0)), "direction is (0, 0); a direction has a length"),
        (
            lambda: TREE.raycast((0, 0), [(1, 0), (0, 0)]),
            "direction[1] is (0, 0); a direction has a length",
        ),
        (
            lambda: TREE.raycast(np.zeros((3, 2)), [(1, 0), (0, 1)]),
            "direction has shape (2, 2); it must be (2,) or (3, 2)",
        ),
        (lambda: TREE.query_point((0, 0), mask=[1]), "mask has shape (1,); it must be an integer"),
    ],
)
def test_refusals_name_argument_index_and_value(call: Any, sentence: str) -> None:
    with pytest.raises(ValueError, match="^" + re.escape(sentence)):
        call()


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: TREE.query_point(("a", "b")), "point must hold real numbers"),
        (lambda: TREE.query_point((0, 0), mask=1.5), "mask must "),
        (lambda: TREE.nearest((0, 0), k=2.5), "k must be an integer"),
        (lambda: TREE.raycast((0, 0), (1, 0), max_distance="far"), "max_distance must "),
        (lambda: jostle.Space().remove({0, 1}), "ids must be an ordered list or array"),
    ],
)
def test_refuses_other_types(call: Any, sentence: str) -> None:
    with pytest.raises(TypeError, match=f"^{sentence}"):
        call()
