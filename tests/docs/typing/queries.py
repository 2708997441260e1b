"""Types of queries: one or many, by the type of the arguments."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pygame
from numpy.typing import NDArray
from typing_extensions import assert_type

from jostle import (
    Box,
    Contacts,
    IdLists,
    Neighbors,
    Quadtree,
    RayHit,
    RayHitLists,
    RayHits,
    Space,
    World,
)

Ids = NDArray[np.int64]


def one_by_literals(tree: Quadtree) -> None:
    assert_type(tree.query_rect((0, 0, 2.5, 1)), Ids)
    assert_type(tree.query_rect([0, 0, 2.5, 1], mask=2), Ids)
    assert_type(tree.query_rect(Box(0, 0, 2.5, 1)), Ids)
    assert_type(tree.query_circle((0, 0.5), 1), Ids)
    assert_type(tree.query_circle([0, 0.5], 1.0), Ids)
    assert_type(tree.query_point((1, 2)), Ids)
    assert_type(tree.query_point([1.0, 2.0]), Ids)
    assert_type(tree.query_point((np.float32(1), np.int64(2))), Ids)
    assert_type(tree.query_polygon([(0, 0), (1, 0), (1, 1.5)]), Ids)
    assert_type(tree.query_polygon([[0, 0], [1, 0], [1, 1.5]]), Ids)
    assert_type(tree.nearest((1, 2), k=3), Neighbors)
    assert_type(tree.raycast((0, 0), (1, 0)), RayHit)
    assert_type(tree.raycast([0, 0], (1, 0), max_distance=5), RayHit)
    assert_type(tree.raycast((0, 0), [1.5, 0]), RayHit)
    assert_type(tree.shape_cast((0, 0), (1, 0), radii=0.5), RayHit)
    assert_type(tree.shape_cast([0, 0], [1, 0], radii=np.float32(0.5), mask=1), RayHit)
    assert_type(tree.shape_cast((0, 0), (1, 0), half_sizes=0.5), RayHit)
    assert_type(tree.shape_cast((0, 0), (1, 0), half_sizes=(1, 0.5), radii=0.25), RayHit)
    assert_type(tree.shape_cast([0, 0], [1, 0], half_sizes=[1, 0.5], max_distance=2), RayHit)
    assert_type(tree.raycast_all((0, 0), (1, 0)), RayHits)
    assert_type(tree.raycast_all([0, 0], (1, 0), max_distance=3.5), RayHits)
    assert_type(tree.raycast((0, 0), (1, 0)).normal, NDArray[np.floating[Any]])


def pairs_of_all(tree: Quadtree, space: Space) -> None:
    assert_type(tree.neighbors(2), IdLists)
    assert_type(space.neighbors(2.5, mask=3), IdLists)
    assert_type(tree.contacts(tree, sort=True, mask=1), Contacts)
    assert_type(space.contacts(sort=True), Contacts)
    assert_type(tree.pairs(distance=1.5), Ids)
    assert_type(tree.period, tuple[float, float])
    print(tree.positions, tree.radii, tree.half_sizes, tree.boxes, tree.dtype)
    assert_type(Quadtree([(0, 0)], period=5), Quadtree)
    assert_type(Quadtree([(0, 0)], period=(5, None)), Quadtree)
    assert_type(Space(period=np.ones(2)), Space)


def one_by_objects(
    tree: Quadtree, vector: pygame.Vector2, rect: pygame.Rect, frect: pygame.FRect
) -> None:
    assert_type(tree.query_rect(rect), Ids)
    assert_type(tree.query_rect(frect), Ids)
    assert_type(tree.query_circle(vector, 5), Ids)
    assert_type(tree.query_point(vector), Ids)
    assert_type(tree.query_polygon([vector, vector, vector]), Ids)
    assert_type(tree.nearest(vector), Neighbors)
    assert_type(tree.raycast(vector, vector), RayHit)
    assert_type(tree.raycast(vector, (1, 0)), RayHit)
    assert_type(tree.shape_cast((0, 0), vector, radii=3), RayHit)


def many_by_arrays(tree: Quadtree, single: NDArray[np.float32], k: int) -> None:
    double = np.zeros((5, 2))
    for points in (single, double):
        assert_type(tree.query_circle(points, 1.0), IdLists)
    assert_type(tree.query_rect(np.zeros((3, 4))), IdLists)
    assert_type(tree.query_rect(single), IdLists)
    assert_type(tree.query_circle(single, np.ones(4)), IdLists)
    assert_type(tree.query_circle((0, 0), single), IdLists)
    assert_type(tree.query_circle(single, [1, 2, 3.5]), IdLists)
    assert_type(tree.query_point(single), IdLists)
    assert_type(tree.query_polygon([single, single]), IdLists)
    assert_type(tree.query_polygon(single), Ids)
    assert_type(tree.nearest(single, k), Neighbors)
    assert_type(tree.raycast(single, single), RayHits)
    assert_type(tree.raycast((0, 0), single), RayHits)
    assert_type(tree.raycast(single, (0, 1)), RayHits)
    assert_type(tree.raycast(single, [0, 1]), RayHits)
    assert_type(tree.shape_cast(single, single, radii=1), RayHits)
    assert_type(tree.shape_cast((0, 0), single, radii=1), RayHits)
    assert_type(tree.shape_cast(single, (0, 1), radii=1), RayHits)
    assert_type(tree.shape_cast((0, 0), (0, 1), radii=single), RayHits)
    assert_type(tree.shape_cast(single, single, half_sizes=1), RayHits)
    assert_type(tree.shape_cast((0, 0), single, half_sizes=single, max_distance=single), RayHits)
    assert_type(tree.raycast_all(single, (0, 1)), RayHitLists)
    assert_type(tree.raycast_all((0, 0), single, max_distance=[1, 2.5]), RayHitLists)
    assert_type(tree.raycast(single, single, max_distance=single), RayHits)
    assert_type(tree.nearest(single, max_distance=single), Neighbors)


def many_by_sequences(
    tree: Quadtree, points: list[tuple[float, float]], rects: list[pygame.Rect]
) -> None:
    assert_type(tree.query_rect([(0, 0, 1, 1), (1, 1, 2, 2.5)]), IdLists)
    assert_type(tree.query_rect([Box(0, 0, 2.5, 1)]), IdLists)
    assert_type(tree.query_rect(rects), IdLists)
    assert_type(tree.query_circle(points, 2), IdLists)
    assert_type(tree.query_circle([(0, 0), (1, 1)], [1, 2]), IdLists)
    assert_type(tree.query_point([[0, 0], [1, 1.5]]), IdLists)
    assert_type(tree.query_point(((0, 0), (1, 1.5))), IdLists)
    assert_type(tree.query_point([pygame.Vector2(), pygame.Vector2()]), IdLists)
    assert_type(tree.query_polygon([[(0, 0), (1, 0), (1, 1)]]), IdLists)
    assert_type(tree.nearest(points), Neighbors)
    assert_type(tree.raycast(points, (0, 1)), RayHits)
    assert_type(tree.raycast((0, 0), [(0, 1), (1, 0)]), RayHits)
    assert_type(tree.shape_cast(points, points, radii=1), RayHits)


def any_is_left_open(tree: Quadtree, given: dict[str, Any]) -> None:
    """An argument of type Any may be one or many, so the answer is used as either."""
    loaded = np.load("centers.npy")
    assert_type(tree.query_rect(loaded), Any)
    assert_type(tree.query_circle(loaded, 1.0), Any)
    assert_type(tree.query_circle((0, 0), given["radius"]), Any)
    assert_type(tree.query_point(loaded), Any)
    assert_type(tree.query_polygon(loaded), Any)
    assert_type(tree.nearest(given["point"]), Neighbors)
    assert_type(tree.raycast(loaded, given["direction"]), Any)
    assert_type(tree.raycast((0, 0), given["direction"]), Any)
    assert_type(tree.shape_cast(loaded, (1, 0), radii=given["radius"]), Any)
    for ids in tree.query_circle(loaded, given["radius"]):
        print(ids.tolist())
    for row in tree.query_point(given["mouse"]):
        print(row + 1)
    print(tree.raycast(given["eye"], (1, 0)).id, tree.raycast(loaded, loaded).ids.max())


def any_beside_an_array_is_many(tree: Quadtree, given: Any, single: NDArray[np.float32]) -> None:
    assert_type(tree.query_circle(single, given), IdLists)
    assert_type(tree.raycast(given, single), RayHits)
    assert_type(tree.raycast(single, given), RayHits)
    assert_type(tree.shape_cast(single, given, radii=given), RayHits)


def any_within_a_sequence_can_be_used(
    tree: Quadtree, given: dict[str, Any], rows: list[Any], single: NDArray[np.float32]
) -> None:
    """For pyright a pair is one and a list is many; mypy infers Any."""
    print(tree.query_point((given["x"], given["y"])).tolist())
    print(tree.query_point(tuple(single)).tolist())
    print(tree.raycast((given["x"], 0), (1, 0)).distance)
    print(tree.query_point(rows))
    print(tree.query_circle([(row["x"], row["y"]) for row in rows], 3))
    assert_type(tree.nearest(rows), Neighbors)


def hits(tree: Quadtree, centers: Any) -> IdLists:
    """The answer to a query of type Any can be given a type."""
    found: IdLists = tree.query_circle(centers, 1.0)
    return found


def a_space_answers_alike(space: Space, single: NDArray[np.float32], given: Any) -> None:
    assert_type(space.query_rect((0, 0, 1, 1)), Ids)
    assert_type(space.query_rect(single), IdLists)
    assert_type(space.query_rect(given), Any)
    assert_type(space.query_circle((0, 0), 1), Ids)
    assert_type(space.query_circle(single, 1), IdLists)
    assert_type(space.query_circle(given, 1), Any)
    assert_type(space.query_point((0, 0)), Ids)
    assert_type(space.query_point(single), IdLists)
    assert_type(space.query_point(given), Any)
    assert_type(space.query_polygon([(0, 0), (1, 0), (1, 1)]), Ids)
    assert_type(space.nearest(single), Neighbors)
    assert_type(space.raycast((0, 0), (1, 0)), RayHit)
    assert_type(space.raycast(single, (1, 0)), RayHits)
    assert_type(space.raycast(given, (1, 0)), Any)
    assert_type(space.shape_cast((0, 0), (1, 0), radii=2), RayHit)
    assert_type(space.shape_cast(single, single, radii=2), RayHits)
    assert_type(space.shape_cast(given, given, radii=2), Any)


def queries_of_worlds(world: World, single: NDArray[np.float32], given: Any) -> None:
    assert_type(world.pairs(distance=1, mask=2, sort=True), Ids)
    assert_type(world.contacts(mask=2), Contacts)
    assert_type(world.neighbors(2), IdLists)
    for shapes in (world, world.walls):
        assert_type(shapes.query_rect((0, 0, 1, 1), exclude=3), Ids)
        assert_type(shapes.query_circle(single, 1), IdLists)
        assert_type(shapes.query_point(given), Any)
        assert_type(shapes.nearest(single, exclude=3), Neighbors)
        assert_type(shapes.raycast((0, 0), (1, 0)).wall, int)
        assert_type(shapes.raycast(single, (1, 0)), RayHits)
        assert_type(shapes.raycast_all((0, 0), (1, 0)).walls, Ids)
        assert_type(shapes.shape_cast((0, 0), (1, 0), radii=2), RayHit)


def a_point_of_any_kind(tree: Quadtree, point: Sequence[float]) -> None:
    assert_type(tree.query_point(point), Ids)
