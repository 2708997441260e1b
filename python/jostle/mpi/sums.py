"""Exact sums over ranks: the same for every distribution of the numbers."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .exchange import totals

#: The exponents of float64, those of subnormal numbers included.
_LOWEST, _HIGHEST = -1080, 1030


def exact_sum(comm: MPI.Intracomm, numbers: NDArray[np.float64]) -> float:
    """The sum of the numbers of all ranks, rounded once."""
    mantissas, exponents = np.frexp(numbers)
    whole = np.ldexp(mantissas, 53).astype(np.int64)
    bins = exponents - _LOWEST
    counts = _HIGHEST - _LOWEST
    # Parts of 27 bits, so that 2³⁶ of them have a sum in int64.
    parts = []
    for part in (whole >> 27, whole & ((1 << 27) - 1)):
        sums = np.zeros(counts, np.int64)
        np.add.at(sums, bins, part)
        parts.append(totals(comm, sums))
    total = sum(
        ((int(high) << 27) + int(low)) << place
        for place, (high, low) in enumerate(zip(*parts, strict=True))
        if high or low
    )
    shift = 53 - _LOWEST
    # The division of whole numbers is rounded correctly.
    return total / (1 << shift)
