"""Small worlds for the tests of `jostle.World`, and values of its columns and settings."""

from typing import Any

import numpy as np

import jostle

COLUMNS = ["positions", "velocities", "radii", "masses", "restitution", "movable"]
COLUMNS += ["friction", "angles", "angular_velocities"]


def three(**settings: Any) -> jostle.World:
    """Three discs that do not touch; the last is immovable."""
    arguments: dict[str, Any] = {
        "positions": [(0, 0), (10, 0), (20, 5)],
        "velocities": [(1, 0), (0, 2), (0, 0)],
        "radii": [1, 2, 3],
        "movable": [True, True, False],
    }
    return jostle.World(**{**arguments, **settings})


def columns(world: jostle.World) -> dict[str, Any]:
    return {name: getattr(world, name).copy() for name in COLUMNS}


def gas(n: int = 400, **settings: Any) -> jostle.World:
    """Discs of radius 0.5 that collide a lot."""
    rng = np.random.default_rng(3)
    side = np.sqrt(n * np.pi * 0.25 / 0.4)
    walls = jostle.Box(0, 0, side + 2, side + 2)
    positions, velocities = rng.uniform(1, side + 1, (n, 2)), rng.normal(size=(n, 2))
    return jostle.World(positions, 0.5, velocities=velocities, container=walls, **settings)


NEW = {
    "positions": [(1, 1), (11, 1), (21, 6)],
    "velocities": [(5, 5), (6, 6), (0, 0)],
    "radii": [0.5, 0.25, 0.125],
    "masses": [3, 2, 1],
    "restitution": [0, 0.5, 1],
    "movable": [True, False, False],
    "friction": [0.5, 0, 2],
    "angles": [1, -2, 3],
    "angular_velocities": [-1, 7, 0],
}

SETTINGS: dict[str, tuple[Any, Any]] = {
    "drag": (0, 0.3),
    "container": (None, jostle.Box(-50, -50, 50, 50)),
    "on_touch": ("bounce", "merge"),
    "method": ("quadtree", "brute"),
    "threads": (None, 2),
    "leaf_capacity": (jostle.World().leaf_capacity, 5),
    "max_depth": (4096, 3),
}
