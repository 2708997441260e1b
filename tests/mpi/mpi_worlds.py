"""Worlds of ranks and of one process, and their comparison. The programs of the tests use them."""

import shutil
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mpi4py import MPI

import jostle
import jostle.mpi
import jostle.mpi.storage

#: The ranks of the present test.
_ranks: MPI.Intracomm = MPI.COMM_WORLD


def comm() -> MPI.Intracomm:
    """The ranks of the present test."""
    return _ranks


def use(ranks: MPI.Intracomm) -> None:
    """Let these ranks make the next test."""
    global _ranks
    _ranks = ranks


def up_to(ranks: int) -> Callable[[Callable[[], None]], Callable[[], None]]:
    """Let a case run on up to so many ranks, because one more makes a difference there.

    A case without it runs on one rank and on two. With more ranks than cores each message waits for
    a rank that has a core.
    """

    def with_most(case: Callable[[], None]) -> Callable[[], None]:
        case.most_ranks = ranks
        return case

    return with_most


def most_ranks(case: Callable[[], None]) -> int:
    """The number of ranks that `up_to` has given to a case."""
    return getattr(case, "most_ranks", 2)


#: The modules of cases.
CASES = sorted(path.stem for path in Path(__file__).parent.glob("mpi_cases_*.py"))


STEPS = 100


CHECK_EVERY = 25  # steps


CONTACTS = ("contacts", "wall_contacts")


#: A distribution gives the rank of each particle, in ascending order.
Distribution = Callable[[int], np.ndarray]


def evenly(n: int) -> np.ndarray:
    return np.arange(n) * comm().size // max(n, 1)


def all_on_first(n: int) -> np.ndarray:
    return np.zeros(n, int)


def all_on_last(n: int) -> np.ndarray:
    return np.full(n, comm().size - 1)


