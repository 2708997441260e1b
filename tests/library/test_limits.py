"""Ctrl-C, too little memory, too few threads: objects stay usable after a failed call."""

import signal
import sys
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest
from signals import reaction_to_ctrl_c, run_child

import jostle

linux = pytest.mark.skipif(sys.platform != "linux", reason="limits and /proc are those of Linux")

# Reactions take 0.05 s on a quiet machine; a busy one gets more.
SOON = 1.0

# One leaf holds everything, in one strip: each of these calls tests everything and takes seconds.
ALL = 10**6
POINTS = np.random.default_rng(0).random((400_000, 2)) * (1, 0)
SOME = POINTS[:100_000]
BESIDE = np.array((1e-9, 0))
COINCIDENT = np.zeros((20_000, 2))


def one_leaf(threads: int, points: np.ndarray = POINTS) -> jostle.Quadtree:
    return jostle.Quadtree(points, 1e-12, leaf_capacity=ALL, threads=threads)


def space_of(threads: int, points: np.ndarray = POINTS) -> jostle.Space:
    space = jostle.Space(leaf_capacity=ALL, threads=threads)
    space.add(points, 1e-12)
    return space


# ruff: noqa: B008 -- the arguments are made before the measured time.
LONG: dict[str, Callable[[int], Callable[[], object]]] = {
    "brute": lambda t: lambda: jostle.find_pairs(POINTS, method="brute", threads=t),
    "find_pairs": lambda t: (
        lambda: jostle.find_pairs(COINCIDENT[:16_300], 1.0, sort=True, threads=t)
    ),
    "build": lambda t: lambda: [jostle.Quadtree(POINTS, threads=t) for _ in range(1000)],
    "pairs": lambda t: one_leaf(t).pairs,
    "pairs with another": lambda t: lambda a=one_leaf(t): a.pairs(one_leaf(t)),
    "contacts": lambda t: one_leaf(t).contacts,
    "rects": lambda t: lambda tree=one_leaf(t, SOME): tree.query_rect(np.hstack([SOME, SOME])),
    "circles": lambda t: lambda tree=one_leaf(t, SOME): tree.query_circle(SOME, 1e-9),
    "points": lambda t: lambda tree=one_leaf(t, SOME): tree.query_point(SOME + BESIDE),
    "polygons": lambda t: (
        lambda tree=one_leaf(t, SOME): tree.query_polygon(
            SOME[:, None] + [(0, 0), (1e-9, 0), (0, 1e-9)]
        )
    ),
    "nearest": lambda t: (
        lambda tree=jostle.Quadtree(COINCIDENT, 1.0, threads=t): tree.nearest(COINCIDENT, k=1000)
    ),
    "raycast": lambda t: lambda tree=one_leaf(t, SOME): tree.raycast(SOME + 2, (-1, -1)),
    "shape_cast": lambda t: (
        lambda tree=one_leaf(t, SOME): tree.shape_cast(SOME + 2, (-1, -1), radii=1e-12)
    ),
    "update": lambda t: space_of(t).update,
    "space pairs": lambda t: space_of(t).pairs,
    "space circles": lambda t: lambda space=space_of(t, SOME): space.query_circle(SOME, 1e-9),
    "space nearest": lambda t: (
        lambda space=space_of(t, COINCIDENT): space.nearest(COINCIDENT, k=1000)
    ),
    "space raycast": lambda t: lambda space=space_of(t, SOME): space.raycast(SOME + 2, (-1, -1)),
}


@pytest.mark.parametrize("name", LONG)
def test_ctrl_c_ends_a_long_call(name: str) -> None:
    threads = 1 + len(name) % 2
    took = reaction_to_ctrl_c(LONG[name](threads))
    print(f"{name}, threads={threads}: {took:.3f} s")
    assert took < SOON


@pytest.mark.parametrize("threads", [1, 2])
def test_an_interrupted_call_changes_nothing(threads: int) -> None:
    tree, space = one_leaf(threads), space_of(threads)
    for call in (tree.pairs, space.update, space.pairs):
        assert reaction_to_ctrl_c(call, after=0.1) < SOON
    assert tree.query_point(POINTS[7]).tolist() == [7]
    assert len(space) == len(POINTS)
    np.testing.assert_array_equal(space.positions, POINTS)
    space.remove(space.ids[2:])
    space.set([0, 1], positions=[(5, 5), (5, 5)])
    space.set([0, 1], radii=1.0)
    assert space.update().entered.tolist() == [[0, 1]]
    assert jostle.find_pairs(COINCIDENT[:300], 1.0, threads=threads).shape == (44_850, 2)


