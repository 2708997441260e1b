"""Exchanging arrays and errors between the ranks of a communicator, through buffers."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from jostle._core import RankError


@contextmanager
def together(comm: MPI.Intracomm) -> Iterator[None]:
    """Raise on all ranks if the block fails on one. The block must not communicate."""
    error: BaseException | None = None
    try:
        yield
    except BaseException as raised:
        error = raised
    raise_together(comm, error)


@contextmanager
def passed_on(comm: MPI.Intracomm) -> Iterator[None]:
    """Raise an error on all ranks if the block fails, which must then fail on all ranks."""
    try:
        yield
    except RankError:
        raise_together(comm, None)
        raise
    except BaseException as error:
        raise_together(comm, error)


def raise_together(comm: MPI.Intracomm, error: BaseException | None) -> None:
    """Raise the error of this rank, or `RankError` if only others have one."""
    first = comm.allreduce(comm.size if error is None else comm.rank, op=MPI.MIN)
    if error is not None:
        if comm.rank == first:
            comm.bcast(_text(error), root=first)
        else:
            comm.bcast(None, root=first)
        raise error
    if first < comm.size:
        raise RankError(f"rank {first}: {comm.bcast(None, root=first)}")


def _text(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__


#: Keeps the duplicate of a communicator, and frees it with the communicator.
_DUPLICATE = MPI.Comm.Create_keyval(delete_fn=lambda comm, key, duplicate: duplicate.Free())


def duplicate_of(comm: MPI.Intracomm) -> MPI.Intracomm:
    """Return the duplicate of a communicator that all worlds of it share.

    Its messages do not mix with those of the caller. It is freed when the communicator is freed, a
    call of all ranks; worlds are freed at a different time on each rank.
    """
    known: Any = comm.Get_attr(_DUPLICATE)
    duplicate: MPI.Intracomm = comm.Dup() if known is None else known
    if known is None:
        comm.Set_attr(_DUPLICATE, duplicate)
    return duplicate


def first_id(comm: MPI.Intracomm, count: int) -> int:
    """Number of rows of all ranks before this one."""
    return int(comm.exscan(count, op=MPI.SUM) or 0)


def extremes(comm: MPI.Intracomm, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    """Replace each number by the largest of all ranks."""
    largest = np.empty_like(numbers)
    comm.Allreduce(numbers, largest, op=MPI.MAX)
    return largest


def totals(comm: MPI.Intracomm, numbers: NDArray[np.int64]) -> NDArray[np.int64]:
    """Replace each number by the sum over all ranks."""
    sums = np.empty_like(numbers)
    comm.Allreduce(numbers, sums, op=MPI.SUM)
    return sums


def from_all(comm: MPI.Intracomm, own: NDArray[Any]) -> NDArray[Any]:
    """Gather arrays of one shape from all ranks, the rank as the first axis."""
    everything = np.empty((comm.size, *own.shape), own.dtype)
    comm.Allgather(_bytes(own), _bytes(everything))
    return everything


def joined(comm: MPI.Intracomm, rows: NDArray[Any]) -> NDArray[Any]:
    """Append the rows of all ranks, in the order of ranks."""
    return deliver(comm, [rows] * comm.size)


def send(comm: MPI.Intracomm, rows: NDArray[Any], to: NDArray[np.integer]) -> NDArray[Any]:
    """Send each row to a rank; returns what this rank gets, in the order of sender and row."""
    order = np.argsort(to, kind="stable")
    counts = np.bincount(to, minlength=comm.size)
    return deliver(comm, np.split(rows[order], np.cumsum(counts)[:-1]))


def deliver(comm: MPI.Intracomm, parts: list[NDArray[Any]]) -> NDArray[Any]:
    """Send one array of rows to each rank; returns the rows that this rank gets."""
    size = parts[0].dtype.itemsize
    sent = np.array([len(part) for part in parts], np.int64) * size
    got = np.empty_like(sent)
    comm.Alltoall(sent, got)
    rows = np.empty(int(got.sum()) // size, parts[0].dtype)
    out = np.concatenate(parts)
    comm.Alltoallv(
        [_bytes(out), sent, _starts(sent), MPI.BYTE], [_bytes(rows), got, _starts(got), MPI.BYTE]
    )
    return rows


def _starts(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.cumsum(counts) - counts


def _bytes(array: NDArray[Any]) -> NDArray[np.uint8]:
    return array.reshape(-1).view(np.uint8)
