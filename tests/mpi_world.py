"""A program of test_mpi_world: compares the hashes of distributed worlds with one process.

The world of one process is stepped once for all numbers of ranks.
"""

import os
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mpi4py import MPI
from mpi_groups import ALL, on_each_number_of_ranks, run, wait_for_all

import jostle
import jostle.mpi

DT, STEPS = 1 / 20, 100
CHECK_EVERY = 20  # steps

#: A distribution gives the rank of each of n particles, in ascending order, for a number of ranks.
Distribution = Callable[[int, int], np.ndarray]


def evenly(n: int, ranks: int) -> np.ndarray:
    return np.arange(n) * ranks // max(n, 1)


def all_on_first(n: int, ranks: int) -> np.ndarray:
    return np.zeros(n, int)


def all_on_last(n: int, ranks: int) -> np.ndarray:
    return np.full(n, ranks - 1)


def unevenly(n: int, ranks: int) -> np.ndarray:
    return np.sort(np.random.default_rng(n).integers(0, ranks, n) ** 2 // max(ranks - 1, 1))


COLUMNS = (
    *("masses", "movable", "friction", "angles", "angular_velocities"),
    *("categories", "masks", "sensors"),
)
SETTINGS = (
    *("gravity", "drag", "container", "container_restitution", "walls", "wall_velocities"),
    *("wall_restitution", "wall_friction", "forces", "on_touch", "substeps", "sleeping"),
)


def scattered(comm: MPI.Comm, world: jostle.World, where: Distribution) -> jostle.mpi.World:
    """This rank's part of a world."""
    mine = where(len(world), comm.size) == comm.rank
    columns = {name: getattr(world, name)[mine] for name in COLUMNS}
    settings: dict[str, Any] = {name: getattr(world, name) for name in SETTINGS}
    # One number is the world's.
    is_one = (world.restitutions == 1).all()
    restitution = world.restitution if is_one else world.restitutions[mine]
    return jostle.mpi.World(
        comm,
        world.positions[mine],
        world.velocities[mine],
        world.radii[mine],
        restitution=restitution,
        **columns,
        **settings,
    )


class Expected(NamedTuple):
    """The world of one process after its steps."""

    hashes: list[int]  # before the first step, and after every `CHECK_EVERY`
    contacts: dict[str, np.ndarray]
    collisions: tuple[int, int]
    kinetic_energy: float


def expected_of(world: jostle.World, dt: float, steps: int) -> Expected | None:
    """Step the world of one process, on the first rank; all ranks get the result."""
    found = None
    if ALL.rank == 0:
        hashes = [world.state_hash()]
        for now in counts(steps):
            world.step(dt, now)
            hashes.append(world.state_hash())
        contacts = {kind: table_of(getattr(world, kind)) for kind in CONTACTS}
        found = Expected(hashes, contacts, tuple(world.collisions), world.kinetic_energy)
    wait_for_all()
    return ALL.bcast(found)


CONTACTS = ("contacts", "wall_contacts")


def counts(steps: int) -> list[int]:
    """The numbers of steps between two comparisons."""
    return [min(CHECK_EVERY, steps - done) for done in range(0, steps, CHECK_EVERY)]


def table_of(columns: Any) -> np.ndarray:
    """Contacts as a sorted table."""
    table = np.column_stack([np.asarray(column, np.float64) for column in columns])
    return table[np.lexsort((table[:, 2], table[:, 1], table[:, 0]))]


def check(
    name: str, world: jostle.World, dt: float = DT, steps: int = STEPS, where: Distribution = evenly
) -> None:
    """Compare a world that is distributed over each number of ranks with one process."""
    begun = world.snapshot()
    expected = expected_of(world, dt, steps)

    def compare(comm: MPI.Comm) -> None:
        check_on(comm, name, jostle.World.restore(begun), (dt, steps), where, expected)

    on_each_number_of_ranks(compare)


def check_on(
    comm: MPI.Comm,
    name: str,
    world: jostle.World,
    time_of: tuple[float, int],
    where: Distribution,
    expected: Expected,
) -> jostle.mpi.World:
    dt, steps = time_of
    ours = scattered(comm, world, where)
    # Particles move to other ranks often.
    ours._core._rebalance_every(4)
    name = f"{name} on {comm.size} ranks"
    assert ours.state_hash() == expected.hashes[0], f"{name}: before the first step"
    done = 0
    for now, one in zip(counts(steps), expected.hashes[1:], strict=True):
        ours.step(dt, now)
        done += now
        found = ours.state_hash()
        assert found == one, f"{name}: {found:#x} is not {one:#x} after {done} steps"
    assert sum(comm.allgather(len(ours))) == len(world) == ours.total
    energy = expected.kinetic_energy
    assert abs(ours.kinetic_energy - energy) <= 1e-12 * energy
    check_touches(comm, name, ours, expected)
    if comm.rank == 0:
        print(name, ours.traffic, flush=True)
    return ours


def check_touches(comm: MPI.Comm, name: str, ours: jostle.mpi.World, expected: Expected) -> None:
    """The contacts of all ranks together are those of one process. Sums of the impulses of several
    bounces of a pair in a step may be rounded differently."""
    for kind in CONTACTS:
        of_ranks = zip(*comm.allgather(getattr(ours, kind)), strict=True)
        found = table_of([np.concatenate(column) for column in of_ranks])
        one = expected.contacts[kind]
        assert found.shape == one.shape, f"{name}: {kind}"
        assert np.array_equal(found[:, :-2], one[:, :-2]), f"{name}: {kind}"
        scale = np.abs(one[:, -2:]).max(initial=1.0)
        assert np.allclose(found[:, -2:], one[:, -2:], rtol=1e-6, atol=1e-6 * scale), name
    assert tuple(ours.collisions) == expected.collisions, name


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
    check("gas", gas())
    for where in (all_on_first, all_on_last, unevenly):
        check("gas", gas(), 1 / 60, 30, where)


def test_scenes() -> None:
    """All scenes that are not refused."""
    done = []
    for name in jostle.scenes.names():
        world = jostle.scenes.create(name, n=100, seed=3)
        world.sleeping = False
        try:
            scattered(ALL, world, evenly)
        except ValueError:
            continue
        check(name, world, DT, 5, unevenly)
        done.append(name)
    assert {"gas", "pile"} <= set(done), done


def test_piles() -> None:
    rest: dict[str, Any] = {"gravity": (0.0, 30.0), "restitution": 0.4, "sleeping": False}
    check("pile", gas(300, **rest), steps=8)
    for where in (all_on_first, unevenly):
        check("pile", gas(300, **rest), DT, 4, where)
    check("friction", gas(200, friction=0.5, **rest), steps=6)
    masses = np.where(np.arange(200) % 5 == 0, 30.0, 1.0)
    check("uneven masses", gas(200, masses=masses, **rest), steps=5)
    walls = jostle.polyline([(0, 30), (15, 36), (30, 20)])
    check("walls", gas(200, walls=walls, friction=0.3, **rest), steps=6)
    movable = np.arange(200) % 9 > 0
    still = gas(200, movable=movable, velocities=np.zeros((200, 2)), **rest)
    check("obstacles", still, steps=6)


def test_long(steps: int = 30) -> None:
    """A larger gas and a larger pile."""
    check("gas", jostle.scenes.create("gas", n=3000, seed=3), DT, steps)
    pile = jostle.scenes.create("pile", n=400, seed=3)
    pile.sleeping = False
    check("pile", pile, DT, steps)


def test_search() -> None:
    """As `test_long`, for `make search ARGS=ranks`."""
    test_long(600)


def test_containers() -> None:
    check("torus", gas(container="torus"))
    check("plane", gas(container=None), steps=40)
    check("circle", gas(container=jostle.Circle((22, 22), 40)), steps=50)
    # Steps so long that they are divided, and trajectories around the torus.
    check("long steps on a torus", gas(200, container="torus"), 0.5, 10)
    check("long steps", gas(200, cover=0.05), 0.5, 10)
    walls = jostle.polyline([(5, 5), (20, 25), (30, 10)])
    check("walls", gas(walls=walls), steps=50)


def test_rules() -> None:
    # A granular gas with friction: it cools down and forms clusters.
    cooling = gas(restitution=0.8, friction=0.3, angular_velocities=2.0, container="torus")
    check("granular gas", cooling)
    check("gravity, elastic", gas(gravity=(0, 30)), steps=50)
    check("damping and sub-steps", gas(drag=0.5, substeps=3), steps=50)
    check("ignore", gas(on_touch="ignore"), steps=40)
    hot = jostle.ThermalWalls(400.0, seed=3)
    check("thermal walls", gas(forces=[hot]), steps=50)
    check("thermostat", gas(forces=[jostle.Thermostat(30.0, 0.5)]), steps=50)
    bath = jostle.AndersenThermostat(400.0, 2.0, seed=3)
    check("bath", gas(forces=[bath], container="torus"), steps=50)
    kinds = np.arange(600) % 3
    check("filters", gas(categories=1 << kinds, masks=7 ^ (1 << kinds)), steps=50)
    check("sensors", gas(sensors=kinds == 0), steps=50)
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
    check("a line", jostle.World(row, velocities, radii=1.0), DT, 20, unevenly)
    lattice = np.stack(np.meshgrid(np.arange(12.0), np.arange(12.0)), -1).reshape(-1, 2)
    lattice[:, 0] += 0.5 * (np.arange(144) // 12 % 2)
    lattice[:, 1] *= np.sqrt(0.75)
    velocities = np.zeros((144, 2))
    velocities[:12] = (0.0, 9.0)
    check("a rack", jostle.World(lattice * 2, velocities, radii=1.0), DT, 20)
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
    check("a fast disc", world, 1 / 60, 40)
    positions, radii = gas(500).positions.copy(), gas(500).radii.copy()
    positions[7], radii[7] = (22, 22), 15.0
    far = np.hypot(*(positions - positions[7]).T) > 16.5
    far[7] = True
    count = int(far.sum())
    options = {"radii": radii[far], "container": jostle.Torus(60, 60)}
    giant = jostle.World(positions[far], rng.normal(0, 20, (count, 2)), **options)
    check("a giant", giant, steps=50)
    positions = gas(300).positions.copy()
    positions[5] = (3e5, -2e5)
    check("far away", jostle.World(positions, rng.normal(0, 20, (300, 2)), radii=0.5), DT, 20)


def test_files() -> None:
    """A saved world continues with the same bits on other numbers of ranks, and in one process."""
    world = gas(2000)
    begun = world.snapshot()
    expected = expected_of(world, DT, 2 * CHECK_EVERY)
    on_each_number_of_ranks(lambda comm: save_and_load(comm, jostle.World.restore(begun), expected))


def save_and_load(comm: MPI.Comm, world: jostle.World, expected: Expected) -> None:
    folder = Path(comm.bcast(tempfile.mkdtemp() if comm.rank == 0 else None))
    half, last = expected.hashes[1:]
    ours = scattered(comm, world, evenly)
    ours._core._rebalance_every(7)
    ours.step(DT, CHECK_EVERY)
    assert ours.state_hash() == half
    ours.save(folder / "world")
    assert sorted(path.name for path in folder.iterdir()) == ["world"]
    # All ranks, one rank alone, and groups of two.
    for some in (comm, MPI.COMM_SELF, comm.Split(comm.rank // 2)):
        again = jostle.mpi.World.load(some, folder / "world")
        assert again.time == ours.time and again.total == len(world)
        again.step(DT, CHECK_EVERY)
        assert again.state_hash() == last
    alone = ours.gather(comm.size - 1)
    assert (alone is not None) == (comm.rank == comm.size - 1)
    if alone is not None:
        assert alone.state_hash() == ours_hash_of(alone)
        alone.step(DT, CHECK_EVERY)
        assert alone.state_hash() == last
    for root in (-1, comm.size):
        refuse(lambda root=root: ours.gather(root), f"root is {root}")
    comm.Barrier()
    # A damaged file, one that is cut off, another file, and none.
    whole = (folder / "world").read_bytes()
    comm.Barrier()
    damaged = whole[:-30] + bytes([whole[-30] ^ 1]) + whole[-29:]
    for name, data, message in (
        ("damaged", damaged, "is damaged"),
        ("short", whole[:-1], "is cut off"),
        ("other", b"something else", "is not a file"),
    ):
        if comm.rank == 0:
            (folder / name).write_bytes(data)
        comm.Barrier()
        refuse(lambda name=name: jostle.mpi.World.load(comm, folder / name), message)
    refuse(lambda: jostle.mpi.World.load(comm, folder / "none"), "none")
    # A file that cannot be written leaves the old one as it was.
    refuse(lambda: ours.save(folder / "no" / "where"), "no")
    assert (folder / "world").read_bytes() == whole
    comm.Barrier()
    if comm.rank == 0:
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
    world = scattered(ALL, gas(), evenly)
    world.step(1 / 60, 5)
    if ALL.rank == ALL.size - 1:
        os.kill(os.getpid(), signal.SIGKILL)
    world.step(1 / 60, 1_000_000)


def test_pressed() -> None:
    on_each_number_of_ranks(press)


def press(comm: MPI.Comm) -> None:
    """Ctrl-C on one rank ends the call on all, between two steps."""
    world = scattered(comm, gas(), evenly)
    if comm.rank == comm.size - 1:
        threading.Timer(1.0, signal.raise_signal, [signal.SIGINT]).start()
    try:
        world.step(1 / 60, 1_000_000)
    except KeyboardInterrupt:
        assert comm.rank == comm.size - 1
    except jostle.mpi.RankError as error:
        assert str(error) == f"rank {comm.size - 1}: KeyboardInterrupt"
    else:
        raise AssertionError("the call ends")
    times = comm.allgather(world.time)
    assert times[0] == times[-1] > 0
    before = world.state_hash()
    world.step(1 / 60)
    assert world.state_hash() != before


def test_errors() -> None:
    on_each_number_of_ranks(refuse_all)


def refuse_all(comm: MPI.Comm) -> None:
    """What is refused is refused on all ranks, and an error leaves the world as it was."""
    rest = {"gravity": (0.0, 9.8), "restitution": 0.5}  # and sleeping=True
    world = scattered(comm, gas(50), evenly)
    # So many that their text would be shortened; one in the middle differs.
    walls = np.arange(600.0)[:, None, None] * 2 + np.array([[[0.0, 0.0], [1.0, 0.0]]])
    walls[300, 1, 1] += comm.rank
    refused: list[tuple[str, Callable[[], Any]]] = [
        ("sleeping", lambda: scattered(comm, gas(50, **rest), evenly).step(1 / 60)),
        ("on_touch", lambda: scattered(comm, gas(50, on_touch="merge"), evenly)),
        ("forces[0]", lambda: scattered(comm, gas(50, forces=[jostle.Gravitation(1.0)]), evenly)),
        ("track_events", lambda: jostle.mpi.World(comm, [], [], [], track_events=True)),
        ("dt", lambda: world.step(-1.0)),
        ("gravity", lambda: jostle.mpi.World(comm, [], [], [], gravity=(comm.rank, 0))),
        ("walls", lambda: jostle.mpi.World(comm, [], [], [], walls=walls)),
    ]
    for argument, call in refused:
        if argument in ("gravity", "walls") and comm.size == 1:
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
        comm,
        gas(50, velocities=np.where(np.arange(50)[:, None] == 49, 1e18, 1.0) * np.ones((50, 2))),
        evenly,
    )
    try:
        hurried.step(100.0)
    except ValueError as error:
        assert comm.rank == comm.size - 1 and "dt" in str(error), error
    except jostle.mpi.RankError as error:
        assert comm.rank < comm.size - 1, error
        assert f"rank {comm.size - 1}: ValueError: dt" in str(error), error
    else:
        raise AssertionError("the step is refused")
    hurried.step(1e-18)
    assert world.state_hash() == before and world.time == 0.0


run(globals()[f"test_{sys.argv[1]}"], "all bits are right")
