"""Shapes given as boxes: min and max are compared exactly, in pairs, queries and spaces."""

from collections.abc import Callable
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
import oracle_queries as oracle
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from results import fields

import jostle

DTYPES = [np.float32, np.float64]
METHODS = ["brute", "quadtree"]
Vector = tuple[float, float]


def by_row(pairs: NDArray[Any]) -> list[list[int]]:
    return sorted(pairs.tolist())


def pairs_of(shapes: list[Any], overlap: Callable[[Any, Any], bool]) -> list[list[int]]:
    """Pairs of rows of which `overlap` is true."""
    rows = range(len(shapes))
    return [[i, j] for i in rows for j in rows[i + 1 :] if overlap(shapes[i], shapes[j])]


class Shape(NamedTuple):
    """A rounded box in exact numbers."""

    low: tuple[Fraction, ...]
    high: tuple[Fraction, ...]
    radius: Fraction


def shapes_of(centers: Any, radii: Any, half_sizes: Any = None) -> list[Shape]:
    """Make exact shapes of centres and half sizes."""
    halves = np.zeros_like(centers) if half_sizes is None else half_sizes
    return boxes_of(np.hstack([centers - halves, centers + halves]), radii)


def boxes_of(boxes: Any, radii: Any) -> list[Shape]:
    """Make exact shapes of boxes."""
    exact = [[Fraction(float(v)) for v in row] for row in boxes]
    return [
        Shape(tuple(row[:2]), tuple(row[2:]), Fraction(float(radius)))
        for row, radius in zip(exact, np.broadcast_to(radii, len(exact)), strict=True)
    ]


def overlap(a: Shape, b: Shape) -> bool:
    """Return whether two shapes overlap, in exact arithmetic."""
    gaps = [max(a.low[k] - b.high[k], b.low[k] - a.high[k]) for k in (0, 1)]
    squares = sum(max(gap, Fraction(0)) ** 2 for gap in gaps)
    return squares < (a.radius + b.radius) ** 2 or max(gaps) < 0


_borders = st.integers(-8, 8).map(float)
_any = st.one_of(
    _borders,
    st.integers(-9, 9).map(lambda k: k * 0.1),
    st.floats(-100, 100, width=32),
    st.sampled_from([1e30, -1e30, 1e-30, -1e-30, 0.0, -0.0]),
)


@st.composite
def boxes(draw: st.DrawFn, coordinates: st.SearchStrategy[float] = _any) -> NDArray[Any]:
    """Up to 40 boxes: touching, nested, coincident, flat, huge and tiny."""
    four = st.tuples(coordinates, coordinates, coordinates, coordinates)
    rows = np.array(draw(st.lists(four, max_size=40)), np.float64).reshape(-1, 4)
    rows = rows.astype(draw(st.sampled_from(DTYPES)))
    x, y = np.sort(rows[:, ::2], axis=1), np.sort(rows[:, 1::2], axis=1)
    return np.stack([x[:, 0], y[:, 0], x[:, 1], y[:, 1]], axis=1)


def tiles(dtype: Any) -> NDArray[Any]:
    """30 × 30 tiles between neighbouring edges, 0.1 apart."""
    low, high = np.arange(30) * 0.1, np.arange(1, 31) * 0.1
    edges = np.concatenate([low, high[-1:]]).astype(dtype)
    x, y = (part.ravel() for part in np.meshgrid(np.arange(30), np.arange(30)))
    return np.stack([edges[x], edges[y], edges[x + 1], edges[y + 1]], axis=1)


@pytest.mark.parametrize("dtype", DTYPES)
def test_touching_tiles_never_overlap(dtype: Any) -> None:
    all_tiles = tiles(dtype)
    for method in METHODS:
        assert len(jostle.find_pairs(boxes=all_tiles, method=method)) == 0
    tree = jostle.Quadtree(boxes=all_tiles, leaf_capacity=4)
    assert len(tree.pairs()) == len(tree.contacts().pairs) == 0
    board = (np.arange(30)[:, None] + np.arange(30)) % 2 == 0
    black, white = all_tiles[board.ravel()], all_tiles[~board.ravel()]
    assert len(jostle.Quadtree(boxes=black).pairs(jostle.Quadtree(boxes=white))) == 0
    space = jostle.Space(dtype=np.dtype(dtype).name)
    space.add(boxes=black)
    space.add(boxes=white)
    assert len(space.pairs()) == len(space.update().entered) == 0
    # The reason for boxes: centres and half sizes are rounded.
    low, high = all_tiles[:, :2], all_tiles[:, 2:]
    centers, sizes = (low + high) / 2, (high - low) / 2
    assert len(jostle.find_pairs(centers, half_sizes=sizes)) > 100


