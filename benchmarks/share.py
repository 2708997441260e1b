"""The share of the binding and of Python in the time of a call.

The core times a step, stage by stage. The rest of the call, and the copy of the positions, belong
to the binding and Python. `find_pairs` has no such profile: its share is estimated by the same call
for a single shape, and a copy of its arrays and its answer by NumPy.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator
from functools import partial

import numpy as np
import shapes
from machine import Row
from timing import interleaved

import jostle

COUNTS = (1, 10, 100, 1_000, 10_000, 100_000)
STEP = 1 / 60


def race(rounds: int, largest: int) -> Iterator[list[Row]]:
    """Yield rows of the whole time and of the share of Python."""
    for count in (count for count in COUNTS if count <= largest):
        yield [of_step(count, 10 * rounds), of_pairs(count, rounds)]


def of_step(count: int, rounds: int) -> Row:
    """Time steps, and read their profile."""
    world = jostle.scenes.create("gas", n=count)
    world.threads = 1
    world.step(STEP, 60)
    whole, outside = [], []
    for _ in range(rounds):
        start = time.perf_counter()
        world.step(STEP)
        _positions = world.positions
        whole.append(time.perf_counter() - start)
        outside.append(whole[-1] - sum(world.profile.values()) / 1e3)
    return row("step and positions", count, statistics.median(whole), statistics.median(outside))


def of_pairs(count: int, rounds: int) -> Row:
    """Time a search, a search with a single shape, and the copies."""
    scene = shapes.create("discs", count)
    centers, radii = scene.centers.astype(np.float32), scene.column().astype(np.float32)
    search = partial(jostle.find_pairs, threads=1)
    answer = search(centers, radii)

    def copies() -> object:
        return centers.copy(), radii.copy(), answer.copy()

    whole, single, copied = interleaved(
        [partial(search, centers, radii), partial(search, centers[:1], radii[:1]), copies], rounds
    )
    return row("find_pairs", count, whole.median, single.median + copied.median)


def row(call: str, count: int, whole: float, outside: float) -> Row:
    """Return a row of the results."""
    return {
        "call": call,
        "count": count,
        "version": jostle.__version__,
        "whole_s": f"{whole:.4g}",
        "python_s": f"{outside:.4g}",
        "share": f"{min(1.0, outside / whole):.3f}",
    }
