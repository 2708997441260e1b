"""The time of the stages of a step on all ranks, and that of waiting and communication."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

import jostle.mpi

WAITING = "waiting, communication"


@dataclass(frozen=True)
class Span:
    """Milliseconds of a step: the mean of all ranks, and the longest."""

    mean: float
    longest: float


class StageTimes:
    """Adds up the times of steps on this rank."""

    def __init__(self, world: jostle.mpi.World) -> None:
        self._world = world
        self.steps = 0
        self._sums: dict[str, float] = {}
        self._begun = world.traffic

    def add(self, seconds: float) -> None:
        """Add the last step, which took so long."""
        self.steps += 1
        for name, milliseconds in {"step": seconds * 1e3, **self._world.profile}.items():
            self._sums[name] = self._sums.get(name, 0.0) + milliseconds

    def traffic(self) -> dict[str, float]:
        """Return what this rank has sent in a step, on average."""
        now = self._world.traffic
        return {name: (now[name] - self._begun[name]) / max(self.steps, 1) for name in now}

    def of_ranks(self, comm: MPI.Intracomm) -> dict[str, Span]:
        """Return the time of each stage; all ranks call this together."""
        own = {name: total / max(self.steps, 1) for name, total in self._sums.items()}
        own[WAITING] = self.traffic()["seconds"] * 1e3
        # A rank without particles may lack a stage.
        names = list(dict.fromkeys(name for of in comm.allgather(list(own)) for name in of))
        times = np.array([own.get(name, 0.0) for name in names])
        sums, longest = np.empty_like(times), np.empty_like(times)
        comm.Allreduce(times, sums, op=MPI.SUM)
        comm.Allreduce(times, longest, op=MPI.MAX)
        return {
            name: Span(float(total) / comm.size, float(most))
            for name, total, most in zip(names, sums, longest, strict=True)
        }
