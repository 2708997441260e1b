"""Segments and capsules as shapes: pairs, contacts, queries, events, slides."""

import copy
import itertools
import pickle
from fractions import Fraction

import exact_shapes as exact
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import jostle

NUMBERS = st.integers(-6, 6)
POINTS = st.tuples(NUMBERS, NUMBERS)
RADII = st.sampled_from([0.0, 0.0, 0.5, 1.0, 2.5])
SEGMENTS = st.tuples(POINTS, POINTS)
MANY = st.lists(SEGMENTS, min_size=1, max_size=12)
DTYPES = st.sampled_from(["float32", "float64"])


@st.composite
def mixed_shapes(draw: st.DrawFn, most: int = 12) -> list[tuple[str, tuple, float]]:
    """Segments, circles and boxes, each with a radius."""
    sides = st.tuples(POINTS, st.integers(0, 4), st.integers(0, 4)).map(
        lambda given: (*given[0], given[0][0] + given[1], given[0][1] + given[2])
    )
    kinds = st.one_of(
        st.tuples(st.just("segments"), SEGMENTS, RADII),
        st.tuples(st.just("segments"), SEGMENTS, RADII),
        st.tuples(st.just("positions"), POINTS, RADII),
        st.tuples(st.just("boxes"), sides, RADII),
    )
    return draw(st.lists(kinds, min_size=1, max_size=most))


def space_of(shapes, **options) -> tuple[jostle.Space, list[int]]:
    space = jostle.Space(**options)
    return space, [space.add(**{kind: where}, radii=radius) for kind, where, radius in shapes]


def exact_of(shapes) -> list[exact.Exact]:
    def of(kind: str, where, radius: float) -> exact.Exact:
        if kind == "boxes":
            return exact.box(where, radius)
        return exact.shape([where] if kind == "positions" else where, radius)

    return [of(*one) for one in shapes]


def sorted_pairs(found) -> list[list[int]]:
    return sorted(sorted(pair) for pair in found.tolist())


@given(dtype=DTYPES, segments=MANY, radii=st.lists(RADII, min_size=12, max_size=12))
def test_pairs_of_segments_are_exact(dtype, segments, radii) -> None:
    rows, radii = np.array(segments, dtype), np.array(radii[: len(segments)], dtype)
    expected = exact.pairs([exact.shape(*one) for one in zip(rows, radii, strict=True)])
    for method in ("auto", "brute", "quadtree"):
        found = jostle.find_pairs(segments=rows, radii=radii, method=method, sort=True)
        assert found.tolist() == expected
    tree = jostle.Quadtree(segments=rows, radii=radii, leaf_capacity=4)
    assert tree.pairs(sort=True).tolist() == expected


@given(
    dtype=DTYPES, shapes=mixed_shapes(), period=st.sampled_from([None, (14, 14), (0, 13), (15, 0)])
)
def test_pairs_with_circles_and_boxes_are_exact(dtype, shapes, period) -> None:
    space, _ = space_of(shapes, dtype=dtype, period=period)
    expected = exact.pairs(exact_of(shapes), period or (0, 0))
    assert sorted_pairs(space.pairs()) == expected
    assert sorted_pairs(space.update().entered) == expected
    assert sorted_pairs(space.contacts().pairs) == expected


