"""What the core writes of particles, and what it keeps of them from step to step."""

from __future__ import annotations

import numpy as np

from jostle._core import record_fields

#: A particle: its fields are named as the columns of worlds.
RECORD = np.dtype([("id", "<i8"), *record_fields()])

#: How a particle has moved, and how many periods it has travelled.
KEPT = np.dtype([("id", "<i8"), ("drift", "<f4", (2, 3)), ("turns", "<i4", 2)])

#: Impulses of a resting contact; the smaller id is first.
RESTING = np.dtype([("id", "<i8"), ("other", "<i8"), ("impulses", "<f4", 2)])

#: Impulses of a wall on a particle, of the step and at rest.
PUSH = np.dtype([("id", "<i8"), ("wall", "<u4"), ("impulses", "<f4", (2, 2))])

#: A sleeping particle, and the smallest id of its island.
MEMBER = np.dtype([("id", "<i8"), ("island", "<i8")])

#: A contact of a sleeping particle.
TOUCH = np.dtype(
    [
        ("id", "<i8"),
        ("other", "<i8"),
        ("island", "<i8"),
        ("categories", "<u4", 2),
        ("rows", "<u4", 2),
        ("image", "<f4", 2),
        ("normal", "<f4", 2),
        ("gap", "<f4"),
        ("impulses", "<f4", 2),
        ("totals", "<f4", 2),
        ("touched", "?"),
        ("is_near", "?"),
    ]
)

#: All parts of the state, each with an `id` by which it is distributed.
PARTS = (RECORD, KEPT, RESTING, PUSH, MEMBER, TOUCH)

#: Those of pairs, which the ranks of both particles have.
PAIRS = tuple(number for number, part in enumerate(PARTS) if "other" in (part.names or ()))
