"""Messages between the ranks of a world, for the core."""

from __future__ import annotations

import time
from itertools import accumulate

import numpy as np
from mpi4py import MPI


class Messages:
    """The calls that the core makes, with buffers.

    A step of a pile makes hundreds of them. So sizes are tuples, each call has one buffer, and the
    times are taken without a context manager.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm
        self.rank, self.size = comm.rank, comm.size
        #: Time in calls, waiting included.
        self.seconds = 0.0

    def gather(self, own: bytes) -> bytearray:
        """Gather as many bytes from each rank."""
        start = time.perf_counter()
        everything = bytearray(len(own) * self.size)
        self._comm.Allgather([own, MPI.BYTE], [everything, MPI.BYTE])
        self.seconds += time.perf_counter() - start
        return everything

    def gather_all(self, own: bytes, counts: tuple[int, ...]) -> bytearray:
        """Gather bytes from each rank, of which there are `counts`."""
        start = time.perf_counter()
        everything = bytearray(sum(counts))
        self._comm.Allgatherv([own, MPI.BYTE], [everything, counts, starts(counts), MPI.BYTE])
        self.seconds += time.perf_counter() - start
        return everything

    def transpose(self, numbers: list[int]) -> list[int]:
        """Send one number to each rank; returns those from each rank."""
        start = time.perf_counter()
        sent = np.array(numbers, np.int64)
        got = np.empty_like(sent)
        self._comm.Alltoall(sent, got)
        received: list[int] = got.tolist()
        self.seconds += time.perf_counter() - start
        return received

    def exchange(self, to: bytes, sent: tuple[int, ...], received: tuple[int, ...]) -> bytearray:
        """Send bytes to each rank; returns those from each rank. Both are in the order of ranks."""
        start = time.perf_counter()
        everything = bytearray(sum(received))
        self._comm.Alltoallv(
            [to, sent, starts(sent), MPI.BYTE],
            [everything, received, starts(received), MPI.BYTE],
        )
        self.seconds += time.perf_counter() - start
        return everything


def starts(counts: tuple[int, ...]) -> tuple[int, ...]:
    """Where the parts of each rank begin in a buffer."""
    return (0, *accumulate(counts[:-1]))
