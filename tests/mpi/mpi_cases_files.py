"""Files of distributed worlds."""

import resource
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from mpi_checks import InPlaceOf, check, check_asleep, check_saved, fail_by_the_last_rank, refuse
from mpi_worlds import REST, comm, evenly, gas, scattered, sleepers, unevenly, up_to, with_folder

import jostle
import jostle.mpi
import jostle.mpi.storage


@up_to(3)
@with_folder
def test_files(folder: Path) -> None:
    """A saved world continues with the same bits on other numbers of ranks, and in one process."""
    # More than a chunk of ids, so that several ranks write.
    check_file(folder / "world", gas(600, movable=np.arange(600) % 9 > 0), 2, every=33)
    check_refused_files(folder)
    check_failed_writing(folder)


@with_folder
def test_files_of_resting_particles(folder: Path) -> None:
    """Impulses at rest and sleeping islands are saved, and some of these wake later."""
    walls = jostle.polyline([(0, 12), (9, 14), (14, 9)])
    check_file(folder / "pile", gas(60, friction=0.4, walls=walls, **REST), 15)
    for done, steps in ((110, 60), (190, 15)):
        world = sleepers(5)
        world.step(1 / 60, done)
        ours = scattered(sleepers(5), unevenly)
        ours.step(1 / 60, done)
        assert 0 < world.asleep.sum() < len(world)
        check_asleep("before the file", ours, world)
        check_saved(folder / f"sleepers-{done}", ours, world, steps)


def check_file(path: Path, world: jostle.World, steps: int, every: int = 1) -> None:
    """Save a world of which only every so many ids are those of particles."""
    ours = check(path.name, world, 1 / 60, steps)
    world.step(1 / 60, steps)
    if every > 1:
        ours._core._drop_ghosts()
        cores: list[Any] = [world, ours._core]
        for core, ids in zip(cores, (world.ids, ours.ids), strict=True):
            core._set_ids(ids * every, len(world) * every)
    check_saved(path, ours, world, steps)


def check_refused_files(folder: Path) -> None:
    """A damaged file, one that is cut off, another file, and none."""
    whole = (folder / "world").read_bytes()
    for name, data, message in (
        ("damaged", whole[:-30] + bytes([whole[-30] ^ 1]) + whole[-29:], "is damaged"),
        ("short", whole[:-1], "is cut off"),
        ("shorter", whole[:30], "is cut off"),
        ("other", b"something else", "is not a file"),
    ):
        if comm().rank == 0:
            (folder / name).write_bytes(data)
        comm().Barrier()
        refuse(partial(jostle.mpi.World.load, comm(), folder / name), message)
        refuse(partial(jostle.World.load, folder / name), f"{folder / name} holds")
    refuse(lambda: jostle.mpi.World.load(comm(), folder / "none"), "none")


def check_failed_writing(folder: Path) -> None:
    """A file that cannot be written leaves the old one as it was, and no rank waits for others."""
    path = folder / "world"
    whole = path.read_bytes()
    comm().Barrier()
    ours = scattered(gas(50), evenly)
    refuse(lambda: ours.save(folder / "no" / "where"), "no")
    storage: Any = jostle.mpi.storage
    last = comm().rank == comm().size - 1

    class Full(InPlaceOf):
        """A file on a disk that is full for the last rank."""

        def Write_at(self, *arguments: Any) -> None:
            if last:
                raise MPI.Exception(MPI.ERR_NO_SPACE)
            self._of.Write_at(*arguments)

    class Files(InPlaceOf):
        File = type("File", (), {"Open": lambda *of: Full(MPI.File.Open(*of))})

    storage.MPI = Files(MPI)
    try:
        fail_by_the_last_rank(lambda: ours.save(path), OSError, "world")
    finally:
        storage.MPI = MPI
    comm().Barrier()
    assert path.read_bytes() == whole and not list(folder.glob(".*"))
    # On all ranks, as the system says it.
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    refuse(lambda: ours.save(path), "world")
    resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    comm().Barrier()
    assert path.read_bytes() == whole and not list(folder.glob(".*"))
    ours.save(path)
