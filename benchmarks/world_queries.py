"""Times the first query of a world after a step, and the next ones.

    python benchmarks/world_queries.py

The first builds a tree of the particles that are awake: all of them, or 1 %. The next use it, one
ray in a call or 1,000.
"""

import time
from collections.abc import Callable
from statistics import median

import numpy as np

import jostle

ROUNDS, RAYS, STEP = 11, 1000, 1 / 60


def seconds(call: Callable[[], object]) -> float:
    """Return how long a call takes."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def shelves(n: int) -> jostle.World:
    """Return discs that sleep on shelves, and cover 30 % of a box."""
    columns = int(np.ceil(np.sqrt(n)))
    spacing = float(np.sqrt(np.pi * 0.25 / 0.3))
    places, side = np.arange(n), columns * spacing
    levels = np.arange(columns) * spacing
    world = jostle.World(
        np.stack([(places % columns + 0.5) * spacing, levels[places // columns] + 0.5], axis=1),
        0.5,
        restitution=0.5,
        friction=0.5,
        gravity=(0, -10),
        container=jostle.Box(0, 0, side, side),
        # Rays with the mask 1 do not see them.
        walls={"segments": [((0, y), (side, y)) for y in levels], "categories": 2},
    )
    while not world.asleep.all():
        world.step(STEP, steps=10)
    return world


def measure(world: jostle.World, awake: float) -> str:
    """Return one line of the table; a share of the discs is awake."""
    n, side = len(world), world.container.bounds[2]
    rng = np.random.default_rng(1)
    moving = rng.permutation(world.ids)[: max(1, int(awake * n))]
    origins, directions = rng.uniform(0, side, (RAYS, 2)), rng.normal(size=(RAYS, 2))
    rays = list(zip(origins, directions, strict=True))
    first, one, many = [], [], []
    for _ in range(ROUNDS):
        world.set(moving, velocities=rng.normal(size=(len(moving), 2)))
        world.step(STEP)
        first.append(seconds(lambda: world.raycast((1, 1), (1, 1), mask=1)))
        one.append(seconds(lambda: [world.raycast(*ray, mask=1) for ray in rays]) / RAYS)
        many.append(seconds(lambda: world.raycast(origins, directions, mask=1)) / RAYS)
    times = (1e3 * median(first), 1e6 * median(one), 1e6 * median(many))
    share = 1 - world.asleep.mean()
    return (
        "{:9,} discs, {:4.0%} awake: first {:.2f} ms, next {:.1f} µs, in one call {:.2f} µs".format(
            n, share, *times
        )
    )


if __name__ == "__main__":
    for n in (10_000, 100_000, 1_000_000):
        for awake in (0.01, 1.0):
            print(measure(shelves(n), awake), flush=True)
