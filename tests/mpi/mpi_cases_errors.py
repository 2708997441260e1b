"""Refusals, failures and signals of one rank or all."""

import os
import signal
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from mpi_checks import InPlaceOf, fail_by_the_last_rank, refuse
from mpi_worlds import comm, evenly, gas, scattered

import jostle
import jostle.mpi


def test_killed() -> None:
    """One rank dies; the launcher ends the others."""
    world = scattered(gas(), evenly)
    world.step(1 / 60, 5)
    if comm().rank == comm().size - 1:
        os.kill(os.getpid(), signal.SIGKILL)
    world.step(1 / 60, 1_000_000)


def test_pressed() -> None:
    """Ctrl-C on one rank ends the call on all, between two steps."""
    world = scattered(gas(), evenly)
    if comm().rank == comm().size - 1:
        threading.Timer(1.0, signal.raise_signal, [signal.SIGINT]).start()
    fail_by_the_last_rank(lambda: world.step(1 / 60, 1_000_000), KeyboardInterrupt, "")
    times = comm().allgather(world.time)
    assert times[0] == times[-1] > 0
    before = world.state_hash()
    world.step(1 / 60)
    assert world.state_hash() != before


def test_signals() -> None:
    """A signal handler that raises on one rank raises on all, after the call."""

    class Interrupted(InPlaceOf):
        """A core that is interrupted by a signal when its particles are read."""

        def _own_records(self) -> bytes:
            signal.raise_signal(signal.SIGUSR1)
            records: bytes = self._of._own_records()
            return records

    def handler(*_: object) -> None:
        raise InterruptedError("told so")

    world, last = scattered(gas(50), evenly), comm().rank == comm().size - 1
    before, core = world.state_hash(), world._core
    signal.signal(signal.SIGUSR1, handler)
    if last:
        world._core = Interrupted(core)
    calls: list[Callable[[], Any]] = [
        world.state_hash,
        world.gather,
        lambda: world.kinetic_energy(),
        lambda: world.momentum(),
    ]
    for call in calls:
        fail_by_the_last_rank(call, InterruptedError, "told so")
    world._core = core
    assert signal.getsignal(signal.SIGUSR1) is handler
    # A handler that does not raise runs, and changes nothing.
    told = []
    signal.signal(signal.SIGUSR1, lambda *_: told.append(world.time))
    if last:
        world._core = Interrupted(core)
    assert world.state_hash() == before
    assert told == [0.0] * last


def test_errors() -> None:
    """What is refused is refused on all ranks, and an error leaves the world as it was."""
    world = scattered(gas(50), evenly)
    # So many that their text would be shortened; one in the middle differs.
    walls = np.arange(600.0)[:, None, None] * 2 + np.array([[[0.0, 0.0], [1.0, 0.0]]])
    walls[300, 1, 1] += comm().rank
    refused: list[tuple[str, Callable[[], Any]]] = [
        ("forces[0]", lambda: scattered(gas(50, forces=[jostle.Gravitation(1.0)]), evenly)),
        ("dt", lambda: world.step(-1.0)),
        ("steps is -1", lambda: world.step(0.1, -1)),
        (
            "gravity",
            lambda: jostle.mpi.World(comm(), [], [], velocities=[], gravity=(comm().rank, 0)),
        ),
        ("walls", lambda: jostle.mpi.World(comm(), [], [], velocities=[], walls=walls)),
    ]
    for argument, call in refused:
        if comm().size > 1 or argument not in ("gravity", "walls"):
            refuse(call, argument)
    for name in ("gravitiy", "velocities"):  # a misspelt setting, a column
        refuse(partial(setattr, world, name, 0), name)
    # Only one rank has a particle that moves too far.
    before = world.state_hash()
    hurried = scattered(
        gas(50, velocities=np.where(np.arange(50)[:, None] == 49, 1e18, 1.0) * np.ones((50, 2))),
        evenly,
    )
    fail_by_the_last_rank(lambda: hurried.step(100.0), ValueError, "particle 49 would move")
    hurried.step(1e-18)
    assert world.state_hash() == before and world.time == 0.0