@pytest.mark.parametrize(
    ("a", "b", "overlaps"),
    [
        ([(0, 0), (4, 4)], [(0, 4), (4, 0)], True),
        ([(0, 0), (4, 4)], [(2, 2), (4, 0)], False),  # a T
        ([(0, 0), (4, 4)], [(4, 4), (9, 0)], False),  # a joint
        ([(0, 0), (4, 4)], [(1, 1), (3, 3)], False),  # on one line
        ([(0, 0), (4, 0)], [(1, 0), (9, 0)], False),
        ([(0, 0), (4, 0)], [(2, -1), (2, 1)], True),
        ([(0, 0), (4, 0)], [(2, -1), (2, 0)], False),
        ([(0, 0), (4, 4)], [(2, 2), (2, 2)], False),  # no length
        ([(0, 0), (4, 4)], [(0, 1), (4, 5)], False),  # parallel
    ],
)
def test_segments_that_only_touch_do_not_overlap(a, b, overlaps) -> None:
    for start, end in itertools.product((a, a[::-1]), (b, b[::-1])):
        for order in ([start, end], [end, start]):
            assert len(jostle.find_pairs(segments=order)) == overlaps
            # Any radius makes what touches an overlap.
            at_least = overlaps or exact.touch(exact.shape(a), exact.shape(b))
            assert len(jostle.find_pairs(segments=order, radii=0.25)) == at_least


@given(st.integers(0, 2**32), st.sampled_from(["float32", "float64"]))
def test_many_segments_by_every_method(seed: int, dtype: str) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(100, 700))
    starts = rng.uniform(-50, 50, (count, 2))
    segments = np.stack([starts, starts + rng.normal(0, 4, (count, 2))], 1).astype(dtype)
    radii = rng.choice([0, 0, 0.3, 1.0], count).astype(dtype)
    expected = jostle.find_pairs(segments=segments, radii=radii, method="brute", sort=True)
    found = jostle.find_pairs(segments=segments, radii=radii, sort=True)
    np.testing.assert_array_equal(found, expected)
    turned = jostle.find_pairs(segments=segments[:, ::-1], radii=radii, sort=True)
    np.testing.assert_array_equal(turned, expected)
    order = rng.permutation(count)
    other = order[jostle.find_pairs(segments=segments[order], radii=radii[order])]
    assert sorted_pairs(other) == expected.tolist()
    distance = 0.75
    near = jostle.find_pairs(segments=segments, radii=radii, distance=distance, sort=True)
    grown = jostle.find_pairs(segments=segments, radii=radii + dtype_of(distance / 2, dtype))
    assert len(near) >= len(expected) and sorted_pairs(grown) == near.tolist()


def dtype_of(value: float, dtype: str):
    return np.dtype(dtype).type(value)


@given(shapes=mixed_shapes())
def test_contacts_push_apart(shapes) -> None:
    space, ids = space_of(shapes)
    contacts, rounded = space.contacts(), [one.rounded() for one in exact_of(shapes)]
    columns = contacts.pairs, contacts.normals, contacts.depths, contacts.points
    for pair, normal, depth, points in zip(*columns, strict=True):
        a, b = (rounded[ids.index(id)] for id in pair)
        assert np.hypot(*normal) == pytest.approx(1) and depth > 0
        moved = b.moved(normal * depth)
        assert exact.distance(a, moved) == pytest.approx(a.radius + b.radius, abs=1e-9)
        assert exact.overlap(a, b.moved(normal * depth * 0.99))
        # In the middle of the overlap.
        for point in points[~np.isnan(points[:, 0])]:
            for one in (a, b):
                away = exact.distance(one, exact.shape([point]).rounded())
                assert away <= abs(one.radius - depth / 2) + 1e-9


@given(
    dtype=DTYPES,
    shapes=mixed_shapes(),
    point=POINTS,
    size=st.tuples(st.integers(1, 5), st.integers(1, 5)),
    radius=st.sampled_from([0.5, 1.0, 3.0]),
)
def test_region_queries_are_exact(dtype, shapes, point, size, radius) -> None:
    space, ids = space_of(shapes, dtype=dtype)
    every = exact_of(shapes)
    x, y = point
    rect = (x, y, x + size[0], y + size[1])
    corners = [(x, y), (x + size[0], y), (x + 1, y + size[1] + 1)]
    for asked in (space, copy.copy(space)):
        asked.pairs()  # a tree of all
        rows = asked.rows(asked.query_rect(rect)).tolist()
        assert rows == [k for k, one in enumerate(every) if exact.overlap(one, exact.box(rect))]
        disc = exact.shape([point], radius)
        rows = asked.rows(asked.query_circle(point, radius)).tolist()
        assert rows == [k for k, one in enumerate(every) if exact.overlap(one, disc)]
        rows = set(asked.rows(asked.query_polygon(corners)).tolist())
        triangle = exact.shape(corners)
        for k, one in enumerate(every):
            # A rounding decides whether what is round touches a slanted side or overlaps it.
            if one.radius == 0 or exact.overlap(one, triangle) == exact.touch(one, triangle):
                assert (k in rows) == exact.overlap(one, triangle)
        rows = set(asked.rows(asked.query_point(point)).tolist())
        for k, (kind, _, own) in enumerate(shapes):
            if kind != "boxes" or own > 0:  # those have a rule for their edges
                assert (k in rows) == exact.touch(every[k], exact.shape([point]))
    assert len(ids) == len(every)