@pytest.mark.parametrize("dtype", DTYPES)
def test_each_point_is_in_one_tile(dtype: Any) -> None:
    all_tiles = tiles(dtype)
    tree = jostle.Quadtree(boxes=all_tiles, leaf_capacity=4)
    corners = all_tiles[:, :2]
    hits = tree.query_point(np.concatenate([corners, np.nextafter(corners, dtype(9))]))
    assert hits.ids.tolist() == [*range(900), *range(900)]
    assert len(tree.query_point((all_tiles[-1, 2], 0))) == 0


@given(boxes(), st.integers(1, 8))
def test_pairs_are_those_of_exact_comparison(rows: NDArray[Any], leaf_capacity: int) -> None:
    expected = pairs_of(boxes_of(rows, 0), overlap)
    for method in METHODS:
        assert by_row(jostle.find_pairs(boxes=rows, method=method)) == expected
    tree = jostle.Quadtree(boxes=rows, leaf_capacity=leaf_capacity)
    assert by_row(tree.pairs()) == expected
    assert by_row(tree.contacts().pairs) == expected
    other = jostle.Quadtree(boxes=rows[::-1])
    both = {tuple(pair) for pair in expected} | {(j, i) for i, j in expected}
    area = (rows[:, :2] < rows[:, 2:]).all(axis=1)
    both |= {(i, i) for i in np.flatnonzero(area).tolist()}
    found = tree.pairs(other)
    assert {(i, len(rows) - 1 - j) for i, j in found.tolist()} == both
    assert len(found) == len(both)


_eighths = st.integers(-40, 40).map(lambda k: k / 8)
_sizes = st.one_of(st.just(0.0), st.integers(0, 16).map(lambda k: k / 8))


@given(
    boxes(_eighths),
    st.lists(st.tuples(_eighths, _eighths, _sizes, _sizes, _sizes), max_size=20),
    _sizes,
)
def test_boxes_and_other_shapes_overlap_as_in_exact_arithmetic(
    rows: NDArray[Any], others: list[tuple[float, ...]], radius: float
) -> None:
    dtype = rows.dtype
    centers, radii, halves = np.split(np.array(others, dtype).reshape(-1, 5), [2, 3], axis=1)
    radii = radii.ravel()
    first, circles = boxes_of(rows, radius), shapes_of(centers, radii)
    for second, sizes in [(circles, None), (shapes_of(centers, radii, halves), halves)]:
        tree = jostle.Quadtree(boxes=rows, radii=np.full(len(rows), radius, dtype), leaf_capacity=2)
        other = jostle.Quadtree(centers, radii, sizes, leaf_capacity=3)
        expected = [
            [i, j] for i, a in enumerate(first) for j, b in enumerate(second) if overlap(a, b)
        ]
        assert by_row(tree.pairs(other)) == expected
        assert by_row(other.pairs(tree)[:, ::-1]) == expected
        # All in one space, the boxes in the middle of the ids.
        space = jostle.Space(dtype=dtype.name, leaf_capacity=2)
        half = len(centers) // 2
        space.add(centers[:half], radii[:half], None if sizes is None else sizes[:half])
        space.add(boxes=rows, radii=radius)
        space.add(centers[half:], radii[half:], None if sizes is None else sizes[half:])
        together = second[:half] + first + second[half:]
        pairs = pairs_of(together, overlap)
        assert by_row(space.pairs()) == pairs
        assert space.update().entered.tolist() == pairs


def test_contacts_give_the_axis_of_least_penetration_of_a_box() -> None:
    tree = jostle.Quadtree(boxes=[(0, 0, 10, 4), (1, 1, 2, 9), (9, 3.5, 20, 20)])
    pairs, normals, depths, *_ = fields(tree.contacts())
    order = np.lexsort(pairs.T[::-1])
    assert pairs[order].tolist() == [[0, 1], [0, 2]]
    assert normals[order].tolist() == [[-1, 0], [0, 1]]
    assert depths[order].tolist() == [2, 0.5]


