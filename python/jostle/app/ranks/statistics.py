"""Statistics of the values of all ranks."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from jostle.app.draw.colouring import Statistics


class StatisticsOfRanks(Statistics):
    """As `Statistics`, over all ranks, which call its methods together."""

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm

    def extremes(self, values: NDArray[np.floating]) -> tuple[float, float] | None:
        own = [-np.inf, -np.inf]
        if len(values):
            own = [-float(values.min()), float(values.max())]
        largest = np.empty(2)
        self._comm.Allreduce(np.array(own), largest, op=MPI.MAX)
        return None if largest[1] == -np.inf else (-float(largest[0]), float(largest[1]))

    def mean(self, values: NDArray[np.floating]) -> float:
        sums = np.empty(2)
        own = np.array([values.sum(dtype=np.float64), len(values)])
        self._comm.Allreduce(own, sums, op=MPI.SUM)
        return float(sums[0] / max(sums[1], 1.0))
