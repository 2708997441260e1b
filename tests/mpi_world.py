"""A program of test_mpi_world: steps distributed worlds, and compares their hashes with one process."""

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
from mpi4py import MPI

import jostle
import jostle.mpi

COMM = MPI.COMM_WORLD
STEPS = 300

#: A distribution gives the rank of each particle, in ascending order.
Distribution = Callable[[int], np.ndarray]


def evenly(n: int) -> np.ndarray:
    return np.arange(n) * COMM.size // max(n, 1)


def all_on_first(n: int) -> np.ndarray:
    return np.zeros(n, int)


def all_on_last(n: int) -> np.ndarray:
    return np.full(n, COMM.size - 1)


def unevenly(n: int) -> np.ndarray:
    return np.sort(np.random.default_rng(n).integers(0, COMM.size, n) ** 2 // max(COMM.size - 1, 1))


def parts(n: int, where: Distribution) -> np.ndarray:
    return where(n) == COMM.rank


COLUMNS = (
    *("masses", "movable", "friction", "angles", "angular_velocities"),
    *("categories", "masks", "sensors"),
)
SETTINGS = (
    *("gravity", "drag", "container", "container_restitution", "walls", "wall_restitution"),
    *("forces", "on_touch", "substeps"),
)


def scattered(world: jostle.World, where: Distribution) -> jostle.mpi.World:
    """This rank's part of a world."""
    mine = parts(len(world), where)
    columns = {name: getattr(world, name)[mine] for name in COLUMNS}
    settings: dict[str, Any] = {name: getattr(world, name) for name in SETTINGS}
    # One number is the world's.
    is_one = (world.restitutions == 1).all()
    restitution = world.restitution if is_one else world.restitutions[mine]
    return jostle.mpi.World(
        COMM,
        world.positions[mine],
        world.velocities[mine],
        world.radii[mine],
        restitution=restitution,
        **columns,
        **settings,
    )


def check(
    name: str, world: jostle.World, dt: float, steps: int = STEPS, where: Distribution = evenly
) -> jostle.mpi.World:
    ours = scattered(world, where)
    assert ours.state_hash() == world.state_hash(), f"{name}: before the first step"
    for done in range(0, steps, 50):
        now = min(50, steps - done)
        world.step(dt, now)
        ours.step(dt, now)
        found, expected = ours.state_hash(), world.state_hash()
        assert found == expected, f"{name}: {found:#x} is not {expected:#x} after {done + now} steps"
    assert sum(COMM.allgather(len(ours))) == len(world) == ours.total
    assert abs(ours.kinetic_energy - world.kinetic_energy) <= 1e-12 * world.kinetic_energy
    check_touches(name, ours, world)
    if COMM.rank == 0:
        print(name, ours.traffic, flush=True)
    return ours


def check_touches(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """The contacts of all ranks together are those of one process, as a set of rows."""
    for kind in ("contacts", "wall_contacts"):
        found = [np.concatenate(columns) for columns in zip(*COMM.allgather(getattr(ours, kind)))]
        sets = []
        for columns in (found, getattr(world, kind)):
            table = np.column_stack([np.asarray(column, np.float64) for column in columns])
            sets.append(sorted(map(tuple, table)))
        assert sets[0] == sets[1], f"{name}: {kind}"
    assert ours.collisions == world.collisions, name


def main(which: str) -> None:
    globals()[f"test_{which}"]()
    if COMM.rank == 0:
        print("all bits are right")


def test_gas() -> None:
    for where in (evenly, all_on_first, all_on_last, unevenly):
        check("gas", jostle.scenes.create("gas", n=1500, seed=3), 1 / 60, where=where)


main(sys.argv[1])
