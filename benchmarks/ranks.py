"""Ranks of MPI compared with threads of one process: the time of a step, and memory.

    mpiexec -n 2 .venv/bin/python benchmarks/ranks.py
    mpiexec -n 2 .venv/bin/python benchmarks/ranks.py --memory

The first command simulates the same gas distributed over the ranks, and in one process with as
many threads. The two take turns, and their final states are compared. This is done twice, with
the worlds made in both orders. The second command prints how
much memory a rank needs for each of its particles. With more ranks than cores, set
MPIR_CVAR_POLLS_BEFORE_YIELD=1 (MPICH).
"""

from __future__ import annotations

import argparse
import math
import resource
import statistics
import time
from collections.abc import Callable

from mpi4py import MPI

import jostle
import jostle.mpi

COMM = MPI.COMM_WORLD

#: Seconds of a step.
STEP = 1 / 60

#: Seconds between two tests of the barrier by a waiting rank, which sleeps meanwhile.
POLL = 0.01


def wait_without_work() -> None:
    """Wait for all ranks; the others have all cores."""
    request = COMM.Ibarrier()
    while not request.Test():
        time.sleep(POLL)


def seconds(work: Callable[[], None]) -> float:
    """The time that work takes."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def memory() -> int:
    """The largest memory that this process has had, in bytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def measure_memory(options: argparse.Namespace) -> None:
    """Print the memory for each particle of a rank."""
    before = memory()
    world = jostle.mpi.create_scene(COMM, options.scene, n=options.n, seed=1)
    world.step(STEP, options.steps * options.rounds)
    used = COMM.gather((memory() - before) / max(len(world), 1))
    if used is not None:
        print(f"{options.scene} of {options.n:,}: {max(used):.0f} bytes for a particle of a rank")


def compare(options: argparse.Namespace, is_one_first: bool) -> tuple[float, float]:
    """Milliseconds of a step on all ranks, and of one process with as many threads.

    Of two equal worlds of a million discs in one process, the one that was made first took
    3 % longer.
    """
    worlds: dict[str, jostle.World | jostle.mpi.World] = {}
    for kind in ("one", "ranks") if is_one_first else ("ranks", "one"):
        if kind == "ranks":
            worlds[kind] = jostle.mpi.create_scene(COMM, options.scene, n=options.n, seed=1)
        elif COMM.rank == 0:
            worlds[kind] = jostle.scenes.create(options.scene, n=options.n, seed=1)
            worlds[kind].threads = options.threads or COMM.size
    times: dict[str, list[float]] = {"ranks": [], "one": [0.0]}
    for _ in range(options.rounds + 1):
        COMM.Barrier()
        times["ranks"].append(seconds(lambda: worlds["ranks"].step(STEP, options.steps)))
        if COMM.rank == 0:
            times["one"].append(seconds(lambda: worlds["one"].step(STEP, options.steps)))
        wait_without_work()
    state = worlds["ranks"].state_hash()
    are_equal = COMM.bcast(COMM.rank > 0 or state == worlds["one"].state_hash())
    assert are_equal, "the states differ"
    # The first round is a warm-up.
    ours, theirs = (
        1e3 / options.steps * statistics.median(of[-options.rounds :]) for of in times.values()
    )
    return ours, theirs


def measure_time(options: argparse.Namespace) -> None:
    """Print the times of a step on all ranks, and of one process with as many threads."""
    both = [compare(options, is_one_first) for is_one_first in (True, False)]
    if COMM.rank > 0:
        return
    ours, theirs = (math.sqrt(first * second) for first, second in zip(*both, strict=True))
    threads = options.threads or COMM.size
    print(f"{options.scene} of {options.n:,}, ms per step, median of {options.rounds} rounds,")
    print("geometric mean of both orders of making the worlds:")
    print(f"  {COMM.size} ranks {ours:.1f}, one process with {threads} threads {theirs:.1f}")
    print(f"  ranks have {theirs / ours:.2f} times the speed of threads")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="gas", help="scene")
    parser.add_argument("-n", type=int, default=1_000_000, help="number of particles")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--steps", type=int, default=5, help="steps of a round")
    parser.add_argument(
        "--threads", type=int, help="threads of the one process; default: the ranks"
    )
    parser.add_argument("--memory", action="store_true", help="measure memory instead of time")
    options = parser.parse_args()
    (measure_memory if options.memory else measure_time)(options)


main()
