"""The queries of `world.walls`, compared with brute force, and which walls queries find."""

from typing import Any

import numpy as np
from hypothesis import given
from oracle_worlds import (
    LONGEST,
    MASKS,
    NEAR,
    WORLDS,
    agree,
    from_segment,
    gap_of_boxes,
    has_bits,
    images,
    made,
)
from results import fields

import jostle


@given(WORLDS, MASKS)
def test_queries_of_walls(drawn: tuple[int, str], mask: int | None) -> None:
    world, rng = made(drawn)
    walls, ends = world.walls, world.walls.segments.astype(float)
    chosen = has_bits(walls, mask)
    moved = images(world, 2)
    a, b = ends[:, :1] + moved, ends[:, 1:] + moved
    for _ in range(4):
        point, radius = rng.uniform(-9, 9, 2), rng.uniform(0.1, 4)
        gaps = from_segment(point, a, b).min(axis=1)
        found = walls.query_circle(tuple(point), radius, mask=mask)
        assert agree(found, walls, gaps - radius, chosen)
        assert agree(walls.query_point(tuple(point), mask=mask), walls, gaps, chosen)
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
            assert agree(found, walls, np.where(gaps > 0, gaps, -1), chosen)
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


@given(WORLDS, MASKS)
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


def test_filters_of_walls_select_them() -> None:
    walls = {"segments": [[(x, -1), (x, 1)] for x in (1, 2, 3)], "categories": [1, 2, 6]}
    world = jostle.World(walls=walls)
    world.walls.masks = 0  # of discs that they stop, not of queries
    assert world.raycast_all((0, 0), (1, 0)).walls.tolist() == [0, 1, 2]
    assert world.raycast_all((0, 0), (1, 0), mask=2).walls.tolist() == [1, 2]
    assert world.shape_cast((0, 0), (1, 0), radii=0.25, mask=4).wall == 2
    assert world.walls.query_circle((2, 0), 9, mask=2).tolist() == [1, 2]
    assert world.walls.nearest((0, 0), mask=4).ids.tolist() == [2]


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