class Enough(Exception):
    pass


def test_a_signal_handler_may_use_jostle_and_raise_any_exception() -> None:
    space = space_of(2)
    seen: list[object] = []

    def look(number: int, frame: object) -> None:
        try:
            seen.append(len(space))
        except RuntimeError as error:
            seen.append(str(error))
        seen.append(jostle.find_pairs([(0, 0), (1, 0)], 1.0).tolist())
        if len(seen) > 2:
            raise Enough

    main = threading.get_ident()
    timers = [
        threading.Timer(after, signal.pthread_kill, (main, signal.SIGUSR1)) for after in (0.1, 0.3)
    ]
    handler = signal.signal(signal.SIGUSR1, look)
    try:
        with pytest.raises(Enough):
            for timer in timers:
                timer.start()
            space.pairs()
    finally:
        for timer in timers:
            timer.join()
        signal.signal(signal.SIGUSR1, handler)
    busy = "this space is in use: a signal handler cannot use it before the call that it has"
    assert [str(text)[: len(busy)] for text in seen[::2]] == [busy, busy]
    assert seen[1::2] == [[[0, 1]], [[0, 1]]]
    assert len(space) == len(POINTS)


@linux
def test_too_little_memory_is_a_memory_error() -> None:
    printed = run_child(
        """
import re
from signals import lift_limit, limit_memory
zeros = np.zeros((4000, 2))
tree = jostle.Quadtree(zeros, 1.0)
other = jostle.Quadtree(zeros[:2000], 1.0)
two = jostle.Quadtree([(0, 0), (1, 0)])
space = jostle.Space()
ids = space.add(zeros, 1.0)
jostle.find_pairs(np.random.default_rng(0).random((20_000, 2)))
large = np.zeros((1_000_000, 2))
limit_memory(24 << 20)

def refused(call, *args, **kwargs):
    try:
        call(*args, **kwargs)
    except MemoryError as error:
        # Any allocation may be the one that fails: of an argument, of the answer, of scratch.
        argument = "[a-z_]+: there is no memory for [0-9]+ bytes"
        anything = r"not enough memory: [0-9.]+ (bytes|.iB) could not be"
        assert re.match(f"{argument}|{anything}", str(error)), error
    else:
        raise AssertionError(call)
    assert jostle.find_pairs([(0, 0), (1, 0)], 1.0).tolist() == [[0, 1]]

for threads in (1, 2):
    refused(jostle.find_pairs, zeros, 1.0, threads=threads)
    refused(jostle.find_pairs, zeros, 1.0, threads=threads, method="brute")
refused(tree.pairs)
refused(tree.pairs, other)
refused(tree.contacts)
refused(two.nearest, large[:300_000], k=400)
refused(tree.query_circle, zeros, 1.0)
refused(space.pairs)
refused(space.update)
refused(space.query_circle, zeros, 1.0)
refused(space.add, large, 1.0)
lift_limit()
assert len(tree) == len(space) == 4000
space.set(ids[2:], positions=np.arange(2.0, len(ids))[:, None] * (10, 0))
assert space.update().entered.tolist() == [[0, 1]]
assert len(tree.query_point((0, 0))) == 4000
print("fine")
"""
    )
    assert printed == "fine\n"


@linux
@pytest.mark.parametrize("scene", ["gas", "pile", "springs", "life", "stars"])
def test_worlds_stay_as_they_were_without_memory(scene: str) -> None:
    printed = run_child(
        f"""
import ctypes
from signals import lift_limit, limit_memory
libc = ctypes.CDLL(None)
world = jostle.scenes.create("{scene}", n=20_000, seed=1)
other = jostle.World.restore(world.snapshot())
world.step(1 / 60)
other.step(1 / 60)
before, state, ids = world.snapshot(), world.state_hash(), world.ids
places = world.positions + 1
calls = [
    lambda: jostle.World(places, 0.1),
    lambda: world.step(1 / 60),
    lambda: world.add(places, 0.1),
    lambda: world.set(ids, positions=places, friction=0.5),
    lambda: world.snapshot(),
    lambda: jostle.World.restore(before),
    lambda: jostle.scenes.create("{scene}", n=20_000),
]
refused = 0
for kibibytes in (200, 200, 400, 600, 800, 1200, 1600, 2400, 3200, 4800):
    for call in calls:
        if hasattr(libc, "malloc_trim"):  # else memory that was freed serves most calls
            libc.malloc_trim(0)
        limit_memory(kibibytes << 10)
        try:
            made = call()
        except MemoryError:
            refused += 1
            made = None
        finally:
            lift_limit()
        if made is None and world.state_hash() == state:
            assert world.snapshot() == before
        else:
            # The call had memory enough.
            world = jostle.World.restore(before)
world.step(1 / 60)
other.step(1 / 60)
assert world.state_hash() == other.state_hash()
print(refused > 7)
"""
    )
    assert printed == "True\n"


