"""Ranks in one process: a thread each, with the calls of mpi4py that `jostle.mpi` makes."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from mpi4py import MPI


class Ranks:
    """A number of ranks that run the same function, one after the other between their calls."""

    def __init__(self, size: int) -> None:
        self.size = size
        self._slots: list[Any] = [None] * size
        self._barrier = threading.Barrier(size)

    def run(self, work: Callable[[SimulatedComm], Any]) -> list[Any]:
        """Return what the function returns on each rank."""
        results: list[Any] = [None] * self.size
        errors: list[BaseException] = []

        def one(rank: int) -> None:
            try:
                results[rank] = work(SimulatedComm(self, rank))
            except BaseException as error:
                errors.append(error)
                self._barrier.abort()

        threads = [threading.Thread(target=one, args=(rank,)) for rank in range(self.size)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for error in errors:
            if not isinstance(error, threading.BrokenBarrierError):
                raise error
        return results

    def share(self, rank: int, value: Any) -> list[Any]:
        """Return what all ranks have given."""
        self._slots[rank] = value
        self._barrier.wait()
        values = list(self._slots)
        self._barrier.wait()
        return values


class SimulatedComm:
    """The communicator of one rank."""

    def __init__(self, ranks: Ranks, rank: int) -> None:
        self._ranks = ranks
        self.rank, self.size = rank, ranks.size
        #: CPU time of all calls, which a real rank would spend in MPI.
        self.seconds = 0.0

    def Get_attr(self, _: int) -> SimulatedComm:
        """Return the duplicate: there are no other messages."""
        return self

    def allgather(self, value: Any) -> list[Any]:
        start = time.thread_time()
        values = self._ranks.share(self.rank, value)
        self.seconds += time.thread_time() - start
        return values

    def bcast(self, value: Any, root: int = 0) -> Any:
        return self.allgather(value)[root]

    def allreduce(self, value: Any, op: MPI.Op = MPI.SUM) -> Any:
        acts = [(MPI.SUM, sum), (MPI.MIN, min), (MPI.MAX, max), (MPI.LOR, any)]
        return next(act for known, act in acts if known == op)(self.allgather(value))

    def exscan(self, value: Any, op: MPI.Op = MPI.SUM) -> Any:
        before = self.allgather(value)[: self.rank]
        return sum(before) if before else None

    def Allgather(self, own: Any, everything: Any) -> None:
        start, before = time.thread_time(), self.seconds
        _array(everything)[:] = np.concatenate(self.allgather(_array(own).copy()))
        self.seconds = before + time.thread_time() - start

    def Allgatherv(self, own: Any, got: list[Any]) -> None:
        self.Allgather(own, got)

    def Allreduce(self, own: Any, result: Any, op: MPI.Op = MPI.SUM) -> None:
        act = np.sum if op == MPI.SUM else np.max
        result[...] = act(np.stack(self.allgather(np.array(own))), axis=0)

    def Alltoall(self, own: Any, result: Any) -> None:
        parts = [np.split(part, self.size)[self.rank] for part in self.allgather(np.array(own))]
        result[...] = np.concatenate(parts)

    def Alltoallv(self, own: list[Any], got: list[Any]) -> None:
        start_time, before = time.thread_time(), self.seconds
        data, counts, starts, _ = own
        data = _array(data).copy()
        parts = self.allgather(
            [data[start : start + count] for start, count in zip(starts, counts, strict=True)]
        )
        _array(got[0])[:] = np.concatenate([of[self.rank] for of in parts])
        self.seconds = before + time.thread_time() - start_time


def _array(buffer: Any) -> np.ndarray:
    """The bytes of a buffer, or of one with its type."""
    if isinstance(buffer, list):
        buffer = buffer[0]
    return np.frombuffer(memoryview(buffer).cast("B"), np.uint8)
