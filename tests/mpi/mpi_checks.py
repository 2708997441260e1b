"""Comparison of worlds of ranks with those of one process. The programs of the tests use it."""

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mpi4py import MPI
from mpi_worlds import Distribution, comm, evenly, scattered

import jostle
import jostle.mpi

STEPS = 100

CHECK_EVERY = 25  # steps

CONTACTS = ("contacts", "wall_contacts")


class Expected(NamedTuple):
    """The world of one process after its steps."""

    hashes: list[int]  # before the first step, and after every `CHECK_EVERY`
    contacts: dict[str, np.ndarray]
    call: jostle.LastCall
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
    contacts = {
        kind: table_of(list(getattr(world.last_step, kind).to_dict().values())) for kind in CONTACTS
    }
    return Expected(hashes, contacts, world.last_call, world.kinetic_energy())


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
    assert abs(ours.kinetic_energy() - energy) <= 1e-12 * energy
    check_touches(name, ours, expected)
    if comm().rank == 0:
        print(name, ours.traffic, flush=True)
    return ours


def step_all(worlds: Iterable[Any], dt: float, steps: int = 1) -> None:
    """Step several worlds."""
    for one in worlds:
        one.step(dt, steps)


def step_alike(
    name: str,
    ours: jostle.mpi.World,
    world: jostle.World,
    dt: float,
    steps: int = 1,
    *,
    gathers: bool = False,
) -> None:
    """Step both, and a world of one process with all particles; they have the same states."""
    alone = ours.gather() if gathers else None
    worlds: list[Any] = [world, ours, *([] if alone is None else [alone])]
    for one in worlds:
        one.step(dt, steps)
        assert one.state_hash() == world.state_hash(), f"{name} at {world.time}"


def check_touches(name: str, ours: jostle.mpi.World, expected: Expected) -> None:
    """The contacts of all ranks together are those of one process. Sums of the impulses of several
    bounces of a pair in a step may be rounded differently."""
    for kind in CONTACTS:
        of_ranks = zip(
            *comm().allgather(list(getattr(ours.last_step, kind).to_dict().values())), strict=True
        )
        found = table_of([np.concatenate(column) for column in of_ranks])
        one = expected.contacts[kind]
        assert found.shape == one.shape, f"{name}: {kind}"
        rounded = np.zeros(found.shape[1], bool)
        rounded[-4:-2] = True  # before the categories
        assert np.array_equal(found[:, ~rounded], one[:, ~rounded]), f"{name}: {kind}"
        found, one = found[:, rounded], one[:, rounded]
        scale = np.abs(one).max(initial=1.0)
        assert np.allclose(found, one, rtol=1e-6, atol=1e-6 * scale), name
    call = ours.last_call.to_dict()
    for field, one in expected.call.to_dict().items():
        scale = np.abs(one).max(initial=1.0)
        assert np.allclose(call[field], one, rtol=1e-9, atol=1e-6 * scale), f"{name}: {field}"
    assert call["collisions"] == expected.call.collisions, name
    assert call["wall_collisions"] == expected.call.wall_collisions, name


def check_events(name: str, ours: jostle.mpi.World, world: jostle.World) -> int:
    """The events of all ranks together are those of one process, of particles and of walls; returns
    how many the first ones are."""
    check_same_events(f"{name}, walls", ours.wall_events, world.wall_events)
    return check_same_events(name, ours.events, world.events)


def check_same_events(
    name: str,
    ours: jostle.WorldEvents | jostle.WallEvents,
    expected: jostle.WorldEvents | jostle.WallEvents,
) -> int:
    """The events of all ranks, each pair on one of them; returns how many they are."""
    seen = 0
    for field in ("entered", "stayed", "exited"):
        both = (field, f"{field}_categories")
        found = [np.concatenate(comm().allgather(getattr(ours, of))) for of in both]
        order = np.lexsort((found[0][:, 1], found[0][:, 0]))
        for of, column in zip(both, found, strict=True):
            assert np.array_equal(column[order], getattr(expected, of)), f"{name}: {of}"
        seen += len(found[0])
    return seen


def check_asleep_now(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """The same state and the same sleeping particles."""
    found, expected = ours.state_hash(), world.state_hash()
    assert found == expected, f"{name}: {found:#x} is not {expected:#x} at {world.time}"
    ids, asleep = (np.concatenate(comm().allgather(of)) for of in (ours.ids, ours.asleep))
    assert np.array_equal(np.sort(ids), world.ids), f"{name} at {world.time}"
    assert np.array_equal(asleep[np.argsort(ids)], world.asleep), f"{name} at {world.time}"


def check_asleep(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """As `check_asleep_now`, and the contacts, which are those of the last step."""
    check_asleep_now(name, ours, world)
    check_touches(name, ours, expected_now(world, []))


def check_saved(path: Path, ours: jostle.mpi.World, world: jostle.World, steps: int) -> None:
    ours.save(path)
    comm().Barrier()
    asleep, ids = world.asleep, world.ids
    assert not list(path.parent.glob(".*")), "nothing is left beside the file"
    world.step(1 / 60, steps)
    # All ranks, one rank alone, and groups of two.
    groups: list[Any] = [comm(), MPI.COMM_SELF, comm().Split(comm().rank // 2)]
    for ranks in groups:
        again = jostle.mpi.World.load(ranks, path)
        assert again.time == ours.time and again.total == len(ids)
        assert np.array_equal(again.asleep, asleep[np.searchsorted(ids, again.ids)])
        again.step(1 / 60, steps)
        assert again.state_hash() == world.state_hash()
    alone = ours.gather(comm().size - 1)
    assert (alone is not None) == (comm().rank == comm().size - 1)
    if alone is not None:
        plain = jostle.World.load(path)
        assert plain.time == alone.time and plain.walls.get(plain.walls.ids) == world.walls.get(
            world.walls.ids
        )
        for one in (alone, plain):
            assert np.array_equal(one.asleep, asleep)
            assert one.state_hash() == jostle.World.restore(one.snapshot()).state_hash()
            one.step(1 / 60, steps)
            assert one.state_hash() == world.state_hash()
    for root in (-1, comm().size):
        refuse(partial(ours.gather, root), f"root is {root}")
    # Any number of ranks writes the same file.
    ours.step(1 / 60, steps)
    whole = path.read_bytes()
    again = jostle.mpi.World.load(MPI.COMM_SELF, path)
    again.save(path.with_name(f"{comm().rank}"))
    assert path.with_name(f"{comm().rank}").read_bytes() == whole


class InPlaceOf:
    """Has the attributes of another object, but those that a derived class has."""

    def __init__(self, of: Any) -> None:
        self._of = of

    def __getattr__(self, name: str) -> Any:
        return getattr(self._of, name)


def refuse(call: Callable[[], Any], message: str) -> None:
    """All ranks raise, with this message or that of the rank that has it."""
    try:
        call()
    except (ValueError, TypeError, AttributeError, OSError, jostle.mpi.RankError) as error:
        assert message in str(error), error
    else:
        raise AssertionError(message)


def fail_by_the_last_rank(call: Callable[[], Any], kind: type[BaseException], message: str) -> None:
    """The last rank raises its own error, and the others one that says so."""
    ranks = comm()
    last = ranks.size - 1
    try:
        call()
    except kind as error:
        assert ranks.rank == last and message in str(error), error
    except jostle.mpi.RankError as error:
        assert ranks.rank < last, error
        assert str(error).startswith(f"rank {last}: {kind.__name__}"), error
        assert message in str(error), error
    else:
        raise AssertionError("the last rank raises")
