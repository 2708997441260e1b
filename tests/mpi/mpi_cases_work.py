"""How much ranks do: calls, domains and communicators."""

from typing import Any

import numpy as np
from mpi4py import MPI
from mpi_worlds import comm, evenly, gas, on_first, scattered

import jostle
import jostle.mpi


def test_rebalancing() -> None:
    """Domains are chosen again when a rank has too much work, and results do not depend on it."""
    world = gas(600, velocities=np.zeros((600, 2)))
    ours = scattered(world, on_first)

    def steps(count: int, work: float) -> int:
        for _ in range(count):
            ours._core._set_work(work)
            ours._core._step_distributed(1 / 60)
        world.step(1 / 60, count)
        assert ours.state_hash() == world.state_hash()
        numbers = comm().allgather(ours.traffic["rebalances"])
        assert min(numbers) == max(numbers)
        return int(numbers[0])

    assert steps(40, 1.0) == 1
    even = len(ours)
    assert comm().size == 1 or abs(even - 600 / comm().size) < 60
    slow = comm().rank == 0
    count = steps(60, 3.0 if slow else 1.0)
    assert count == 1 if comm().size == 1 else 2 <= count <= 5, count
    assert comm().size == 1 or (len(ours) < even - 30) == slow


def test_many() -> None:
    """MPI has a limited number of communicators; worlds use it up neither now nor later."""
    for ranks in (comm(), MPI.COMM_SELF):
        for _ in range(1100):
            jostle.mpi.World(ranks, [], [], velocities=[])


def test_calls() -> None:
    """The numbers of calls of a step in docs/mpi.md."""
    size = comm().size
    sparse: dict[str, Any] = {"n": 200, "cover": 0.1}
    for container, calls in (("box", 16), (None, 17), ("torus", 19)):
        options: dict[str, Any] = {} if container == "box" else {"container": container}
        world = scattered(gas(**sparse, **options), evenly)
        world._core._rebalance_every(1000)
        counts = []
        for _ in range(3):
            before = world.traffic["calls"]
            world.step(1 / 600)
            counts.append(world.traffic["calls"] - before)
        assert size == 1 or counts == [calls + 18, calls, calls], (container, counts)
