"""Dividing the plane between ranks by the Morton curve, and the cells that each rank occupies."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .exchange import from_all

#: Cells along each axis of the grid whose keys divide the plane: clusters that are smaller by
#: this factor than the whole are divided too.
_RESOLUTION = 1 << 26

#: Keys that each rank samples.
_SAMPLES = 1024


def morton_keys(places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Morton keys of places in the unit square."""
    x, y = np.clip(places.T * _RESOLUTION, 0, _RESOLUTION - 1).astype(np.int64)
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
    sample = np.full(_SAMPLES, -1, np.int64)
    if len(keys):
        sample = keys[np.linspace(0, len(keys) - 1, _SAMPLES).astype(np.int64)]
    samples = from_all(comm, sample).reshape(-1)
    weights = np.repeat(from_all(comm, np.array([len(keys)], np.int64)), _SAMPLES)
    order = np.argsort(samples, kind="stable")
    before = np.cumsum(weights[order])
    wanted = before[-1] * np.arange(1, comm.size) / comm.size
    first: NDArray[np.int64] = samples[order[np.searchsorted(before, wanted)]]
    return first


class Cells:
    """A square grid of cells in the unit square, in which rows occupy at most two by two cells."""

    def __init__(self, count: int, wraps: tuple[bool, bool]) -> None:
        self.count = count
        self._wraps = wraps

    def corners(
        self, places: NDArray[np.float64], sizes: NDArray[np.float64]
    ) -> list[NDArray[np.int64]]:
        """The numbers of the cells with the four corners of each box ``places ± sizes``."""
        low, high = (self._indices(places + sign * sizes) for sign in (-1, 1))
        return [x * self.count + y for x in (low[0], high[0]) for y in (low[1], high[1])]

    def _indices(self, places: NDArray[np.float64]) -> list[NDArray[np.int64]]:
        indices = np.floor(places.T * self.count).astype(np.int64)
        return [
            index % self.count if wraps else np.clip(index, 0, self.count - 1)
            for index, wraps in zip(indices, self._wraps, strict=True)
        ]

    def ranks_of(self, comm: MPI.Intracomm, corners: list[NDArray[np.int64]]) -> NDArray[np.bool_]:
        """Which ranks occupy each cell: shape (ranks, cells)."""
        occupied = np.zeros(self.count * self.count, np.bool_)
        for cells in corners:
            occupied[cells] = True
        packed = from_all(comm, np.packbits(occupied))
        return np.unpackbits(packed, axis=1, count=len(occupied)).astype(np.bool_)
