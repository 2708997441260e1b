"""One run of a sweep."""

import time

import numpy as np

import jostle

from .measures import MEASURES
from .plan import Run, apply

#: Duration of a step, as of all scenes.
_DT = 1 / 60


def do(run: Run) -> dict[str, str]:
    """Simulate a run; returns its row of the table."""
    start = time.perf_counter()
    world = jostle.scenes.create(run.scene, n=run.n, seed=run.seed)
    # Each process has one thread, because there is a process for each core.
    world.threads = 1
    for name, value in run.settings:
        apply(world, name, value)
    world.step(_DT, run.warm_up)
    values: dict[str, list[float]] = {name: [] for name in run.measures}
    for step in range(run.steps):
        world.step(_DT)
        for name, seen in values.items():
            measure, every = MEASURES[name]
            if step % every == 0:
                seen.append(measure(world, _DT))
    found = {name: repr(float(np.mean(seen))) for name, seen in values.items()}
    seconds = f"{time.perf_counter() - start:.3f}"
    return {**run.key, **found, "hash": f"{world.state_hash():016x}", "seconds": seconds}
