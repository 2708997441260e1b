"""Casts of a world: what they hit, compared with brute force, and single cases."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracle_worlds import (
    LONGEST,
    MASKS,
    NEAR,
    SIDES,
    WORLDS,
    expected_hits,
    gap_of_boxes,
    images,
    made,
    room,
    stops,
    the_one,
)
from results import fields

import jostle


@given(WORLDS, MASKS, st.sampled_from([0.0, 0.3]))
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


@given(WORLDS, MASKS)
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


@given(WORLDS, st.booleans())
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
