"""`jostle.Quadtree`: pairs, filters, contacts, boxes, and the number of tests."""

import re
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracle import (
    ALL_BITS,
    DTYPES,
    Shapes,
    any_shapes,
    by_row,
    may_pair,
    overlap,
    pairs_between,
    pairs_within,
    uniform,
)
from results import fields

import jostle

capacities = st.integers(1, 20)
depths = st.integers(0, 12) | st.just(4096)


def work_of(centers: Any, radii: Any = 0.5, **settings: Any) -> int:
    """Return how many pairs a tree tests to find the overlapping ones."""
    tree = jostle.Quadtree(centers, radii, **settings)
    tree.pairs()
    return tree.stats.tests


@given(any_shapes(), capacities, depths)
def test_equals_brute_force_in_numpy(shapes: Shapes, leaf_capacity: int, max_depth: int) -> None:
    tree = jostle.Quadtree(*shapes, leaf_capacity=leaf_capacity, max_depth=max_depth)
    expected = pairs_within(shapes)
    np.testing.assert_array_equal(by_row(tree.pairs()), expected)
    np.testing.assert_array_equal(tree.pairs(sort=True), expected)


@given(st.sampled_from(DTYPES), st.booleans(), st.data(), capacities, capacities)
def test_pairs_with_another_tree(
    dtype: Any, boxes: bool, data: st.DataObject, capacity: int, other_capacity: int
) -> None:
    a = data.draw(any_shapes(dtype, boxes))
    b = data.draw(any_shapes(dtype))
    tree = jostle.Quadtree(*a, leaf_capacity=capacity)
    other = jostle.Quadtree(*b, leaf_capacity=other_capacity)
    expected = pairs_between(a, b)
    np.testing.assert_array_equal(by_row(tree.pairs(other)), expected)
    np.testing.assert_array_equal(tree.pairs(other, sort=True), expected)
    np.testing.assert_array_equal(by_row(other.pairs(tree)[:, ::-1]), expected)
    np.testing.assert_array_equal(tree.pairs(tree, sort=True), pairs_between(a, a))


@given(any_shapes(), st.randoms(use_true_random=False))
def test_a_permuted_input_permutes_the_answer_and_nothing_else(shapes: Shapes, random: Any) -> None:
    """Even the order of the pairs is the same, unless two shapes are equal."""
    shapes = shapes.distinct()
    order = np.arange(len(shapes.radii))
    random.shuffle(order)
    tree, permuted = jostle.Quadtree(*shapes), jostle.Quadtree(*shapes.take(order))
    np.testing.assert_array_equal(
        np.sort(order[permuted.pairs()], axis=1), np.sort(tree.pairs(), axis=1)
    )
    assert permuted.nodes() == tree.nodes()


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("kind", ["discs", "boxes", "filters"])
def test_threads_change_nothing(dtype: Any, kind: str) -> None:
    centers = uniform(20_000, dtype)  # enough for several threads
    more: dict[str, Any] = {
        "discs": {"radii": 0.5},
        "boxes": {"half_sizes": (0.5, 0.25)},
        "filters": {"radii": 0.5, "masks": np.arange(20_000) % 5},
    }[kind]
    one, two, eight = (jostle.Quadtree(centers, **more, threads=k) for k in (1, 2, 8))
    other = jostle.Quadtree(centers + centers.dtype.type(0.25), **more)
    assert len(one.pairs()) > 500
    for tree in (two, eight):
        np.testing.assert_array_equal(tree.pairs(), one.pairs())
        np.testing.assert_array_equal(tree.pairs(other), one.pairs(other))
        assert tree.contacts() == one.contacts() and tree.nodes() == one.nodes()
        assert tree.stats == one.stats


