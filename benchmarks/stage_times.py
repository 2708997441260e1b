"""Time of each stage of a step, on one thread.

    python benchmarks/run.py stage-times plot

The core times its own stages (`world.profile`). Each row is the median of one stage over all timed
steps; the sum of the rows of a scene is nearly the median of a step. `stages.py` counts the
instructions of the stages.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterator

import numpy as np
import step_rivals
from machine import Row

import jostle

FRAME = step_rivals.FRAME
STEPS = 10
"""Timed steps in a round."""

FALL = 0.5
"""Seconds that a frame of a falling pile may take; a slower pile is omitted."""


def gas(count: int) -> jostle.World:
    """Return elastic discs over 40 % of a box, after a second."""
    return settled(jostle.scenes.create("gas", n=count), 60)


def falling_gas(count: int) -> jostle.World:
    """Return the same discs with gravity and a restitution of 0.9, after a second."""
    world = jostle.scenes.create("gas", n=count)
    world.gravity, world.restitution = (0.0, 200.0), 0.9
    return settled(world, 60)


def balls(count: int) -> jostle.World:
    """Return the balls of `examples/02_ten_thousand_balls.py`, after two seconds."""
    scale = math.sqrt(count / 10_000)
    rng = np.random.default_rng(2)
    world = jostle.World(
        rng.uniform((4, 4), (800 * scale - 4, 500 * scale - 4), (count, 2)),
        rng.uniform(2, 3, count),
        gravity=(0, 200),
        restitution=0.5,
        container=jostle.Box(0, 0, 800 * scale, 500 * scale),
    )
    return settled(world, 120)


def pile(count: int) -> jostle.World | None:
    """Return a pile at rest, None if its fall takes too long."""
    start = step_rivals.pile(count, FALL)
    if start is None:
        return None
    return settled(step_rivals.resumed(start, 1), 60)


def settled(world: jostle.World, steps: int) -> jostle.World:
    """Step a world on one thread; nothing falls asleep."""
    world.threads, world.sleeping = 1, False
    world.step(FRAME, steps)
    return world


SCENES: list[tuple[str, int, Callable[[int], jostle.World | None]]] = [
    ("elastic gas", 10_000, gas),
    ("falling gas", 10_000, falling_gas),
    ("settling balls", 10_000, balls),
    ("pile", 1_000, pile),
    ("pile", 10_000, pile),
]
"""Name, number of discs and world of each scene."""


def race(rounds: int, largest: int, told: Callable[[str], None]) -> Iterator[list[Row]]:
    """Yield rows of the stages of each scene.

    Parameters
    ----------
    rounds : int
        Number of rounds of `STEPS` steps.
    largest : int
        Scenes with more discs get this number.
    told : callable
        Called with a description of the progress.
    """
    sizes = {(name, min(count, largest)): make for name, count, make in SCENES}
    for (name, count), make in sizes.items():
        told(f"{name}, {count:,}")
        world = make(count)
        if world is not None:
            yield rows(name, world, rounds)


def rows(name: str, world: jostle.World, rounds: int) -> list[Row]:
    """Return a row for each stage."""
    steps = [stages(world) for _ in range(rounds * STEPS)]
    return [
        {
            "scene": name,
            "count": len(world),
            "version": jostle.__version__,
            "threads": 1,
            "substeps": world.last_step.substeps,
            "stage": stage,
            "rounds": len(steps),
            "median_s": f"{1e-3 * statistics.median(step[stage] for step in steps):.4g}",
        }
        for stage in steps[0]
    ]


def stages(world: jostle.World) -> dict[str, float]:
    """Return the milliseconds of each stage of one step."""
    world.step(FRAME)
    return world.profile
