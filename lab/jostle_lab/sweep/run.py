"""One run of a sweep."""

import time
from typing import Any

import numpy as np

import jostle
from jostle_lab.schema import Settings
from jostle_lab.simulate.start import start

from .measures import MEASURES
from .plan import Run

#: Duration of a step, as of all scenes.
_DT = 1 / 60


def world_of(run: Run) -> jostle.World:
    """Return the world of a run at its beginning."""
    given: dict[str, Any] = {"n": run.n, **dict(run.settings)}
    speed = given.pop("speed", 1.0)
    # Each process has one thread, because there is a process for each core.
    world = start(Settings(run.scene, seed=run.seed, threads=1, **given)).world
    world.velocities = world.velocities * speed
    return world


def do(run: Run) -> dict[str, str]:
    """Simulate a run; returns its row of the table."""
    begun = time.perf_counter()
    world = world_of(run)
    world.step(_DT, run.warm_up)
    values: dict[str, list[float]] = {name: [] for name in run.measures}
    for step in range(run.steps):
        world.step(_DT)
        for name, seen in values.items():
            measure, every = MEASURES[name]
            if step % every == 0:
                seen.append(measure(world, _DT))
    found = {name: repr(float(np.mean(seen))) for name, seen in values.items()}
    seconds = f"{time.perf_counter() - begun:.3f}"
    return {**run.key, **found, "hash": f"{world.state_hash():016x}", "seconds": seconds}
