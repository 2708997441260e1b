"""A program of test_mpi_world: compares the hashes of distributed worlds with one process."""

import os
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
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
    *("gravity", "drag", "container", "container_restitution", "walls", "wall_velocities"),
    *("wall_restitution", "wall_friction", "forces", "on_touch", "substeps", "sleeping"),
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
    # Particles move to other ranks often.
    ours._core._rebalance_every(7)
    assert ours.state_hash() == world.state_hash(), f"{name}: before the first step"
    for done in range(0, steps, 50):
        now = min(50, steps - done)
        world.step(dt, now)
        ours.step(dt, now)
        found, expected = ours.state_hash(), world.state_hash()
        assert found == expected, (
            f"{name}: {found:#x} is not {expected:#x} after {done + now} steps"
        )
    assert sum(COMM.allgather(len(ours))) == len(world) == ours.total
    assert abs(ours.kinetic_energy - world.kinetic_energy) <= 1e-12 * world.kinetic_energy
    check_touches(name, ours, world)
    if COMM.rank == 0:
        print(name, ours.traffic, flush=True)
    return ours


def check_touches(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """The contacts of all ranks together are those of one process. Sums of the impulses of several
    bounces of a pair in a step may be rounded differently."""
    for kind in ("contacts", "wall_contacts"):
        of_ranks = zip(*COMM.allgather(getattr(ours, kind)), strict=True)
        tables = []
        for columns in ([np.concatenate(column) for column in of_ranks], getattr(world, kind)):
            table = np.column_stack([np.asarray(column, np.float64) for column in columns])
            tables.append(table[np.lexsort((table[:, 2], table[:, 1], table[:, 0]))])
        found, expected = tables
        assert found.shape == expected.shape, f"{name}: {kind}"
        assert np.array_equal(found[:, :-2], expected[:, :-2]), f"{name}: {kind}"
        scale = np.abs(expected[:, -2:]).max(initial=1.0)
        assert np.allclose(found[:, -2:], expected[:, -2:], rtol=1e-6, atol=1e-6 * scale), name
    assert ours.collisions == world.collisions, name


def main(which: str) -> None:
    globals()[f"test_{which}"]()
    if COMM.rank == 0:
        print("all bits are right")


def gas(n: int = 600, seed: int = 1, cover: float = 0.4, **options: Any) -> jostle.World:
    """Discs at random places without overlap, in a square box unless there is another container."""
    rng = np.random.default_rng(seed)
    side = int(np.ceil(np.sqrt(n)))
    spacing = 2.0 * np.sqrt(np.pi / (4 * cover))
    cells = rng.permutation(side * side)[:n]
    places = np.column_stack([cells % side, cells // side]) + 0.5
    radii = rng.uniform(0.5, 1.0, n)
    positions = (places * spacing + rng.uniform(-0.2, 0.2, (n, 2))).astype(np.float32)
    width = max(side, 1) * spacing
    container = options.pop("container", jostle.Box(0, 0, width, width))
    if container == "torus":
        container = jostle.Torus(width, width)
    velocities = options.pop("velocities", rng.normal(0, 20, (n, 2)))
    return jostle.World(positions, velocities, radii, container=container, **options)


def test_gas() -> None:
    for where in (evenly, all_on_first, all_on_last, unevenly):
        check("gas", gas(), 1 / 60, where=where)


def test_scenes() -> None:
    """All scenes that are not refused."""
    done = []
    for name in jostle.scenes.names():
        world = jostle.scenes.create(name, n=100, seed=3)
        world.sleeping = False
        try:
            scattered(world, evenly)
        except ValueError:
            continue
        check(name, world, 1 / 60, 15, unevenly)
        done.append(name)
    assert {"gas", "pile"} <= set(done), done


def test_piles() -> None:
    rest: dict[str, Any] = {"gravity": (0.0, 30.0), "restitution": 0.4, "sleeping": False}
    for where in (evenly, all_on_first, unevenly):
        check("pile", gas(300, **rest), 1 / 60, 25, where)
    check("friction", gas(200, friction=0.5, **rest), 1 / 60, 25)
    masses = np.where(np.arange(200) % 5 == 0, 30.0, 1.0)
    check("uneven masses", gas(200, masses=masses, **rest), 1 / 60, 25)
    walls = jostle.polyline([(0, 30), (15, 36), (30, 20)])
    check("walls", gas(200, walls=walls, friction=0.3, **rest), 1 / 60, 25)
    movable = np.arange(200) % 9 > 0
    still = gas(200, movable=movable, velocities=np.zeros((200, 2)), **rest)
    check("obstacles", still, 1 / 60, 25)


def test_long() -> None:
    """300 steps of a larger gas and of a larger pile."""
    check("gas", jostle.scenes.create("gas", n=3000, seed=3), 1 / 60)
    pile = jostle.scenes.create("pile", n=400, seed=3)
    pile.sleeping = False
    check("pile", pile, 1 / 60)


def test_containers() -> None:
    check("torus", gas(container="torus"), 1 / 60)
    check("plane", gas(container=None), 1 / 60, 100)
    check("circle", gas(container=jostle.Circle((22, 22), 40)), 1 / 60, 150)
    # Steps so long that they are divided, and trajectories around the torus.
    check("long steps on a torus", gas(200, container="torus"), 0.5, 10)
    check("long steps", gas(200, cover=0.05), 0.5, 10)
    walls = jostle.polyline([(5, 5), (20, 25), (30, 10)])
    check("walls", gas(walls=walls), 1 / 60, 150)


def test_rules() -> None:
    # A granular gas with friction: it cools down and forms clusters.
    cooling = gas(restitution=0.8, friction=0.3, angular_velocities=2.0, container="torus")
    check("granular gas", cooling, 1 / 60)
    check("gravity, elastic", gas(gravity=(0, 30)), 1 / 60, 150)
    check("damping and sub-steps", gas(drag=0.5, substeps=3), 1 / 60, 150)
    check("ignore", gas(on_touch="ignore"), 1 / 60, 100)
    hot = jostle.ThermalWalls(400.0, seed=3)
    check("thermal walls", gas(forces=[hot]), 1 / 60, 150)
    check("thermostat", gas(forces=[jostle.Thermostat(30.0, 0.5)]), 1 / 60, 150)
    bath = jostle.AndersenThermostat(400.0, 2.0, seed=3)
    check("bath", gas(forces=[bath], container="torus"), 1 / 60, 150)
    kinds = np.arange(600) % 3
    check("filters", gas(categories=1 << kinds, masks=7 ^ (1 << kinds)), 1 / 60, 150)
    check("sensors", gas(sensors=kinds == 0), 1 / 60, 150)
    movable = np.arange(600) % 7 > 0
    check("kinematic", gas(movable=movable, container="torus"), 1 / 60, 20)


def test_nasty() -> None:
    for n in (0, 1, 2, 3, 5):
        check(f"{n} particles", gas(n), 1 / 60, 20)
    # Simultaneous impacts along a line and in a rack of discs that touch.
    row = np.column_stack([np.arange(40) * 2.0, np.zeros(40)])
    velocities = np.zeros((40, 2))
    velocities[0, 0] = 30.0
    row[0, 0] = -5.0
    check("a line", jostle.World(row, velocities, radii=1.0), 1 / 60, 60, unevenly)
    lattice = np.stack(np.meshgrid(np.arange(12.0), np.arange(12.0)), -1).reshape(-1, 2)
    lattice[:, 0] += 0.5 * (np.arange(144) // 12 % 2)
    lattice[:, 1] *= np.sqrt(0.75)
    velocities = np.zeros((144, 2))
    velocities[:12] = (0.0, 9.0)
    check("a rack", jostle.World(lattice * 2, velocities, radii=1.0), 1 / 60, 60)
    # Discs that overlap at the beginning, and coincident ones.
    rng = np.random.default_rng(2)
    heap = rng.uniform(0, 20, (70, 2))
    heap[:10] = 10.0
    overlapping = jostle.World(
        heap, rng.normal(0, 5, (70, 2)), radii=1.0, container=jostle.Torus(20, 20)
    )
    check("overlaps", overlapping, 1 / 60, 20)
    # One disc that is much larger than the others, one that is much faster, and one far away.
    world = gas(500)
    velocities = world.velocities.copy()
    velocities[3] = (5000.0, 3000.0)
    world.velocities = velocities
    check("a fast disc", world, 1 / 60, 100)
    positions, radii = gas(500).positions.copy(), gas(500).radii.copy()
    positions[7], radii[7] = (22, 22), 15.0
    far = np.hypot(*(positions - positions[7]).T) > 16.5
    far[7] = True
    count = int(far.sum())
    options = {"radii": radii[far], "container": jostle.Torus(60, 60)}
    giant = jostle.World(positions[far], rng.normal(0, 20, (count, 2)), **options)
    check("a giant", giant, 1 / 60, 150)
    positions = gas(300).positions.copy()
    positions[5] = (3e5, -2e5)
    check("far away", jostle.World(positions, rng.normal(0, 20, (300, 2)), radii=0.5), 1 / 60, 60)


def test_files() -> None:
    """A saved world continues with the same bits on other numbers of ranks, and in one process."""
    folder = Path(COMM.bcast(tempfile.mkdtemp() if COMM.rank == 0 else None))
    world = gas(40_000 // 20)
    ours = check("before", world, 1 / 60, 50)
    ours.save(folder / "world")
    assert sorted(path.name for path in folder.iterdir()) == ["world"]
    world.step(1 / 60, 50)
    # All ranks, one rank alone, and groups of two.
    for comm in (COMM, MPI.COMM_SELF, COMM.Split(COMM.rank // 2)):
        again = jostle.mpi.World.load(comm, folder / "world")
        assert again.time == ours.time and again.total == len(world)
        again.step(1 / 60, 50)
        assert again.state_hash() == world.state_hash()
    alone = ours.gather(COMM.size - 1)
    assert (alone is not None) == (COMM.rank == COMM.size - 1)
    if alone is not None:
        assert alone.state_hash() == ours_hash_of(alone)
        alone.step(1 / 60, 50)
        assert alone.state_hash() == world.state_hash()
    for root in (-1, COMM.size):
        refuse(lambda root=root: ours.gather(root), f"root is {root}")
    COMM.Barrier()
    # A damaged file, one that is cut off, another file, and none.
    whole = (folder / "world").read_bytes()
    COMM.Barrier()
    damaged = whole[:-30] + bytes([whole[-30] ^ 1]) + whole[-29:]
    for name, data, message in (
        ("damaged", damaged, "is damaged"),
        ("short", whole[:-1], "is cut off"),
        ("other", b"something else", "is not a file"),
    ):
        if COMM.rank == 0:
            (folder / name).write_bytes(data)
        COMM.Barrier()
        refuse(lambda name=name: jostle.mpi.World.load(COMM, folder / name), message)
    refuse(lambda: jostle.mpi.World.load(COMM, folder / "none"), "none")
    # A file that cannot be written leaves the old one as it was.
    refuse(lambda: ours.save(folder / "no" / "where"), "no")
    assert (folder / "world").read_bytes() == whole
    COMM.Barrier()
    if COMM.rank == 0:
        shutil.rmtree(folder)


def ours_hash_of(world: jostle.World) -> int:
    return jostle.World.restore(world.snapshot()).state_hash()


def refuse(call: Callable[[], Any], message: str) -> None:
    """All ranks raise, with this message or that of the rank that has it."""
    try:
        call()
    except (ValueError, OSError, jostle.mpi.RankError) as error:
        assert message in str(error), error
    else:
        raise AssertionError(message)


def test_killed() -> None:
    """One rank dies; the launcher ends the others."""
    world = scattered(gas(), evenly)
    world.step(1 / 60, 5)
    if COMM.rank == COMM.size - 1:
        os.kill(os.getpid(), signal.SIGKILL)
    world.step(1 / 60, 1_000_000)


def test_pressed() -> None:
    """Ctrl-C on one rank ends the call on all, between two steps."""
    world = scattered(gas(), evenly)
    if COMM.rank == COMM.size - 1:
        threading.Timer(1.0, signal.raise_signal, [signal.SIGINT]).start()
    try:
        world.step(1 / 60, 1_000_000)
    except KeyboardInterrupt:
        assert COMM.rank == COMM.size - 1
    except jostle.mpi.RankError as error:
        assert str(error) == f"rank {COMM.size - 1}: KeyboardInterrupt"
    else:
        raise AssertionError("the call ends")
    times = COMM.allgather(world.time)
    assert times[0] == times[-1] > 0
    before = world.state_hash()
    world.step(1 / 60)
    assert world.state_hash() != before


def test_errors() -> None:
    """What is refused is refused on all ranks, and an error leaves the world as it was."""
    rest = {"gravity": (0.0, 9.8), "restitution": 0.5}  # and sleeping=True
    world = scattered(gas(50), evenly)
    # So many that their text would be shortened; one in the middle differs.
    walls = np.arange(600.0)[:, None, None] * 2 + np.array([[[0.0, 0.0], [1.0, 0.0]]])
    walls[300, 1, 1] += COMM.rank
    refused: list[tuple[str, Callable[[], Any]]] = [
        ("sleeping", lambda: scattered(gas(50, **rest), evenly).step(1 / 60)),
        ("on_touch", lambda: scattered(gas(50, on_touch="merge"), evenly)),
        ("forces[0]", lambda: scattered(gas(50, forces=[jostle.Gravitation(1.0)]), evenly)),
        ("track_events", lambda: jostle.mpi.World(COMM, [], [], [], track_events=True)),
        ("dt", lambda: world.step(-1.0)),
        ("gravity", lambda: jostle.mpi.World(COMM, [], [], [], gravity=(COMM.rank, 0))),
        ("walls", lambda: jostle.mpi.World(COMM, [], [], [], walls=walls)),
    ]
    for argument, call in refused:
        if argument in ("gravity", "walls") and COMM.size == 1:
            continue
        try:
            call()
        except ValueError as error:
            assert argument in str(error), error
        else:
            raise AssertionError(f"{argument} is refused")
    # Only one rank has a particle that moves too far.
    before = world.state_hash()
    hurried = scattered(
        gas(50, velocities=np.where(np.arange(50)[:, None] == 49, 1e18, 1.0) * np.ones((50, 2))),
        evenly,
    )
    try:
        hurried.step(100.0)
    except ValueError as error:
        assert COMM.rank == COMM.size - 1 and "dt" in str(error), error
    except jostle.mpi.RankError as error:
        assert COMM.rank < COMM.size - 1, error
        assert f"rank {COMM.size - 1}: ValueError: dt" in str(error), error
    else:
        raise AssertionError("the step is refused")
    hurried.step(1e-18)
    assert world.state_hash() == before and world.time == 0.0


main(sys.argv[1])
