"""The queries of a world, compared with brute force over all particles, walls and sides in NumPy.

The core computes in float32, this file in float64. Where a result depends on less than `NEAR`, both
answers are right.
"""

import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracle_queries import to_circle
from results import fields
from worlds import gas

import jostle

Floats = NDArray[np.float64]

NEAR = 3e-4
LONGEST = 25.0
SIDES = [jostle.Side.MIN_X, jostle.Side.MAX_X, jostle.Side.MIN_Y, jostle.Side.MAX_Y]
PLACES: dict[str, dict[str, Any]] = {
    "plane": {},
    "box": {"container": jostle.Box(-9, -8, 10, 7)},
    "circle": {"container": jostle.Circle((1, -1), 11)},
    "period": {"period": (15, 12)},
    "sleepers": {"container": jostle.Box(-9, -8, 10, 7), "gravity": (0, -9.8)},
    "woken sleepers": {"container": jostle.Box(-9, -8, 10, 7), "gravity": (0, -9.8)},
    "periodic sleepers": {"period": (15, 12), "gravity": (0, -9.8)},
}


def random_world(rng: np.random.Generator, place: str) -> jostle.World:
    """Discs and walls of several categories that have moved, some removed, some walls one-way."""
    n, walls = rng.integers(0, 40), rng.uniform(-8, 8, (rng.integers(0, 7), 2, 2))
    sleeps = "sleepers" in place
    if "period" in place:  # a wall crosses each side at most once
        walls[:, 0] = np.abs(walls[:, 0])
        walls[:, 1] = walls[:, 0] + walls[:, 1] / 2
    options: dict[str, Any] = {"on_touch": "ignore", "velocities": rng.normal(0, 2, (n, 2))}
    if sleeps:
        options = {"on_touch": "bounce", "restitution": 0.2}
    if sleeps and "period" not in place:
        walls = walls[:0]
    world = jostle.World(
        beside(n, 10 if "period" in place else 13) if sleeps else rng.uniform(-6, 6, (n, 2)),
        rng.uniform(0.2, 0.5, n),
        categories=rng.integers(1, 8, n),
        masks=rng.integers(1, 8, n),
        walls={
            "segments": walls,
            "velocities": rng.normal(0, 1, (len(walls), 2))
            * (rng.random((len(walls), 1)) < 0.5)
            * (not sleeps),
            "one_way": rng.random(len(walls)) < 0.4,
            "sensors": rng.random(len(walls)) < 0.2,
            "categories": rng.integers(1, 8, len(walls)),
            "masks": 0 if sleeps else rng.integers(0, 8, len(walls)),
        },
        **options,
        **PLACES[place],
    )
    world.remove(np.flatnonzero(rng.random(n) < 0.2))
    world.walls.remove(np.flatnonzero(rng.random(len(walls)) < 0.2))
    if not sleeps:
        world.step(0.05, steps=2)
        return world
    if "period" in place:
        world.walls.add(((0, 4), (15, 4)), categories=7)
    for _ in range(3 if "period" in place else 20):
        if not world.asleep.all():
            world.step(1 / 60, steps=60)
    # Without sides some slide forever. In a box a few may still roll: such worlds are drawn again,
    # and the test fails if they are many.
    assume(world.asleep.all() or "period" in place)
    if place != "sleepers":
        woken = rng.permutation(len(world))[: len(world) // 4]
        world.set(world.ids[woken], velocities=rng.normal(0, 2, 2))
        world.add(rng.uniform(-6, 6, (3, 2)), 0.3, velocities=rng.normal(0, 2, (3, 2)))
        world.step(1 / 60)
    return world


def beside(n: int, columns: int) -> Floats:
    """Places in rows, without overlap, of discs that fall to the floor."""
    return np.stack([np.arange(n) % columns * 1.4 - 8, np.arange(n) // columns * 1.5 - 7], axis=1)


worlds = st.tuples(st.integers(0, 2**32 - 1), st.sampled_from(sorted(PLACES)))


def made(drawn: tuple[int, str]) -> tuple[jostle.World, np.random.Generator]:
    rng = np.random.default_rng(drawn[0])
    return random_world(rng, drawn[1]), rng


def images(world: jostle.World, count: int) -> Floats:
    """The offsets of the images that matter up to `count` periods away."""
    if world.period is None:
        return np.zeros((1, 2))
    steps = np.arange(-count, count + 1)
    return np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) * world.period


def cross(a: Floats, b: Floats) -> Floats:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def from_segment(point: Floats, a: Floats, b: Floats) -> Floats:
    """The distance of a point from segments."""
    along = b - a
    length = np.maximum((along**2).sum(-1), 1e-300)
    share = np.clip(((point - a) * along).sum(-1) / length, 0, 1)
    return np.linalg.norm(point - a - share[..., None] * along, axis=-1)


# Regions and pairs


def agree(ids: NDArray[np.int64], world: jostle.World, gaps: Floats, chosen: Any = True) -> bool:
    """Whether the ids are those of the particles with a gap below 0."""
    is_found = np.isin(world.ids, ids)
    known = np.abs(gaps) > NEAR
    assert np.array_equal(ids, np.sort(ids)) and np.isin(ids, world.ids).all()
    return np.array_equal(is_found[known], ((gaps < 0) & chosen)[known])


def gaps_of(world: jostle.World, distance: Callable[[Floats], Floats]) -> Floats:
    """The distance of a region from the nearest image of each particle, less the radius."""
    places = world.positions[:, None].astype(float) + images(world, 2)
    return distance(places).min(axis=1) - world.radii


@settings(max_examples=60)
@given(worlds, st.sampled_from([None, 1, 6]))
def test_regions(drawn: tuple[int, str], mask: int | None) -> None:
    world, rng = made(drawn)
    chosen = True if mask is None else (world.categories & mask) != 0
    before = world.state_hash()
    for _ in range(4):
        point, radius = rng.uniform(-9, 9, 2), rng.uniform(0, 4)
        gaps = gaps_of(world, lambda at, point=point: np.linalg.norm(at - point, axis=-1))
        assert agree(world.query_point(tuple(point), mask=mask), world, gaps, chosen)
        found = world.query_circle(tuple(point), radius, mask=mask)
        assert agree(found, world, gaps - radius, chosen)
        low, size = point, rng.uniform(0.1, 6, 2)
        gaps = gaps_of(world, lambda at, low=low, size=size: from_rect(at, low, low + size))
        rect = (*low, *(low + size))
        assert agree(world.query_rect(rect, mask=mask), world, gaps, chosen)
        corners = point + rng.uniform(1, 3) * np.array([(1, 0), (0, 1), (-1, 0.2), (0, -1)])
        gaps = gaps_of(world, lambda at, corners=corners: from_polygon(at, corners))
        assert agree(world.query_polygon(corners.tolist(), mask=mask), world, gaps, chosen)
        if len(found):
            less = world.query_circle(tuple(point), radius, mask=mask, exclude=found[0])
            assert less.tolist() == found[1:].tolist()
    assert world.state_hash() == before


def from_rect(at: Floats, low: Floats, high: Floats) -> Floats:
    return np.linalg.norm(np.maximum(np.maximum(low - at, at - high), 0), axis=-1)


def from_polygon(at: Floats, corners: Floats) -> Floats:
    """The distance of points from a convex polygon, counterclockwise; 0 inside."""
    sides = list(zip(corners, np.roll(corners, -1, axis=0), strict=True))
    inside = np.all([cross(np.asarray(b - a), at - a) >= 0 for a, b in sides], axis=0)
    nearest = np.min([from_segment(at, a, b) for a, b in sides], axis=0)
    return np.where(inside, 0, nearest)


@settings(max_examples=60)
@given(worlds, st.sampled_from([None, 1, 6]), st.sampled_from([0.0, 1.5]))
def test_pairs_and_neighbors(drawn: tuple[int, str], mask: int | None, distance: float) -> None:
    world, _ = made(drawn)
    at, ids = world.positions.astype(float), world.ids
    apart = at[:, None] - at - images(world, 2)[:, None, None]
    gaps = np.linalg.norm(apart, axis=-1).min(axis=0)
    gaps = gaps - np.add.outer(world.radii, world.radii) - distance
    meets = (world.categories[:, None] & world.masks) != 0
    meets &= meets.T & ~np.eye(len(at), dtype=bool)
    if mask is not None:
        chosen = (world.categories & mask) != 0
        meets &= chosen[:, None] & chosen
    pairs = world.pairs(distance=distance, mask=mask, sort=True)
    assert pairs.tolist() == sorted(pairs.tolist()) and (pairs[:, 0] < pairs[:, 1]).all()
    found = np.zeros((len(at), len(at)), bool)
    first, second = world.rows(pairs).T
    found[first, second] = found[second, first] = True
    known = np.abs(gaps) > NEAR
    np.testing.assert_array_equal(found[known], ((gaps < 0) & meets)[known])
    lists = world.neighbors(distance, mask=mask)
    assert [row.tolist() for row in lists] == [ids[row].tolist() for row in found]
    if distance == 0:
        contacts = world.contacts(mask=mask, sort=True)
        np.testing.assert_array_equal(contacts.pairs, pairs)
        np.testing.assert_allclose(contacts.depths, -gaps[first, second], atol=NEAR)
        np.testing.assert_array_equal(contacts.categories[:, 0], world.categories[first])
        with_unit = contacts.depths > NEAR
        lengths = np.linalg.norm(contacts.normals, axis=1)
        np.testing.assert_allclose(lengths[with_unit], 1, atol=1e-5)
        if len(pairs):
            with pytest.raises(ValueError, match="max_pairs"):
                world.pairs(max_pairs=0, mask=mask)


@settings(max_examples=60)
@given(worlds, st.sampled_from([None, 1, 6]), st.integers(1, 5))
def test_nearest(drawn: tuple[int, str], mask: int | None, k: int) -> None:
    world, rng = made(drawn)
    points, limit = rng.uniform(-9, 9, (5, 2)), rng.uniform(1, 9)
    near = world.nearest(points, k, max_distance=limit, mask=mask)
    excluded = world.nearest(points, k, max_distance=limit, mask=mask, exclude=near.ids[:, 0])
    assert near.ids.shape == (5, k)
    for point, ids, distances, others in zip(
        points, near.ids, near.distances, excluded.ids, strict=True
    ):
        gaps = gaps_of(world, lambda at, point=point: np.linalg.norm(at - point, axis=-1))
        gaps = np.maximum(gaps, 0)
        if mask is not None:
            gaps[(world.categories & mask) == 0] = np.inf
        expected = np.sort(np.append(gaps, [np.inf] * k))[:k]
        expected[expected > limit] = np.inf
        np.testing.assert_allclose(distances, expected, atol=NEAR)
        there = ids >= 0
        assert np.array_equal(there, np.isfinite(distances))
        np.testing.assert_allclose(gaps[world.rows(ids[there])], distances[there], atol=NEAR)
        assert len(set(ids[there])) == there.sum()
        assert others[: k - 1].tolist() == ids[1:].tolist()


# Rays and moving discs


def entry(origin: Floats, u: Floats, a: Floats, b: Floats, reach: Floats) -> Floats:
    """The distance along a ray into each capsule: the points within `reach` of a segment."""
    along = b - a
    length = np.maximum(np.linalg.norm(along, axis=-1), 1e-300)
    along = along / length[:, None]
    aside = np.stack([-along[:, 1], along[:, 0]], axis=1) * reach[:, None]
    ways = [to_circle(origin - end, u, reach) for end in (a, b)]
    with np.errstate(divide="ignore", invalid="ignore"):
        for start in (a + aside, a - aside):
            far = cross(start - origin, along) / cross(u, along)
            at = cross(start - origin, u) / cross(u, along)
            ways.append(np.where((far >= 0) & (at >= 0) & (at <= length), far, np.inf))
    inside = from_segment(origin, a, b) <= reach
    return np.where(inside, 0, np.fmin.reduce(ways))


class Hits(NamedTuple):
    """Where a ray hits each particle, wall and the container, at the earliest and at the latest."""

    first: Floats
    last: Floats
    names: list[tuple[int, tuple[int, ...]]]


def stops(
    world: jostle.World, moved: Floats, origin: Floats, u: Floats, extents: tuple[Any, float]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether each image (row) of each wall may stop a moving box, and whether it surely does."""
    ends, (half, radius) = world.walls.segments.astype(float), extents
    along = ends[:, 1] - ends[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    across /= np.linalg.norm(along, axis=1, keepdims=True)
    left = ((origin - ends[:, 0] - moved[:, None]) * across).sum(axis=2)
    left = left - (np.abs(across) * half).sum(axis=1) - radius
    both_sides, speed = ~world.walls.one_way, across @ u
    solid = ~world.walls.sensors
    maybe = solid & (both_sides | ((left > -NEAR) & (speed < 1e-5)))
    surely = solid & (both_sides | ((left > NEAR) & (speed < -1e-5)))
    return maybe, surely


def expected_hits(
    world: jostle.World, origin: Floats, u: Floats, radius: float, mask: int | None
) -> Hits:
    """The hits by brute force; a name is an id, and the walls or sides it may be."""
    moved, bits = images(world, 4), np.uint32(0xFFFFFFFF if mask is None else mask)
    kept, walls = world.categories & bits != 0, world.walls.categories & bits != 0
    at, ends = world.positions[kept].astype(float), world.walls.segments[walls].astype(float)
    starts, ends = np.concatenate([at, ends[:, 0]]), np.concatenate([at, ends[:, 1]])
    reach = np.append(world.radii[kept], np.zeros(walls.sum())) + radius
    names: list[Any] = [(int(id_), (-1,)) for id_ in world.ids[kept]]
    names += [(-1, (int(id_),)) for id_ in world.walls.ids[walls]]
    shrink = (ends - starts) * np.minimum(
        NEAR / np.maximum(np.linalg.norm(ends - starts, axis=1, keepdims=True), 1e-9), 0.5
    )
    discs = np.ones((len(moved), len(at)), bool)
    first, last = (
        np.min(
            [
                np.where(solid, entry(origin, u, a + move, b + move, grown), np.inf)
                for move, solid in zip(moved, np.hstack([discs, some[:, walls]]), strict=True)
            ],
            axis=0,
        )
        for a, b, grown, some in zip(
            (starts, starts + shrink),
            (ends, ends - shrink),
            (reach + NEAR, np.maximum(reach - NEAR, 0)),
            stops(world, moved, origin, u, (0.0, radius)),
            strict=True,
        )
    )
    sides = exits(world.container, origin, u, radius) if bits & 1 else []
    if sides:
        earliest = min(side[0] for side in sides)
        names.append((-1, tuple(side[2] for side in sides if side[0] <= earliest + NEAR)))
        first = np.append(first, earliest)
        last = np.append(last, min(side[1] for side in sides))
    return Hits(first, last, names)


def exits(
    container: Any, origin: Floats, u: Floats, radius: float
) -> list[tuple[float, float, int]]:
    """Where a moving disc meets each side of a container, at the earliest and at the latest."""
    if container is None:
        return []
    if isinstance(container, jostle.Circle):

        def leave(bound: float) -> float:
            m = origin - container.center
            if bound <= 0 or m @ m >= bound**2:
                return 0.0
            return float(np.sqrt(bound**2 - cross(m, u) ** 2) - m @ u)

        bound = container.radius - radius
        return [(leave(bound - NEAR), leave(bound + NEAR), jostle.Side.RIM)]
    found = []
    for side, axis, inward in zip(SIDES, (0, 0, 1, 1), (1, -1, 1, -1), strict=True):
        at = container.bounds[axis if inward == 1 else axis + 2]
        gap, speed = inward * (origin[axis] - at) - radius, -inward * u[axis]
        if gap <= NEAR:
            found.append((0.0, 0.0 if gap < -NEAR or speed <= 0 else gap / speed, side))
        elif speed > 0:
            found.append(((gap - NEAR) / speed, (gap + NEAR) / speed, side))
    return found


def the_one(hits: Hits, id_: int, wall: int) -> int:
    """The index of what has an id and a number of a wall."""
    return next(k for k, (i, walls) in enumerate(hits.names) if i == id_ and wall in walls)


@settings(max_examples=50)
@given(worlds, st.sampled_from([None, 1, 6]), st.sampled_from([0.0, 0.3]))
def test_rays_and_moving_discs(drawn: tuple[int, str], mask: int | None, radius: float) -> None:
    world, rng = made(drawn)
    before, count = world.state_hash(), 6
    origins = rng.uniform(-7, 7, (count, 2))
    directions = rng.normal(0, 1, (count, 2))
    lengths = rng.uniform(0, LONGEST, count)
    hits = world.shape_cast(origins, directions, radii=radius, max_distance=lengths, mask=mask)
    if radius == 0:
        assert hits == world.raycast(origins, directions, max_distance=lengths, mask=mask)
    origins = origins.astype(np.float32).astype(float)
    units = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    for row, (origin, u, length) in enumerate(zip(origins, units, lengths, strict=True)):
        expected = expected_hits(world, origin, u, radius, mask)
        id_, distance, point, normal, wall = (column[row] for column in fields(hits))
        if id_ == wall == -1:
            assert distance == np.inf and np.isnan(point).all() and not normal.any()
            assert np.min(expected.last, initial=np.inf) >= length - NEAR
            continue
        at = the_one(expected, id_, wall)
        assert expected.first[at] - NEAR <= distance <= expected.last[at] + NEAR
        assert distance <= min(length, expected.last.min()) + NEAR
        if distance > 0:
            assert np.linalg.norm(normal) == pytest.approx(1, abs=1e-4)
            assert normal @ u < 1e-2
            place = origin + u * distance
            np.testing.assert_allclose(point, place - normal * radius, atol=1e-4)
        else:
            assert not normal.any()
    assert world.state_hash() == before


@settings(max_examples=60)
@given(worlds, st.sampled_from([None, 1, 6]))
def test_all_hits(drawn: tuple[int, str], mask: int | None) -> None:
    world, rng = made(drawn)
    origins, directions = rng.uniform(-7, 7, (5, 2)), rng.normal(0, 1, (5, 2))
    options: dict[str, Any] = {"max_distance": LONGEST, "mask": mask}
    lists = world.raycast_all(origins, directions, **options)
    firsts = world.raycast(origins, directions, **options)
    assert len(lists) == 5
    for row, hits in enumerate(lists):
        u = directions[row] / np.linalg.norm(directions[row])
        origin = origins[row].astype(np.float32).astype(float)
        expected = expected_hits(world, origin, u, 0.0, mask)
        assert (np.diff(hits.distances) >= 0).all()
        found = set()
        for id_, distance, wall in zip(hits.ids, hits.distances, hits.walls, strict=True):
            at = the_one(expected, id_, wall)
            assert expected.first[at] - NEAR <= distance <= expected.last[at] + NEAR
            assert at not in found
            found.add(at)
        assert found >= set(np.flatnonzero(expected.last < LONGEST - NEAR))
        one = world.raycast_all(origins[row], directions[row], **options)
        assert hits == one
        if len(hits.ids):
            columns = zip(fields(firsts), fields(hits), strict=True)
            assert all(np.array_equal(column[row], of[0]) for column, of in columns)


# Moving boxes


def gap_of_boxes(places: Floats, half: Floats, a: Floats, b: Floats) -> Floats:
    """The gap of boxes at some places (rows) and segments (columns); -1 if they overlap."""
    a, b = a - places[:, None], b - places[:, None]
    gap = np.minimum(*(from_rect(end, -half, half) for end in (a, b)))
    corners = [np.array([x, y]) for x in (-half[0], half[0]) for y in (-half[1], half[1])]
    gap = np.min([gap, *(from_segment(corner, a, b) for corner in corners)], axis=0)
    smaller = half - NEAR
    low, high = np.minimum(a, b), np.maximum(a, b)
    meets = ((low < smaller) & (high > -smaller)).all(axis=-1)
    along = b - a
    meets &= np.abs(cross(a, along)) < (np.abs(along[..., ::-1]) * smaller).sum(axis=-1)
    inside = (np.abs(a) < smaller).all(axis=-1)  # a disc is a segment without length
    return np.where(meets | inside, -1, gap)


@settings(max_examples=60)
@given(worlds, st.booleans())
def test_moving_boxes_stop_where_they_touch(drawn: tuple[int, str], is_round: bool) -> None:
    world, rng = made(drawn)
    count, radius = 4, 0.25 * is_round
    origins, directions = rng.uniform(-6, 6, (count, 2)), rng.normal(0, 1, (count, 2))
    halves = rng.uniform(0.1, 1.5, (count, 2))
    sizes: dict[str, Any] = {"half_sizes": halves, "radii": radius}
    hits = world.shape_cast(origins, directions, max_distance=LONGEST, **sizes)
    at, ends = world.positions.astype(float), world.walls.segments.astype(float)
    moved = images(world, 4)
    a, b = (np.concatenate([at, end])[:, None] + moved for end in (ends[:, 0], ends[:, 1]))
    reach = np.append(world.radii, np.zeros(len(ends))) + radius
    names = [(int(id_), -1) for id_ in world.ids] + [(-1, int(id_)) for id_ in world.walls.ids]
    for row, (origin, half) in enumerate(zip(origins, halves, strict=True)):
        u = directions[row] / np.linalg.norm(directions[row])
        id_, distance, point, normal, wall = (column[row] for column in fields(hits))
        travelled = min(distance, LONGEST)
        places = origin + u * np.append(np.linspace(0, 0.999, 25), 1)[:, None] * travelled
        gaps = gap_of_boxes(places, half, a.reshape(-1, 2), b.reshape(-1, 2))
        gaps = gaps.reshape(len(places), len(names), len(moved)) - reach[:, None]
        _, surely = stops(world, moved, origin, u, (half, radius))
        surely = np.vstack([np.ones((len(at), len(moved)), bool), surely.T])
        solid, gaps = np.where(surely, gaps, np.inf), gaps.min(axis=2)
        inside = room(world.container, places, half, radius)
        if distance > 0:
            assert solid.min(initial=np.inf) > -2 * NEAR and inside.min() > -2 * NEAR
        if distance == np.inf:
            assert id_ == wall == -1 and world.container is None
            continue
        last = gaps[-1][names.index((id_, wall))] if wall >= -1 else inside[-1]
        assert last < NEAR
        if distance > 0:
            assert abs(last) < 2 * NEAR
            assert normal @ u < 1e-3 and np.linalg.norm(normal) == pytest.approx(1, abs=1e-4)
            on_box = np.maximum(np.abs(point - places[-1]) - half, 0)
            assert np.linalg.norm(on_box) <= radius + NEAR


def room(container: Any, places: Floats, half: Floats, radius: float) -> Floats:
    """How far rounded boxes are from the sides of a container, at least."""
    if container is None:
        return np.full(len(places), np.inf)
    if isinstance(container, jostle.Circle):
        far = np.linalg.norm(np.abs(places - container.center) + half, axis=1)
        return container.radius - radius - far
    low, high = np.split(np.asarray(container.bounds, float), 2)
    return np.minimum(places - half - low, high - places - half).min(axis=1) - radius


# Single cases


def test_a_ray_crosses_the_seam() -> None:
    world = jostle.World([(2, 5)], 1.0, walls=[[(9, 0), (9, 2)]], period=10)
    hit = world.raycast((7, 5), (1, 0), max_distance=9)
    assert (hit.id, hit.distance, hit.wall) == (0, 4, -1)
    assert hit.point.tolist() == [11, 5] and hit.normal.tolist() == [-1, 0]
    hit = world.raycast((1, 1), (-1, 0), max_distance=9)
    assert (hit.id, hit.distance, hit.wall) == (-1, 2, 0)
    assert hit.point.tolist() == [-1, 1] and hit.normal.tolist() == [1, 0]
    with pytest.raises(ValueError, match="max_distance"):
        world.raycast((1, 1), (-1, 0))
    assert world.query_circle((-8, 5), 0.1).tolist() == [0]
    assert world.nearest((12, 9)).distances.tolist() == [3]


def test_moving_walls_are_hit_where_they_are_now() -> None:
    walls = {"segments": [[(4, -1), (4, 1)]], "velocities": [(1, 0)]}
    world = jostle.World([(0, 9)], 1.0, walls=walls)
    for _ in range(3):
        hit = world.raycast((0, 0), (1, 0))
        assert hit.wall == 0 and hit.distance == pytest.approx(4 + world.time)
        world.step(0.5)
    world.walls.add([[(2, -1), (2, 1)], [(3, -1), (3, 1)]])
    assert world.raycast_all((0, 0), (1, 0)).walls.tolist() == [1, 2, 0]
    world.walls.remove([0, 1])
    assert world.raycast_all((0, 0), (1, 0)).walls.tolist() == [2]
    world.walls.remove(2)
    assert world.raycast((0, 0), (1, 0)).wall == -1


def test_each_side_has_its_name() -> None:
    world = jostle.World([(0, 0)], 0.5, container=jostle.Box(-3, -4, 5, 6))
    ways = [(-1, 0), (1, 0), (0, -1), (0, 1)]
    hits = world.raycast((0, 0), ways, exclude=0)
    assert hits.walls.tolist() == [int(side) for side in SIDES]
    assert hits.ids.tolist() == [-1] * 4 and hits.distances.tolist() == [3, 5, 4, 6]
    np.testing.assert_array_equal(hits.normals, -np.array(ways))
    assert world.raycast((0, 2), (1, 0), mask=2).wall == -1
    world.container = jostle.Circle((0, 0), 4)
    hit = world.raycast((0, 2), (0, 1))
    assert (hit.wall, hit.distance, hit.normal.tolist()) == (jostle.Side.RIM, 2, [0, -1])
    world.container = None
    assert world.raycast((0, 2), (0, 1)).distance == np.inf


def test_where_rays_may_start() -> None:
    world = jostle.World(
        [(0, 0)], 1.0, container=jostle.Box(-9, -9, 9, 9), walls=[[(5, -2), (5, 2)]]
    )
    hit = world.raycast((0.5, 0), (1, 0))  # in a disc
    assert (hit.id, hit.distance, hit.wall, hit.normal.tolist()) == (0, 0, -1, [0, 0])
    assert world.raycast((0.5, 0), (1, 0), exclude=0).wall == 0
    for way in [(1, 0), (-1, 0), (0, 1)]:  # on a wall
        hit = world.raycast((5, 1), way)
        assert (hit.id, hit.distance, hit.wall, hit.normal.tolist()) == (-1, 0, 0, [0, 0])
    for start in [(-10, 0), (9, 0), (12, 0)]:  # outside the container or on its side
        hit = world.raycast(start, (1, 0))
        side = jostle.Side.MIN_X if start[0] < 0 else jostle.Side.MAX_X
        assert (hit.id, hit.distance, hit.wall) == (-1, 0, side)
    hit = world.raycast((5, -8), (0, 1))  # along a wall, to its end
    assert (hit.wall, hit.distance, hit.normal.tolist()) == (0, 6, [0, -1])


def test_at_equal_distances_particles_come_first_then_sides() -> None:
    world = jostle.World(
        [(3, 0), (3, 0)], 1.0, container=jostle.Box(-9, -9, 4, 9), walls=[[(2, -1), (2, 1)]]
    )
    hits = world.raycast_all((0, 0), (1, 0))
    assert hits.ids.tolist() == [0, 1, -1, -1] and hits.walls.tolist() == [-1, -1, 0, -3]
    world.walls.segments = [[(4, -1), (4, 1)]]
    assert world.raycast_all((0, 0), (1, 0)).walls.tolist() == [-1, -1, -3, 0]


def test_a_world_without_particles() -> None:
    world = jostle.World(container=jostle.Box(-1, -1, 1, 1))
    assert world.pairs().shape == (0, 2) and len(world.contacts().pairs) == 0
    assert len(world.neighbors(1.0)) == 0 and len(world.nodes().boxes) == 0
    assert len(world.query_circle((0, 0), 9)) == 0 and len(world.query_point((0, 0))) == 0
    assert world.nearest((0, 0), 2).ids.tolist() == [-1, -1]
    assert world.raycast((0, 0), (1, 0)).wall == jostle.Side.MAX_X
    world.container = None
    assert world.raycast((0, 0), (1, 0)).wall == -1
    assert len(world.raycast_all((0, 0), (1, 0)).ids) == 0


def columns_of(answer: Any) -> tuple[Any, ...]:
    return (answer,) if isinstance(answer, np.ndarray) else fields(answer)


def answers(world: jostle.World) -> list[Any]:
    """The answers of many queries."""
    ways = np.array([(1, 0), (0, 1), (-1, 0.1), (0.3, -1)])
    found = [
        world.pairs(sort=True, distance=0.5),
        world.contacts(sort=True),
        world.neighbors(1.0, mask=3),
        world.query_rect((-5, -5, 5, 5)),
        world.nearest([(0, 0), (9, 9)], 3),
        world.raycast((5, 5), ways, max_distance=30),
        world.raycast_all((5, 5), ways, max_distance=30),
        world.raycast_all((5, 5), ways, max_distance=30, mask=1),
        world.walls.query_circle((3, 5), 1.0),
        world.walls.nearest((0, 0), 2),
        world.walls.raycast_all((9, 5), (-1, 0), max_distance=30),
        world.nodes(),
    ]
    return [np.hstack([np.ravel(column) for column in columns_of(one)]) for one in found]


def are_equal(some: list[Any], others: list[Any]) -> bool:
    pairs = zip(some, others, strict=True)
    return all(np.array_equal(one, other, equal_nan=True) for one, other in pairs)


CHANGES: dict[str, Callable[[jostle.World], Any]] = {
    "step": lambda world: world.step(0.1),
    "add": lambda world: world.add((0, 0), 2.0),
    "remove": lambda world: world.remove(world.ids[3]),
    "set positions": lambda world: world.set(world.ids[:4], positions=[(0, 0)] * 4),
    "set radii": lambda world: world.set(world.ids[:4], radii=2.0),
    "set categories": lambda world: world.set(world.ids[:9], categories=4),
    "set masks": lambda world: world.set(world.ids[:9], masks=0),
    "set velocities": lambda world: world.set(world.ids[:4], velocities=(5, 0)),
    "positions": lambda world: setattr(world, "positions", world.positions[::-1]),
    "radii": lambda world: setattr(world, "radii", 0.9),
    "masks": lambda world: setattr(world, "masks", 2),
    "container": lambda world: setattr(world, "container", jostle.Box(-50, -50, 50, 50)),
    "leaf_capacity": lambda world: setattr(world, "leaf_capacity", 8),
    "move walls": lambda world: setattr(world.walls, "segments", [[(1, 1), (2, 30)]]),
    "set walls": lambda world: world.walls.set(0, segments=((1, 1), (2, 30))),
    "wall categories": lambda world: world.walls.set(0, categories=4),
    "one_way": lambda world: setattr(world.walls, "one_way", True),
    "sensors": lambda world: setattr(world.walls, "sensors", True),
    "add walls": lambda world: world.walls.add([[(1, 1), (2, 30)]]),
    "remove walls": lambda world: world.walls.remove(0),
    "forces": lambda world: setattr(world, "forces", []),
}


@pytest.mark.parametrize("name", CHANGES)
def test_after_each_change_the_answers_are_new(name: str) -> None:
    world = gas(200, leaf_capacity=16, walls=[[(3, 1), (4, 9)]])
    before = answers(world)
    CHANGES[name](world)
    again = jostle.World.restore(world.snapshot())
    for found, expected in zip(answers(world), answers(again), strict=True):
        np.testing.assert_array_equal(found, expected)
    assert are_equal(before, answers(world)) == (name in ("set velocities", "forces"))


def test_queries_find_those_that_sleep_and_those_that_woke() -> None:
    places, options = [(3 * k, 1) for k in range(30)], {"gravity": (0, -9.8), "restitution": 0.25}
    world = jostle.World(places, 1.0, period=90, **options)
    world.walls.add(((0, 0), (45, 0)))
    world.walls.add(((45, 0), (90, 0)))
    world.step(1 / 60, steps=120)
    assert world.asleep.all()
    for woken in ([], [3], [7, 8, 29]):
        world.set(woken, velocities=(0, 2))
        assert world.asleep.sum() == 30 - len(woken) - (1 if len(woken) == 3 else 0)
        for _ in range(2):  # in the trees of sleepers, then in that of all
            assert world.query_rect((-2, -1, 200, 9)).tolist() == list(range(30))
            found = world.query_circle(world.positions, 0.5)
            assert [ids.tolist() for ids in found] == [[row] for row in range(30)]
            near = world.nearest(world.positions + np.array([0.1, 0]), 2)
            np.testing.assert_array_equal(near.ids[:, 0], range(30))
            np.testing.assert_array_equal(near.ids[:, 1], np.roll(range(30), -1))
            hits = world.raycast_all((-1.4, 1.1), (1, 0), max_distance=89)
            assert hits.ids.tolist() == [*range(30)] and (hits.walls == -1).all()
            excluded = world.raycast((-1.4, 1.1), [(1, 0)] * 2, max_distance=89, exclude=[0, 1])
            assert excluded.ids.tolist() == [1, 0]
            assert len(world.pairs()) == 0


def test_a_period_is_assigned() -> None:
    world = jostle.World([(0.5, 0.5), (9.5, 0.5)], 0.6)
    assert len(world.pairs()) == 0
    world.period = 10
    assert world.pairs().tolist() == [[0, 1]]
    world.period = None
    assert len(world.pairs()) == 0


def test_merged_particles_answer_once() -> None:
    world = jostle.World([(0, 0), (1, 0), (9, 0)], 0.6, on_touch="merge")
    assert world.pairs().tolist() == [[0, 1]]
    world.step(0.1)
    assert len(world.pairs()) == 0 and world.query_circle((0, 0), 2).tolist() == [0]
    assert world.raycast((20, 0), (-1, 0)).id == 2


def test_removed_ids_are_not_found() -> None:
    world = jostle.World([(0, 0), (5, 0), (9, 0)], 1.0)
    assert world.query_circle((0, 0), 2).tolist() == [0]
    world.remove(0)
    assert len(world.query_circle((0, 0), 2)) == 0
    assert world.query_circle((9, 0), 0.5, exclude=0).tolist() == [2]
    assert world.raycast((-9, 0), (1, 0), exclude=0).id == 1
    assert world.raycast((-9, 0), (1, 0), exclude=1).id == 2
    assert world.nearest((0, 0), 3, exclude=0).ids.tolist() == [1, 2, -1]
    assert [row.tolist() for row in world.neighbors(3.0)] == [[2], [1]]


# Walls


def test_filters_of_walls_select_them() -> None:
    walls = {"segments": [[(x, -1), (x, 1)] for x in (1, 2, 3)], "categories": [1, 2, 6]}
    world = jostle.World(walls=walls)
    world.walls.masks = 0  # of discs that they stop, not of queries
    assert world.raycast_all((0, 0), (1, 0)).walls.tolist() == [0, 1, 2]
    assert world.raycast_all((0, 0), (1, 0), mask=2).walls.tolist() == [1, 2]
    assert world.shape_cast((0, 0), (1, 0), radii=0.25, mask=4).wall == 2
    assert world.walls.query_circle((2, 0), 9, mask=2).tolist() == [1, 2]
    assert world.walls.nearest((0, 0), mask=4).ids.tolist() == [2]


def test_one_way_walls_are_hit_from_their_left() -> None:
    # Up is to the left of start → end.
    world = jostle.World(walls={"segments": [[(-3, 0), (3, 0)]], "one_way": True})
    down = world.raycast((0, 2), (0, -1))
    assert (down.wall, down.distance, down.normal.tolist()) == (0, 2, [0, 1])
    assert world.raycast((0, -2), (0, 1)).wall == -1
    assert world.raycast((0, 0), (0, -1)).wall == -1, "a ray that starts on the wall"
    assert world.raycast((-5, 0), (1, 0)).wall == -1, "along the wall"
    assert world.raycast((-5, 1), (1, 0)).wall == -1
    for distance, wall in [(1.01, 0), (1.0, -1), (0.5, -1), (-0.5, -1)]:
        hit = world.shape_cast((0, distance), (0, -1), radii=1.0)
        assert hit.wall == wall, distance
        hit = world.shape_cast((0, distance), (0, -1), half_sizes=(0.25, 1.0))
        assert hit.wall == wall, distance
    end = world.shape_cast((-3.5, 2), (0, -1), radii=1.0)
    assert end.wall == 0 and end.distance == pytest.approx(2 - np.sqrt(0.75))
    world.walls.set(0, segments=((3, 0), (-3, 0)))
    assert world.raycast((0, 2), (0, -1)).wall == -1
    assert world.raycast((0, -2), (0, 1)).wall == 0
    world.walls.one_way = False
    assert world.raycast((0, 2), (0, -1)).wall == 0
    assert world.raycast((0, 0), (0, -1)).distance == 0


def test_casts_pass_sensors_and_other_queries_find_them() -> None:
    walls = {"segments": [[(x, -1), (x, 1)] for x in (1, 2, 3)], "sensors": [True, False, True]}
    world = jostle.World(walls=walls)
    world.walls.remove(0)
    assert world.raycast_all((0, 0), (1, 0)).walls.tolist() == [1]
    assert world.walls.raycast_all((4, 0), (-1, 0)).ids.tolist() == [1]
    assert world.shape_cast((0, 0), (1, 0), radii=0.25).wall == 1
    assert world.walls.query_circle((2, 0), 9).tolist() == [1, 2]
    assert world.walls.nearest((9, 0)).ids.tolist() == [2]
    world.walls.sensors = False
    assert world.raycast_all((0, 0), (1, 0)).walls.tolist() == [1, 2]


def test_one_way_walls_of_a_periodic_world() -> None:
    walls = {"segments": [[(12, 2), (18, 2)]], "one_way": True}
    world = jostle.World(walls=walls, period=10)
    hit = world.raycast((4, 1), (0, -1), max_distance=30)  # the image below
    assert (hit.wall, hit.distance) == (0, 9)
    assert world.raycast((4, 1), (0, 1), max_distance=30).wall == -1
    hit = world.raycast((4, 5), (0, -1), max_distance=30)
    assert (hit.wall, hit.distance, hit.point.tolist()) == (0, 3, [4, 2])


def test_a_wall_as_long_as_the_period_moves_over_its_side() -> None:
    walls = {"segments": [[(0, 5), (10, 5)]], "velocities": [(1.1, 0.3)]}
    world = jostle.World([(5, 1)], 0.5, walls=walls, period=10)
    for _ in range(40):
        world.step(0.1)
        hit = world.raycast((5, 1), (0, 1), max_distance=9, exclude=0)
        assert hit.wall == 0 and world.walls.query_point((5, 1)).tolist() == []


def test_casts_pass_no_joint() -> None:
    rng = np.random.default_rng(5)
    corners = np.cumsum(rng.normal(size=(50, 2)), axis=0).astype(np.float32)
    world = jostle.World(walls=jostle.polyline(corners))
    origins = corners[1:-1] + rng.normal(size=(48, 2)) * 20
    hits = world.raycast(origins, corners[1:-1] - origins, max_distance=1e3)
    assert (hits.walls >= 0).all()


@settings(max_examples=60)
@given(worlds, st.sampled_from([None, 1, 6]))
def test_queries_of_walls(drawn: tuple[int, str], mask: int | None) -> None:
    world, rng = made(drawn)
    walls, ends = world.walls, world.walls.segments.astype(float)
    chosen = np.ones(len(walls), bool) if mask is None else walls.categories & mask != 0
    moved = images(world, 2)
    a, b = ends[:, :1] + moved, ends[:, 1:] + moved
    for _ in range(4):
        point, radius = rng.uniform(-9, 9, 2), rng.uniform(0.1, 4)
        gaps = from_segment(point, a, b).min(axis=1)
        found = walls.query_circle(tuple(point), radius, mask=mask)
        agrees(walls, found, gaps - radius, chosen)
        agrees(walls, walls.query_point(tuple(point), mask=mask), gaps, chosen)
        half = rng.uniform(0.1, 3, 2)
        rect = (*(point - half), *(point + half))
        gaps = gap_of_boxes(point[None], half, a.reshape(-1, 2), b.reshape(-1, 2))
        gaps = gaps.reshape(len(walls), len(moved)).min(axis=1)
        for found in (
            walls.query_rect(rect, mask=mask),
            walls.query_polygon(
                [rect[:2], (rect[2], rect[1]), rect[2:], (rect[0], rect[3])], mask=mask
            ),
        ):
            agrees(walls, found, np.where(gaps > 0, gaps, -1), chosen)
            if len(found):
                less = walls.query_rect(rect, mask=mask, exclude=found[0])
                assert found[0] not in less
    points = rng.uniform(-9, 9, (5, 2))
    near = walls.nearest(points, 3, max_distance=6, mask=mask)
    for point, ids, distances in zip(points, near.ids, near.distances, strict=True):
        gaps = np.where(chosen, from_segment(point, a, b).min(axis=1), np.inf)
        expected = np.sort(np.append(gaps, [np.inf] * 3))[:3]
        expected[expected > 6] = np.inf
        np.testing.assert_allclose(distances, expected, atol=NEAR)
        there = ids >= 0
        np.testing.assert_allclose(gaps[walls.rows(ids[there])], distances[there], atol=NEAR)


def agrees(walls: jostle.Walls, found: NDArray[np.int64], gaps: Floats, chosen: Any) -> None:
    """Check that those with a gap below 0 are found."""
    assert np.array_equal(found, np.sort(found)) and np.isin(found, walls.ids).all()
    known = np.abs(gaps) > NEAR
    np.testing.assert_array_equal(np.isin(walls.ids, found)[known], ((gaps < 0) & chosen)[known])


@settings(max_examples=60)
@given(worlds, st.sampled_from([None, 1, 6]))
def test_casts_of_walls_are_those_of_a_world_without_the_rest(
    drawn: tuple[int, str], mask: int | None
) -> None:
    world, rng = made(drawn)
    origins, directions = rng.uniform(-7, 7, (6, 2)), rng.normal(0, 1, (6, 2))
    options: dict[str, Any] = {"max_distance": LONGEST, "mask": mask}
    found = [
        world.walls.raycast(origins, directions, **options),
        world.walls.raycast_all(origins, directions, **options),
        world.walls.shape_cast(origins, directions, radii=0.3, half_sizes=(0.5, 0.2), **options),
    ]
    world.container = None if world.period is None else world.container
    world.remove(world.ids)
    expected = [
        world.raycast(origins, directions, **options),
        world.raycast_all(origins, directions, **options),
        world.shape_cast(origins, directions, radii=0.3, half_sizes=(0.5, 0.2), **options),
    ]
    for some, others in zip(found, expected, strict=True):
        np.testing.assert_array_equal(some.ids, some.walls)
        for one, other in zip(fields(some)[1:], fields(others)[1:], strict=True):
            np.testing.assert_array_equal(one, other)


def test_walls_are_excluded_by_id() -> None:
    world = jostle.World([(9, 0)], 1.0, walls=[[(x, -1), (x, 1)] for x in (1, 2, 3)])
    world.walls.remove(0)
    assert world.walls.raycast((0, 0), (1, 0), exclude=1).id == 2
    hits = world.walls.raycast((0, 0), [(1, 0)] * 3, exclude=[-1, 1, 2])
    assert hits.ids.tolist() == hits.walls.tolist() == [1, 2, 1]
    assert world.raycast((0, 0), (1, 0), exclude=1).wall == 1, "ids of particles"
    assert world.walls.query_circle((2, 0), 5, exclude=2).tolist() == [1]
    assert world.walls.nearest((0, 0), 2, exclude=1).ids.tolist() == [2, -1]
    hit = world.walls.raycast((0, 5), (1, 0))
    assert (hit.id, hit.wall, hit.distance) == (-1, -1, np.inf)


def test_no_walls_and_touching_ones() -> None:
    world = jostle.World([(0, 0)], 1.0)
    assert world.walls.query_circle((0, 0), 9).tolist() == []
    assert world.walls.nearest((0, 0)).ids.tolist() == [-1]
    assert world.walls.raycast((5, 0), (-1, 0)).id == -1
    world.walls.add(((2, 0), (4, 0)))
    assert world.walls.query_point((2, 0)).tolist() == [0], "a segment contains its ends"
    assert world.walls.query_circle((3, 1), 1).tolist() == [], "touching is not overlapping"
    assert world.walls.query_rect((4, -1, 5, 1)).tolist() == []
    assert world.walls.query_rect((3.5, -1, 5, 1)).tolist() == [0]


NAN = float("nan")
REFUSED: list[tuple[str, Callable[[jostle.World], Any]]] = [
    (r"^point is \(NaN, 0\)", lambda world: world.query_point((NAN, 0))),
    (r"^rect", lambda world: world.query_rect((0, NAN, 1, 1))),
    (r"^radius", lambda world: world.query_circle((0, 0), NAN)),
    (r"^vertices", lambda world: world.query_polygon([(0, 0), (1, 0), (0, NAN)])),
    (r"^point", lambda world: world.nearest((0, NAN))),
    (r"^max_distance", lambda world: world.nearest((0, 0), max_distance=NAN)),
    (r"^origin", lambda world: world.raycast((NAN, 0), (1, 0))),
    (r"^direction", lambda world: world.raycast((0, 0), (NAN, 0))),
    (r"^direction", lambda world: world.raycast_all((0, 0), (0, 0))),
    (r"^max_distance", lambda world: world.raycast((0, 0), (1, 0), max_distance=-1)),
    (r"^radii", lambda world: world.shape_cast((0, 0), (1, 0), radii=NAN)),
    (r"^distance", lambda world: world.neighbors(NAN)),
    (r"^distance", lambda world: world.pairs(distance=-1)),
    (r"^max_pairs", lambda world: world.contacts(max_pairs=-1)),
    (r"^mask", lambda world: world.pairs(mask=2**32)),
    (r"^point is \(NaN, 0\)", lambda world: world.walls.query_point((NAN, 0))),
    (r"^origin", lambda world: world.walls.raycast((NAN, 0), (1, 0))),
    (r"^direction", lambda world: world.walls.raycast_all((0, 0), (0, 0))),
    (r"^radii", lambda world: world.walls.shape_cast((0, 0), (1, 0), radii=-1)),
    (r"^k", lambda world: world.walls.nearest((0, 0), 0)),
]


@pytest.mark.parametrize(("message", "ask"), REFUSED)
def test_wrong_arguments_are_refused(message: str, ask: Callable[[jostle.World], Any]) -> None:
    world = jostle.World([(0, 0), (1, 0)], 1.0)
    before = world.state_hash()
    with pytest.raises(ValueError, match=message):
        ask(world)
    assert world.state_hash() == before


def test_queries_change_no_step() -> None:
    asked, alone = gas(300), gas(300)
    for _ in range(5):
        answers(asked)
        assert asked.snapshot() == alone.snapshot()
        asked.step(0.05)
        alone.step(0.05)
    assert asked.state_hash() == alone.state_hash()


@pytest.mark.parametrize("threads", [1, 2, 8])
def test_threads_change_no_answer(threads: int) -> None:
    one, many = gas(2000, threads=1), gas(2000, threads=threads)
    for found, expected in zip(answers(many), answers(one), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_queries_while_another_thread_steps() -> None:
    world, expected = gas(500), gas(500)
    stepping = threading.Thread(target=lambda: [world.step(0.01) for _ in range(30)])
    stepping.start()
    while stepping.is_alive():
        hits = world.raycast((5, 5), np.random.default_rng(1).normal(size=(50, 2)))
        assert np.isfinite(hits.distances[hits.ids >= 0]).all()
        world.pairs()
    stepping.join()
    expected.step(0.01, steps=30)
    assert world.state_hash() == expected.state_hash()


def test_a_copy_has_the_same_answers() -> None:
    world = gas(100)
    before = answers(world)
    world_copy = jostle.World.restore(world.snapshot())
    world.step(1.0)
    assert are_equal(answers(world_copy), before)