@pytest.mark.parametrize("dtype", DTYPES)
def test_trees_of_boxes_hold_their_invariants_at_any_size(dtype: Any) -> None:
    rng = np.random.default_rng(3)
    low = rng.integers(0, 60, (3000, 2)).astype(dtype)
    low[:40] *= dtype(1e-6)
    rows = np.hstack([low, low + rng.integers(0, 3, (3000, 2)).astype(dtype)])
    rows[::700, 2:] += 50
    expected = by_row(jostle.find_pairs(boxes=rows, method="brute"))
    for threads in (1, 2):
        tree = jostle.Quadtree(boxes=rows, threads=threads, leaf_capacity=8)
        assert by_row(tree.pairs()) == expected
    middles = (rows[:, :2] + rows[:, 2:]) / 2
    root = tree.nodes().boxes[0]
    assert (middles >= root[:2]).all() and (middles <= root[2:]).all()
    order = rng.permutation(len(rows))
    mixed = jostle.Quadtree(boxes=rows[order], leaf_capacity=8)
    assert (mixed.nodes().boxes == tree.nodes().boxes).all()


# The formulas would lose numbers whose squares underflow; `test_ranges.py` tests those.
_decimals = st.floats(-10, 10, width=32).map(lambda x: x if abs(x) > 1e-12 else 0.0)
_near = st.one_of(_borders, st.integers(-9, 9).map(lambda k: k * 0.1), _decimals)
_small = st.one_of(st.just(0.0), st.integers(0, 4).map(float), st.floats(0.0078125, 5, width=32))


@given(boxes(_near), st.tuples(_near, _near), st.tuples(_small, _small), _small, st.booleans())
def test_queries_are_those_of_min_and_max(
    rows: NDArray[Any], at: Vector, size: Vector, radius: float, in_space: bool
) -> None:
    dtype = rows.dtype
    point, size, r = np.array(at, dtype), np.array(size, dtype), dtype.type(radius)
    for radii in (np.zeros(len(rows), dtype), np.full(len(rows), r)):
        index: Any
        if in_space:
            index = jostle.Space(dtype=dtype.name, leaf_capacity=2)
            index.add(boxes=rows, radii=radii)
        else:
            index = jostle.Quadtree(boxes=rows, radii=radii, leaf_capacity=2)
        cores = oracle.cores_of_boxes(rows, radii)
        rect = np.concatenate([point, point + size])
        in_rect = oracle.in_rect(cores, rect)
        assert index.query_rect(rect).tolist() == np.flatnonzero(in_rect).tolist()
        in_circle = oracle.in_circle(cores, point, r)
        assert index.query_circle(point, r).tolist() == np.flatnonzero(in_circle).tolist()
        at_point = oracle.at_point(cores, point)
        assert index.query_point(point).tolist() == np.flatnonzero(at_point).tolist()
        near = index.nearest(point, 5)
        far, ids = oracle.k_nearest(oracle.distance(cores, point), 5, np.inf)
        assert (near.ids.tolist(), near.distances.tolist()) == (ids.tolist(), far.tolist())
        direction = np.array((size[0] - 2, size[1] - dtype.type(1.5)), dtype)
        if not direction.any():
            continue
        for thrown in (dtype.type(0), r):
            hits = oracle.along_ray(cores, point, direction, thrown)
            hit = index.shape_cast(point, direction, radii=thrown)
            if len(rows) and np.isfinite(hits).any():
                assert (hit.id, hit.distance) == (int(np.argmin(hits)), hits.min())
            else:
                assert (hit.id, hit.distance) == (-1, np.inf)


def polygon_overlaps(corners: list[tuple[int, int]], box: list[Fraction]) -> bool:
    """Return whether the interiors of a convex polygon and a box overlap (separating axes)."""
    of_box = [(box[x], box[y]) for x in (0, 2) for y in (1, 3)]
    axes = [(1, 0), (0, 1)]
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        axes.append((by - ay, ax - bx))
    for x, y in axes:
        own = [x * px + y * py for px, py in corners]
        other = [x * px + y * py for px, py in of_box]
        if max(own) <= min(other) or max(other) <= min(own):
            return False
    return True


@given(boxes(st.integers(-8, 8).map(float)), st.integers(-6, 6), st.integers(-6, 6))
def test_polygons_overlap_boxes_as_in_exact_arithmetic(rows: NDArray[Any], x: int, y: int) -> None:
    corners = [(x, y), (x + 5, y + 1), (x + 6, y + 4), (x + 2, y + 6)]
    exact = [[Fraction(float(v)) for v in row] for row in rows]
    expected = [i for i, box in enumerate(exact) if polygon_overlaps(corners, box)]
    tree = jostle.Quadtree(boxes=rows, leaf_capacity=2)
    assert tree.query_polygon(corners).tolist() == expected
    assert tree.query_polygon(corners[::-1]).tolist() == expected