@given(shapes=mixed_shapes(), point=POINTS)
def test_the_nearest_shapes(shapes, point) -> None:
    space, ids = space_of(shapes)
    found = space.nearest(point, k=len(ids))
    here = exact.shape([point])
    expected = [max(exact.distance(one, here) - float(one.radius), 0) for one in exact_of(shapes)]
    assert found.distances == pytest.approx(np.sort(expected), abs=1e-12)
    rows = space.rows(found.ids)
    assert np.array(expected)[rows] == pytest.approx(found.distances, abs=1e-12)


MOVERS = {
    "ray": ({}, lambda at: exact.shape([at])),
    "disc": ({"radii": 0.75}, lambda at: exact.shape([at], 0.75)),
    "box": (
        {"half_sizes": (0.5, 1.0)},
        lambda at: exact.box((at[0] - 0.5, at[1] - 1.0, at[0] + 0.5, at[1] + 1.0)),
    ),
}


@pytest.mark.parametrize("mover", MOVERS)
@given(shapes=mixed_shapes(4), origin=POINTS, direction=POINTS.filter(any))
def test_casts_find_the_first_contact(mover, shapes, origin, direction) -> None:
    """The distance of two convex shapes is a convex function of the way."""
    keywords, at = MOVERS[mover]
    space, ids = space_of(shapes)
    unit = np.array(direction) / np.hypot(*direction)
    cast = space.shape_cast if keywords else space.raycast
    for id, one in zip(ids, [one.rounded() for one in exact_of(shapes)], strict=True):
        others = [other for other in ids if other != id]
        alone = copy.copy(space)
        alone.remove(others)
        hit = (
            alone.shape_cast(origin, direction, **keywords)
            if keywords
            else alone.raycast(origin, direction)
        )

        def gap(way: float, one=one) -> float:
            here = at(origin).rounded().moved(unit * way)
            return exact.distance(one, here) - (one.radius + here.radius)

        _, least = exact.lowest(gap, 0.0, 40.0)
        if hit.id < 0:
            # What has no width is not entered.
            assert least > -1e-9
            continue
        assert hit.id == id and gap(hit.distance) <= 1e-9
        if hit.distance > 0:
            assert gap(hit.distance) == pytest.approx(0, abs=1e-9)
            assert gap(hit.distance / 2) >= -1e-9 and np.hypot(*hit.normal) == pytest.approx(1)
            assert hit.normal @ unit < 1e-12
            at_point = exact.shape([hit.point]).rounded()
            assert exact.distance(one, at_point) == pytest.approx(one.radius, abs=1e-9)
    first = cast(origin, direction, **keywords)
    alone = [space.get(id) for id in ids]
    assert len(alone) == len(ids) and (first.id < 0 or first.id in ids)


