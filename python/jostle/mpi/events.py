"""Pairs that began and ceased to touch, from what all ranks have seen."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

import jostle

from .exchange import send

_PAIR = np.dtype([("first", "<i8"), ("second", "<i8"), ("when", "u1")])


def events_of(comm: MPI.Intracomm, *touched: NDArray[np.int64]) -> jostle.WorldEvents:
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
    return jostle.WorldEvents(
        entered=pairs[(during | at_end) & ~before],
        stayed=pairs[before & at_end],
        left=pairs[(before | during) & ~at_end],
    )