def id_and_distance(hit: jostle.RayHit) -> tuple[int, float]:
    return hit.id, hit.distance


def test_rays_hit_the_sides_of_boxes_exactly() -> None:
    tree = jostle.Quadtree(boxes=tiles(np.float64))
    edge = 3 * 0.1
    assert id_and_distance(tree.raycast((-1, edge), (1, 0), max_distance=2)) == (60, 1.0)
    walls = jostle.Quadtree(boxes=[(0.3, -1, 0.7, 0.1)])
    assert id_and_distance(walls.raycast((0, 0.1), (1, 0))) == (0, 0.3)
    assert id_and_distance(walls.raycast((0, np.nextafter(0.1, 1)), (1, 0))) == (-1, np.inf)
    assert walls.nearest((0, 0)).distances.tolist() == [0.3]


def overlap_by_sides(a: Any, b: Any) -> bool:
    """Whether two rects overlap; pygame rounds the sides of an FRect to float32."""
    return (a.left < b.right and b.left < a.right) and (a.top < b.bottom and b.top < a.bottom)


def test_rects_of_pygame_are_read_by_their_sides() -> None:
    pygame = pytest.importorskip("pygame")
    rng = np.random.default_rng(5)
    four = np.hstack([rng.integers(-40, 40, (60, 2)), rng.integers(1, 12, (60, 2))])
    for rects in (
        [pygame.Rect(*row) for row in four.tolist()],
        [pygame.FRect(*(row * 0.1)) for row in four],
    ):
        expected = pairs_of(rects, overlap_by_sides)
        assert by_row(jostle.find_pairs(boxes=rects)) == expected
        assert by_row(jostle.find_pairs(boxes=tuple(rects))) == expected
        tree = jostle.Quadtree(boxes=rects, leaf_capacity=4)
        assert by_row(tree.pairs()) == expected
        space = jostle.Space()
        ids = space.add(boxes=rects)
        assert space.update().entered.tolist() == expected
        for x, y in [rect.topleft for rect in rects] + [rect.bottomright for rect in rects]:
            point = (x, y)
            inside = [
                i
                for i, rect in enumerate(rects)
                if rect.left <= x < rect.right and rect.top <= y < rect.bottom
            ]
            assert tree.query_point(point).tolist() == space.query_point(point).tolist() == inside
        moved = [rect.move(3, 0) for rect in rects]
        space.set(ids, boxes=moved)
        assert by_row(space.pairs()) == by_row(jostle.find_pairs(boxes=moved))
        one = space.add(boxes=rects[0])
        assert one == len(rects)
        space.set(one, boxes=moved[0])
        sides = [moved[0].left, moved[0].top, moved[0].right, moved[0].bottom]
        assert space.get(one).boxes.tolist() == sides


def test_a_rect_among_rows_is_read_by_its_sides_too() -> None:
    pygame = pytest.importorskip("pygame")
    rows = [(0, 0, 2, 2), pygame.Rect(1, 1, 1, 1), [5, 5, 7, 7]]
    assert jostle.find_pairs(boxes=rows).tolist() == [[0, 1]]
    space = jostle.Space()
    space.add(boxes=rows)
    assert space.boxes.tolist() == [[0, 0, 2, 2], [1, 1, 2, 2], [5, 5, 7, 7]]
    tree = jostle.Quadtree(boxes=rows)
    assert [ids.tolist() for ids in tree.query_rect(rows)] == [[0, 1], [0, 1], [2]]
    assert tree.query_rect(rows[1]).tolist() == [0, 1]  # (1, 1, 1, 1) would be a point


@pytest.mark.parametrize("dtype", DTYPES)
def test_a_space_answers_for_its_boxes(dtype: Any) -> None:
    space = jostle.Space(dtype=np.dtype(dtype).name)
    circle = space.add((1, 2), 0.5)
    box = space.add(boxes=(0.1, 0.2, 0.4, 0.8))
    around = space.add((5, 5), half_sizes=(1, 2))
    given_box = np.array([0.1, 0.2, 0.4, 0.8], dtype)
    assert (space.get(box).boxes == given_box).all()
    assert (space.get(box).positions == (given_box[:2] + given_box[2:]) / 2).all()
    assert (space.get(box).half_sizes == (given_box[2:] - given_box[:2]) / 2).all()
    assert space.get(circle).boxes.tolist() == [1, 2, 1, 2]
    assert space.get([around, circle]).boxes.tolist() == [[4, 3, 6, 7], [1, 2, 1, 2]]
    assert space.boxes.dtype == dtype and space.boxes.shape == (3, 4)
    assert space.radii.tolist() == [0.5, 0, 0]