@pytest.mark.parametrize("nothing", [[], np.empty((0, 2)), np.empty((0, 2), np.float32)])
def test_an_empty_tree(nothing: Any) -> None:
    tree = jostle.Quadtree(nothing)
    assert len(tree) == 0
    assert tree.pairs().shape == (0, 2)
    assert tree.pairs(tree).shape == (0, 2)
    assert [part.shape for part in fields(tree.contacts())] == [
        (0, 2),
        (0, 2),
        (0,),
        (0, 2, 2),
        (0, 2),
    ]
    assert [part.shape for part in fields(tree.nodes())] == [(0, 4), (0,), (0,), (0,)]
    assert tree.stats == jostle.Stats(0, 0, 0, 0)


def test_the_tree_keeps_its_own_copy() -> None:
    centers, radii = uniform(500), np.full(500, 0.5)
    tree = jostle.Quadtree(centers, radii)
    before = tree.pairs()
    centers[:] = 0
    radii[:] = 0
    np.testing.assert_array_equal(tree.pairs(), before)


def test_several_threads_may_query_at_the_same_time() -> None:
    tree = jostle.Quadtree(uniform(20_000), 0.5)
    alone = tree.pairs()
    with ThreadPoolExecutor(4) as pool:
        for together in pool.map(lambda _: tree.pairs(), range(8)):
            np.testing.assert_array_equal(together, alone)


def test_a_tree_says_what_it_is_and_cannot_be_changed() -> None:
    tree = jostle.Quadtree(np.zeros((3, 2), np.float32))
    assert len(tree) == 3
    assert repr(tree) == "<jostle.Quadtree of 3 shapes, float32>"
    for name in ("stats", "nodes", "own"):
        with pytest.raises(AttributeError):
            setattr(tree, name, 1)


bits = st.integers(0, 7) | st.sampled_from([ALL_BITS, ALL_BITS - 1, 1 << 31])


@given(any_shapes(), st.data(), capacities)
def test_filters(shapes: Shapes, data: st.DataObject, leaf_capacity: int) -> None:
    n = len(shapes.radii)
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    kinds = np.array(data.draw(st.lists(bits, min_size=4, max_size=4)), np.uint32)
    categories, masks = kinds[rng.integers(0, 4, (2, n))]
    cases: list[tuple[dict[str, Any], Any, Any]] = [
        ({"categories": categories, "masks": masks}, categories, masks),
        ({"categories": categories}, categories, np.full(n, ALL_BITS, np.uint32)),
        ({"masks": masks}, np.ones(n, np.uint32), masks),
        ({"categories": 6, "masks": masks.tolist()}, np.full(n, 6, np.uint32), masks),
        ({"categories": categories, "masks": 3}, categories, np.full(n, 3, np.uint32)),
    ]
    for given_ones, own, wanted in cases:
        tree = jostle.Quadtree(*shapes, **given_ones, leaf_capacity=leaf_capacity)
        expected = pairs_within(shapes, may_pair(own, wanted, own, wanted))
        np.testing.assert_array_equal(tree.pairs(sort=True), expected)
        np.testing.assert_array_equal(by_row(tree.contacts().pairs), expected)
        for method in ("auto", "brute", "quadtree"):
            found = jostle.find_pairs(*shapes, **given_ones, method=method, sort=True)
            np.testing.assert_array_equal(found, expected)


@given(st.sampled_from(DTYPES), st.data())
def test_filters_between_two_trees(dtype: Any, data: st.DataObject) -> None:
    a, b = data.draw(any_shapes(dtype)), data.draw(any_shapes(dtype))
    seed = data.draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    of_a, of_b = (rng.integers(0, 4, (2, len(s.radii)), dtype=np.uint32) for s in (a, b))
    filtered = jostle.Quadtree(*a, categories=of_a[0], masks=of_a[1])
    other = jostle.Quadtree(*b, categories=of_b[0], masks=of_b[1])
    expected = pairs_between(a, b, may_pair(*of_a, *of_b))
    np.testing.assert_array_equal(filtered.pairs(other, sort=True), expected)
    # Without filters a shape has category 1 and may pair with all.
    plain = np.array([[1], [ALL_BITS]], np.uint32).repeat(len(b.radii), axis=1)
    expected = pairs_between(a, b, may_pair(*of_a, *plain))
    np.testing.assert_array_equal(filtered.pairs(jostle.Quadtree(*b), sort=True), expected)
    swapped = jostle.Quadtree(*b).pairs(filtered)[:, ::-1]
    np.testing.assert_array_equal(by_row(swapped), expected)


