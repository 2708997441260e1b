"""Work, messages and imbalance of distributed worlds on ranks that are simulated in one process.

It predicts the time of real ranks from them.

    python benchmarks/scaling.py                  # a gas of 100,000, ranks up to 64
    python benchmarks/scaling.py -n 1000000 --ranks 1 4 16

The CPU time of each rank is that of its thread, about that of a rank with a core of its own.
Predictions add messages, by the assumptions below.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass

import numpy as np
from simulated_ranks import Ranks, SimulatedComm

import jostle
import jostle.mpi

DT = 1 / 60

# Assumptions of the predictions: a cluster with InfiniBand, one rank on each core.
LATENCY = 2e-6
"""Seconds of a message, and of each of the log2(ranks) stages of a call of all ranks."""
CALL = 10e-6
"""Seconds that a call costs in Python, whatever its size."""
BANDWIDTH = 1e9
"""Bytes in a second for each rank, when all cores of a node send."""


@dataclass
class Measured:
    """The mean of a step on one rank."""

    own: float
    ghosts: float
    calls: float
    messages: float
    size: float
    seconds: float
    repeats: float


def measure(comm: SimulatedComm, n: int, steps: int, warm_up: int) -> Measured:
    """Step a gas; the shares of the ranks are columns of its box."""
    whole = jostle.scenes.create("gas", n=n, seed=1)
    mine = np.arange(n) * comm.size // n == comm.rank
    world = jostle.mpi.World(
        comm,
        whole.positions[mine],
        whole.velocities[mine],
        whole.radii[mine],
        masses=whole.masses[mine],
        restitution=whole.restitution,
        container=whole.container,
    )
    del whole
    for _ in range(warm_up):
        world.step(DT)
        world._core._set_work(1.0)
    before, start, in_calls = world.traffic, time.thread_time(), comm.seconds
    own = ghosts = 0
    for _ in range(steps):
        world.step(DT)
        # Threads disturb each other, so domains have equal numbers of particles instead.
        world._core._set_work(1.0)
        own, ghosts = own + len(world), ghosts + world.ghosts
    seconds = time.thread_time() - start - (comm.seconds - in_calls)
    of = {name: (world.traffic[name] - before[name]) / steps for name in before}
    return Measured(
        *(own / steps, ghosts / steps, of["calls"], of["messages"], of["bytes"]),
        *(seconds / steps, of["repeats"]),
    )


def predicted(all_ranks: list[Measured], size: int) -> float:
    """Seconds of a step: the slowest rank, the calls and the messages."""
    slowest = max(rank.seconds for rank in all_ranks)
    rank = max(all_ranks, key=lambda rank: rank.size)
    stages = math.log2(size) if size > 1 else 0.0
    calls = rank.calls * (CALL + LATENCY * stages)
    return slowest + calls + rank.messages * LATENCY + rank.size / BANDWIDTH


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, default=100_000, help="number of particles")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4, 8, 16, 32, 64])
    parser.add_argument("--steps", type=int, default=10)
    parser.add_argument("--warm-up", type=int, default=35)
    options = parser.parse_args()
    print(
        "ranks      own   ghosts largest/mean calls messages  KiB  repeats  CPU ms  "
        "predicted ms  efficiency"
    )
    alone = None
    for size in options.ranks:
        found = Ranks(size).run(
            lambda comm: measure(comm, options.n, options.steps, options.warm_up)
        )
        own = np.array([rank.own for rank in found])
        seconds = predicted(found, size)
        alone = alone or seconds * size
        print(
            f"{size:5} {own.mean():8.0f} {np.mean([r.ghosts for r in found]):8.0f} "
            f"{own.max() / own.mean():6.3f} {found[0].calls:6.1f} "
            f"{np.mean([r.messages for r in found]):6.1f} "
            f"{np.mean([r.size for r in found]) / 1024:9.1f} {found[0].repeats:6.2f} "
            f"{1e3 * max(r.seconds for r in found):9.3f} {1e3 * seconds:9.3f} "
            f"{alone / (seconds * size):6.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
