"""Adding, removing, changing and pushing particles of a distributed world."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from .exchange import first_id, joined, passed_on, together
from .ids import check_ids, places_of, read_ids

#: A radius that fits into every container.
_SMALL = 1e-9

#: The largest coordinate of a vector that a world takes.
_FARTHEST = 1e18


def rows_of(column: ArrayLike) -> ArrayLike:
    """A column of pairs, also if it is empty."""
    return np.zeros((0, 2)) if np.size(column) == 0 else column


def add(comm: MPI.Intracomm, core: Any, *columns: ArrayLike, **named: Any) -> NDArray[np.int64]:
    """Add this rank's new particles to the core; returns their ids."""
    with together(comm):
        # Checked and completed by a world without other particles.
        new: Any = core._of_records(b"")
        new.add(*columns, **named)
    ids: NDArray[np.int64] = (
        core._own_ids()[1] + first_id(comm, len(new)) + np.arange(len(new), dtype=np.int64)
    )
    core._add_records(new._own_records(), ids, int(comm.allreduce(len(new))))
    core._agree_on_losses()
    return ids


def remove(comm: MPI.Intracomm, core: Any, ids: ArrayLike) -> None:
    """Remove the particles with the ids that any rank gives."""
    with together(comm):
        own = read_ids(ids)
    everything = joined(comm, own)
    check_ids(comm, core, everything)
    core._remove_ids(everything)
    core._agree_on_losses()


def change(comm: MPI.Intracomm, core: Any, ids: ArrayLike, **columns: Any) -> None:
    """Change columns of the particles with the ids that any rank gives."""
    given = sorted(name for name, column in columns.items() if column is not None)
    with together(comm):
        own = read_ids(ids)
        # Checked and completed by a world with as many particles.
        trial: Any = core._of_records(b"")
        zeros = np.zeros((len(own), 2))
        trial.add(zeros, _SMALL, masses=1.0)
        trial.set(np.arange(len(own)), **columns)
        new = trial.get(np.arange(len(own)))
    if len(set(comm.allgather(tuple(given)))) > 1:
        raise ValueError(f"the columns are not the same on all ranks: here they are {given}")
    values = {name: np.asarray(getattr(new, name)) for name in given}
    kinds = [(name, value.dtype, value.shape[1:]) for name, value in values.items()]
    rows = np.zeros(len(own), np.dtype([("id", np.int64), *kinds]))
    rows["id"] = own
    for name, value in values.items():
        rows[name] = value
    rows = joined(comm, rows)
    check_ids(comm, core, rows["id"])
    ids_here = core._own_ids()[0]
    rows = rows[np.isin(rows["id"], ids_here)]
    core.set(_rows_of(core, rows["id"]), **{name: rows[name] for name in given})
    core._agree_on_losses()


def accelerate(comm: MPI.Intracomm, core: Any, accelerations: ArrayLike | None) -> None:
    """Give this rank's particles accelerations."""
    core._drop_ghosts()
    with together(comm):
        own = _vectors("accelerations", accelerations, len(core._own_ids()[0]))
    with passed_on(comm):
        core.accelerations = own


def push(
    comm: MPI.Intracomm, core: Any, ids: ArrayLike, forces: ArrayLike, points: ArrayLike | None
) -> None:
    """Add forces on the particles with the ids that any rank gives."""
    rows, found = _gathered(comm, core, ids, "forces", forces, points)
    with passed_on(comm):
        core.apply_force(_rows_of(core, rows["id"]), rows["vector"], found)


def hit(
    comm: MPI.Intracomm, core: Any, ids: ArrayLike, impulses: ArrayLike, points: ArrayLike | None
) -> None:
    """Give impulses to the particles with the ids that any rank gives."""
    rows, found = _gathered(comm, core, ids, "impulses", impulses, points)
    with passed_on(comm):
        core.apply_impulse(_rows_of(core, rows["id"]), rows["vector"], found)
    core._agree_on_losses()


def _gathered(
    comm: MPI.Intracomm,
    core: Any,
    ids: ArrayLike,
    name: str,
    vectors: ArrayLike,
    points: ArrayLike | None,
) -> tuple[NDArray[Any], NDArray[np.float32] | None]:
    """The ids and vectors of all ranks for this rank's particles, and the points, if any."""
    with together(comm):
        own = read_ids(ids)
        both = [("vector", np.float32, 2), ("point", np.float32, 2)]
        rows = np.zeros(len(own), [("id", np.int64), *both])
        rows["id"] = own
        is_one = np.ndim(ids) == 0
        rows["vector"] = _vectors(name, vectors, len(own), is_one=is_one)
        rows["point"] = _vectors("points", points, len(own), is_one=is_one)
    given = {
        are_given for count, are_given in comm.allgather((len(own), points is not None)) if count
    }
    if len(given) > 1:
        raise ValueError("points are given by some ranks only")
    rows = joined(comm, rows)
    check_ids(comm, core, rows["id"], may_repeat=True)
    core._drop_ghosts()
    rows = rows[np.isin(rows["id"], core._own_ids()[0])]
    return rows, rows["point"] if True in given else None


def _rows_of(core: Any, ids: NDArray[np.int64]) -> NDArray[np.intp]:
    """The rows of particles of this rank."""
    return places_of(core._own_ids()[0], ids)


def _vectors(
    name: str, values: ArrayLike | None, count: int, is_one: bool = False
) -> NDArray[np.float32]:
    """Return `values` as `count` pairs of float32, of one pair for all; zeros for None."""
    shape = (2,) if is_one else (count, 2)
    array = np.zeros(shape) if values is None else np.asarray(values)
    if array.size and array.dtype.kind not in "biuf":
        raise TypeError(f"{name} must hold real numbers, not {array.dtype}")
    if array.shape not in (shape, (2,)) and not array.size == count == 0:
        raise ValueError(f"{name} has shape {array.shape}; it must be {shape}")
    if not array.size:
        array = np.zeros(shape)
    vectors = np.broadcast_to(array, (count, 2)).astype(np.float32)
    wrong = np.flatnonzero(~(np.abs(vectors) <= _FARTHEST).all(axis=1))
    if len(wrong):
        x, y = vectors[wrong[0]].tolist()
        rule = f"both coordinates must lie within ±{_FARTHEST:.0e}"
        raise ValueError(f"{name}[{wrong[0]}] is ({x}, {y}); {rule}")
    return vectors
