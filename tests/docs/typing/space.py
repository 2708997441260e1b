"""Types of ids of a `Space`: one or many."""

from typing import Any

import numpy as np
import pygame
from numpy.typing import NDArray
from typing_extensions import assert_type

from jostle import Slide, Slides, Space

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


def added_of_any_type(space: Space, given: dict[str, Any], rows: list[Any]) -> None:
    assert_type(space.add(np.load("centers.npy"), 1.0), Any)
    for id in space.add(given["centers"]):
        print(id)
    kept: dict[int, str] = {space.add(given["center"]): "ship"}
    more: dict[int, str] = {space.add((given["x"], given["y"]), given["r"]): "shot"}
    print(kept, more, space.add(rows).tolist())


def columns(space: Space, id: int, ids: Ids, some: list[int], given: Any) -> None:
    assert_type(space.radii(id), float)
    assert_type(space.radii(np.int64(3)), float)
    assert_type(space.radii(), Reals)
    assert_type(space.radii(None), Reals)
    assert_type(space.radii(ids), Reals)
    assert_type(space.radii(some), Reals)
    assert_type(space.radii(range(3)), Reals)
    assert_type(space.radii(given), Any)
    assert_type(space.categories(id), int)
    assert_type(space.categories(ids), Bits)
    assert_type(space.categories(some), Bits)
    assert_type(space.categories(given), Any)
    assert_type(space.masks(id), int)
    assert_type(space.masks(ids), Bits)
    assert_type(space.masks(), Bits)
    assert_type(space.masks(given), Any)
    assert_type(space.centers(id), Reals)
    assert_type(space.centers(ids), Reals)
    assert_type(space.half_sizes(some), Reals)


def events(space: Space) -> None:
    happened = space.update()
    assert_type(happened.entered, Ids)
    entered, stayed, left = happened
    assert_type(stayed, Ids)
    print(entered.tolist(), left.tolist())


def changed(space: Space, id: int, ids: Ids, vector: pygame.Vector2) -> None:
    space.move(id, (0, 1))
    space.move(id, vector)
    space.move(ids, [(0, 1), (2, 3)])
    space.move([1, 2], [vector, vector])
    space.resize(ids, radii=2.0)
    space.set_filter(id, masks=0)
    space.remove([1, 2])
    space.remove(ids[space.radii(ids) < 1])


def slid(space: Space, id: int, ids: Ids, vector: pygame.Vector2, given: Any) -> None:
    assert_type(space.move_and_slide(id, (0, 1)), Slide)
    assert_type(space.move_and_slide(np.int64(3), vector, up=(0, 1)), Slide)
    assert_type(space.move_and_slide(ids, [(0, 1), (2, 3)], one_way=4), Slides)
    assert_type(space.move_and_slide([1, 2], np.ones((2, 2)), mask=3), Slides)
    assert_type(space.move_and_slide(id, (0, 1)).on_floor, bool)
    for step in space.move_and_slide(given, given).displacements:
        print(step)