@given(st.integers(0, 2**32))
def test_queries_of_a_periodic_plane(seed: int) -> None:
    """Those of all images in an open plane."""
    rng, sides = np.random.default_rng(seed), np.array((20, 15))
    starts = rng.uniform(-30, 30, (12, 2)).round(1)
    ends = np.stack([starts, starts + rng.uniform(-9, 9, (12, 2)).round(1)], 1)
    radii = rng.choice([0, 0.5], 12)
    ring = jostle.Quadtree(segments=ends, radii=radii, period=tuple(sides))
    turns = np.array(list(itertools.product(range(-3, 4), range(-3, 4))))
    images = (ring.segments[:, None] + (turns * sides)[None, :, None]).reshape(-1, 2, 2)
    plane = jostle.Quadtree(segments=images, radii=np.repeat(radii, len(turns)))

    def rows(found) -> list[int]:
        return sorted({int(id) // len(turns) for id in found})

    for _ in range(5):
        point, radius = rng.uniform(0, 15, 2), rng.uniform(0.5, 3)
        assert ring.query_circle(point, radius).tolist() == rows(plane.query_circle(point, radius))
        assert ring.query_point(point).tolist() == rows(plane.query_point(point))
        rect = (*point, *(point + rng.uniform(1, 5, 2)))
        assert ring.query_rect(rect).tolist() == rows(plane.query_rect(rect))
        assert ring.nearest(point).distances == pytest.approx(plane.nearest(point).distances)
        way = rng.normal(0, 1, 2)
        for mover in ({}, {"radii": 0.4}, {"half_sizes": (0.3, 0.6)}):
            hits = [tree.shape_cast(point, way, max_distance=14, **mover) for tree in (ring, plane)]
            assert hits[0].distance == pytest.approx(hits[1].distance)
            assert hits[0].normal == pytest.approx(hits[1].normal, abs=1e-9)


@pytest.mark.parametrize("ends", [[(0, 0), (8, 6)], [(8, 6), (0, 0)], [(0, 6), (8, 0)]])
def test_a_ray_meets_a_slope_from_both_sides(ends) -> None:
    tree = jostle.Quadtree(segments=[ends])
    for origin, direction in (((4, -5), (0, 1)), ((4, 11), (0, -1))):
        hit = tree.raycast(origin, direction)
        assert hit.distance == pytest.approx(8) and hit.point == pytest.approx([4, 3])
        assert hit.normal[1] == pytest.approx(-0.8 * direction[1])
    assert tree.raycast((4, -5), (0, 1), max_distance=7.9).id == -1
    assert tree.shape_cast((4, -5), (0, 1), radii=1.0).distance == pytest.approx(8 - 1.25)


@pytest.mark.parametrize("x", [2.0, 0.1, 7.3])
def test_the_normal_of_an_upright_segment_faces_the_ray(x: float) -> None:
    tree = jostle.Quadtree(segments=[[(x, -6), (x, 5)]])
    for side, slope in itertools.product((-1, 1), np.linspace(-3, 3, 31)):
        hit = tree.raycast((x + side, -slope), (-side, slope))
        assert hit.normal.tolist() == [side, 0]


def test_columns_of_a_quadtree() -> None:
    ends = [[(0, 0), (1, 2)], [(5, 4), (3, 1)]]
    tree = jostle.Quadtree(segments=ends, radii=[0.0, 0.5])
    np.testing.assert_array_equal(tree.segments, ends)
    np.testing.assert_array_equal(tree.boxes, [(0, 0, 1, 2), (3, 1, 5, 4)])
    np.testing.assert_array_equal(tree.positions, [(0.5, 1), (4, 2.5)])
    again = pickle.loads(pickle.dumps(tree))
    np.testing.assert_array_equal(again.segments, ends)
    assert np.isnan(jostle.Quadtree([(0, 0)], 1.0).segments).all()
    wide = jostle.Quadtree(segments=[[(9, 0), (13, 2)]], period=(10, 0))
    np.testing.assert_array_equal(wide.segments, [[(-1, 0), (3, 2)]])


def test_columns_of_a_space() -> None:
    space = jostle.Space()
    ball, slope = space.add((0, 0), 1.0), space.add(segments=[(0, 0), (4, 2)], radii=0.5)
    assert np.isnan(space.segments[0]).all() and np.isnan(space.get(ball).segments).all()
    assert space.get(slope).segments.tolist() == [[0, 0], [4, 2]]
    assert space.get([slope, ball]).segments.shape == (2, 2, 2)
    assert space.positions.tolist() == [[0, 0], [2, 1]]
    assert space.half_sizes.tolist() == [[0, 0], [2, 1]]
    assert space.bounds().tolist() == [[-1, -1, 1, 1], [-0.5, -0.5, 4.5, 2.5]]
    assert space.boxes[1].tolist() == [0, 0, 4, 2]
    space.set(slope, positions=(12, 1))
    assert space.get(slope).segments.tolist() == [[10, 0], [14, 2]]
    space.positions = space.positions + np.array((0, 3))
    assert space.segments[1].tolist() == [[10, 3], [14, 5]]
    space.set(slope, segments=[(3, 4), (1, 0)])
    assert space.segments[1].tolist() == [[3, 4], [1, 0]]
    space.set([ball, slope], segments=[[(0, 0), (1, 1)], [(1, 1), (0, 0)]])
    assert space.segments.tolist() == [[[0, 0], [1, 1]], [[1, 1], [0, 0]]]
    # A half size makes a box of it, as does a box.
    space.set(ball, half_sizes=(2, 1))
    assert np.isnan(space.get(ball).segments).all() and space.get(ball).radii == 1
    space.set(slope, boxes=(0, 0, 1, 5))
    assert np.isnan(space.segments).all()


def test_what_is_read_can_be_assigned() -> None:
    space = jostle.Space()
    space.add([(0, 0), (9, 9)], 1.0)
    space.add(segments=[[(0.1, 0.2), (4.3, -2.7)], [(7.7, 1.1), (0.3, 1.1)]], radii=[0, 0.5])
    space.add(boxes=(0.1, 0.2, 0.3, 0.4))
    space.update()
    before = pickle.dumps(space)
    for name in ("positions", "radii", "half_sizes", "boxes", "segments", "categories", "masks"):
        setattr(space, name, getattr(space, name))
        assert len(space.update().exited) == 0
    assert pickle.loads(before).segments.tolist()[2:4] == space.segments.tolist()[2:4]
    np.testing.assert_array_equal(pickle.loads(before).boxes, space.boxes)


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda s: pickle.loads(pickle.dumps(s))])
def test_copies_keep_segments(way) -> None:
    space = jostle.Space(dtype="float32")
    space.add([(0, 0)], 1.0)
    ids = space.add(segments=[[(0, 0), (4, 2)], [(4, 2), (0, 2)], [(1, 5), (1, 5)]])
    space.update()
    space.remove(ids[1])
    twin = way(space)
    np.testing.assert_array_equal(twin.segments, space.segments)
    np.testing.assert_array_equal(twin.ids, space.ids)
    assert twin.update().exited.tolist() == space.update().exited.tolist()
    assert twin.add(segments=[(0, 0), (1, 1)]) == space.add(segments=[(0, 0), (1, 1)])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ([[(0, 0), (1, np.nan)]], r"segments\[0\] is \(\(0, 0\), \(1, NaN\)\)"),
        ([[(0, 0), (1, 1)], [(-1.7e308, 0), (1.7e308, 1)]], r"segments\[1\] is .* apart"),
        ([(0, 0, 1, 1)], r"segments has shape \(1, 4\)"),
        ([[(0, 0)]], r"segments has shape \(1, 1, 2\)"),
    ],
)
def test_bad_segments_change_nothing(wrong, message) -> None:
    space = jostle.Space()
    id = space.add(segments=[(0, 0), (1, 1)])
    for call in (
        lambda: space.add(segments=wrong),
        lambda: jostle.find_pairs(segments=wrong),
        lambda: jostle.Quadtree(segments=wrong),
        lambda: space.set([id] * len(wrong), segments=wrong),
    ):
        with pytest.raises(ValueError, match=message):
            call()
    assert space.segments.tolist() == [[[0, 0], [1, 1]]]
    space.set(id, segments=[(0, 0), (4e307, 0)])
    with pytest.raises(ValueError, match=r"positions is .*ends of its segment must be finite"):
        space.set(id, positions=(1.797e308, 0))


