"""Work, messages and imbalance of distributed worlds on ranks that are simulated in one process.

It predicts the time of real ranks from them.

    python benchmarks/scaling.py                  # a gas of 100,000, 1 to 256 ranks
    python benchmarks/scaling.py -n 300000 --ranks 2 4 --steps 8
    python benchmarks/scaling.py --scene pile -n 300 --ranks 1 2 4 --steps 20
    python benchmarks/scaling.py --alone -n 300000 --steps 8

The CPU time of each rank is that of its thread, about that of a rank with a core of its own.
Predictions add messages, by the assumptions below. `--alone` compares one rank with `jostle.World`.
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
CALL = 3e-6
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


def measure(comm: SimulatedComm, options: argparse.Namespace) -> Measured:
    """Step a scene, of which each rank has made its particles."""
    name, n, steps = options.scene, options.n, options.steps
    world = jostle.mpi.create_scene(comm, name, n=n, seed=1, sleeping=False)
    for _ in range(options.warm_up):
        step_evenly(world)
    before, start, in_calls = world.traffic, time.thread_time(), comm.seconds
    own = ghosts = 0
    for _ in range(steps):
        step_evenly(world)
        own, ghosts = own + len(world), ghosts + world.ghosts
    seconds = time.thread_time() - start - (comm.seconds - in_calls)
    of = {name: (world.traffic[name] - before[name]) / steps for name in before}
    return Measured(
        *(own / steps, ghosts / steps, of["calls"], of["messages"], of["bytes"]),
        *(seconds / steps, of["repeats"]),
    )


def step_evenly(world: jostle.mpi.World) -> None:
    """Make a step; domains have equal numbers of particles, because threads disturb each other."""
    world.step(DT)
    world._core._set_work(1.0)


def compare_alone(options: argparse.Namespace) -> None:
    """Print the CPU time of a step of one rank and of `jostle.World`, interleaved."""

    def one(comm: SimulatedComm) -> None:
        whole = jostle.scenes.create(options.scene, n=options.n, seed=1)
        whole.sleeping, whole.threads = False, 1
        ours = jostle.mpi.create_scene(comm, options.scene, n=options.n, seed=1, sleeping=False)
        spent: dict[str, list[float]] = {"World": [], "one rank": []}
        for step in range(options.warm_up + options.steps):
            for name, world in (("World", whole), ("one rank", ours)):
                start = time.thread_time()
                world.step(DT)
                if step >= options.warm_up:
                    spent[name].append(time.thread_time() - start)
        for name, seconds in spent.items():
            print(f"{name:9} {1e3 * np.median(seconds):9.2f} ms of CPU time a step")

    Ranks(1).run(one)


def predicted(all_ranks: list[Measured], size: int) -> float:
    """Seconds of a step: the slowest rank, the calls and the messages."""
    slowest = max(rank.seconds for rank in all_ranks)
    rank = max(all_ranks, key=lambda rank: rank.size)
    stages = math.log2(size) if size > 1 else 0.0
    calls = rank.calls * (CALL + LATENCY * stages)
    return slowest + calls + rank.messages * LATENCY + rank.size / BANDWIDTH


def print_predictions(first: list[Measured], found: list[Measured], size: int) -> None:
    """Print weak and strong scaling, from the work in the first run and the messages in the last.

    With many ranks the threads disturb each other, so their work is not that of real ranks.
    """
    own, ghosts = (
        float(np.mean([getattr(rank, name) for rank in found])) for name in ("own", "ghosts")
    )
    work = sum(rank.seconds for rank in first) / sum(rank.own + rank.ghosts for rank in first)
    along = ghosts / math.sqrt(own)
    calls, messages = found[0].calls, float(np.mean([rank.messages for rank in found]))
    a_ghost = float(np.mean([rank.size for rank in found])) / max(ghosts, 1.0)
    print(
        f"\npredicted from {size} ranks: {1e6 * work:.2f} µs of work a particle, "
        f"{along:.1f} √n ghosts, {a_ghost:.0f} bytes each, {calls:.0f} calls, "
        f"{messages:.0f} messages\nassumed: {LATENCY:.0e} s a message, {CALL:.0e} s a call, "
        f"{BANDWIDTH:.0e} bytes per second"
    )
    print(" ranks     weak, 1,000,000 each         strong, 1,000,000 in all")
    print("              ms   efficiency         own   ghosts         ms   efficiency")

    def step(n: float, ranks: int) -> tuple[float, float]:
        near = along * math.sqrt(n) if ranks > 1 else 0.0
        stages = math.log2(ranks) if ranks > 1 else 0.0
        waits = calls * (CALL + LATENCY * stages) if ranks > 1 else 0.0
        sent = messages * LATENCY + near * a_ghost / BANDWIDTH if ranks > 1 else 0.0
        return work * (n + near) + waits + sent, near

    alone, _ = step(1e6, 1)
    for ranks in (1, 4, 16, 64, 256, 1000):
        weak, _ = step(1e6, ranks)
        strong, near = step(1e6 / ranks, ranks)
        print(
            f"{ranks:6} {1e3 * weak:10.2f} {alone / weak:12.3f} {1e6 / ranks:11.0f} {near:8.0f} "
            f"{1e3 * strong:10.3f} {alone / (ranks * strong):12.3f}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="gas", help="scene")
    parser.add_argument("-n", type=int, default=100_000, help="number of particles")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4, 16, 64, 256])
    parser.add_argument("--steps", type=int, default=5)
    parser.add_argument("--warm-up", type=int, default=35)
    parser.add_argument("--alone", action="store_true", help="compare one rank with jostle.World")
    options = parser.parse_args()
    if options.alone:
        compare_alone(options)
        return
    print(
        "ranks      own   ghosts largest/mean calls messages  KiB  repeats  CPU ms  "
        "predicted ms  efficiency"
    )
    alone, first = None, []
    for size in options.ranks:
        found = Ranks(size).run(lambda comm: measure(comm, options))
        own = np.array([rank.own for rank in found])
        seconds = predicted(found, size)
        alone, first = alone or seconds * size, first or found
        print(
            f"{size:5} {own.mean():8.0f} {np.mean([r.ghosts for r in found]):8.0f} "
            f"{own.max() / own.mean():6.3f} {found[0].calls:6.1f} "
            f"{np.mean([r.messages for r in found]):6.1f} "
            f"{np.mean([r.size for r in found]) / 1024:9.1f} {found[0].repeats:6.2f} "
            f"{1e3 * max(r.seconds for r in found):9.3f} {1e3 * seconds:9.3f} "
            f"{alone / (seconds * size):6.2f}",
            flush=True,
        )
    if found[0].ghosts:
        print_predictions(first, found, options.ranks[-1])


if __name__ == "__main__":
    main()
