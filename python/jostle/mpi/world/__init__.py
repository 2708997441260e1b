"""Worlds whose particles are distributed over ranks: one file for each part of their interface."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mpi4py import MPI
from numpy.typing import ArrayLike

import jostle

from .. import edits, state
from ..exchange import together
from ..interrupts import collective
from ..storage import read, write
from .editing import Editing
from .found import Found
from .querying import Querying
from .settings import Settings
from .stepping import Stepping
from .totals import Totals


class World(Stepping, Editing, Settings, Totals, Found, Querying):
    """Particles that are distributed over the ranks of a communicator.

    Methods but `rows` are collective: all ranks call them in the same order. So are `events`,
    `wall_events`, `renumbered` and `last_call`. The particles of all ranks have the same states, in
    bits, as those of one `jostle.World` with all of them. Neither the number of ranks nor the
    distribution changes them.

    Parameters
    ----------
    comm : mpi4py.MPI.Intracomm
        The ranks. All worlds of a communicator share one duplicate of it, which is freed with it.
        So they are used from one thread at a time, and not after the communicator is freed.
    positions : array_like, shape (n, 2)
        Those of this rank's share, at any positions; n may be 0. The ids count the particles of
        rank 0 first, then those of rank 1, and so on.
    radii : array_like, a number or shape (n,)
        As for `jostle.World`.
    threads : int, default 1
        Number of threads of each rank; None for all cores.
    **options
        The other arguments of `jostle.World`; arrays have a row for each particle of this rank.
        Settings are the same on all ranks. A rank may leave out columns that others give.

    Raises
    ------
    TypeError, ValueError
        As by `jostle.World`, for what is not supported (see Notes), or if settings of ranks differ.
    RankError
        If another rank raises one of these.

    See Also
    --------
    jostle.World : The same in one process.
    jostle.mpi.find_pairs : Pairs of shapes without a world.

    Notes
    -----
    Not supported are forces other than `PairForce`, `Flocking`, `Thermostat`, `ThermalWalls`,
    `AndersenThermostat` and `Pump`. They are refused.

    Queries such as `nearest` and `raycast` are collective. Each rank gives its own points, regions
    or rays, and gets the results of a `jostle.World` with the particles of all ranks, in bits. A
    rank without a query gives an empty list. Each rank computes the queries of all ranks, so give
    many in one call. For pairs there is `jostle.mpi.find_pairs`.

    `free_positions` and `force_virial` depend on the particles of all ranks; the world that
    `gather` returns has these methods.

    Each rank has the particles of a range of the Morton curve, and copies of those near them. If
    some ranks need more time than others, or have many copies, the ranges are chosen again, and
    particles move to other ranks; sleeping ones stay where they are until they wake.

    Settings such as `gravity` can be assigned, and `walls` edited, in collective calls. Contacts
    are empty after that, and after `add`, `remove`, `apply_force` and `apply_impulse`, until the
    next step.

    Examples
    --------
    >>> from mpi4py import MPI
    >>> import jostle.mpi
    >>> world = jostle.mpi.World(MPI.COMM_SELF, [(0, 0), (3, 0)], 1.0, velocities=[(1, 0), (0, 0)])
    >>> world.step(0.1, steps=20)
    >>> world.velocities
    array([[0., 0.],
           [1., 0.]], dtype=float32)
    """

    __slots__ = ()

    def __init__(
        self,
        comm: MPI.Intracomm,
        positions: ArrayLike,
        radii: ArrayLike,
        *,
        threads: int | None = 1,
        **options: Any,
    ) -> None:
        def part(*_: int) -> Any:
            places = edits.rows_of(positions)
            return jostle.World(places, radii, threads=threads, **options)

        self._begin(comm)
        self._distribute(part)

    @classmethod
    def of_parts(cls, comm: MPI.Intracomm, part: Callable[[int, int], Any]) -> World:
        """Make a world of which each rank makes its part.

        Parameters
        ----------
        comm : mpi4py.MPI.Intracomm
            The ranks.
        part : callable
            Takes the number of the rank and that of all ranks. Returns a `jostle.World` with this
            rank's particles, which is used up.

        Returns
        -------
        World
            Its ids count the particles of rank 0 first, then those of rank 1, and so on.

        Raises
        ------
        TypeError, ValueError
            Those of `part`, for what is not supported, or if settings of ranks differ.
        RankError
            If another rank raises one of these.

        See Also
        --------
        jostle.mpi.create_scene : Makes the world of a scene.
        """
        world = cls.__new__(cls)
        world._begin(comm)
        world._distribute(part)
        return world

    @collective
    def gather(self, root: int = 0) -> jostle.World | None:
        """Bring all particles to one rank.

        Parameters
        ----------
        root : int, default 0
            The rank.

        Returns
        -------
        jostle.World or None
            On `root` a world of all particles in the order of ids, which continues with the same
            bits; None on other ranks. It has no contacts, events and collisions before its first
            step.

        Raises
        ------
        ValueError
            If there is no rank `root`.
        """
        with together(self._comm):
            if not 0 <= root < self._comm.size:
                raise ValueError(f"root is {root}; it must be from 0 to {self._comm.size - 1}")
        return state.gathered(self._comm, self._core, root)

    @collective
    def save(self, path: str | bytes | os.PathLike[str]) -> None:
        """Write the world into one file, in which each rank writes a part.

        Parameters
        ----------
        path : str, bytes or os.PathLike
            An existing file is replaced when the new one is complete.

        Raises
        ------
        OSError
            If the file cannot be written; then an existing one is unchanged.

        See Also
        --------
        load : Reads the file, on any number of ranks.
        jostle.World.load : Reads the file in one process.
        """
        settings = self._core._of_records(b"").snapshot()
        end, parts = self._core._own_ids()[1], state.parts_of(self._core)
        write(self._comm, Path(os.fsdecode(path)), settings, end, parts)

    @classmethod
    def load(
        cls, comm: MPI.Intracomm, path: str | bytes | os.PathLike[str], *, threads: int | None = 1
    ) -> World:
        """Read a world from a file that `save` has written, on any number of ranks.

        Parameters
        ----------
        comm : mpi4py.MPI.Intracomm
            The ranks.
        path : str, bytes or os.PathLike
            The file.
        threads : int, default 1
            Number of threads of each rank.

        Returns
        -------
        World
            A world that continues with the same bits.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If it does not contain a distributed world, or is truncated or damaged.

        See Also
        --------
        save : Writes the file.
        """
        world = cls.__new__(cls)
        world._begin(comm)
        world._load(Path(os.fsdecode(path)), threads)
        return world

    @collective
    def _load(self, path: Path, threads: int | None) -> None:
        settings, end, parts = read(self._comm, path)
        records, *kept = (rows.tobytes() for rows in parts)
        with together(self._comm):
            empty: Any = jostle.World.restore(settings)
            core = empty._of_records(records)
            core.threads = threads
        self._core = core
        core._distribute(self._messages, parts[0]["id"].copy())
        core._agree_on_losses()
        core._set_ids(parts[0]["id"].copy(), end)
        core._take_kept(*kept)

    def __repr__(self) -> str:
        return (
            f"<jostle.mpi.World of {self.total} particles after {self.time:.3f} s, "
            f"{len(self)} of them on rank {self._comm.rank} of {self._comm.size}>"
        )