@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", ">u4", ">i8"])
def test_any_integers_are_bits(dtype: str) -> None:
    categories, masks = np.array([1, 2, 4], dtype), np.array([2, 1, 7], dtype)
    tree = jostle.Quadtree(np.zeros((3, 2)), 1.0, categories=categories, masks=masks)
    assert tree.pairs(sort=True).tolist() == [[0, 1]]
    tree = jostle.Quadtree(np.zeros((3, 2)), 1.0, masks=np.repeat(masks, 2)[::2])
    assert tree.pairs(sort=True).tolist() == [[1, 2]]


def moved(shapes: Shapes, pairs: NDArray[Any], by: NDArray[Any]) -> tuple[Shapes, Shapes]:
    """Return the first and the second of each pair, row by row, the second moved."""
    first, second = shapes.take(pairs[:, 0]), shapes.take(pairs[:, 1])
    return first, second._replace(centers=second.centers + by)


@given(any_shapes())
def test_contacts_part_the_pairs(shapes: Shapes) -> None:
    """Moved by its depth along the normal, j only touches i: half of it is too little."""
    near = np.abs(shapes.centers).max(axis=1, initial=0) < 1e7
    shapes = shapes.take(np.flatnonzero(near & (shapes.radii > 1e-3) & (shapes.radii < 1e3)))
    tree = jostle.Quadtree(*shapes)
    pairs, normals, depths, *_ = fields(tree.contacts())
    np.testing.assert_array_equal(pairs, tree.pairs())
    assert normals.dtype == depths.dtype == shapes.centers.dtype
    assert (normals.shape, depths.shape) == ((len(pairs), 2), (len(pairs),))
    if len(pairs) == 0:
        return
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-6)
    wide = Shapes(*(None if part is None else part.astype(np.float64) for part in shapes))
    scale = 1 + np.abs(wide.centers).max() + wide.radii.max()
    scale += 0 if wide.half_sizes is None else wide.half_sizes.max()
    slack = scale * (1e-5 if shapes.centers.dtype == np.float32 else 1e-12)
    enough = normals * (depths + slack)[:, None].astype(np.float64)
    first, second = moved(wide, pairs, enough)
    assert not overlap(first, second).any()
    deep = depths > 4 * slack
    first, second = moved(wide, pairs[deep], (normals * (depths / 2)[:, None])[deep])
    assert overlap(first, second).all()


@pytest.mark.parametrize("dtype", DTYPES)
def test_contacts_by_hand(dtype: Any) -> None:
    def contact(centers: Any, radii: Any, half_sizes: Any = None) -> tuple[Any, ...]:
        shapes = [np.array(part, dtype) for part in (centers, radii)]
        if half_sizes is not None:
            shapes.append(np.array(half_sizes, dtype))
        contacts = jostle.Quadtree(*shapes).contacts()
        assert isinstance(contacts, jostle.Contacts)
        pairs, normals, depths, *_ = fields(contacts)
        assert (pairs.dtype, depths.dtype) == (np.int64, dtype)
        assert pairs.tolist() == [[0, 1]]
        return (*normals[0].tolist(), depths.item())

    assert contact([(0, 0), (3, 4)], [4, 2]) == pytest.approx((0.6, 0.8, 1))
    assert contact([(3, 4), (0, 0)], [4, 2]) == pytest.approx((-0.6, -0.8, 1))
    assert contact([(5, 5), (5, 5)], [1, 2]) == (1, 0, 3)  # coincident: +x
    # The axis of least penetration for two rectangles, the diagonal for a circle at a corner.
    assert contact([(0, 0), (1, 1.5)], [0, 0], [(2, 1), (2, 1)]) == (0, 1, 0.5)
    assert contact([(0, 0), (-3, 0.5)], [0, 0], [(2, 1), (2, 1)]) == (-1, 0, 1)
    assert contact([(0, 0), (5, 5)], [0, 6], [(2, 1), (0, 0)]) == pytest.approx((0.6, 0.8, 1))
    # The centre of the circle is in the rectangle: out by the nearer side and its radius.
    assert contact([(0, 0), (0, -0.5)], [0, 1], [(2, 1), (0, 0)]) == (0, -1, 1.5)


