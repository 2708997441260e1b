"""Ids of particles: where they are, and the particles that have them."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle.errors import IdError

from .exchange import joined, raise_together, send, together
from .records import RECORD


def read_ids(ids: ArrayLike) -> NDArray[np.int64]:
    """The ids of an argument in one row."""
    found = np.atleast_1d(np.asarray(ids))
    if found.size == 0:
        return np.zeros(0, np.int64)
    if found.ndim != 1 or found.dtype.kind not in "iu":
        raise TypeError(f"ids must be integers, one or in one row; got {ids!r}")
    return found.astype(np.int64)


def check_ids(
    comm: MPI.Intracomm, core: Any, ids: NDArray[np.int64], may_repeat: bool = False
) -> None:
    """Raise on all ranks if an id has no particle, or is given twice unless `may_repeat`."""
    found = np.isin(ids, core._own_ids()[0])
    comm.Allreduce(MPI.IN_PLACE, found, op=MPI.LOR)
    different, counts = np.unique(ids, return_counts=True)
    error: ValueError | None = None
    if not found.all():
        error = IdError(f"ids contain {ids[~found][0]}; no particle has this id")
    elif (counts > 1).any() and not may_repeat:
        error = ValueError(f"ids contain {different[counts > 1][0]} twice")
    raise_together(comm, error)


def places_of(own: NDArray[np.int64], ids: NDArray[np.int64]) -> NDArray[np.intp]:
    """Where ids are among all that a rank has, in any order; all are there."""
    order = np.argsort(own)
    places: NDArray[np.intp] = order[np.searchsorted(own[order], ids)]
    return places


def rows(core: Any, ids: ArrayLike) -> Any:
    """The rows of particles of this rank, in the shape of their ids."""
    flat = read_ids(np.asarray(ids).reshape(-1))
    own = core._own_ids()[0]
    there = np.isin(flat, own)
    if not there.all():
        raise IdError(f"ids contain {flat[~there][0]}; no particle of this rank has this id")
    places = places_of(own, flat).reshape(np.shape(ids))
    return places if places.ndim else int(places)


def particles(comm: MPI.Intracomm, core: Any, ids: ArrayLike) -> jostle.Particle | jostle.Particles:
    """The particles of any rank that have the ids which this rank gives."""
    with together(comm):
        own = read_ids(ids)
    asked = np.zeros(len(own), [("id", np.int64), ("rank", np.int64)])
    asked["id"], asked["rank"] = own, comm.rank
    asked = joined(comm, asked)
    check_ids(comm, core, asked["id"], may_repeat=True)
    records = np.frombuffer(core._own_records(), RECORD)
    asked = asked[np.isin(asked["id"], records["id"])]
    records = send(comm, records[places_of(records["id"], asked["id"])], asked["rank"])
    records = records[places_of(records["id"], own)]
    # A world gives the values their types.
    world = core._of_records(records.tobytes())
    found: jostle.Particle | jostle.Particles = world.get(
        0 if np.ndim(ids) == 0 else np.arange(len(own))
    )
    return found


def at_ids(comm: MPI.Intracomm, rows: NDArray[Any], ids: NDArray[np.int64]) -> NDArray[Any]:
    """The row of each id that this rank gives, of rows that any ranks have: each id on one."""
    asked = np.zeros(len(ids), [("id", np.int64), ("rank", np.int64)])
    asked["id"], asked["rank"] = ids, comm.rank
    # They meet on a rank that follows from the id.
    rows, asked = (send(comm, of, of["id"] % comm.size) for of in (rows, asked))
    found = send(comm, rows[places_of(rows["id"], asked["id"])], asked["rank"])
    return found[places_of(found["id"], ids)]