@linux
def test_the_error_names_the_size_of_the_whole_answer() -> None:
    """The size so far, if the whole is not known; the parts of an answer are smaller."""
    printed = run_child(
        """
from signals import limit_memory
zeros = np.zeros((3000, 2))
points = np.random.default_rng(0).random((9000, 2))
tree, other = jostle.Quadtree(zeros, 1.0), jostle.Quadtree(points)
calls = [
    lambda: jostle.find_pairs(zeros, 1.0, method="brute"),
    lambda: tree.query_circle(zeros, 1.0),
    lambda: other.nearest(points, k=200),
]
def refused(call):
    try:
        call()
    except MemoryError as error:
        words = str(error).split()
        return float(words[3]) if words[4] == "MiB" else 0
limit_memory(20 << 20)
for call in calls:
    # A thread may be refused at its first pairs, and the size so far is small then: in about one
    # call of 100 on a busy machine. So two of three calls must name a large one.
    assert sorted(refused(call) for _ in range(3))[1] > 6
    print("refused")
"""
    )
    assert printed == "refused\n" * 3


@linux
@pytest.mark.parametrize(
    ("shapes", "points", "k", "mebibytes"),
    # A small allocation that fails ends the process, so some memory is left for the threads.
    [(9000, 9000, 200, most) for most in (2, 8, 16, 24)]
    # Each answer would be too small an allocation to look at what is left.
    + [(2, 300_000, 2, most) for most in (4, 12, 16)],
)
def test_threads_keep_memory_for_small_allocations(
    shapes: int, points: int, k: int, mebibytes: int
) -> None:
    printed = run_child(
        f"""
from signals import limit_memory
tree = jostle.Quadtree(np.random.default_rng(0).random(({shapes}, 2)))
points = np.random.default_rng(1).random(({points}, 2))
limit_memory({mebibytes} << 20)
try:
    tree.nearest(points, k={k})
except MemoryError:
    print("refused")
"""
    )
    assert printed == "refused\n"


def test_threads_sleep_when_there_is_nothing_to_do() -> None:
    jostle.find_pairs(SOME[:5000], 0.001, threads=2)
    time.sleep(0.1)
    before = time.process_time()
    time.sleep(0.3)
    assert time.process_time() - before < 0.1


@linux
def test_numbers_of_threads_share_a_few_pools() -> None:
    printed = run_child(
        """
import os
points = np.random.default_rng(0).random((600, 2))
expected = jostle.Quadtree(points, 0.02, threads=1).query_circle(points, 0.1)
for threads in range(2, 130):
    found = jostle.Quadtree(points, 0.02, threads=threads).query_circle(points, 0.1)
    assert np.array_equal(found.ids, expected.ids)
print(len(os.listdir("/proc/self/task")), os.cpu_count())
"""
    )
    threads, cores = map(int, printed.split())
    assert threads <= 3 * cores + 40  # NumPy has its own


@linux
def test_the_calling_thread_works_if_no_thread_can_be_started() -> None:
    printed = run_child(
        """
from signals import limit_threads
points = np.random.default_rng(0).random((17_000, 2))  # fewer would be left to one thread
limit_threads()
for method, some in (("quadtree", points), ("brute", points[:2100])):
    found, expected = (
        jostle.find_pairs(some, 0.004, sort=True, threads=threads, method=method)
        for threads in (2, 1)
    )
    assert len(found) > 0 and np.array_equal(found, expected), method
jostle.Quadtree(points, 0.002, threads=2).nearest(points[:600], k=2)
pull = jostle.Gravitation(1.0)
world = jostle.World(points * 99, 0.01, velocities=points, forces=[pull], threads=2)
world.step(0.01)
print(len(world))
"""
    )
    assert printed == "17000\n"