def test_a_wrong_row_of_a_column_is_named() -> None:
    space = jostle.Space()
    space.add((0, 0), 1.0)
    space.add(segments=[(0, 0), (1, 1)])
    none = np.full((2, 2), np.nan)
    for ends, message in (
        ([none, none], r"segments\[1\] is .*both ends must be finite"),
        ([none, [(0, 0), (np.inf, 0)]], r"segments\[1\] is .*both ends must be finite"),
        ([[(0, 0), (np.nan, 1)], none], r"segments\[0\] is .*both ends must be finite"),
        ([none], r"segments has shape \(1, 2, 2\)"),
    ):
        with pytest.raises(ValueError, match=message):
            space.segments = ends
    assert space.segments[1].tolist() == [[0, 0], [1, 1]]


def test_arguments_that_exclude_each_other() -> None:
    for other in ({"boxes": (0, 0, 1, 1)}, {"positions": (0, 0)}, {"half_sizes": (1, 1)}):
        with pytest.raises(TypeError, match="both given"):
            jostle.Space().add(segments=[(0, 0), (1, 1)], **other)
    with pytest.raises(TypeError, match="positions, boxes or segments must be given"):
        jostle.find_pairs()
    with pytest.raises(ValueError, match=r"segments is .*at most one period apart"):
        jostle.Space(period=(5, 0)).add(segments=[(0, 0), (5.5, 1)])
    with pytest.raises(ValueError, match=r"segments\[1\] is .*at most one period apart"):
        jostle.find_pairs(segments=[[(0, 0), (4, 9)], [(0, 0), (5.5, 1)]], period=(5, 0))


