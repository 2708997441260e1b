"""Pairs that began and ceased to touch, and ids that changed, from what all ranks have seen."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .exchange import send

_PAIR = np.dtype([("first", "<i8"), ("second", "<i8"), ("when", "u1")])


def events_of(comm: MPI.Intracomm, *touched: NDArray[np.int64]) -> dict[str, NDArray[np.int64]]:
    """The events, each pair on one rank.

    `touched` are the pairs that this rank has seen at the end of the call before, in this one, and
    at its end. Other ranks may have seen the same pairs.
    """
    rows = np.zeros(sum(map(len, touched)), _PAIR)
    pairs = np.concatenate(touched)
    rows["first"], rows["second"] = pairs[:, 0], pairs[:, 1]
    rows["when"] = np.repeat(np.arange(len(touched)), list(map(len, touched)))
    rows = send(comm, rows, rows["first"] % comm.size)
    pairs, numbers = np.unique(
        np.column_stack([rows["first"], rows["second"]]), axis=0, return_inverse=True
    )
    before, during, at_end = (np.zeros(len(pairs), np.bool_) for _ in range(3))
    for when, seen in enumerate((before, during, at_end)):
        seen[numbers.reshape(-1)[rows["when"] == when]] = True
    return {
        "entered": pairs[(during | at_end) & ~before],
        "stayed": pairs[before & at_end],
        "exited": pairs[(before | during) & ~at_end],
    }


def new_ids(
    comm: MPI.Intracomm, merged: NDArray[np.int64], own: NDArray[np.int64], end: int
) -> NDArray[np.int64]:
    """The new id of each id below `end`, -1 for those that no particle has.

    `merged` are the old and the new ids of all ranks, `own` those of this rank's particles.
    """
    there = np.zeros(end, np.bool_)
    there[own] = True
    comm.Allreduce(MPI.IN_PLACE, there, op=MPI.LOR)
    new = np.where(there, np.arange(end), -1)
    old, successors = merged.T
    following = np.arange(end)
    following[old] = successors
    # A particle with which another merged may itself have merged later, on another rank.
    while not np.array_equal(successors, following[successors]):
        successors = following[successors]
    new[old] = new[successors]
    new.setflags(write=False)
    return new
