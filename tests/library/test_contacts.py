"""Points and categories of contacts, and contacts and events between categories."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracle import DTYPES
from results import chosen

import jostle

Columns = dict[str, NDArray[Any]]


def scene(seed: int, dtype: Any = np.float64, n: int = 300) -> Columns:
    """Circles, boxes and rounded boxes, many of which overlap; some are nested or level."""
    rng = np.random.default_rng(seed)
    grid = rng.random(n) < 0.3
    positions = np.where(grid[:, None], rng.integers(0, 20, (n, 2)), rng.uniform(0, 20, (n, 2)))
    half = np.where(grid[:, None], rng.integers(0, 3, (n, 2)), rng.uniform(0, 2, (n, 2)))
    half[rng.random(n) < 0.4] = 0
    radii = np.where(rng.random(n) < 0.3, 0, rng.uniform(0.1, 1.5, n))
    categories = rng.choice([1, 2, 4, 6], n).astype(np.uint32)
    columns = {"positions": positions, "radii": radii, "half_sizes": half}
    return {**{k: v.astype(dtype) for k, v in columns.items()}, "categories": categories}


def outside(points: NDArray[Any], centers: NDArray[Any], half: NDArray[Any]) -> NDArray[Any]:
    """Return the signed distance of points from boxes: negative inside."""
    gap = np.abs(points - centers) - half
    return np.linalg.norm(np.maximum(gap, 0), axis=-1) + np.minimum(gap.max(axis=-1), 0)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("seed", range(4))
def test_points_are_half_the_depth_below_both_surfaces(seed: int, dtype: Any) -> None:
    columns = scene(seed, dtype)
    found = jostle.Quadtree(**columns).contacts()
    assert found.points.shape == (len(found.pairs), 2, 2) and found.points.dtype == dtype
    assert found.categories.dtype == np.uint32
    np.testing.assert_array_equal(found.categories, columns["categories"][found.pairs])
    exact = {k: v.astype(float) for k, v in columns.items()}
    way = (found.normals * found.depths[:, None] / 2).astype(float)
    two = 0
    for points in (found.points[:, 0], found.points[:, 1]):
        there = ~np.isnan(points).any(axis=1)
        two += there.sum()
        assert (np.isnan(points).all(axis=1) == ~there).all()
        for side, shift in ((0, way), (1, -way)):
            rows = found.pairs[there, side]
            surface = outside(
                points[there] + shift[there], exact["positions"][rows], exact["half_sizes"][rows]
            )
            np.testing.assert_allclose(
                surface, exact["radii"][rows], atol=1e3 * np.finfo(dtype).eps
            )
    assert not np.isnan(found.points[:, 0]).any() and len(found.pairs) < two < 2 * len(found.pairs)


def test_points_of_boxes_are_the_ends_of_the_middle_of_their_intersection() -> None:
    """Of boxes of which none is within the range of the other along an axis."""
    rng = np.random.default_rng(5)
    low = rng.uniform(0, 60, (400, 2))
    boxes = np.hstack([low, low + rng.uniform(1, 4, (400, 2))])
    found = jostle.Quadtree(boxes=boxes).contacts()
    a, b = boxes[found.pairs[:, 0]], boxes[found.pairs[:, 1]]
    low, high = np.maximum(a[:, :2], b[:, :2]), np.minimum(a[:, 2:], b[:, 2:])
    inside = ((a[:, :2] < b[:, :2]) == (a[:, 2:] > b[:, 2:])).any(axis=1)
    across = np.argmax(np.abs(found.normals), axis=1)
    rows = np.arange(len(a))
    expected = np.stack([low, high], axis=1)
    expected[rows, :, across] = ((low + high) / 2)[rows, across][:, None]
    assert (~inside).sum() > 100
    np.testing.assert_allclose(found.points[~inside], expected[~inside], rtol=1e-13)


def test_the_point_of_circles_is_on_the_line_of_their_centres() -> None:
    rng = np.random.default_rng(6)
    centers, radii = rng.uniform(0, 30, (300, 2)), rng.uniform(0.1, 2, 300)
    found = jostle.Quadtree(centers, radii).contacts()
    i, j = found.pairs.T
    way = centers[j] - centers[i]
    far = np.linalg.norm(way, axis=1)
    share = (radii[i] + far - radii[j]) / 2 / far  # half way between the two surfaces
    np.testing.assert_allclose(found.points[:, 0], centers[i] + share[:, None] * way, rtol=1e-9)
    assert np.isnan(found.points[:, 1]).all() and len(found.pairs) > 100


def test_points_of_coincident_and_touching_corners() -> None:
    tree = jostle.Quadtree([(3, 3), (3, 3)], [1.0, 2.0])
    np.testing.assert_array_equal(tree.contacts().points[0], [(2.5, 3), (np.nan, np.nan)])
    # Two rounded boxes whose cores are level at one corner, and a disc above a side.
    tree = jostle.Quadtree([(0, 0), (3, 2)], radii=0.75, half_sizes=1.0)
    np.testing.assert_array_equal(tree.contacts().points[0], [(1.5, 1), (np.nan, np.nan)])
    tree = jostle.Quadtree([(0, 0), (0.5, 2)], radii=[0, 1.5], half_sizes=[(1, 1), (0, 0)])
    np.testing.assert_array_equal(tree.contacts().points[0], [(0.5, 0.75), (np.nan, np.nan)])


def test_points_across_a_border_are_next_to_the_first_shape() -> None:
    for positions, expected in (([(0.5, 1), (9.5, 1)], 0.0), ([(9.5, 1), (0.5, 1)], 10.0)):
        for index in (
            jostle.Quadtree(positions, 1.0, period=(10, 0)),
            jostle.Space(period=(10, 0)),
        ):
            if isinstance(index, jostle.Space):
                index.add(positions, 1.0)
            found = index.contacts()
            assert found.pairs.tolist() == [[0, 1]]
            np.testing.assert_array_equal(found.points[0], [(expected, 1), (np.nan, np.nan)])


def test_a_space_and_two_trees_have_points_and_categories_too() -> None:
    columns = scene(9)
    space, tree = jostle.Space(), jostle.Quadtree(**columns)
    space.add(**columns)
    assert space.contacts(sort=True) == tree.contacts(sort=True)
    first, second = (
        {k: v[rows] for k, v in columns.items()} for rows in (slice(150), slice(150, None))
    )
    found = jostle.Quadtree(**first).contacts(jostle.Quadtree(**second), sort=True)
    within = tree.contacts(sort=True)
    rows = (within.pairs[:, 0] < 150) & (within.pairs[:, 1] >= 150)
    for name in ("normals", "depths", "points", "categories"):
        np.testing.assert_array_equal(getattr(found, name), getattr(within, name)[rows])


@given(seed=st.integers(0, 5), a=st.integers(0, 7), b=st.integers(0, 7))
def test_contacts_between_categories(seed: int, a: int, b: int) -> None:
    whole = jostle.Quadtree(**scene(seed, n=60)).contacts()
    before = copy.deepcopy(whole)
    part = whole.between(a, b)
    assert whole == before and type(part) is jostle.Contacts
    rows = [
        (row, found)
        for row, (pair, both) in enumerate(
            zip(whole.pairs.tolist(), whole.categories.tolist(), strict=True)
        )
        if (found := chosen(pair, both, a, b))
    ]
    assert part.pairs.tolist() == [found for _, found in rows]
    kept = [row for row, _ in rows]
    turned = np.array([found != whole.pairs[row].tolist() for row, found in rows], bool)
    signs = np.where(turned, -1.0, 1.0)[:, None]
    np.testing.assert_array_equal(part.normals, whole.normals[kept] * signs)
    for name in ("depths", "points"):
        np.testing.assert_array_equal(getattr(part, name), getattr(whole, name)[kept])
    back = part.between(b, a)
    assert sorted(map(sorted, back.pairs.tolist())) == sorted(map(sorted, part.pairs.tolist()))


def random_events(seed: int) -> tuple[jostle.Space, jostle.Events, dict[int, int]]:
    """Return a space, the events of its second update, and the categories by id."""
    rng = np.random.default_rng(seed)
    columns, space = scene(seed), jostle.Space()
    ids = space.add(**columns)
    space.remove(ids[::7])
    space.update()
    moved = ids[np.isin(ids, space.ids)][::3]
    space.set(moved, positions=rng.uniform(0, 20, (len(moved), 2)))
    space.remove(moved[:10])
    more = space.add([(10, 10)] * 5, 2.0, categories=[1, 2, 4, 6, 0])
    categories = dict(zip(ids.tolist(), columns["categories"].tolist(), strict=True))
    return (
        space,
        space.update(),
        categories | dict(zip(more.tolist(), [1, 2, 4, 6, 0], strict=True)),
    )


NAMES = ("entered", "stayed", "exited")


@given(seed=st.integers(0, 3), a=st.integers(0, 7), b=st.integers(-8, 7))
def test_events_between_categories(seed: int, a: int, b: int) -> None:
    _, events, categories = random_events(seed)
    part = events.between(a, b)
    for name in NAMES:
        pairs = getattr(events, name).tolist()
        assert len(pairs) > 10
        every = (chosen(pair, [categories[id] for id in pair], a, b) for pair in pairs)
        assert getattr(part, name).tolist() == [pair for pair in every if pair], name
    assert repr(part) == f"<jostle.Events: {len(part.entered)} entered, {len(part.exited)} exited>"
    twice = part.between(b, a).between(a, b)
    for name in NAMES:
        rows = [sorted(map(sorted, getattr(some, name).tolist())) for some in (twice, part)]
        assert rows[0] == rows[1]


def test_events_have_the_categories_of_the_update() -> None:
    """Also of shapes that were removed since, and whose slots others use."""
    space, events, _ = random_events(1)
    expected = {name: getattr(events.between(2, 4), name).tolist() for name in NAMES}
    again = pickle.loads(pickle.dumps(events)).between(2, 4)
    space.set(space.ids, categories=8)
    assert {
        name: getattr(events.between(2, 4), name).tolist() for name in ("entered", "exited")
    } == {name: expected[name] for name in ("entered", "exited")}
    space.update()
    space.remove(space.ids)
    space.update()
    space.add(np.zeros((400, 2)), categories=16)
    for some in (events.between(2, 4), again):
        assert {name: getattr(some, name).tolist() for name in NAMES} == expected


def test_stayed_between_categories_has_to_be_read_in_time() -> None:
    space, events, _ = random_events(2)
    part = events.between(2, 4)
    space.update()
    with pytest.raises(RuntimeError, match="read it before the next update"):
        _ = part.stayed
    assert part.entered.shape[1] == 2


def test_shapes_without_categories_have_the_default_one() -> None:
    space = jostle.Space()
    space.add([(0, 0), (1, 0)], radii=1.0)
    events = space.update()
    assert events.between(1, 1).entered.tolist() == [[0, 1]]
    assert events.between(1, ~1).entered.tolist() == events.between(2, 1).entered.tolist() == []
    contacts = space.contacts()
    assert contacts.categories.tolist() == [[1, 1]] and len(contacts.between(1, 3).pairs) == 1
    assert len(contacts.between(~0, ~1).pairs) == 0


@pytest.mark.parametrize("kind", ["contacts", "update"])
def test_categories_are_sets_of_bits(kind: str) -> None:
    space = jostle.Space()
    space.add([(0, 0), (1, 0)], radii=1.0)
    whole = getattr(space, kind)()
    for wrong in (1.5, "a", None, True, [1]):
        with pytest.raises((TypeError, ValueError), match=r"^b\b"):
            whole.between(1, wrong)
    for wrong in (1 << 32, -(1 << 32) - 1):
        with pytest.raises(ValueError, match=r"^a is -?\d+; it must be a set of 32"):
            whole.between(wrong, 1)