@given(shapes=mixed_shapes(8), data=st.data())
def test_events_of_a_space(shapes, data) -> None:
    space, ids = space_of(shapes)
    known, before = dict(zip(ids, shapes, strict=True)), set()
    for _ in range(5):
        for id in list(known):
            action = data.draw(st.sampled_from(["stay", "stay", "set", "move", "remove", "add"]))
            if action == "remove":
                space.remove(id)
                del known[id]
            elif action == "set":
                ends = data.draw(SEGMENTS)
                space.set(id, segments=ends)
                known[id] = ("segments", ends, known[id][2])
            elif action == "move" and known[id][0] == "segments":
                by, ends = data.draw(POINTS), known[id][1]
                space.set(id, positions=space.get(id).positions + by)
                moved = tuple((x + by[0], y + by[1]) for x, y in ends)
                known[id] = ("segments", moved, known[id][2])
            elif action == "add":
                ends = data.draw(SEGMENTS)
                known[space.add(segments=ends)] = ("segments", ends, 0.0)
        rows, events = list(known), space.update()
        now = {tuple(sorted((rows[i], rows[j]))) for i, j in exact.pairs(exact_of(known.values()))}
        found = {name: set(map(tuple, getattr(events, name).tolist())) for name in EVENTS}
        assert found == {"entered": now - before, "stayed": now & before, "exited": before - now}
        before = now


EVENTS = ("entered", "stayed", "exited")