def test_a_box_moves_by_boxes_and_by_centers() -> None:
    space = jostle.Space()
    left, right = space.add(boxes=[(0, 0, 0.1, 1), (0.3, 0, 0.6, 1)])
    assert len(space.update().entered) == 0
    space.set(left, boxes=(0.2, 0, 0.3, 1))
    assert len(space.update().entered) == 0
    space.set([left], boxes=[(0.2, 0, np.nextafter(0.3, 1), 1)])
    assert space.update().entered.tolist() == [[left, right]]
    # At its own centre it stays a box; elsewhere it is its centre and half its size.
    space.set(right, positions=space.get(right).positions)
    assert space.get(right).boxes.tolist() == [0.3, 0, 0.6, 1]
    half = space.get(right).half_sizes
    space.set(right, positions=(7, 0.5))
    assert space.get(right).positions.tolist() == [7, 0.5]
    assert (space.get(right).half_sizes == half).all()
    sides = np.concatenate([(7, 0.5) - half, np.add((7, 0.5), half)])
    assert (space.get(right).boxes == sides).all()
    assert space.update().exited.tolist() == [[left, right]]
    # And back again, rounded by a radius.
    space.set(right, radii=0.25)
    space.set(right, boxes=(0.5, 0, 0.6, 1))
    assert space.get(right).boxes.tolist() == [0.5, 0, 0.6, 1]
    assert space.update().entered.tolist() == [[left, right]]
    assert space.get(right).radii == 0.25


def test_a_box_is_resized_around_its_middle() -> None:
    space = jostle.Space()
    box = space.add(boxes=(0.1, 0.1, 0.4, 0.3))
    space.set(box, half_sizes=space.get(box).half_sizes)
    assert space.get(box).boxes.tolist() == [0.1, 0.1, 0.4, 0.3]
    space.set(box, half_sizes=2)
    assert space.get(box).positions.tolist() == [0.25, 0.2]
    assert space.get(box).boxes.tolist() == [-1.75, -1.8, 2.25, 2.2]
    space.set(box, boxes=(0.1, 0.1, 0.4, 0.3))
    assert space.get(box).boxes.tolist() == [0.1, 0.1, 0.4, 0.3]


def test_a_removed_box_leaves_its_place_to_another_shape() -> None:
    space = jostle.Space()
    ids = space.add(boxes=tiles(np.float64)[:10])
    space.remove(ids)
    new = space.add(np.zeros((10, 2)), 1.0)
    assert (space.get(new).boxes == 0).all() and (space.get(new).half_sizes == 0).all()
    assert len(space.pairs()) == 45


def test_filters_and_masks_apply_to_boxes() -> None:
    rows = [(0, 0, 2, 2), (1, 1, 3, 3), (1, 1, 2, 2)]
    tree = jostle.Quadtree(boxes=rows, categories=[1, 2, 4], masks=[4, 7, 7])
    assert by_row(tree.pairs()) == [[0, 2], [1, 2]]
    assert tree.pairs(mask=5).tolist() == [[0, 2]]
    assert tree.query_rect((0, 0, 9, 9), mask=6).tolist() == [1, 2]


def test_no_boxes_are_no_shapes() -> None:
    for none in ([], np.zeros((0, 4)), ()):
        assert jostle.find_pairs(boxes=none).shape == (0, 2)
        assert len(jostle.Quadtree(boxes=none)) == 0
        assert jostle.Space().add(boxes=none).shape == (0,)


def test_float32_boxes_are_compared_in_float32() -> None:
    a, b = np.float32(0.1), np.float32(np.nextafter(np.float32(0.1), np.float32(1)))
    rows = np.array([(0, 0, b, 1), (a, 0, 1, 1)], np.float32)
    assert jostle.find_pairs(boxes=rows).tolist() == [[0, 1]]
    assert "float32" in repr(jostle.Quadtree(boxes=rows))
    assert "float64" in repr(jostle.Quadtree(boxes=rows.tolist()))
    assert "float64" in repr(jostle.Quadtree(boxes=rows, radii=np.zeros(2)))


