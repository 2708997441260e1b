"""A program of test_mpi_world: compares the hashes of distributed worlds with one process."""

import os
import resource
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mpi4py import MPI
from mpi_groups import ALL, on_each_number_of_ranks, run

import jostle
import jostle.mpi
import jostle.mpi.storage

COMM = ALL  # of the present group
STEPS = 100
CHECK_EVERY = 25  # steps
CONTACTS = ("contacts", "wall_contacts")

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
#: A pile that stays awake.
REST: dict[str, Any] = {"gravity": (0.0, 30.0), "restitution": 0.4, "sleeping": False}

SETTINGS = (
    *("gravity", "drag", "container", "container_restitution", "walls", "wall_velocities"),
    *(
        "wall_restitution",
        "wall_friction",
        "forces",
        "on_touch",
        "substeps",
        "sleeping",
        "track_events",
    ),
)


def scattered(world: jostle.World, where: Distribution) -> jostle.mpi.World:
    """This rank's part of a world."""
    mine = parts(len(world), where)
    columns = {name: getattr(world, name)[mine] for name in COLUMNS}
    settings: dict[str, Any] = {name: getattr(world, name) for name in SETTINGS}
    settings["forces"] = [
        jostle.PairForce(force.kinds[mine], force.table, force.cutoff, force.damping)
        if isinstance(force, jostle.PairForce)
        else force
        for force in world.forces
    ]
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


class Expected(NamedTuple):
    """The world of one process after its steps."""

    hashes: list[int]  # before the first step, and after every `CHECK_EVERY`
    contacts: dict[str, np.ndarray]
    collisions: Any
    kinetic_energy: float


#: By the name of a world, its first hash and its steps: those of other numbers of ranks are equal.
EXPECTED: dict[tuple[str, int, float, int], Expected] = {}


def expected_of(name: str, world: jostle.World, dt: float, steps: int) -> Expected:
    """Step the world of one process, on the first rank; all ranks get the result."""
    key = (name, world.state_hash(), dt, steps)
    if key not in EXPECTED:
        found = None
        if COMM.rank == 0:
            world = jostle.World.restore(world.snapshot())
            hashes = [world.state_hash()]
            for now in counts(steps):
                world.step(dt, now)
                hashes.append(world.state_hash())
            found = expected_now(world, hashes)
        COMM.Barrier()
        EXPECTED[key] = COMM.bcast(found)
    return EXPECTED[key]


def expected_now(world: jostle.World, hashes: list[int]) -> Expected:
    """What distributed worlds must have at this time."""
    contacts = {kind: table_of(getattr(world, kind)) for kind in CONTACTS}
    return Expected(hashes, contacts, world.collisions, world.kinetic_energy)


def counts(steps: int) -> list[int]:
    """The numbers of steps between two comparisons."""
    return [min(CHECK_EVERY, steps - done) for done in range(0, steps, CHECK_EVERY)]


def table_of(columns: Any) -> np.ndarray:
    """Contacts as a sorted table."""
    table = np.column_stack([np.asarray(column, np.float64) for column in columns])
    return table[np.lexsort((table[:, 2], table[:, 1], table[:, 0]))]


def check(
    name: str, world: jostle.World, dt: float, steps: int = STEPS, where: Distribution = evenly
) -> jostle.mpi.World:
    """Compare a distributed world with one process; `world` remains as it is."""
    expected = expected_of(name, world, dt, steps)
    ours = scattered(world, where)
    # Particles move to other ranks often.
    ours._core._rebalance_every(7)
    assert ours.state_hash() == expected.hashes[0], f"{name}: before the first step"
    done = 0
    for now, one in zip(counts(steps), expected.hashes[1:], strict=True):
        ours.step(dt, now)
        done += now
        found = ours.state_hash()
        assert found == one, f"{name}: {found:#x} is not {one:#x} after {done} steps"
    assert sum(COMM.allgather(len(ours))) == len(world) == ours.total
    energy = expected.kinetic_energy
    assert abs(ours.kinetic_energy - energy) <= 1e-12 * energy
    check_touches(name, ours, expected)
    if COMM.rank == 0:
        print(name, ours.traffic, flush=True)
    return ours