SINGLE, DOUBLE = np.zeros((2, 2), "f4"), np.zeros((2, 2), "f8")


@pytest.mark.parametrize(
    ("arguments", "dtype"),
    [
        ((SINGLE,), "f4"),
        ((SINGLE.astype(">f4"), SINGLE[0]), "f4"),
        ((SINGLE, 1), "f4"),
        ((SINGLE, np.float64(1), (1, 2)), "f4"),
        ((SINGLE, 0.5, 0.5), "f4"),
        ((SINGLE, SINGLE[0], SINGLE), "f4"),
        ((DOUBLE,), "f8"),
        ((SINGLE, DOUBLE[0]), "f8"),
        ((SINGLE, [1, 2]), "f8"),
        ((SINGLE, 1.0, DOUBLE), "f8"),
        ((SINGLE, 1.0, DOUBLE[0]), "f8"),
        ((SINGLE, 1.0, [(1, 2), (1, 2)]), "f8"),
        ((DOUBLE, SINGLE[0], SINGLE), "f8"),
        ((SINGLE.tolist(), SINGLE[0]), "f8"),
        ((SINGLE.astype("i4"),), "f8"),
        ((SINGLE.astype("f2"),), "f8"),
        (([],), "f8"),
        ((SINGLE[:0],), "f4"),
    ],
)
def test_float32_only_if_every_array_is(arguments: tuple[Any, ...], dtype: str) -> None:
    assert jostle.Quadtree(*arguments).contacts().depths.dtype == dtype


def holds_one_place(shapes: Shapes, box: Any, count: int) -> bool:
    """Return whether so many of the centres in a box coincide."""
    inside = ((shapes.centers >= box[:2]) & (shapes.centers <= box[2:])).all(axis=1)
    alike = np.unique(shapes.centers[inside], axis=0, return_counts=True)[1]
    return bool(alike.max() == count)


@given(any_shapes(), capacities, depths)
def test_the_boxes_make_a_tree(shapes: Shapes, leaf_capacity: int, max_depth: int) -> None:
    tree = jostle.Quadtree(*shapes, leaf_capacity=leaf_capacity, max_depth=max_depth)
    boxes, levels, counts, is_leaf = fields(tree.nodes())
    types = [part.dtype for part in (boxes, levels, counts, is_leaf)]
    assert types == [np.float64, np.int64, np.int64, np.bool_]
    n, k = len(shapes.radii), len(levels)
    assert boxes.shape == (k, 4)
    assert (k == 0) == (n == 0)
    if n == 0:
        return
    # The root contains all; every level contains all shapes that are not in a leaf above it.
    assert (levels[0], counts[0]) == (0, n)
    for level in range(1, levels.max() + 1):
        kept = counts[is_leaf & (levels < level)].sum()
        assert counts[levels == level].sum() == n - kept
    assert counts[is_leaf].sum() == n
    # Capacity and depth.
    assert levels.max() <= max_depth
    crowded = is_leaf & (counts > leaf_capacity) & (levels < max_depth)
    for box, count in zip(boxes[crowded], counts[crowded], strict=True):
        assert count <= 8 or (box[:2] == box[2:]).all() or holds_one_place(shapes, box, count)
    assert (counts[~is_leaf] > leaf_capacity).all()
    # Every box but the root is in an earlier box, one subdivision up, and contains at least as
    # many centres as it has shapes.
    centers = shapes.centers.astype(np.float64)
    for here in range(k):
        inside = (centers >= boxes[here, :2]).all(axis=1) & (centers <= boxes[here, 2:]).all(axis=1)
        assert inside.sum() >= counts[here]
        if here:
            around = (boxes[:here, :2] <= boxes[here, :2]) & (boxes[:here, 2:] >= boxes[here, 2:])
            assert (around.all(axis=1) & (levels[:here] + 1 == levels[here])).any()


