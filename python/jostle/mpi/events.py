"""Pairs that began and ceased to touch, and ids that changed, from the records of all ranks."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .exchange import send

_PAIR = np.dtype([("pair", "<i8", 2), ("categories", "<u4", 2), ("when", "u1")])

#: When a pair touched.
_BEFORE, _DURING, _AT_END = range(3)


def events_of(
    comm: MPI.Intracomm, touched: list[tuple[NDArray[np.int64], NDArray[np.uint32]]]
) -> dict[str, NDArray[Any]]:
    """The fields of the events, each pair on one rank.

    `touched` are the pairs of this rank with their categories: at the end of the call before, in
    this one, and at its end. Other ranks may have the same pairs.
    """
    rows = np.zeros(sum(len(pairs) for pairs, _ in touched), _PAIR)
    for name, columns in zip(("pair", "categories"), zip(*touched, strict=True), strict=True):
        rows[name] = np.concatenate(columns)
    rows["when"] = np.repeat(np.arange(len(touched)), [len(pairs) for pairs, _ in touched])
    rows = send(comm, rows, rows["pair"][:, 0] % comm.size)
    # The last row of each pair has the categories when it touched last: as in the core, the largest
    # of those in the call.
    in_call, (a, b) = rows["when"] != _BEFORE, rows["categories"].T
    rows = rows[np.lexsort([b, a, in_call, *rows["pair"].T[::-1]])]
    pairs, numbers, counts = np.unique(
        rows["pair"], axis=0, return_inverse=True, return_counts=True
    )
    categories = rows["categories"][np.cumsum(counts) - 1]
    before, during, at_end = (np.zeros(len(pairs), np.bool_) for _ in range(3))
    for when, seen in ((_BEFORE, before), (_DURING, during), (_AT_END, at_end)):
        seen[numbers.reshape(-1)[rows["when"] == when]] = True
    chosen = {
        "entered": (during | at_end) & ~before,
        "stayed": before & at_end,
        "exited": (before | during) & ~at_end,
    }
    return {name: pairs[of] for name, of in chosen.items()} | {
        f"{name}_categories": categories[of] for name, of in chosen.items()
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
