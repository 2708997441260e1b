"""The particles of a distributed world as records, and what all ranks compute from them."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

import jostle
from jostle._core import begin_hash, hash_parts, hash_records

from .exchange import deliver, passed_on
from .ids import at_ids, places_of
from .records import PARTS, RECORD
from .storage import by_ids
from .sums import exact_sum


def records_of(core: Any) -> NDArray[Any]:
    """The particles of this rank."""
    return np.frombuffer(core._own_records(), RECORD)


def parts_of(core: Any) -> list[NDArray[Any]]:
    """The particles of this rank, and what the core keeps of them: all `PARTS`."""
    parts = [core._own_records(), *core._own_kept()]
    return [np.frombuffer(part, kind) for part, kind in zip(parts, PARTS, strict=True)]


def kinetic_energy(comm: MPI.Intracomm, core: Any) -> float:
    """The sum of ½ m v² + ½ I ω² of the movable particles of all ranks, with I = m r²/2."""
    rows = _movable(records_of(core))
    mass = rows["masses"].astype(np.float64)
    x, y = rows["velocities"].astype(np.float64).T
    surface = rows["radii"].astype(np.float64) * rows["angular_velocities"]
    return exact_sum(
        comm, np.concatenate([0.5 * mass * (x * x + y * y), 0.25 * mass * (surface * surface)])
    )


def potential_energy(comm: MPI.Intracomm, core: Any, messages: Any) -> float:
    """The energy of the movable particles of all ranks in gravity and forces between kinds."""
    rows = records_of(core)
    moved = _movable(rows)
    gravity = np.array(core.gravity, np.float32).astype(np.float64)
    heights = moved["positions"].astype(np.float64) @ gravity
    energy = exact_sum(comm, -moved["masses"].astype(np.float64) * heights)
    if not any(isinstance(force, jostle.PairForce) for force in core.forces):
        return energy
    copy = _copy(core, messages)
    return energy + exact_sum(comm, np.array([copy._own_energy_of_pairs()]))


def net_forces(comm: MPI.Intracomm, core: Any, messages: Any) -> NDArray[np.float64]:
    """The sum of the forces on each particle of this rank."""
    own = core._own_ids()[0]
    if not any(isinstance(of, jostle.PairForce | jostle.Flocking) for of in core.forces):
        forces: NDArray[np.float64] = core.net_forces()[: len(own)]
        return forces
    copy = _copy(core, messages)
    ids = np.sort(own)
    with passed_on(comm):
        copy.accelerations = core.accelerations[places_of(own, ids)]
    copy._own_energy_of_pairs()  # after it there are ghosts within the cutoff
    there = copy._own_ids()[0]
    rows = np.zeros(len(there), [("id", np.int64), ("force", np.float64, 2)])
    rows["id"], rows["force"] = there, copy.net_forces()[: len(there)]
    return at_ids(comm, rows, own)["force"]


def _copy(core: Any, messages: Any) -> Any:
    """A distributed world with the same particles, in the order of ids and without ghosts.

    The ghosts of a step may lack particles within the cutoff of forces.
    """
    rows = np.sort(records_of(core), order="id", kind="stable")
    copy = core._of_records(rows.tobytes())
    copy._distribute(messages, rows["id"].copy())
    return copy


def momentum(comm: MPI.Intracomm, core: Any) -> NDArray[np.float64]:
    """The sum of mass times velocity of the movable particles of all ranks."""
    rows = _movable(records_of(core))
    x, y = rows["masses"].astype(np.float64) * rows["velocities"].astype(np.float64).T
    return np.array([exact_sum(comm, x), exact_sum(comm, y)])


def angular_momentum(comm: MPI.Intracomm, core: Any, about: NDArray[np.float64]) -> float:
    """The sum of m (r − about) × v + I ω of the movable particles of all ranks."""
    rows = _movable(records_of(core))
    x, y = (rows["positions"].astype(np.float64) - about).T
    u, v = rows["velocities"].astype(np.float64).T
    mass, radius = (rows[name].astype(np.float64) for name in ("masses", "radii"))
    return exact_sum(
        comm, mass * (x * v - y * u + 0.5 * radius * radius * rows["angular_velocities"])
    )


def temperature(comm: MPI.Intracomm, core: Any) -> float:
    """The sum of m (v − u)² of the movable particles of all ranks over 2 (n − 1)."""
    rows = records_of(core)
    count = int(comm.allreduce(int(rows["movable"].sum())))
    if count < 2:
        return math.nan
    # As in the core, u is the mean of those that are awake.
    asleep = core.asleep[places_of(core._own_ids()[0], rows["id"])]
    rows = _movable(rows[~asleep])
    mass = rows["masses"].astype(np.float64)
    total = exact_sum(comm, mass)
    if total == 0.0:  # all sleep
        return 0.0
    x, y = rows["velocities"].astype(np.float64).T
    x, y = (of - exact_sum(comm, mass * of) / total for of in (x, y))
    return exact_sum(comm, mass * (x * x + y * y)) / (2 * (count - 1))


def state_hash(comm: MPI.Intracomm, core: Any) -> int:
    """The hash of the particles of all ranks, in the order of ids.

    The particles are sent to ranks in this order, and the ranks compute the hash one after the
    other.
    """
    rows = by_ids(comm, records_of(core), core._own_ids()[1])
    records = rows.tobytes()
    parts = set().union(*comm.allgather(hash_parts(records)))
    state = begin_hash(int(core._counts()[1]))
    for part in sorted(parts):
        for rank in range(comm.size):
            if rank == comm.rank:
                state = hash_records(state, records, part)
            state = comm.bcast(state, root=rank)
    return state


def gathered(comm: MPI.Intracomm, core: Any, root: int) -> jostle.World | None:
    """A world of the particles of all ranks, in the order of ids; None on ranks but `root`."""
    count, ids, _ = core._own()
    given = np.zeros(count, [("id", np.int64), ("acceleration", np.float32, 3)])
    given["id"], given["acceleration"] = ids[:count], core._given()[:count]
    all_rows = []
    for rows in (*parts_of(core), given):
        to = [rows[:0]] * comm.size
        to[root] = rows
        all_rows.append(np.sort(deliver(comm, to), order="id", kind="stable"))
    if comm.rank != root:
        return None
    accelerations = all_rows.pop()["acceleration"]
    records, *kept = (rows.tobytes() for rows in all_rows)
    world = core._of_records(records)
    world._set_ids(all_rows[0]["id"].copy(), core._own_ids()[1])
    world._take_kept(*kept)
    world._give(accelerations)
    return cast(jostle.World, world)


def _movable(rows: NDArray[Any]) -> NDArray[Any]:
    movable: NDArray[Any] = rows[rows["movable"]]
    return movable