def test_boxes_by_hand() -> None:
    """Four quarters of [0, 8]², then those of the lower left one, without useless subdivisions."""
    centers = [(0, 0), (1, 0), (0, 1), (7, 0), (0, 7), (7, 7), (3, 3)]
    tree = jostle.Quadtree(centers, 0.1, leaf_capacity=3)
    nodes = tree.nodes()
    assert isinstance(nodes, jostle.Nodes)
    columns = nodes.boxes.tolist(), nodes.levels, nodes.counts, nodes.is_leaf
    found = {(*box, level, count, leaf) for box, level, count, leaf in zip(*columns, strict=True)}
    assert found == {
        (0, 0, 8, 8, 0, 7, False),
        (0, 0, 4, 4, 1, 4, False),
        (4, 0, 8, 4, 1, 1, True),
        (0, 4, 4, 8, 1, 1, True),
        (4, 4, 8, 8, 1, 1, True),
        (0, 0, 2, 2, 2, 3, True),
        (2, 2, 4, 4, 2, 1, True),
    }
    assert tree.stats == jostle.Stats(7, 5, 2, 0)


@pytest.mark.parametrize("max_depth", [0, 1, 2, 5])
@pytest.mark.parametrize("centers", [uniform(2000), np.zeros((2000, 2))], ids=["spread", "same"])
def test_max_depth_allows_so_many_subdivisions(max_depth: int, centers: Any) -> None:
    tree = jostle.Quadtree(centers, leaf_capacity=1, max_depth=max_depth)
    deepest = max_depth if len(np.unique(centers)) > 1 else 0  # coincident shapes are one box
    assert tree.stats.depth == tree.nodes().levels.max() == deepest
    assert tree.stats.nodes <= (4 ** (max_depth + 1) - 1) // 3


def test_stats_are_of_the_last_call() -> None:
    tree = jostle.Quadtree(uniform(1000), 0.5)
    nodes = tree.nodes()
    built = tree.stats
    assert isinstance(built, jostle.Stats)
    expected = jostle.Stats(len(nodes.levels), nodes.is_leaf.sum(), nodes.levels.max(), 0)
    assert built == expected
    pairs = tree.pairs()
    after = tree.stats
    assert fields(after)[:3] == fields(built)[:3]
    assert len(pairs) < after.tests < 1000 * 999 // 2
    tree.pairs(jostle.Quadtree([(1, 1)], 0.5))
    assert tree.stats.tests < after.tests
    tree.contacts()
    assert tree.stats == after


def test_one_leaf_tests_every_pair() -> None:
    assert work_of(uniform(100), max_depth=0) == 100 * 99 // 2
    assert work_of(uniform(100), leaf_capacity=100) == 100 * 99 // 2


N = 20_000
USUAL = work_of(uniform(N))


def test_work_grows_with_the_number_of_shapes() -> None:
    assert USUAL < 100 * N
    assert work_of(uniform(4 * N)) < 5 * USUAL


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("far", [1e7, 1e15, 1e30])
def test_two_far_ones_do_not_blow_up_a_small_cluster(dtype: Any, far: float) -> None:
    cluster = np.random.default_rng(1).random((N, 2)).astype(dtype)
    radius = 0.5 / np.sqrt(N * np.pi * 0.25 / 0.4)
    without = work_of(cluster, radius)
    ends = np.array([(-far, -far), (far, far)], dtype)
    assert work_of(np.vstack([cluster, ends]), radius) < 3 * without


@pytest.mark.parametrize("direction", [(1, 0), (0, 1), (1, 1), (1, -1e-6)])
def test_a_line_does_not_blow_up(direction: tuple[float, float]) -> None:
    line = np.outer(np.arange(N) / np.hypot(*direction), direction)
    tree = jostle.Quadtree(line, 0.6)
    assert len(tree.pairs()) == N - 1
    assert tree.stats.tests < 3 * USUAL


