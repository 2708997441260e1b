"""Types of the arguments for shapes and particles."""

from typing import Any

import numpy as np
import pygame
from numpy.typing import NDArray
from typing_extensions import assert_type

import jostle
from jostle import Quadtree, World


def trees(
    single: NDArray[np.float32], points: list[tuple[float, float]], given: dict[str, Any]
) -> None:
    assert_type(Quadtree(single, 1.0), Quadtree)
    assert_type(Quadtree(points, radii=[1, 2]), Quadtree)
    assert_type(Quadtree(np.load("centers.npy"), given["radii"]), Quadtree)
    assert_type(Quadtree([pygame.Vector2(), pygame.Vector2()], 2), Quadtree)
    assert_type(Quadtree(points).pairs(Quadtree(points)), NDArray[np.int64])
    print(jostle.find_pairs(single, 1).shape, jostle.find_pairs(given["centers"]).tolist())
    contacts = Quadtree(single, 1.0).contacts()
    print(contacts.pairs[contacts.depths > 0.5].tolist())


def apart(single: NDArray[np.float32], given: dict[str, Any]) -> None:
    assert_type(jostle.separate(single, 1.0, movable=np.ones(3, bool)), jostle.Separated)
    assert_type(jostle.separate([(0, 0), (1, 1)], half_sizes=(1, 2), axis=1).overlaps, int)
    print(jostle.separate(given["centers"], given["radii"]).positions.tolist())
    assert_type(jostle.tiles(given["grid"] == 1, (16, 16)), NDArray[np.float64])


def worlds(points: list[tuple[float, float]], given: Any) -> None:
    world = World(points, 1.0, gravity=(0, 9.8), container=jostle.Box(0, 0, 9, 9))
    assert_type(World(given, given, velocities=given, forces=[jostle.Gravitation(1.0)]), World)
    assert_type(world.positions, NDArray[np.float32])
    assert_type(world.movable, NDArray[np.bool_])
    world.velocities = np.zeros((3, 2))
    world.velocities = 2 * world.velocities
    world.velocities *= 2
    world.gravity = pygame.Vector2(0, 9.8)
    world.step(1 / 60, steps=10)
    world.set([0], positions=[(1, 2)])
    assert_type(jostle.scenes.create("pile", 100), World)


def contradictions(points: list[tuple[float, float]], boxes: NDArray[np.float64]) -> None:
    jostle.find_pairs(boxes=boxes)
    jostle.find_pairs(None, 1.0, boxes=boxes)
    jostle.find_pairs(points, boxes=boxes)  # type: ignore[call-overload]
    jostle.find_pairs(half_sizes=1.0, boxes=boxes)  # type: ignore[call-overload]
    jostle.find_pairs(radii=1.0)  # type: ignore[call-overload]
    assert_type(Quadtree(boxes=boxes), Quadtree)
    Quadtree(points, boxes=boxes)  # type: ignore[call-overload]
    Quadtree()  # type: ignore[call-overload]
    space = jostle.Space()
    space.set(0, boxes=(0, 0, 1, 1))
    space.add(points, boxes=boxes)  # type: ignore[call-overload]
