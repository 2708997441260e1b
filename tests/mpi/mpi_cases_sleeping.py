"""Islands of several ranks that fall asleep and wake, and particles that are changed meanwhile."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from mpi_checks import check_asleep, check_asleep_now, check_events, check_saved, refuse, step_all
from mpi_worlds import comm, evenly, gas, of_rank, scattered, sleepers, unevenly, up_to, with_folder

import jostle


def sleeping_counts(name: str, world: jostle.World, rounds: int, *how: Any) -> list[int]:
    """Compare with one process after each of some rounds; return how many particles sleep then.

    How the world is scattered is given as in `scattered`.
    """
    ours, counts = scattered(world, *how), []
    for _ in range(rounds):
        step_all((world, ours), 1 / 30, 12)
        check_asleep(name, ours, world)
        if world.track_events:
            check_events(name, ours, world)
        counts.append(int(world.asleep.sum()))
    return counts


@up_to(3)
def test_sleeping() -> None:
    """Islands that several ranks have fall asleep and wake as in one process."""
    counts = sleeping_counts("sleeping", sleepers(), 14, unevenly, 7)
    # Some wake when discs fall on them.
    assert max(counts) > 30 and np.diff(counts).min() < 0, counts


def test_sleeping_beside_others() -> None:
    """Sleeping particles beside walls, and beside immovable particles."""
    walls = jostle.polyline([(0, 3), (9, 5), (30, 4)])
    # Contacts of sleepers are with particles of other ranks, too, and have their categories.
    tracked = sleepers(walls=walls, track_events=True, categories=1 + np.arange(42) % 5)
    assert sleeping_counts("walls", tracked, 8, unevenly)[-1] > 10
    # Kinematic particles keep others awake; static ones do not.
    movable = np.arange(42) % 5 > 0
    still = sleepers(movable=movable)
    still.velocities = np.where(np.arange(42)[:, None] == 30, [[0.1, 0.0]], 0.0)
    assert sleeping_counts("obstacles", still, 5, evenly)[-1] > 0
    # A kinematic disc moves to sleeping ones, and wakes them.
    coming = sleepers(8, falling=1, movable=np.arange(33) < 32)
    coming.set(32, positions=(3.0, 150.0), velocities=(0.0, -60.0))
    counts = sleeping_counts("a kinematic disc", coming, 8, evenly)
    assert np.diff(counts).min() < 0, counts


def test_calls_of_sleepers() -> None:
    """A world of which all sleeps takes one call of all ranks for a step."""
    world = sleepers(4, falling=0)
    ours = scattered(world, evenly)
    ours._core._rebalance_every(1000)
    ours.step(1 / 60, 120)
    assert sum(comm().allgather(int(ours.asleep.sum()))) == ours.total
    before = ours.traffic["calls"]
    ours.step(1 / 60, 10)
    assert ours.traffic["calls"] - before == 10


def edits() -> list[tuple[str, Callable[[Any, Callable[..., Any]], None]]]:
    """Changes of a world; the second argument gives a rank's share of rows."""
    new = np.column_stack([np.arange(7) * 9.0 + 4.0, np.full(7, 30.0)])
    still = np.zeros((7, 2))
    gone = np.array([2, 17, 31, 9])
    pushed, static = np.array([20, 5]), np.array([0])

    return [
        ("a push", lambda w, own: w.set(own(pushed), velocities=own(np.ones((2, 2))))),
        ("nothing", lambda w, own: w.set(own(pushed[:0]), radii=own(np.zeros(0)))),
        (
            "added",
            lambda w, own: w.add(
                own(new), own(np.full(7, 0.5)), velocities=own(still), friction=0.5
            ),
        ),
        ("removed", lambda w, own: w.remove(own(gone))),
        ("driven", lambda w, own: w.set(own(static), velocities=own(np.full((1, 2), 0.02)))),
        ("no more", lambda w, own: w.set(own(static), velocities=own(np.zeros((1, 2))))),
        ("the static disc is removed", lambda w, own: w.remove(own(static))),
        ("a moving wall", lambda w, own: setattr(w.walls, "velocities", [(0.0, 0.4)])),
        ("a wall that stops", lambda w, own: setattr(w.walls, "velocities", [(0.0, 0.0)])),
        ("gravity", lambda w, own: setattr(w, "gravity", (0.0, -9.0))),
        ("friction", lambda w, own: w.set(own(pushed + 3), friction=own(np.ones(2)))),
        (
            "obstacles",
            lambda w, own: w.add(
                own(new + 9.0), 1.0, velocities=own(still), movable=False, friction=0.6
            ),
        ),
    ]


def resting(**options: Any) -> jostle.World:
    """Triangles on a static disc and on a wall, which fall asleep."""
    world = sleepers(
        8, falling=1, walls=[[(60.0, 0.5), (75.0, 0.5)]], movable=np.arange(33) > 0, **options
    )
    assert len(world) == 33
    return world


@with_folder
def test_edits(folder: Path) -> None:
    """Particles that are added, removed and changed while others sleep."""
    world = resting(track_events=True)
    ours = scattered(world, evenly, every=5)
    counts = set()
    for number, (name, change) in enumerate(edits()):
        for _ in range(2):
            step_all((world, ours), 1 / 30, 16)
        check_asleep(f"before {name}", ours, world)
        check_events(name, ours, world)
        change(world, lambda rows: rows)
        change(ours, of_rank)
        check_asleep_now(f"after {name}", ours, world)
        counts.add(int(world.asleep.sum()))
        if name in ("removed", "obstacles"):
            check_saved(folder / str(number), ours, world, 0)
    step_all((world, ours), 1 / 30, 16)
    check_asleep("the last", ours, world)
    assert len(counts) > 3 and ours.total == len(world) == 33 + 7 - 4 - 1 + 7
    check_refused_edits()


def check_refused_edits() -> None:
    ours = scattered(gas(50), evenly)
    before, ids = ours.state_hash(), ours.ids
    last = comm().rank == comm().size - 1
    none = np.zeros((0, 2))
    for call, message in (
        (lambda: ours.remove([7, 99] if last else []), "ids contain 99; no particle"),
        (lambda: ours.remove([7, 7] if last else []), "ids contain 7 twice"),
        (lambda: ours.remove([0.5] if last else []), "ids must be integers"),
        (lambda: ours.set([3] if last else [], radii=-1.0 if last else 1.0), "radii"),
        (
            lambda: ours.add(
                [(1, 1)] if last else none, -1.0, velocities=[(1, 1)] if last else none
            ),
            "radii",
        ),
        (lambda: setattr(ours, "drag", -1.0 if last else 0.0), "drag"),
    ):
        refuse(call, message)
    if comm().size > 1:
        refuse(lambda: setattr(ours, "drag", comm().rank * 0.5), "drag is not the same")
        refuse(lambda: ours.step(0.1 + comm().rank), "dt is not the same")
        refuse(lambda: ours.step(0.1, 1 + comm().rank), "steps is not the same")
        columns = {"radii": 1.0} if last else {"masses": 1.0}
        refuse(lambda: ours.set([], **columns), "the columns are not the same")
    assert ours.state_hash() == before and np.array_equal(ours.ids, ids)
    ours.step(1 / 60)