@given(
    shapes=mixed_shapes(2).filter(lambda shapes: len(shapes) == 2),
    ways=st.tuples(POINTS, POINTS),
)
def test_pairs_that_meet_on_the_way(shapes, ways) -> None:
    space, ids = space_of(shapes)
    space.update()
    starts = exact_of(shapes)
    for id, by in zip(ids, ways, strict=True):
        space.set(id, positions=space.get(id).positions + by)
    entered = len(space.update(swept=True).entered) > 0
    reach = float(sum(one.radius for one in starts))

    def gap(time: float) -> float:
        both = zip(starts, ways, strict=True)
        return (
            exact.distance(*(one.rounded().moved(np.array(by) * time) for one, by in both)) - reach
        )

    ends = [one.moved([Fraction(v) for v in by]) for one, by in zip(starts, ways, strict=True)]
    if exact.overlap(*starts) or exact.overlap(*ends):
        assert entered == (exact.overlap(*ends) and not exact.overlap(*starts))
        return
    _, least = exact.lowest(gap)
    if reach > 0 and abs(least) > 1e-9:
        assert entered == (least < 0)
    elif reach == 0:
        assert entered == is_met_inside(starts, ways)


def is_met_inside(starts, ways) -> bool:
    """Whether the interiors meet: at a time between those at which a corner meets a side."""
    by = [Fraction(b - a) for a, b in zip(*ways, strict=True)]
    times = {Fraction(0), Fraction(1)}
    for p, q in itertools.product(starts[0].core, starts[1].core):
        for side in (*exact.edges(starts[0]), *exact.edges(starts[1])):
            along = (side[1][0] - side[0][0], side[1][1] - side[0][1])
            speed = exact.cross(along, by)
            if speed:
                times.add(-exact.cross(along, (q[0] - p[0], q[1] - p[1])) / speed)
    ordered = sorted(time for time in times if 0 <= time <= 1)
    middles = [(a + b) / 2 for a, b in itertools.pairwise(ordered)]
    return any(exact.is_interior(starts[0], starts[1].moved([v * t for v in by])) for t in middles)


def test_a_bullet_passes_a_slanted_fence() -> None:
    space = jostle.Space()
    space.add(segments=[(0, 0), (8, 6)])
    bullet = space.add((4, -90), 0.01)
    space.update()
    space.set(bullet, positions=(4, 90))
    assert len(space.update(swept=True).entered) == 1
    space.set(bullet, positions=(90, 90))
    assert len(space.update(swept=True).entered) == 0


def test_filters_and_masks() -> None:
    space = jostle.Space()
    space.add(segments=[(0, 0), (4, 4)], categories=2, masks=1)
    other = space.add(segments=[(0, 4), (4, 0)], categories=2)
    assert len(space.pairs()) == 0
    space.set(other, categories=1)
    assert len(space.pairs()) == 1
    assert space.query_point((1, 1), mask=1).tolist() == []
    assert space.raycast((1, -9), (0, 1), mask=1).distance == pytest.approx(12)


# The slide.


@pytest.mark.parametrize("ends", [[(-10, 0), (10, 0)], [(10, 0), (-10, 0)], [(-10, 5), (10, -5)]])
def test_a_one_way_segment_stops_only_what_is_above_its_line(ends) -> None:
    space = jostle.Space()
    ledge = space.add(segments=ends, categories=4)
    hero = space.add((0, 8), half_sizes=(1, 2))
    slide = space.move_and_slide(hero, (0, -16), one_way=4)
    assert slide.displacement.tolist() == [0, -16] and len(slide.hits) == 0  # through it
    slide = space.move_and_slide(hero, (0, 16), one_way=4)
    assert slide.on_floor and slide.floor == ledge and slide.hits.tolist() == [ledge]
    # Without the rule it is solid from both sides.
    space.set(hero, positions=(0, 8))
    assert space.move_and_slide(hero, (0, -16)).on_ceiling


def test_a_one_way_segment_along_up_stops_nothing() -> None:
    space = jostle.Space()
    space.add(segments=[(0, -9), (0, 9)], categories=4)
    hero = space.add((-5, 0), half_sizes=(1, 2))
    assert space.move_and_slide(hero, (10, 0), one_way=4).displacement[0] == 10
    assert space.move_and_slide(hero, (-10, 0)).on_wall


