"""Scenes that are distributed over ranks."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

from jostle._core import create_scene_part

from .records import RECORD
from .world import World


def create_scene(
    comm: MPI.Intracomm,
    name: str,
    n: int | None = None,
    seed: int = 0,
    *,
    threads: int | None = 1,
    **settings: Any,
) -> World:
    """Make the world of a scene, of which each rank makes its particles.

    A collective call. The particles, all ranks together, are those of `jostle.scenes.create`.

    Parameters
    ----------
    comm : mpi4py.MPI.Intracomm
        The ranks.
    name : str
        One of `jostle.scenes.names()`.
    n : int, optional
        Number of particles of all ranks, as for `jostle.scenes.create`.
    seed : int, default 0
        The same seed gives the same world.
    threads : int, default 1
        Number of threads of each rank; None for all cores.
    **settings
        Attributes of `jostle.World` with other values than the scene has, for example
        ``sleeping=False``; the same on all ranks.

    Returns
    -------
    World
        In pixels and seconds, y grows downwards, for steps of 1/60 s.

    Raises
    ------
    TypeError, ValueError
        As by `jostle.scenes.create`, for what `World` does not support, or if settings of ranks
        differ.
    RankError
        If another rank raises one of these.

    See Also
    --------
    jostle.scenes.create : The same in one process.

    Notes
    -----
    No rank holds all particles of the scenes ``gas``, ``pile`` and ``thermostat``. Each rank draws
    the random numbers of all of them, about 10 ns for a particle. Other scenes are made as a whole
    on each rank.

    Examples
    --------
    >>> from mpi4py import MPI
    >>> import jostle.mpi
    >>> world = jostle.mpi.create_scene(MPI.COMM_SELF, "gas", n=1000, seed=3)
    >>> world.state_hash() == jostle.scenes.create("gas", n=1000, seed=3).state_hash()
    True
    """

    def part(rank: int, size: int) -> Any:
        core = create_scene_part(name, n, seed, rank, size)
        core.threads = threads
        for setting, value in settings.items():
            setattr(core, setting, value)
        return core

    return World.of_parts(comm, part)


def part_of(world: Any, rank: int, size: int) -> Any:
    """Return a world with a rank's share of the particles of a `jostle.World`."""
    records, total = world._own_records(), len(world)
    first, last = (of * total // size * RECORD.itemsize for of in (rank, rank + 1))
    return world._of_records(records[first:last])