def unevenly(n: int) -> np.ndarray:
    size = comm().size
    return np.sort(np.random.default_rng(n).integers(0, size, n) ** 2 // max(size - 1, 1))


def parts(n: int, where: Distribution) -> np.ndarray:
    return where(n) == comm().rank


COLUMNS = (
    *("masses", "movable", "friction", "angles", "angular_velocities"),
    *("categories", "masks", "sensors"),
)


#: A pile that stays awake.
REST: dict[str, Any] = {"gravity": (0.0, 30.0), "restitution": 0.4, "sleeping": False}


SETTINGS = (
    *("gravity", "drag", "container", "container_restitution", "walls", "wall_velocities"),
    *("wall_restitution", "wall_friction", "forces", "on_touch", "sleeping", "track_events"),
)


class RandomDomains(jostle.mpi.World):
    """A world whose domains follow from random numbers in place of measured times.

    So they have very different sizes, which are the same in each run of a test.
    """

    _random: np.random.Generator | None = None

    def _step(self, dt: float) -> None:
        if self._random is None:
            self._random = np.random.default_rng(comm().rank)
        self._core._set_work(self._random.lognormal(sigma=1.5))
        super()._step(dt)


def chosen_substeps(world: jostle.World) -> int | None:
    """The number of sub-steps, or None if the world finds the same one."""
    free = jostle.World.restore(world.snapshot())
    free.substeps = None
    return None if free.substeps == world.substeps else world.substeps


def scattered(
    world: jostle.World, where: Distribution, every: int | None = None
) -> jostle.mpi.World:
    """This rank's part of a world. Particles move to other domains after `every` steps."""
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
    kind = jostle.mpi.World if every is None else RandomDomains
    ours = kind(
        comm(), world.positions[mine], world.velocities[mine], world.radii[mine],
        restitution=restitution, substeps=chosen_substeps(world), **columns, **settings,
    )  # fmt: skip
    if every is not None:
        ours._core._rebalance_every(every)
    return ours


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
        if comm().rank == 0:
            world = jostle.World.restore(world.snapshot())
            hashes = [world.state_hash()]
            for now in counts(steps):
                world.step(dt, now)
                hashes.append(world.state_hash())
            found = expected_now(world, hashes)
        comm().Barrier()
        EXPECTED[key] = comm().bcast(found)
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
    ours = scattered(world, where, every=7)
    assert ours.state_hash() == expected.hashes[0], f"{name}: before the first step"
    done = 0
    for now, one in zip(counts(steps), expected.hashes[1:], strict=True):
        ours.step(dt, now)
        done += now
        found = ours.state_hash()
        assert found == one, f"{name}: {found:#x} is not {one:#x} after {done} steps"
    assert sum(comm().allgather(len(ours))) == len(world) == ours.total
    energy = expected.kinetic_energy
    assert abs(ours.kinetic_energy - energy) <= 1e-12 * energy
    check_touches(name, ours, expected)
    if comm().rank == 0:
        print(name, ours.traffic, flush=True)
    return ours


def step_all(worlds: Iterable[Any], dt: float, steps: int = 1) -> None:
    """Step several worlds."""
    for one in worlds:
        one.step(dt, steps)


def check_touches(name: str, ours: jostle.mpi.World, expected: Expected) -> None:
    """The contacts of all ranks together are those of one process. Sums of the impulses of several
    bounces of a pair in a step may be rounded differently."""
    for kind in CONTACTS:
        of_ranks = zip(*comm().allgather(getattr(ours, kind)), strict=True)
        found = table_of([np.concatenate(column) for column in of_ranks])
        one = expected.contacts[kind]
        assert found.shape == one.shape, f"{name}: {kind}"
        assert np.array_equal(found[:, :-2], one[:, :-2]), f"{name}: {kind}"
        scale = np.abs(one[:, -2:]).max(initial=1.0)
        assert np.allclose(found[:, -2:], one[:, -2:], rtol=1e-6, atol=1e-6 * scale), name
    assert ours.collisions == expected.collisions, name


def check_events(name: str, ours: jostle.mpi.World, world: jostle.World) -> int:
    """The events of all ranks together are those of one process; returns how many these are."""
    found = [np.concatenate(parts) for parts in zip(*comm().allgather(ours.events), strict=True)]
    for pairs, expected in zip(found, world.events, strict=True):
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
        assert np.array_equal(pairs, expected), f"{name} at {world.time}"
    return sum(map(len, found))


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
    ids, asleep = (np.concatenate(comm().allgather(of)) for of in (ours.ids, ours.asleep))
    assert np.array_equal(asleep[np.argsort(ids)], world.asleep), f"{name} at {world.time}"
    check_touches(name, ours, expected_now(world, [expected]))


def of_rank(rows: np.ndarray) -> np.ndarray:
    """Every rank's share of some rows, in the order of ranks."""
    return np.array_split(rows, comm().size)[comm().rank]


def check_asleep_now(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """As `check_asleep`, without contacts, which are those of a step."""
    assert ours.state_hash() == world.state_hash(), name
    ids, asleep = (np.concatenate(comm().allgather(of)) for of in (ours.ids, ours.asleep))
    assert np.array_equal(np.sort(ids), world.ids), name
    assert np.array_equal(asleep[np.argsort(ids)], world.asleep), name


def check_saved(path: Path, ours: jostle.mpi.World, world: jostle.World, steps: int) -> None:
    ours.save(path)
    comm().Barrier()
    asleep, ids = world.asleep, world.ids
    assert not list(path.parent.glob(".*")), "nothing is left beside the file"
    world.step(1 / 60, steps)
    # All ranks, one rank alone, and groups of two.
    for ranks in (comm(), MPI.COMM_SELF, comm().Split(comm().rank // 2)):
        again = jostle.mpi.World.load(ranks, path)
        assert again.time == ours.time and again.total == len(ids)
        assert np.array_equal(again.asleep, asleep[np.searchsorted(ids, again.ids)])
        again.step(1 / 60, steps)
        assert again.state_hash() == world.state_hash()
    alone = ours.gather(comm().size - 1)
    assert (alone is not None) == (comm().rank == comm().size - 1)
    if alone is not None:
        plain = jostle.World.load(path)
        assert plain.time == alone.time and plain.walls.shape == world.walls.shape
        for one in (alone, plain):
            assert np.array_equal(one.asleep, asleep)
            assert one.state_hash() == ours_hash_of(one)
            one.step(1 / 60, steps)
            assert one.state_hash() == world.state_hash()
    for root in (-1, comm().size):
        refuse(lambda root=root: ours.gather(root), f"root is {root}")
    # Any number of ranks writes the same file.
    ours.step(1 / 60, steps)
    whole = path.read_bytes()
    again = jostle.mpi.World.load(MPI.COMM_SELF, path)
    again.save(path.with_name(f"{comm().rank}"))
    assert path.with_name(f"{comm().rank}").read_bytes() == whole


def ours_hash_of(world: jostle.World) -> int:
    return jostle.World.restore(world.snapshot()).state_hash()


def with_folder(case: Callable[[Path], None]) -> Callable[[], None]:
    """Give a case a temporary folder of all ranks."""

    def with_one() -> None:
        folder = Path(comm().bcast(tempfile.mkdtemp() if comm().rank == 0 else None))
        case(folder)
        comm().Barrier()
        if comm().rank == 0:
            shutil.rmtree(folder)

    return with_one


def refuse(call: Callable[[], Any], message: str) -> None:
    """All ranks raise, with this message or that of the rank that has it."""
    try:
        call()
    except (ValueError, TypeError, AttributeError, OSError, jostle.mpi.RankError) as error:
        assert message in str(error), error
    else:
        raise AssertionError(message)
