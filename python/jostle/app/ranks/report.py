"""The table after a run over ranks."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from rich.table import Table

import jostle.mpi
from jostle.app.draw.text import plural
from jostle.app.ranks.stages import StageTimes


def report(
    comm: MPI.Intracomm, title: str, world: jostle.mpi.World, times: StageTimes, seconds: float
) -> Table:
    """Return the numbers of a run; all ranks call this together, and rank 0 prints it."""
    spans, state = times.of_ranks(comm), world.state_hash()
    traffic = times.traffic()
    own = np.array([len(world), world.ghosts, traffic["messages"], traffic["bytes"] / 1024])
    of_ranks = np.array(comm.allgather(own))
    particles, ghosts, messages, kib = of_ranks.T
    rate = times.steps / seconds if seconds else 0.0
    table = Table(title=title, title_style="bold")
    table.add_column()
    table.add_column("mean of ranks", justify="right")
    table.add_column("largest", justify="right")
    rows = [
        ("particles", f"{particles.mean():,.0f}", f"{particles.max():,.0f}"),
        ("ghosts", f"{ghosts.mean():,.0f}", f"{ghosts.max():,.0f}"),
        ("calls a step", f"{traffic['calls']:,.1f}", ""),
        ("messages a step", f"{messages.mean():,.1f}", f"{messages.max():,.1f}"),
        ("KiB a step", f"{kib.mean():,.1f}", f"{kib.max():,.1f}"),
        ("repeats a step", f"{traffic['repeats']:.2f}", ""),
    ]
    stages = [
        (f"{name}, ms", f"{of.mean:,.2f}", f"{of.longest:,.2f}") for name, of in spans.items()
    ]
    whole = [
        ("steps", f"{times.steps:,}", f"{rate:,.1f} a second"),
        ("all particles", f"{world.total:,}", plural(comm.size, "rank")),
        ("state hash", f"{state:016x}", f"at {world.time:.3f} s"),
    ]
    for part in (whole, rows, stages):
        table.add_section()
        for row in part:
            table.add_row(*row)
    return table