def test_ever_smaller_steps_do_not_blow_up() -> None:
    """Each point is half as far from the origin as the previous one, down to subnormal numbers."""
    points = np.outer(0.5 ** np.arange(1070), (1, 1))
    tree = jostle.Quadtree(points, leaf_capacity=1)
    assert len(tree.pairs()) == 0
    assert tree.stats.depth <= 1070
    assert tree.stats.nodes < 3 * 1070


TWO = [(0, 0), (1, 1)]
# test_find_pairs.py has those of arguments that both have.
WRONG_VALUES: list[tuple[dict[str, Any], str]] = [
    ({"masks": [1, 2, 3]}, "masks has shape (3,); it must be an integer or (2,)"),
    ({"leaf_capacity": 0}, "leaf_capacity is 0; it must be at least 1"),
    ({"leaf_capacity": -5}, "leaf_capacity is -5; it must be at least 1"),
    ({"max_depth": -1}, "max_depth is -1; it must be at least 0"),
    ({"max_depth": 4097}, "max_depth is 4097; it must be at most 4096"),
]
WRONG_TYPES: list[tuple[dict[str, Any], str]] = [
    ({"categories": 1.0}, "categories must hold integers, not float"),
    ({"categories": [1.0, 2.0]}, "categories must hold integers, not float64"),
    ({"masks": True}, "masks must hold integers, not bool"),
    ({"masks": [True, False]}, "masks must hold integers, not bool"),
    ({"masks": "all"}, "masks must hold integers, not str"),
    ({"leaf_capacity": 2.5}, "leaf_capacity must be an integer, not float"),
    ({"leaf_capacity": None}, "leaf_capacity must be an integer, not NoneType"),
    ({"max_depth": "deep"}, "max_depth must be an integer, not str"),
]


@pytest.mark.parametrize(
    ("error", "arguments", "message"),
    [(ValueError, *case) for case in WRONG_VALUES] + [(TypeError, *case) for case in WRONG_TYPES],
)
def test_wrong_arguments(error: Any, arguments: dict[str, Any], message: str) -> None:
    end = "$" if error is TypeError else ""
    with pytest.raises(error, match=f"^{re.escape(message)}{end}"):
        jostle.Quadtree(**{"positions": TWO, **arguments})


def test_wrong_questions() -> None:
    tree = jostle.Quadtree(TWO, 1.0)
    with pytest.raises(TypeError, match="other must be a Quadtree, not list"):
        tree.pairs(TWO)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="sort must be True or False, not str"):
        tree.pairs(sort="yes")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="max_pairs is -1; it must be at least 0"):
        tree.contacts(max_pairs=-1)
    with pytest.raises(TypeError, match="positional argument"):
        tree.pairs(None, True)  # type: ignore[misc]


def test_trees_of_different_precision_do_not_mix() -> None:
    single, double = jostle.Quadtree(SINGLE, 1.0), jostle.Quadtree(DOUBLE, 1.0)
    message = "other computes in float64 and this tree in float32; build both from float32 arrays"
    with pytest.raises(TypeError, match=message):
        single.pairs(double)
    with pytest.raises(TypeError, match="other computes in float32 and this tree in float64"):
        double.pairs(single)


@pytest.mark.parametrize("threads", [1, 2])
def test_max_pairs_is_exact(threads: int) -> None:
    tree = jostle.Quadtree(uniform(3000), 0.5, threads=threads)
    within, between = len(tree.pairs()), len(tree.pairs(tree))
    assert len(tree.pairs(max_pairs=within)) == within
    assert len(tree.contacts(max_pairs=within).pairs) == within
    assert len(tree.pairs(tree, max_pairs=between)) == between
    for query in (
        lambda: tree.pairs(max_pairs=within - 1),
        lambda: tree.contacts(max_pairs=within - 1),
        lambda: tree.pairs(tree, max_pairs=between - 1),
    ):
        with pytest.raises(ValueError, match=r"more than max_pairs = \d+ pairs overlap"):
            query()
