"""Worlds of ranks and of one process. The programs of the tests use them."""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

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


#: The most ranks of the cases that `up_to` marks.
_MOST: dict[Callable[[], None], int] = {}


def up_to(ranks: int) -> Callable[[Callable[[], None]], Callable[[], None]]:
    """Let a case run on up to so many ranks, because one more makes a difference there.

    A case without it runs on one rank and on two. With more ranks than cores each message waits for
    a rank that has a core.
    """

    def with_most(case: Callable[[], None]) -> Callable[[], None]:
        _MOST[case] = ranks
        return case

    return with_most


def most_ranks(case: Callable[[], None]) -> int:
    """The number of ranks that `up_to` has given to a case."""
    return _MOST.get(case, 2)


#: The modules of cases.
CASES = sorted(path.stem for path in Path(__file__).parent.glob("mpi_cases_*.py"))

#: A distribution gives the rank of each particle, in ascending order.
Distribution = Callable[[int], np.ndarray]


def evenly(n: int) -> np.ndarray:
    return np.arange(n) * comm().size // max(n, 1)


def on_first(n: int) -> np.ndarray:
    return np.zeros(n, int)


def on_last(n: int) -> np.ndarray:
    return np.full(n, comm().size - 1)


def unevenly(n: int) -> np.ndarray:
    size = comm().size
    return np.sort(np.random.default_rng(n).integers(0, size, n) ** 2 // max(size - 1, 1))


def parts(n: int, where: Distribution) -> np.ndarray:
    mine: np.ndarray = where(n) == comm().rank
    return mine


COLUMNS = (
    *("masses", "movable", "friction", "angles", "angular_velocities"),
    *("categories", "masks", "sensors", "kinds"),
)

#: A pile that stays awake.
REST: dict[str, Any] = {"gravity": (0.0, 30.0), "restitution": 0.4, "sleeping": False}

SETTINGS = (
    *("gravity", "drag", "container", "period", "forces", "on_touch", "sleeping"),
    "track_events",
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


def scattered(
    world: jostle.World, where: Distribution, every: int | None = None
) -> jostle.mpi.World:
    """This rank's part of a world. Particles move to other domains after `every` steps."""
    mine = parts(len(world), where)
    columns = {name: getattr(world, name)[mine] for name in COLUMNS}
    settings: dict[str, Any] = {name: getattr(world, name) for name in SETTINGS}
    settings["walls"] = world.walls.get(world.walls.ids).to_dict()
    kind = jostle.mpi.World if every is None else RandomDomains
    ours = kind(
        comm(),
        world.positions[mine],
        world.radii[mine],
        velocities=world.velocities[mine],
        restitution=world.restitution[mine],
        substeps=world.substeps,
        **columns,
        **settings,
    )
    if every is not None:
        ours._core._rebalance_every(every)
    return ours


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
    if options.get("container") == "torus":
        options |= {"container": None, "period": width}
    options.setdefault("container", jostle.Box(0, 0, width, width))
    velocities = options.pop("velocities", rng.normal(0, 20, (n, 2)))
    return jostle.World(positions, radii, velocities=velocities, **options)


def sleepers(n: int = 10, falling: int = 2, **options: Any) -> jostle.World:
    """Triangles that fall asleep soon, a row of discs that touch, and discs that fall on them."""
    left = np.arange(n) * 6.0 + 3.0
    corners = np.array([(-1.0, 1.0), (1.0, 1.0), (0.0, 1.0 + np.sqrt(3.0))])
    row = np.column_stack([left[-1] + 5.0 + 2.0 * np.arange(n), np.ones(n)])
    late = np.array([(left[n // 2] + 0.5, 55.0), (row[n // 2, 0] + 0.3, 90.0)])
    triangles = np.concatenate([corners + np.array([x, 0.0]) for x in left])
    positions = np.concatenate([triangles, row, late[:falling]])
    rules: dict[str, Any] = {
        "gravity": (0.0, -9.8),
        "restitution": 0.3,
        "friction": 0.6,
        "substeps": 2,
    } | options
    width = float(row[-1, 0]) + 3.0
    return jostle.World(positions, 1.0, container=jostle.Box(0, 0, width, 200), **rules)


def of_rank(rows: np.ndarray) -> np.ndarray:
    """Every rank's share of some rows, in the order of ranks."""
    return np.array_split(rows, comm().size)[comm().rank]


def with_folder(case: Callable[[Path], None]) -> Callable[[], None]:
    """Give a case a temporary folder of all ranks."""

    def with_one() -> None:
        folder = Path(comm().bcast(tempfile.mkdtemp() if comm().rank == 0 else None))
        case(folder)
        comm().Barrier()
        if comm().rank == 0:
            shutil.rmtree(folder)

    return with_one
