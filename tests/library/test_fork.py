"""A forked process, which does not have the threads of its parent, can use jostle."""

import os
import signal
import threading
from collections.abc import Callable

import numpy as np
import pytest

import jostle

pytestmark = [
    pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork"),
    pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning"),
]


def exit_code_of_child(work: Callable[[], object]) -> int:
    """Fork; return 0 if `work` succeeds, 2 if it raises the error about the fork."""
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # a hang ends the child, not the test run
        code = 1
        try:
            work()
            code = 0
        except RuntimeError as error:
            code = 2 if "when this process was forked" in str(error) else 3
        finally:
            os._exit(code)
    _, status = os.waitpid(child, 0)
    return os.waitstatus_to_exitcode(status)


@pytest.mark.parametrize("threads", [None, 2])
def test_a_forked_process_finds_the_same_pairs(threads: int | None) -> None:
    centers = np.random.default_rng(0).random((60_000, 2))
    expected = jostle.find_pairs(centers, 0.001, threads=threads)
    assert len(expected) > 0

    def work() -> None:
        assert np.array_equal(jostle.find_pairs(centers, 0.001, threads=threads), expected)

    assert exit_code_of_child(work) == 0


def forks_during(call: Callable[[], object], work: Callable[[], object]) -> set[int]:
    """Return the results of `work` in processes that are forked while a thread calls `call`."""
    done = threading.Event()

    def keep_calling() -> None:
        while not done.is_set():
            call()

    thread = threading.Thread(target=keep_calling)
    thread.start()
    try:
        return {exit_code_of_child(work) for _ in range(5)}
    finally:
        done.set()
        thread.join()


@pytest.mark.parametrize("threads", [1, 2])
def test_a_fork_during_a_call_of_another_thread_does_not_hang(threads: int) -> None:
    rng = np.random.default_rng(0)
    centers = rng.random((5_000, 2))
    space = jostle.Space(threads=threads)
    ids = space.add(centers, 0.001)
    world = jostle.World(centers, 0.001, velocities=centers, threads=threads)
    tree = jostle.Quadtree(centers, 0.001, threads=threads)
    expected = jostle.find_pairs(centers, 0.001, sort=True)

    def find() -> None:
        assert np.array_equal(jostle.find_pairs(centers, 0.001, sort=True, threads=2), expected)

    def move() -> None:
        space.set(ids, positions=rng.random((5_000, 2)))
        space.update()

    assert forks_during(find, find) == {0}
    assert forks_during(tree.pairs, tree.pairs) == {0}
    assert forks_during(move, lambda: len(space)) <= {0, 2}
    assert forks_during(move, space.update) <= {0, 2}
    assert forks_during(lambda: world.step(0.001), lambda: world.positions) <= {0, 2}


def test_a_child_can_use_what_no_other_thread_was_using() -> None:
    space = jostle.Space()
    space.add([(0, 0), (1, 0)], 1.0)
    world = jostle.World([(0, 0)], 1.0, velocities=[(1, 0)])

    def work() -> None:
        assert len(space.update().entered) == 1
        world.step(0.5)
        # Threads of the child share them as in other processes.
        thread = threading.Thread(target=lambda: [space.update() for _ in range(100)])
        thread.start()
        assert all(len(space.pairs()) == 1 for _ in range(100))
        thread.join()

    assert exit_code_of_child(work) == 0
