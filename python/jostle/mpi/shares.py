"""Dividing the plane between ranks by the Morton curve, and the cells that each rank occupies."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .exchange import from_all

#: Cells of a scale along each axis, as the keys divide the plane.
_RESOLUTION = 1 << 26

#: Keys that each rank samples.
_SAMPLES = 1024

#: Quantiles of a scale.
_QUANTILES = 256

#: Coordinates that a rank samples for a scale at least, and that all ranks sample, about.
_FEWEST, _TOGETHER = 64, 8192

#: Rows that a rank sorts for a sample, at most.
_SORTED = 1 << 15


class Scale:
    """A coordinate as a share of all rows: 0 at the smallest, 1 at the largest, monotone between.

    As many rows are in each cell of a scale, so a row far away from all others does not make the
    cells of these larger. `numbers` are the coordinates of this rank's rows.
    """

    def __init__(self, comm: MPI.Intracomm, numbers: NDArray[np.float64]) -> None:
        samples, weights = _samples(comm, numbers, max(_TOGETHER // comm.size, _FEWEST))
        #: The quantiles, ascending.
        self.edges = np.zeros(1)
        if len(samples):
            before = np.cumsum(weights).astype(np.float64)
            wanted = before[0] + (before[-1] - before[0]) * np.linspace(0, 1, _QUANTILES + 1)
            at = np.searchsorted(before, wanted).clip(0, len(samples) - 1)
            self.edges = np.unique(samples[at])

    def shares(self, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        """The share of each coordinate."""
        # A quarter, so that differences are finite.
        shares: NDArray[np.float64] = np.interp(
            numbers * 0.25, self.edges * 0.25, np.linspace(0, 1, len(self.edges))
        )
        return shares


def _samples(
    comm: MPI.Intracomm, numbers: NDArray[Any], count: int
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Ascending samples of the numbers of all ranks, `count` of each rank that has any.

    The weight of each sample is the number of rows of its rank.
    """
    sample = _evenly(numbers, count) if len(numbers) else np.zeros(count, numbers.dtype)
    samples = from_all(comm, sample).reshape(-1)
    weights = np.repeat(from_all(comm, np.array([len(numbers)], np.int64)).reshape(-1), count)
    samples, weights = samples[weights > 0], weights[weights > 0]
    order = np.argsort(samples, kind="stable")
    return samples[order], weights[order]


def _evenly(numbers: NDArray[Any], count: int) -> NDArray[Any]:
    """Evenly spaced ones of some numbers in ascending order."""
    if len(numbers) > _SORTED:
        numbers = numbers[np.random.default_rng(0).integers(0, len(numbers), _SORTED)]
    numbers = np.sort(numbers)
    return numbers[np.linspace(0, len(numbers) - 1, count).astype(np.int64)]


def morton_keys(shares: list[NDArray[np.float64]]) -> NDArray[np.int64]:
    """Morton keys of shares along both axes."""
    x, y = (np.clip(of * _RESOLUTION, 0, _RESOLUTION - 1).astype(np.int64) for of in shares)
    return _spread(x) | (_spread(y) << 1)


def _spread(bits: NDArray[np.int64]) -> NDArray[np.int64]:
    """Insert a zero after each of 26 bits."""
    for shift, mask in (
        (16, 0x0000FFFF0000FFFF),
        (8, 0x00FF00FF00FF00FF),
        (4, 0x0F0F0F0F0F0F0F0F),
        (2, 0x3333333333333333),
        (1, 0x5555555555555555),
    ):
        bits = (bits | (bits << shift)) & mask
    return bits


def cuts(comm: MPI.Intracomm, keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """The first keys of the ranges of all ranks but the first; all get about as many rows."""
    samples, weights = _samples(comm, keys, _SAMPLES)
    if len(samples) == 0:
        return np.zeros(comm.size - 1, np.int64)
    before = np.cumsum(weights)
    wanted = before[-1] * np.arange(1, comm.size) / comm.size
    first: NDArray[np.int64] = samples[np.searchsorted(before, wanted)]
    return first


class Cells:
    """A grid of cells in which rows occupy at most two by two.

    `scales` divide both axes, and no cell is narrower than `width`. `periods` are 0 along axes
    that are not periodic.
    """

    def __init__(self, scales: list[Scale], width: float, periods: NDArray[np.float64]) -> None:
        self._periods = periods
        #: Where all cells but the first begin.
        self._edges = [
            _apart(scale.edges, width, period)
            for scale, period in zip(scales, periods.tolist(), strict=True)
        ]
        self.count = math.prod(len(edges) + 1 for edges in self._edges)

    def corners(
        self, centers: NDArray[np.float64], sizes: NDArray[np.float64]
    ) -> list[NDArray[np.int64]]:
        """The numbers of the cells with the four corners of each box ``centers ± sizes``."""
        low, high = (self._indices(centers + sign * sizes[:, None]) for sign in (-1, 1))
        rows = len(self._edges[1]) + 1
        return [x * rows + y for x in (low[0], high[0]) for y in (low[1], high[1])]

    def _indices(self, places: NDArray[np.float64]) -> list[NDArray[np.intp]]:
        return [
            np.searchsorted(edges, numbers % period if period else numbers, side="right")
            for numbers, edges, period in zip(
                places.T, self._edges, self._periods.tolist(), strict=True
            )
        ]

    def ranks_of(self, comm: MPI.Intracomm, corners: list[NDArray[np.int64]]) -> NDArray[np.bool_]:
        """Which ranks occupy each cell: shape (ranks, cells)."""
        occupied = np.zeros(self.count, np.bool_)
        for cells in corners:
            occupied[cells] = True
        packed = from_all(comm, np.packbits(occupied))
        return np.unpackbits(packed, axis=1, count=len(occupied)).astype(np.bool_)


def _apart(edges: NDArray[np.float64], width: float, period: float) -> NDArray[np.float64]:
    """Those of some ascending edges that are further apart than a width."""
    kept: list[float] = []
    last = -np.inf if period == 0 else 0.0
    end = np.inf if period == 0 else period
    for edge in edges.tolist():
        if edge * 0.25 - last * 0.25 > width * 0.25 and end - edge > width:
            kept.append(edge)
            last = edge
    return np.array(kept, np.float64)
