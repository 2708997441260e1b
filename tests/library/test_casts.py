"""Normals, all hits of a ray, casts of boxes, a distance for each query, contacts of two trees."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from results import fields

import jostle


@st.composite
def scenes(draw: st.DrawFn) -> tuple[jostle.Quadtree, jostle.Space, np.random.Generator]:
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(0, 60))
    centers = rng.uniform(-10, 10, (n, 2))
    if draw(st.booleans()):
        centers = centers.round()
    radii = rng.uniform(0, 1, n) * draw(st.sampled_from([0, 1]))
    halves = rng.uniform(0, 2, (n, 2)) * draw(st.sampled_from([0, 1]))
    space = jostle.Space()
    space.add(centers, radii, halves)
    return jostle.Quadtree(centers, radii, halves), space, rng


def some_of(tree: jostle.Quadtree, rows: Any) -> jostle.Quadtree:
    return jostle.Quadtree(tree.positions[rows], tree.radii[rows], tree.half_sizes[rows])


@given(scenes())
def test_all_hits_are_the_first_hits_of_each_shape(scene: Any) -> None:
    tree, space, rng = scene
    origins, directions = rng.uniform(-12, 12, (5, 2)), rng.normal(0, 1, (5, 2))
    lengths = rng.uniform(0, 30, 5)
    all_hits = tree.raycast_all(origins, directions, max_distance=lengths)
    ids, distances, points, normals, walls, offsets = fields(all_hits)
    assert (walls == -1).all()
    for row in range(5):
        expected = []
        for shape in range(len(tree)):
            alone = some_of(tree, [shape])
            hit = alone.raycast(origins[row], directions[row], max_distance=lengths[row])
            if hit.id == 0:
                expected.append((hit.distance, shape, hit.normal))
        expected.sort()
        part = slice(offsets[row], offsets[row + 1])
        assert ids[part].tolist() == [shape for _, shape, _ in expected]
        assert distances[part].tolist() == [distance for distance, _, _ in expected]
        assert normals[part].tolist() == [list(normal) for _, _, normal in expected]
        one = tree.raycast_all(origins[row], directions[row], max_distance=lengths[row])
        parts = (column[part] for column in (ids, distances, points, normals, walls))
        assert one == all_hits[row] == jostle.RayHits(*parts)
    assert space.raycast_all(origins, directions, max_distance=lengths) == all_hits
    assert all_hits.counts.sum() == len(all_hits.queries) == len(ids)


@given(scenes())
def test_a_box_stops_where_it_touches(scene: Any) -> None:
    tree, space, rng = scene
    origins, directions = rng.uniform(-12, 12, (5, 2)), rng.normal(0, 1, (5, 2))
    sizes = rng.uniform(0.1, 2, (5, 2))
    options = {"half_sizes": sizes, "radii": 0.25, "max_distance": 20.0}
    hits = tree.shape_cast(origins, directions, **options)
    assert space.shape_cast(origins, directions, **options) == hits
    units = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    for row in range(5):
        travelled = min(hits.distances[row], 20.0)
        for share, touched in ((0.999, False), (1.0, hits.ids[row] >= 0)):
            center = origins[row] + units[row] * travelled * share
            box = jostle.Quadtree([center], 0.25 + 1e-6 * touched, [sizes[row]])
            found = tree.pairs(box, distance=1e-6 * touched)
            if touched:
                assert hits.ids[row] in found[:, 0]
            elif travelled > 0 and share < 1:
                nearer = tree.pairs(jostle.Quadtree([center], 0.25 - 1e-9, [sizes[row] - 1e-9]))
                assert len(nearer) == 0
        if hits.ids[row] >= 0 and travelled > 0:
            assert np.linalg.norm(hits.normals[row]) == pytest.approx(1)
            assert hits.normals[row] @ units[row] < 1e-6


@given(scenes())
def test_points_lie_on_both_surfaces(scene: Any) -> None:
    tree, _, rng = scene
    origins, directions = rng.uniform(-12, 12, (8, 2)), rng.normal(0, 1, (8, 2))
    sizes = rng.uniform(0, 2, (8, 2)) * (rng.random((8, 1)) < 0.5)
    radii = rng.uniform(0, 1, 8) * (rng.random(8) < 0.5)
    hits = tree.shape_cast(origins, directions, half_sizes=sizes, radii=radii)
    units = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    for row in range(8):
        hit, point = hits.ids[row], hits.points[row]
        assert np.isnan(point).all() == (hit < 0)
        if hit < 0 or hits.distances[row] == 0:
            continue
        place = origins[row] + units[row] * hits.distances[row]
        mover = jostle.Quadtree([place], radii[row], [sizes[row]])
        for shape, way in ((mover, -1), (some_of(tree, [hit]), 1)):
            assert shape.nearest(tuple(point)).distances[0] == pytest.approx(0, abs=1e-9)
            if shape.radii[0] > 0.01 or shape.half_sizes.min() > 0.01:
                inside = point - 1e-6 * way * hits.normals[row]
                assert shape.nearest(tuple(inside)).distances[0] < 1e-9
    rays = tree.raycast(origins, directions)
    there = rays.ids >= 0
    ends = (origins + units * rays.distances[:, None])[there]
    assert rays.points[there] == pytest.approx(ends, abs=1e-12)


@given(scenes(), st.integers(1, 4))
def test_exclude_gives_the_answers_without_that_shape(scene: Any, k: int) -> None:
    tree, space, rng = scene
    n, count = len(tree), 6
    points, ways = rng.uniform(-12, 12, (count, 2)), rng.normal(0, 1, (count, 2))
    if n:
        points[:3] = tree.positions[rng.integers(0, n, 3)]
    out = rng.integers(-1, n, count)
    for row in range(count):
        kept = np.flatnonzero(np.arange(n) != out[row])
        fewer, to_kept = some_of(tree, kept), np.append(kept, -1)
        for index in (tree, space):
            options: dict[str, Any] = {"exclude": int(out[row])}
            near, other = index.nearest(points, k, exclude=out), fewer.nearest(points, k)
            assert near.ids[row].tolist() == to_kept[other.ids[row]].tolist()
            assert near.distances[row].tolist() == other.distances[row].tolist()
            one = index.nearest(tuple(points[row]), k, **options)
            assert one.ids.tolist() == near.ids[row].tolist()
            for query, arguments in (
                ("query_point", (tuple(points[row]),)),
                ("query_circle", (tuple(points[row]), 2.0)),
                ("query_rect", ((*(points[row] - 1), *(points[row] + 2)),)),
            ):
                found = getattr(index, query)(*arguments, **options)
                assert found.tolist() == kept[getattr(fewer, query)(*arguments)].tolist()
            hits, others = index.raycast(points, ways, exclude=out), fewer.raycast(points, ways)
            assert hits.ids[row] == to_kept[others.ids[row]]
            assert hits.distances[row] == others.distances[row]
            every = index.raycast_all(points, ways, exclude=out)
            others = fewer.raycast_all(points, ways)
            assert every[row].ids.tolist() == kept[others[row].ids].tolist()
    if n:
        rule = f"it must be one id, or {len(points)}, one for each query"
        with pytest.raises(ValueError, match=f"^exclude has 1 ids; {rule}$"):
            tree.nearest(points, exclude=[0])


def test_the_normal_of_what_is_hit_end_on_faces_the_ray() -> None:
    tree = jostle.Quadtree(segments=[[(5, -2), (5, 2)], [(7, 3), (9, 3)]])
    hits = tree.raycast([(5, -9), (5, 9), (0, 3), (20, 3)], [(0, 1), (0, -1), (1, 0), (-1, 0)])
    assert hits.distances.tolist() == [7, 7, 7, 11]
    assert hits.normals.tolist() == [[0, -1], [0, 1], [-1, 0], [1, 0]]


def test_a_distance_for_each_query() -> None:
    tree = jostle.Quadtree([(0, 0), (10, 0)])
    near = tree.nearest([(1, 0), (1, 0)], max_distance=[0.5, 2.0])
    assert near.ids.tolist() == [[-1], [0]]
    assert near.distances.tolist() == [[np.inf], [1.0]]
    hits = tree.raycast((-1, 0), (1, 0), max_distance=[0.5, 2.0])
    assert hits.ids.tolist() == [-1, 0]
    assert hits.normals.tolist() == [[0, 0], [-1, 0]] or hits.distances.tolist() == [np.inf, 1.0]
    with pytest.raises(ValueError, match=r"max_distance\[1\] is -2; it must be at least 0"):
        tree.nearest([(1, 0), (1, 0)], max_distance=[1, -2])
    for points, reach in (([(1, 0), (1, 0)], [1, 2, 3]), ((1, 0), [1])):
        with pytest.raises(ValueError, match="max_distance has shape"):
            tree.nearest(points, max_distance=reach)


def test_contacts_between_two_trees() -> None:
    rng = np.random.default_rng(2)
    tiles = jostle.Quadtree(boxes=[(x, 0, x + 1, 1) for x in range(20)], categories=2)
    walkers = jostle.Quadtree(rng.uniform(0, (20, 2), (50, 2)), 0.3)
    pairs, normals, depths, *_ = fields(walkers.contacts(tiles, sort=True))
    assert np.array_equal(pairs, walkers.pairs(tiles, sort=True))
    assert (depths > 0).all()
    # Moved by the depth along the normal, a tile only touches.
    boxes = tiles.boxes[pairs[:, 1]] + np.tile(normals * (depths[:, None] + 1e-9), 2)
    for pair, box in zip(pairs, boxes, strict=True):
        walker = some_of(walkers, pair[:1])
        assert len(walker.pairs(jostle.Quadtree(boxes=[box]))) == 0
    assert len(walkers.contacts(tiles, mask=1).pairs) == 0
    with pytest.raises(ValueError, match="max_pairs"):
        walkers.contacts(tiles, max_pairs=1)
    with pytest.raises(TypeError, match="other must be a Quadtree"):
        walkers.contacts([1])  # type: ignore[arg-type]
