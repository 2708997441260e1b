"""Types of the particles of a world: one or many."""

from typing import Any

import numpy as np
import pygame
from numpy.typing import NDArray
from typing_extensions import assert_type

from jostle import Particle, Particles, World

Ids = NDArray[np.int64]


def added(world: World, places: NDArray[np.float32], points: list[tuple[int, int]]) -> None:
    assert_type(world.add((0, 0), 1, velocities=(1, 0)), int)
    assert_type(world.add([0, 0.5], 1.0, velocities=[0, 0]), int)
    assert_type(world.add(pygame.Vector2(), 1.0, velocities=pygame.Vector2(), friction=0.5), int)
    assert_type(world.add(places, 1.0), Ids)
    assert_type(world.add(points, np.ones(3), velocities=points), Ids)
    assert_type(world.add([(0, 0)], 1.0, movable=False), Ids)
    assert_type(world.add([pygame.Vector2()], 2, velocities=[pygame.Vector2()], masses=2.0), Ids)


def added_of_any_type(world: World, given: dict[str, Any]) -> None:
    assert_type(world.add(np.load("positions.npy"), 1, velocities=np.load("velocities.npy")), Any)
    balls: dict[int, str] = {world.add(given["position"], 1, velocities=given["velocity"]): "ball"}
    print(balls)
    assert_type(world.rows(given["ids"]), Any)


def changed(world: World, id: int, ids: Ids, vector: pygame.Vector2) -> None:
    assert_type(world.ids, Ids)
    assert_type(id in world, bool)
    world.set(id, positions=(0, 1), velocities=vector)
    world.set(ids, positions=[(0, 1), (2, 3)])
    assert_type(world.rows(id), int)
    assert_type(world.rows(ids), Ids)
    assert_type(world.rows([1, 2]), Ids)
    assert_type(world.get(id), Particle)
    assert_type(world.get(ids), Particles)
    assert_type(world.get([1, 2]).radii, NDArray[np.float32])
    world.remove(id)
    world.remove(ids[world.radii < 1])
