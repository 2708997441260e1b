"""What the core writes of particles, and of the impulses that it keeps from step to step."""

from __future__ import annotations

import numpy as np

#: A particle.
RECORD = np.dtype(
    [
        ("id", "<i8"),
        ("angle", "<f8"),
        ("position", "<f4", 2),
        ("residual", "<f4", 2),
        ("velocity", "<f4", 2),
        ("radius", "<f4"),
        ("mass", "<f4"),
        ("restitution", "<f4"),
        ("friction", "<f4"),
        ("angular_velocity", "<f4"),
        ("category", "<u4"),
        ("mask", "<u4"),
        ("movable", "?"),
        ("sensor", "?"),
        ("kinds", "u1", 2),
    ]
)

#: Impulses of the sides of the container on a particle, and of their friction.
SIDES = np.dtype([("id", "<i8"), ("impulses", "<f4", (2, 4))])

#: Impulses of a resting contact; the smaller id is first.
RESTING = np.dtype([("id", "<i8"), ("other", "<i8"), ("impulses", "<f4", 2)])

#: Impulses of a wall on a particle at rest.
PUSH = np.dtype([("id", "<i8"), ("wall", "<u4"), ("impulses", "<f4", 2)])

#: All parts of the state, each with an `id` by which it is distributed.
PARTS = (RECORD, SIDES, RESTING, PUSH)
