"""Types of ids of a `Space`: one or many."""

from typing import Any

import numpy as np
import pygame
from numpy.typing import NDArray
from typing_extensions import assert_type

from jostle import Slide, Slides, Space, polyline

Ids = NDArray[np.int64]
Reals = NDArray[np.floating[Any]]
Bits = NDArray[np.uint32]


def added(space: Space, single: NDArray[np.float32], points: list[tuple[int, int]]) -> None:
    assert_type(space.add((0, 0), 1.0), int)
    assert_type(space.add([0, 0.5], half_sizes=(1, 2)), int)
    assert_type(space.add(pygame.Vector2(), 1.0, categories=2), int)
    assert_type(space.add(single, 1.0), Ids)
    assert_type(space.add(points, np.ones(3)), Ids)
    assert_type(space.add([(0, 0)], radii=1.0, masks=3), Ids)
    assert_type(space.add([pygame.Vector2(), pygame.Vector2()]), Ids)
    assert_type(space.add(segments=[(0, 0), (1, 2.5)]), int)
    assert_type(space.add(segments=(pygame.Vector2(), pygame.Vector2())), int)
    assert_type(space.add(segments=[[(0, 0), (1, 2)], [(1, 2), (3, 4)]]), Ids)
    assert_type(space.add(segments=polyline(points)), Ids)


def added_of_any_type(space: Space, given: dict[str, Any], rows: list[Any]) -> None:
    assert_type(space.add(np.load("centers.npy"), 1.0), Any)
    for id in space.add(given["centers"]):
        print(id)
    kept: dict[int, str] = {space.add(given["center"]): "ship"}
    more: dict[int, str] = {space.add((given["x"], given["y"]), given["r"]): "shot"}
    print(kept, more, space.add(rows).tolist())


def columns(space: Space, id: int, ids: Ids, some: list[int], given: Any) -> None:
    assert_type(space.get(id).radii, float)
    assert_type(space.get(np.int64(3)).radii, float)
    assert_type(space.radii, Reals)
    assert_type(space.get(ids).radii, Reals)
    assert_type(space.get(some).radii, Reals)
    assert_type(space.get(range(3)).radii, Reals)
    assert_type(space.get(given).radii, Any)
    assert_type(space.get(id).categories, int)
    assert_type(space.get(ids).categories, Bits)
    assert_type(space.get(some).categories, Bits)
    assert_type(space.get(given).categories, Any)
    assert_type(space.get(id).masks, int)
    assert_type(space.get(ids).masks, Bits)
    assert_type(space.masks, Bits)
    assert_type(space.get(given).masks, Any)
    assert_type(space.get(id).positions, Reals)
    assert_type(space.get(ids).positions, Reals)
    assert_type(space.get(some).half_sizes, Reals)
    assert_type(space.get(id).segments, Reals)
    assert_type(space.segments, Reals)
    assert_type(space.bounds(), Reals)


def events(space: Space) -> None:
    happened = space.update()
    assert_type(happened.entered, Ids)
    assert_type(happened.stayed, Ids)
    print(happened.entered.tolist(), happened.exited.tolist())


def changed(space: Space, id: int, ids: Ids, vector: pygame.Vector2) -> None:
    space.set(id, positions=(0, 1))
    space.set(id, positions=vector)
    space.set(ids, positions=[(0, 1), (2, 3)])
    space.set([1, 2], positions=[vector, vector])
    space.set(ids, radii=2.0)
    space.set(id, masks=0)
    space.remove([1, 2])
    space.remove(ids[space.get(ids).radii < 1])


def slid(space: Space, id: int, ids: Ids, vector: pygame.Vector2, given: Any) -> None:
    assert_type(space.move_and_slide(id, (0, 1)), Slide)
    assert_type(space.move_and_slide(np.int64(3), vector, up=(0, 1)), Slide)
    assert_type(space.move_and_slide(ids, [(0, 1), (2, 3)], one_way=4), Slides)
    assert_type(space.move_and_slide([1, 2], np.ones((2, 2)), mask=3), Slides)
    assert_type(space.move_and_slide(id, (0, 1)).on_floor, bool)
    for step in space.move_and_slide(given, given).displacement:
        print(step)
