"""The time of the stages of a step on all ranks, of waiting and communication; their table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from rich.table import Column, Table

import jostle.mpi
from jostle_lab.draw.text import plural

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
        self._seconds = 0.0  # of all steps
        self._sums: dict[str, float] = {}
        self._begun = world.traffic

    def add(self, seconds: float) -> None:
        """Add the last step, which took so long."""
        self.steps += 1
        self._seconds += seconds
        for name, milliseconds in {"step": seconds * 1e3, **self._world.profile}.items():
            self._sums[name] = self._sums.get(name, 0.0) + milliseconds

    @property
    def rate(self) -> float | None:
        """Return the steps per second; None before the first."""
        return self.steps / self._seconds if self._seconds else None

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


def report(comm: MPI.Intracomm, title: str, world: jostle.mpi.World, times: StageTimes) -> Table:
    """Return the numbers of a run; all ranks call this together, and rank 0 prints it."""
    spans, state = times.of_ranks(comm), world.state_hash()
    traffic = times.traffic()
    own = np.array([len(world), world.ghosts, traffic["messages"], traffic["bytes"] / 1024])
    of_ranks = np.array(comm.allgather(own))
    particles, ghosts, messages, kib = of_ranks.T
    columns = (Column(name, justify="right") for name in ("mean of ranks", "largest"))
    table = Table("", *columns, title=title, title_style="bold")
    rows = [
        ("particles", f"{particles.mean():,.0f}", f"{particles.max():,.0f}"),
        ("ghosts", f"{ghosts.mean():,.0f}", f"{ghosts.max():,.0f}"),
        ("calls per step", f"{traffic['calls']:,.1f}", ""),
        ("messages per step", f"{messages.mean():,.1f}", f"{messages.max():,.1f}"),
        ("KiB per step", f"{kib.mean():,.1f}", f"{kib.max():,.1f}"),
        ("repeats per step", f"{traffic['repeats']:.2f}", ""),
    ]
    stages = [
        (f"{name}, ms", f"{of.mean:,.2f}", f"{of.longest:,.2f}") for name, of in spans.items()
    ]
    whole = [
        ("steps", f"{times.steps:,}", f"{times.rate or 0.0:,.1f} per second"),
        ("all particles", f"{world.total:,}", plural(comm.size, "rank")),
        ("state hash", f"{state:016x}", f"at {world.time:.3f} s"),
    ]
    for part in (whole, rows, stages):
        table.add_section()
        for row in part:
            table.add_row(*row)
    return table