def check_touches(name: str, ours: jostle.mpi.World, expected: Expected) -> None:
    """The contacts of all ranks together are those of one process. Sums of the impulses of several
    bounces of a pair in a step may be rounded differently."""
    for kind in CONTACTS:
        of_ranks = zip(*COMM.allgather(getattr(ours, kind)), strict=True)
        found = table_of([np.concatenate(column) for column in of_ranks])
        one = expected.contacts[kind]
        assert found.shape == one.shape, f"{name}: {kind}"
        assert np.array_equal(found[:, :-2], one[:, :-2]), f"{name}: {kind}"
        scale = np.abs(one[:, -2:]).max(initial=1.0)
        assert np.allclose(found[:, -2:], one[:, -2:], rtol=1e-6, atol=1e-6 * scale), name
    assert ours.collisions == expected.collisions, name


def check_events(name: str, ours: jostle.mpi.World, world: jostle.World) -> int:
    """The events of all ranks together are those of one process; returns how many these are."""
    found = [np.concatenate(parts) for parts in zip(*COMM.allgather(ours.events), strict=True)]
    for pairs, expected in zip(found, world.events, strict=True):
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
        assert np.array_equal(pairs, expected), f"{name} at {world.time}"
    return sum(map(len, found))


def main(which: str) -> None:
    def test(comm: MPI.Comm) -> None:
        global COMM
        COMM = comm
        globals()[f"test_{which}"]()

    run(lambda: on_each_number_of_ranks(test), "all bits are right")


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