ONE = [(0, 0, 1, 1)]
WRONG = [
    ({}, TypeError, "positions, boxes or segments must be given"),
    ({"half_sizes": 1}, TypeError, "positions, boxes or segments must be given"),
    ({"positions": [(0, 0)], "boxes": ONE}, TypeError, "leave out positions"),
    ({"half_sizes": 1, "boxes": ONE}, TypeError, "leave out half_sizes"),
    ({"boxes": [(0, 0, 1, 1), (2, 0, 1, 1)]}, ValueError, r"boxes\[1\] is \(2, 0, 1, 1\); it must"),
    ({"boxes": [(0, 3, 1, 1)]}, ValueError, r"boxes\[0\] is \(0, 3, 1, 1\); .*no minimum above"),
    ({"boxes": [(0, 0, np.nan, 1)]}, ValueError, r"boxes\[0\] is \(0, 0, NaN, 1\); .*finite"),
    ({"boxes": [(0, 0, 1, 1), (0, -np.inf, 1, 1)]}, ValueError, r"boxes\[1\] is .*finite"),
    ({"boxes": [(-1e308, 0, 1e308, 1)]}, ValueError, r"boxes\[0\] is .* at most .* wide"),
    ({"boxes": [(0, 0, 1)]}, ValueError, r"boxes has shape \(1, 3\); it must be \(n, 4\)"),
    ({"boxes": [("a", 0, 1, 1)]}, TypeError, "boxes must hold real numbers"),
    ({"boxes": ONE, "radii": [1, 2]}, ValueError, "radii has shape"),
    ({"boxes": ONE, "radii": -1}, ValueError, "radii is -1"),
    ({"positions": ONE}, ValueError, "rectangles are given as boxes="),
]


@pytest.mark.parametrize(("arguments", "error", "message"), WRONG)
def test_wrong_boxes_are_refused(
    arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    calls: list[Any] = [jostle.find_pairs, jostle.Quadtree]
    space = jostle.Space()
    # One triple is one shape of wrong form for a space, too, but named otherwise.
    if message != r"boxes has shape \(1, 3\); it must be \(n, 4\)":
        calls.append(space.add)
    for call in calls:
        with pytest.raises(error, match=message):
            call(**arguments)
    assert len(space) == 0


def test_wrong_moves_are_refused() -> None:
    space = jostle.Space()
    ids = space.add(boxes=[(0, 0, 1, 1), (2, 0, 3, 1)])
    before = space.boxes.tolist()
    for which, arguments, error, message in [
        (ids, {"positions": [(0, 0)] * 2, "boxes": ONE * 2}, TypeError, "leave out positions"),
        (ids, {"boxes": ONE}, ValueError, r"boxes has shape \(1, 4\); it must be \(2, 4\)"),
        (ids, {"boxes": ONE[0]}, ValueError, r"boxes has shape \(4,\); it must be \(2, 4\)"),
        (ids, {"boxes": [ONE[0], (0, 1, 1, 0)]}, ValueError, r"boxes\[1\] is \(0, 1, 1, 0\)"),
        (ids, {"positions": ONE * 2}, ValueError, "rectangles are given as boxes="),
        (0, {"boxes": (0, 1, 1, 0)}, ValueError, r"boxes is \(0, 1, 1, 0\); "),
        (0, {"boxes": ONE}, ValueError, "as there is one id"),
        ([0, 7], {"boxes": ONE * 2}, ValueError, r"ids\[1\] is 7; no shape"),
    ]:
        with pytest.raises(error, match=message):
            space.set(which, **arguments)  # type: ignore[arg-type]
    assert space.boxes.tolist() == before


def test_a_container_is_a_rectangle_to_ask_about_and_no_shape() -> None:
    """`jostle.Box` keeps its sides as float32, so tiles made of it would overlap."""
    tree = jostle.Quadtree(boxes=[(0, 0, 0.5, 1), (0.75, 0, 1, 1)])
    assert tree.query_rect(jostle.Box(0, 0, 0.75, 1)).tolist() == [0]
    assert tree.query_rect([jostle.Box(0, 0, 2, 1)]).ids.tolist() == [0, 1]
    with pytest.raises(TypeError, match=r"^boxes must hold real numbers"):
        jostle.find_pairs(boxes=[jostle.Box(0, 0, 1, 1)])