def test_the_masks_of_a_slide() -> None:
    space = jostle.Space()
    ghost = space.add(segments=[(0, -9), (0, 9)], categories=2)
    solid = space.add(segments=[(5, -9), (5, 9)], categories=1)
    hero = space.add((-5, 0), half_sizes=(1, 2))
    slide = space.move_and_slide(hero, (20, 0), mask=1)
    assert slide.hits.tolist() == [solid] and slide.displacement[0] == pytest.approx(9)
    slide = space.move_and_slide(hero, (-20, 0))
    assert slide.hits.tolist() == [ghost] and slide.displacement[0] == pytest.approx(-3)


def test_a_chain_is_smooth() -> None:
    """A walker meets no joint as a wall, whatever the order and the directions of the parts."""
    rng = np.random.default_rng(3)
    x = np.linspace(0, 100, 101)
    chain = jostle.polyline(np.stack([x, 2 * np.sin(x / 5)], 1))
    for order in (slice(None), rng.permutation(len(chain))):
        parts = chain[order].copy()
        parts[::3] = parts[::3, ::-1]
        space = jostle.Space()
        space.add(segments=parts)
        box = space.add((3, -3), half_sizes=(0.3, 0.5), categories=2, masks=1)
        disc = space.add((3, -3), 0.5, categories=2, masks=1)
        for _ in range(200):
            slides = space.move_and_slide([box, disc], [(0.3, 0.3)] * 2, floor_angle=1.0)
            assert not slides.on_wall.any()
        assert (space.get([box, disc]).positions[:, 0] > 40).all()


@pytest.mark.parametrize("radius", [0.0, 1.0])
def test_a_lift_of_a_segment_carries(radius: float) -> None:
    space = jostle.Space()
    lift = space.add(segments=[(-5, 1), (5, -1)], radii=radius)
    hero = space.add((0, -6), half_sizes=(1, 2))
    space.move_and_slide(hero, (0, 9))
    before = space.get(hero).positions
    space.set(lift, positions=space.get(lift).positions + np.array((3, -2)))
    slide = space.move_and_slide(hero, (0, 0.1))
    assert slide.displacement == pytest.approx([3, -2]) and slide.floor == lift
    space.set(lift, segments=space.get(lift).segments + 1)
    slide = space.move_and_slide(hero, (0, 0.1))
    assert slide.platform_velocity == pytest.approx([1, 1]) and slide.floor == lift
    assert space.get(hero).positions == pytest.approx(before + np.array((4, -1)), abs=1e-9)


def test_segments_do_not_slide() -> None:
    space = jostle.Space()
    ids = [space.add((0, 0), 1.0), space.add(segments=[(0, 5), (5, 5)])]
    with pytest.raises(ValueError, match=r"ids\[1\] is .*segment"):
        space.move_and_slide(ids, [(1, 0), (1, 0)])
    assert space.positions[0].tolist() == [0, 0]


@given(st.integers(0, 2**32), st.sampled_from(["float32", "float64"]))
def test_a_slide_ends_in_nothing(seed: int, dtype: str) -> None:
    """By the formula of the pairs, whatever the shapes are."""
    rng = np.random.default_rng(seed)
    space = jostle.Space(dtype=dtype, period=(60, 0) if seed % 3 == 0 else None)
    starts = rng.uniform(-30, 30, (30, 2)).round(int(rng.integers(0, 3)))
    ends = starts + rng.normal(0, 6, (30, 2)).round(int(rng.integers(0, 3)))
    space.add(segments=np.stack([starts, ends], 1), radii=rng.choice([0, 0, 0.5], 30))
    shapes = [({"radii": 0.7}), ({"half_sizes": (0.5, 1.0)}), ({"radii": 0.3, "half_sizes": 0.4})]
    hero = space.add(rng.uniform(-20, 20, 2), **shapes[seed % 3])
    while (space.pairs() == hero).any():
        space.set(hero, positions=rng.uniform(-20, 20, 2))
    for _ in range(60):
        space.move_and_slide(hero, rng.normal(0, 3, 2), snap=float(rng.choice([0, 2])))
        assert not (space.pairs() == hero).any()