def sleepers(n: int = 10, falling: int = 2, **options: Any) -> jostle.World:
    """Triangles that fall asleep soon, a row of discs that touch, and discs that fall on them."""
    left = np.arange(n) * 6.0 + 3.0
    corners = np.array([(-1.0, 1.0), (1.0, 1.0), (0.0, 1.0 + np.sqrt(3.0))])
    row = np.column_stack([left[-1] + 5.0 + 2.0 * np.arange(n), np.ones(n)])
    late = np.array([(left[n // 2] + 0.5, 55.0), (row[n // 2, 0] + 0.3, 90.0)])
    triangles = np.concatenate([corners + np.array([x, 0.0]) for x in left])
    positions = np.concatenate([triangles, row, late[:falling]])
    rules = {"gravity": (0.0, -9.8), "restitution": 0.3, "friction": 0.6, "substeps": 2} | options
    width = float(row[-1, 0]) + 3.0
    return jostle.World(
        positions, np.zeros_like(positions), 1.0, container=jostle.Box(0, 0, width, 200), **rules
    )


def check_asleep(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """The same state and the same sleeping particles."""
    found, expected = ours.state_hash(), world.state_hash()
    assert found == expected, f"{name}: {found:#x} is not {expected:#x} at {world.time}"
    ids, asleep = (np.concatenate(COMM.allgather(of)) for of in (ours.ids, ours.asleep))
    assert np.array_equal(asleep[np.argsort(ids)], world.asleep), f"{name} at {world.time}"
    check_touches(name, ours, expected_now(world, [expected]))


def test_sleeping() -> None:
    """Islands that several ranks have fall asleep and wake as in one process."""
    for where in (evenly, all_on_first, unevenly):
        world = sleepers()
        ours = scattered(world, where)
        ours._core._rebalance_every(7)
        counts = []
        for _ in range(14):
            world.step(1 / 30, 12)
            ours.step(1 / 30, 12)
            check_asleep("sleeping", ours, world)
            counts.append(int(world.asleep.sum()))
        # Some wake when discs fall on them.
        assert max(counts) > 30 and np.diff(counts).min() < 0, counts
    walls = jostle.polyline([(0, 3), (9, 5), (30, 4)])
    tracked = sleepers(walls=walls, track_events=True)
    ours = scattered(tracked, unevenly)
    for _ in range(8):
        tracked.step(1 / 30, 12)
        ours.step(1 / 30, 12)
        check_asleep("walls", ours, tracked)
        check_events("walls", ours, tracked)
    assert tracked.asleep.sum() > 10
    # Kinematic particles keep others awake; static ones do not.
    movable = np.arange(42) % 5 > 0
    still = sleepers(movable=movable)
    still.velocities = np.where(np.arange(42)[:, None] == 30, [[0.1, 0.0]], 0.0)
    ours = scattered(still, evenly)
    for _ in range(5):
        still.step(1 / 30, 12)
        ours.step(1 / 30, 12)
        check_asleep("obstacles", ours, still)
    assert still.asleep.any()
    # A kinematic disc moves to sleeping ones, and wakes them.
    coming = sleepers(8, falling=1, movable=np.arange(33) < 32)
    coming.set(32, positions=(3.0, 150.0), velocities=(0.0, -60.0))
    ours = scattered(coming, evenly)
    counts = []
    for _ in range(8):
        coming.step(1 / 30, 12)
        ours.step(1 / 30, 12)
        check_asleep("a kinematic disc", ours, coming)
        counts.append(int(coming.asleep.sum()))
    assert np.diff(counts).min() < 0, counts


def test_calls_of_sleepers() -> None:
    """A world of which all sleeps takes one call of all ranks for a step."""
    world = sleepers(4, falling=0)
    ours = scattered(world, evenly)
    ours._core._rebalance_every(1000)
    ours.step(1 / 60, 120)
    assert sum(COMM.allgather(int(ours.asleep.sum()))) == ours.total
    before = ours.traffic["calls"]
    ours.step(1 / 60, 10)
    assert ours.traffic["calls"] - before == 10


def of_rank(rows: np.ndarray) -> np.ndarray:
    """Every rank's share of some rows, in the order of ranks."""
    return np.array_split(rows, COMM.size)[COMM.rank]


def edits() -> list[tuple[str, Callable[[Any, Callable[..., Any]], None]]]:
    """Changes of a world; the second argument gives a rank's share of rows."""
    new = np.column_stack([np.arange(7) * 9.0 + 4.0, np.full(7, 30.0)])
    still = np.zeros((7, 2))
    gone = np.array([2, 17, 31, 9])
    pushed, static = np.array([20, 5]), np.array([0])

    def wall(world: Any, _: Callable[..., Any]) -> None:
        world.wall_velocities = [(0.0, 0.4)]

    def stop(world: Any, _: Callable[..., Any]) -> None:
        world.wall_velocities = [(0.0, 0.0)]

    def lighter(world: Any, _: Callable[..., Any]) -> None:
        world.gravity = (0.0, -9.0)

    return [
        ("a push", lambda w, own: w.set(own(pushed), velocities=own(np.ones((2, 2))))),
        ("nothing", lambda w, own: w.set(own(pushed[:0]), radii=own(np.zeros(0)))),
        ("added", lambda w, own: w.add(own(new), own(still), own(np.full(7, 0.5)), friction=0.5)),
        ("removed", lambda w, own: w.remove(own(gone))),
        ("driven", lambda w, own: w.set(own(static), velocities=own(np.full((1, 2), 0.02)))),
        ("no more", lambda w, own: w.set(own(static), velocities=own(np.zeros((1, 2))))),
        ("the static disc is removed", lambda w, own: w.remove(own(static))),
        ("a moving wall", wall),
        ("a wall that stops", stop),
        ("gravity", lighter),
        ("friction", lambda w, own: w.set(own(pushed + 3), friction=own(np.ones(2)))),
        (
            "obstacles",
            lambda w, own: w.add(own(new + 9.0), own(still), 1.0, movable=False, friction=0.6),
        ),
    ]


def resting(**options: Any) -> jostle.World:
    """Triangles on a static disc and on a wall, which fall asleep."""
    world = sleepers(
        8, falling=1, walls=[[(60.0, 0.5), (75.0, 0.5)]], movable=np.arange(33) > 0, **options
    )
    assert len(world) == 33
    return world


def test_edits() -> None:
    """Particles that are added, removed and changed while others sleep."""
    folder = Path(COMM.bcast(tempfile.mkdtemp() if COMM.rank == 0 else None))
    for where in (evenly, all_on_last)[: 1 if COMM.size > 2 else 2]:
        world = resting(track_events=True)
        ours = scattered(world, where)
        ours._core._rebalance_every(5)
        counts = set()
        for number, (name, change) in enumerate(edits()):
            for _ in range(2):
                world.step(1 / 30, 16)
                ours.step(1 / 30, 16)
            check_asleep(f"before {name}", ours, world)
            check_events(name, ours, world)
            change(world, lambda rows: rows)
            change(ours, of_rank)
            check_asleep_now(f"after {name}", ours, world)
            counts.add(int(world.asleep.sum()))
            if name in ("removed", "obstacles") and where is evenly:
                check_saved(folder / str(number), ours, world, 0)
        world.step(1 / 30, 16)
        ours.step(1 / 30, 16)
        check_asleep("the last", ours, world)
        assert len(counts) > 3 and ours.total == len(world) == 33 + 7 - 4 - 1 + 7
    COMM.Barrier()
    if COMM.rank == 0:
        shutil.rmtree(folder)
    check_refused_edits()


def check_asleep_now(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """As `check_asleep`, without contacts, which are those of a step."""
    assert ours.state_hash() == world.state_hash(), name
    ids, asleep = (np.concatenate(COMM.allgather(of)) for of in (ours.ids, ours.asleep))
    assert np.array_equal(np.sort(ids), world.ids), name
    assert np.array_equal(asleep[np.argsort(ids)], world.asleep), name


def check_refused_edits() -> None:
    ours = scattered(gas(50), evenly)
    before, ids = ours.state_hash(), ours.ids
    last = COMM.rank == COMM.size - 1
    none = np.zeros((0, 2))
    for call, message in (
        (lambda: ours.remove([7, 99] if last else []), "ids contain 99; no particle"),
        (lambda: ours.remove([7, 7] if last else []), "ids contain 7 twice"),
        (lambda: ours.remove([0.5] if last else []), "ids must be integers"),
        (lambda: ours.set([3] if last else [], radii=-1.0 if last else 1.0), "radii"),
        (lambda: ours.add([(1, 1)] if last else none, [(1, 1)] if last else none, -1.0), "radii"),
        (lambda: setattr(ours, "drag", -1.0 if last else 0.0), "drag"),
    ):
        refuse(call, message)
    if COMM.size > 1:
        refuse(lambda: setattr(ours, "drag", COMM.rank * 0.5), "drag is not the same")
        refuse(lambda: ours.step(0.1 + COMM.rank), "dt is not the same")
        refuse(lambda: ours.step(0.1, 1 + COMM.rank), "steps is not the same")
        columns = {"radii": 1.0} if last else {"masses": 1.0}
        refuse(lambda: ours.set([], **columns), "the columns are not the same")
    assert ours.state_hash() == before and np.array_equal(ours.ids, ids)
    ours.step(1 / 60)


def test_rebalancing() -> None:
    """Domains are chosen again when a rank has too much work, and results do not depend on it."""
    world = gas(600, velocities=np.zeros((600, 2)))
    ours = scattered(world, all_on_first)

    def steps(count: int, work: float) -> int:
        for _ in range(count):
            ours._core._set_work(work)
            ours._core._step_distributed(1 / 60)
        world.step(1 / 60, count)
        assert ours.state_hash() == world.state_hash()
        numbers = COMM.allgather(ours.traffic["rebalances"])
        assert min(numbers) == max(numbers)
        return int(numbers[0])

    assert steps(40, 1.0) == 1
    even = len(ours)
    assert COMM.size == 1 or abs(even - 600 / COMM.size) < 60
    slow = COMM.rank == 0
    count = steps(60, 3.0 if slow else 1.0)
    assert count == 1 if COMM.size == 1 else 2 <= count <= 5, count
    assert COMM.size == 1 or (len(ours) < even - 30) == slow


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
    rest = REST
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
    check("gas", jostle.scenes.create("gas", n=3000, seed=3), 1 / 60, 300)
    pile = jostle.scenes.create("pile", n=400, seed=3)
    pile.sleeping = False
    check("pile", pile, 1 / 60, 300)


def test_containers() -> None:
    check("torus", gas(container="torus"), 1 / 20, 100)
    check("plane", gas(container=None), 1 / 20, 40)
    check("circle", gas(container=jostle.Circle((22, 22), 40)), 1 / 20, 50)
    # Steps so long that they are divided, and trajectories around the torus.
    check("long steps on a torus", gas(200, container="torus"), 0.5, 10)
    check("long steps", gas(200, cover=0.05), 0.5, 10)
    walls = jostle.polyline([(5, 5), (20, 25), (30, 10)])
    check("walls", gas(walls=walls), 1 / 20, 50)


def test_rules() -> None:
    # A granular gas with friction: it cools down and forms clusters.
    cooling = gas(restitution=0.8, friction=0.3, angular_velocities=2.0, container="torus")
    check("granular gas", cooling, 1 / 20, 100)
    check("gravity, elastic", gas(gravity=(0, 30)), 1 / 20, 50)
    check("damping and sub-steps", gas(drag=0.5, substeps=3), 1 / 20, 50)
    check("ignore", gas(on_touch="ignore"), 1 / 20, 40)
    hot = jostle.ThermalWalls(400.0, seed=3)
    check("thermal walls", gas(forces=[hot]), 1 / 20, 50)
    check("thermostat", gas(forces=[jostle.Thermostat(30.0, 0.5)]), 1 / 20, 50)
    bath = jostle.AndersenThermostat(400.0, 2.0, seed=3)
    check("bath", gas(forces=[bath], container="torus"), 1 / 20, 50)
    kinds = np.arange(600) % 3
    check("filters", gas(categories=1 << kinds, masks=7 ^ (1 << kinds)), 1 / 20, 50)
    check("sensors", gas(sensors=kinds == 0), 1 / 20, 50)
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
    check("a giant", giant, 1 / 20, 50)
    positions = gas(300).positions.copy()
    positions[5] = (3e5, -2e5)
    check("far away", jostle.World(positions, rng.normal(0, 20, (300, 2)), radii=0.5), 1 / 60, 60)


def test_files() -> None:
    """A saved world continues with the same bits on other numbers of ranks, and in one process."""
    folder = Path(COMM.bcast(tempfile.mkdtemp() if COMM.rank == 0 else None))
    # More than a chunk of ids, so that several ranks write.
    still: dict[str, Any] = {"movable": np.arange(20_000) < 2000, "cover": 0.3}
    world = gas(20_000, velocities=np.zeros((20_000, 2)), **still)
    world.velocities = (
        np.random.default_rng(1).normal(0, 20, (20_000, 2)) * still["movable"][:, None]
    )
    check_file(folder / "world", world, 2)
    walls = jostle.polyline([(0, 12), (9, 14), (14, 9)])
    check_file(folder / "pile", gas(60, friction=0.4, walls=walls, **REST), 30)
    # Some sleep when it is saved, and some wake later.
    for done in (110, 190):
        world = sleepers(5)
        world.step(1 / 60, done)
        ours = scattered(sleepers(5), unevenly)
        ours.step(1 / 60, done)
        assert 0 < world.asleep.sum() < len(world)
        check_asleep("before the file", ours, world)
        check_saved(folder / f"sleepers-{done}", ours, world, 60)
    check_refused_files(folder)
    check_failed_writing(folder)
    COMM.Barrier()
    if COMM.rank == 0:
        shutil.rmtree(folder)


def check_file(path: Path, world: jostle.World, steps: int) -> None:
    ours = check(path.name, world, 1 / 60, steps)
    world.step(1 / 60, steps)
    check_saved(path, ours, world, steps)


def check_saved(path: Path, ours: jostle.mpi.World, world: jostle.World, steps: int) -> None:
    ours.save(path)
    COMM.Barrier()
    asleep = world.asleep
    assert not list(path.parent.glob(".*")), "nothing is left beside the file"
    world.step(1 / 60, steps)
    # All ranks, one rank alone, and groups of two.
    for comm in (COMM, MPI.COMM_SELF, COMM.Split(COMM.rank // 2)):
        again = jostle.mpi.World.load(comm, path)
        assert again.time == ours.time and again.total == len(world)
        assert np.array_equal(again.asleep, asleep[np.searchsorted(world.ids, again.ids)])
        again.step(1 / 60, steps)
        assert again.state_hash() == world.state_hash()
    alone = ours.gather(COMM.size - 1)
    assert (alone is not None) == (COMM.rank == COMM.size - 1)
    if alone is not None:
        plain = jostle.World.load(path)
        assert plain.time == alone.time and plain.walls.shape == world.walls.shape
        for one in (alone, plain):
            assert np.array_equal(one.asleep, asleep)
            assert one.state_hash() == ours_hash_of(one)
            one.step(1 / 60, steps)
            assert one.state_hash() == world.state_hash()
    for root in (-1, COMM.size):
        refuse(lambda root=root: ours.gather(root), f"root is {root}")
    # Any number of ranks writes the same file.
    ours.step(1 / 60, steps)
    whole = path.read_bytes()
    again = jostle.mpi.World.load(MPI.COMM_SELF, path)
    again.save(path.with_name(f"{COMM.rank}"))
    assert path.with_name(f"{COMM.rank}").read_bytes() == whole


def check_refused_files(folder: Path) -> None:
    """A damaged file, one that is cut off, another file, and none."""
    whole = (folder / "pile").read_bytes()
    for name, data, message in (
        ("damaged", whole[:-30] + bytes([whole[-30] ^ 1]) + whole[-29:], "is damaged"),
        ("short", whole[:-1], "is cut off"),
        ("shorter", whole[:30], "is cut off"),
        ("other", b"something else", "is not a file"),
    ):
        if COMM.rank == 0:
            (folder / name).write_bytes(data)
        COMM.Barrier()
        refuse(lambda name=name: jostle.mpi.World.load(COMM, folder / name), message)
        refuse(lambda name=name: jostle.World.load(folder / name), f"{folder / name} holds")
    refuse(lambda: jostle.mpi.World.load(COMM, folder / "none"), "none")


def check_failed_writing(folder: Path) -> None:
    """A file that cannot be written leaves the old one as it was, and no rank waits for others."""
    path = folder / "world"
    whole = path.read_bytes()
    COMM.Barrier()
    ours = scattered(gas(50), evenly)
    refuse(lambda: ours.save(folder / "no" / "where"), "no")
    storage, last = jostle.mpi.storage, COMM.rank == COMM.size - 1

    class Full:
        """A file on a disk that is full for the last rank."""

        def __init__(self, file: MPI.File) -> None:
            self._file = file

        def __getattr__(self, name: str) -> Any:
            return getattr(self._file, name)

        def Write_at(self, *arguments: Any) -> None:
            if last:
                raise MPI.Exception(MPI.ERR_NO_SPACE)
            self._file.Write_at(*arguments)

    class Files:
        File = type("File", (), {"Open": lambda *of: Full(MPI.File.Open(*of))})

        def __getattr__(self, name: str) -> Any:
            return getattr(MPI, name)

    storage.MPI = Files()
    try:
        ours.save(path)
    except OSError as error:
        assert last and "world" in str(error), error
    except jostle.mpi.RankError as error:
        assert not last and f"rank {COMM.size - 1}: OSError" in str(error), error
    else:
        raise AssertionError("the disk is full")
    finally:
        storage.MPI = MPI
    COMM.Barrier()
    assert path.read_bytes() == whole and not list(folder.glob(".*"))
    # On all ranks, as the system says it.
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    refuse(lambda: ours.save(path), "world")
    resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    COMM.Barrier()
    assert path.read_bytes() == whole and not list(folder.glob(".*"))
    ours.save(path)


def ours_hash_of(world: jostle.World) -> int:
    return jostle.World.restore(world.snapshot()).state_hash()


def refuse(call: Callable[[], Any], message: str) -> None:
    """All ranks raise, with this message or that of the rank that has it."""
    try:
        call()
    except (ValueError, TypeError, OSError, jostle.mpi.RankError) as error:
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


def test_signals() -> None:
    """A signal handler that raises on one rank raises on all, after the call."""

    class Interrupted:
        """A core that is interrupted by a signal when its particles are read."""

        def __init__(self, core: Any) -> None:
            self._of = core

        def __getattr__(self, name: str) -> Any:
            return getattr(self._of, name)

        def _own_records(self) -> bytes:
            signal.raise_signal(signal.SIGUSR1)
            return self._of._own_records()

    def handler(*_: object) -> None:
        raise InterruptedError("told so")

    world, last = scattered(gas(50), evenly), COMM.rank == COMM.size - 1
    before, core = world.state_hash(), world._core
    signal.signal(signal.SIGUSR1, handler)
    if last:
        world._core = Interrupted(core)
    calls: list[Callable[[], Any]] = [
        world.state_hash,
        world.gather,
        lambda: world.kinetic_energy,
        lambda: world.momentum,
    ]
    for call in calls:
        try:
            call()
        except InterruptedError as error:
            assert last and str(error) == "told so", error
        except jostle.mpi.RankError as error:
            assert not last and "told so" in str(error), error
        else:
            raise AssertionError("the handler raises")
    world._core = core
    assert signal.getsignal(signal.SIGUSR1) is handler
    # A handler that does not raise runs, and changes nothing.
    told = []
    signal.signal(signal.SIGUSR1, lambda *_: told.append(world.time))
    if last:
        world._core = Interrupted(core)
    assert world.state_hash() == before
    assert told == [0.0] * last


def test_many() -> None:
    """MPI has a limited number of communicators; worlds use it up neither now nor later."""
    for comm in (COMM, MPI.COMM_SELF):
        for _ in range(1500):
            jostle.mpi.World(comm, [], [], [])


def test_forces() -> None:
    """Forces between neighbours, whose particles have neighbours on other ranks."""
    for name in ("life", "fluid", "flock"):
        check(name, jostle.scenes.create(name, n=300, seed=2), 1 / 60, 40, unevenly)
    kinds = np.arange(400) % 3
    table = np.random.default_rng(4).normal(0, 300, (3, 3, 12))
    long = jostle.PairForce(kinds, table, 11.0, damping=3.0)
    other = jostle.PairForce(np.arange(400) % 2, table[:2, :2], 4.0)
    flocking = jostle.Flocking(6.0, 40.0, 1.0, 0.5, max_speed=60.0)
    world = gas(400, forces=[long, flocking, other], container="torus", substeps=3)
    ours = check("three forces", world, 1 / 60, 25)
    alone = ours.gather()
    if alone is not None:
        assert np.array_equal(alone.forces[0].kinds, kinds)
        alone.step(1 / 60, 5)
    ours.step(1 / 60, 5)
    state = COMM.bcast(alone.state_hash() if alone is not None else None)
    assert ours.state_hash() == state
    ours = jostle.mpi.create_scene(COMM, "life", n=100, seed=3)
    assert ours.state_hash() == jostle.scenes.create("life", n=100, seed=3).state_hash()
    if COMM.size > 1:
        force = jostle.PairForce([], table * (1 + COMM.rank), 4.0)
        make = partial(jostle.mpi.World, COMM, [], [], [], forces=[force])
        refuse(make, "forces is not the same")


def test_events() -> None:
    """All ranks together have the events of one process, also of pairs that move to other ranks."""
    kinds = np.arange(400) % 5
    options: dict[str, Any] = {"track_events": True, "container": "torus"}
    still = {"movable": kinds > 1, "sensors": kinds < 2}
    for name, world, steps in (
        ("gas", gas(400, cover=0.6, **options), 3),
        ("sensors", gas(400, **still, **options), 4),
        ("ignore", gas(400, on_touch="ignore", **options), 2),
        ("rest", gas(40, track_events=True, **REST), 1),
    ):
        ours = scattered(world, unevenly)
        ours._core._rebalance_every(3)
        seen = 0
        for _ in range(8):
            world.step(1 / 60, steps)
            ours.step(1 / 60, steps)
            seen += check_events(name, ours, world)
        assert seen > 0, name
    try:
        _ = scattered(gas(9), evenly).events
    except RuntimeError as error:
        assert "track_events=True" in str(error)


def test_calls() -> None:
    """The numbers of calls of a step in docs/mpi.md."""
    size = COMM.size
    sparse = {"n": 200, "cover": 0.1}
    for container, calls in (("box", 16), (None, 17), ("torus", 19)):
        options = {} if container == "box" else {"container": container}
        world = scattered(gas(**sparse, **options), evenly)
        world._core._rebalance_every(1000)
        counts = []
        for _ in range(3):
            before = world.traffic["calls"]
            world.step(1 / 600)
            counts.append(world.traffic["calls"] - before)
        assert size == 1 or counts == [calls + 18, calls, calls], (container, counts)


def test_parts() -> None:
    """Scenes that are made in parts have the particles of one process."""
    for name in ("gas", "pile", "thermostat", "mixed", "clusters"):
        for n in (0, 1, 2, 7, 200):
            whole = jostle.scenes.create(name, n=n, seed=4)
            ours = jostle.mpi.create_scene(COMM, name, n=n, seed=4, sleeping=False)
            assert ours.state_hash() == whole.state_hash(), (name, n)
            assert ours.total == len(whole) and len(ours) <= len(whole) // COMM.size + 1
    for _ in range(2):
        whole.step(1 / 60, 10)
        ours.step(1 / 60, 10)
        assert ours.state_hash() == whole.state_hash()
    refuse(lambda: jostle.mpi.create_scene(COMM, "nothing"), "nothing")
    refuse(lambda: jostle.mpi.create_scene(COMM, "stars", n=10), "")


def test_errors() -> None:
    """What is refused is refused on all ranks, and an error leaves the world as it was."""
    world = scattered(gas(50), evenly)
    # So many that their text would be shortened; one in the middle differs.
    walls = np.arange(600.0)[:, None, None] * 2 + np.array([[[0.0, 0.0], [1.0, 0.0]]])
    walls[300, 1, 1] += COMM.rank
    refused: list[tuple[str, Callable[[], Any]]] = [
        ("on_touch", lambda: scattered(gas(50, on_touch="merge"), evenly)),
        ("forces[0]", lambda: scattered(gas(50, forces=[jostle.Gravitation(1.0)]), evenly)),
        ("dt", lambda: world.step(-1.0)),
        ("steps is -1", lambda: world.step(0.1, -1)),
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
        assert COMM.rank == COMM.size - 1 and "particle 49 would move" in str(error), error
    except jostle.mpi.RankError as error:
        assert COMM.rank < COMM.size - 1, error
        assert f"rank {COMM.size - 1}: ValueError: dt" in str(error), error
    else:
        raise AssertionError("the step is refused")
    hurried.step(1e-18)
    assert world.state_hash() == before and world.time == 0.0


main(sys.argv[1])
