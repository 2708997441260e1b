"""Messages between the ranks of a world, for the core."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray


class Messages:
    """The calls that the core makes, with buffers."""

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm
        self.rank, self.size = comm.rank, comm.size
        #: Time in calls, waiting included.
        self.seconds = 0.0

    @contextmanager
    def _timed(self) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self.seconds += time.perf_counter() - start

    def gather(self, own: bytes) -> bytes:
        """Gather as many bytes from each rank."""
        with self._timed():
            everything = bytearray(len(own) * self.size)
            self._comm.Allgather([own, MPI.BYTE], [everything, MPI.BYTE])
            return bytes(everything)

    def gather_all(self, own: bytes, counts: list[int]) -> bytes:
        """Gather bytes from each rank, of which there are `counts`."""
        with self._timed():
            got = np.array(counts, np.int64)
            everything = bytearray(int(got.sum()))
            self._comm.Allgatherv([own, MPI.BYTE], [everything, got, starts(got), MPI.BYTE])
            return bytes(everything)

    def transpose(self, numbers: list[int]) -> list[int]:
        """Send one number to each rank; returns those from each rank."""
        with self._timed():
            sent = np.array(numbers, np.int64)
            got = np.empty_like(sent)
            self._comm.Alltoall(sent, got)
            received: list[int] = got.tolist()
            return received

    def exchange(self, parts: list[bytes], counts: list[int]) -> list[bytes]:
        """Send bytes to each rank; returns those from each rank, of which there are `counts`."""
        if not parts:  # one rank alone has no lists of ghosts
            return []
        with self._timed():
            sent, got = np.array(list(map(len, parts)), np.int64), np.array(counts, np.int64)
            everything = bytearray(int(got.sum()))
            self._comm.Alltoallv(
                [b"".join(parts), sent, starts(sent), MPI.BYTE],
                [everything, got, starts(got), MPI.BYTE],
            )
            ends = np.cumsum(got).tolist()
            return [
                bytes(everything[end - count : end])
                for end, count in zip(ends, counts, strict=True)
            ]


def starts(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Where the parts of each rank begin in a buffer."""
    return np.cumsum(counts) - counts
