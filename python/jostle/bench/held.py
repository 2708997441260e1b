"""The largest number of discs at 60 steps a second, with all positions read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from jostle.bench import step_rivals as ways
from jostle.bench.machine import Row, version_of
from jostle.bench.timing import Timing, clock

__all__ = ["LADDER", "largest", "search", "searches"]

STEPS = (
    10,
    11,
    12,
    13,
    15,
    16,
    18,
    20,
    22,
    24,
    27,
    30,
    33,
    36,
    39,
    43,
    47,
    51,
    56,
    62,
    68,
    75,
    82,
    91,
)
LADDER = tuple(step * 10**power for power in range(1, 6) for step in STEPS)
"""Numbers of discs, each about a tenth above the last."""

BUDGET = ways.FRAME
HOPELESS = 1.5
"""A fall that takes so many times the budget a frame does not end in a pile that is held."""

TRIES = 3
"""A number is held if it is in one of so many tries: another program may spoil one."""

Told = Callable[[str], None]


def largest(holds: Callable[[int], bool], guess: int) -> int:
    """Return the last step of the ladder that holds, 0 if none does.

    Doubles or halves from the guess until the end is between two numbers, then bisects.

    Examples
    --------
    >>> from jostle.bench.held import largest
    >>> largest(lambda count: count < 12_345, guess=1_000)
    12000
    """
    low, high = -1, len(LADDER)  # the last known to hold, the first known not to
    at, stride = min(range(high), key=lambda index: abs(LADDER[index] - guess)), 8
    while high - low > 1:
        if holds(LADDER[at]):
            low = at
        else:
            high = at
        if high == len(LADDER):
            at = min(low + stride, high - 1)
        elif low == -1:
            at = max(high - stride, 0)
        else:
            at = (low + high) // 2
    return LADDER[low] if low >= 0 else 0


def search(
    scene: str, threads: int, frames: int = 31, guess: int = 10_000, told: Told = lambda text: None
) -> Row:
    """Find the largest number of discs whose median frame fits into a sixtieth of a second.

    Parameters
    ----------
    scene : {"gas", "pile", "article"}
        A gas, a pile at rest, or the article's own program with its tree.
    threads : int
        How many work on a step.
    frames : int
        How many are timed for each number of discs.
    guess : int
        Where to begin.
    told : callable
        Is told what is being done.
    """
    timings: dict[int, Timing] = {}

    def holds(count: int) -> bool:
        told(f"{scene}, {threads} threads: {count:,}")
        frame = frame_of(scene, count, threads)
        if frame is None:
            return False
        for _ in range(5):
            frame()
        for _ in range(TRIES):
            timings[count] = Timing(tuple(clock(frame) for _ in range(frames)))
            if timings[count].median <= BUDGET:
                return True
        return False

    count = largest(holds, guess)
    timing = timings.get(count)
    return {
        "scene": scene,
        "version": version_of("jostle"),
        "threads": threads,
        "held": count,
        **(
            timing.columns() if timing else {"rounds": 0, "median_s": "", "low_s": "", "high_s": ""}
        ),
    }


def frame_of(scene: str, count: int, threads: int) -> Callable[[], object] | None:
    """Return the frame to be timed; None where there is no hope."""
    if scene == "article":
        frame = ways.article(count, "quadtree")
        for _ in range(60):  # the crowd falls to the floor
            frame()
        return frame
    start = ways.gas(count) if scene == "gas" else ways.pile(count, HOPELESS * BUDGET)
    return next(iter(ways.jostle_world(start, threads).frames.values())) if start else None


def searches(threads: Sequence[int] = (1, 2), told: Told = lambda text: None) -> Iterator[Row]:
    """Search for the article's tree, then for jostle; how many times as many is a column."""
    article = search("article", 1, guess=1_000, told=told)
    base = article["held"]
    yield {**article, "times_article": 1}
    for scene in ("gas", "pile"):
        for number in threads:
            row = search(scene, number, told=told)
            held = row["held"]
            assert isinstance(held, int) and isinstance(base, int)
            yield {**row, "times_article": f"{held / base:.1f}" if base else ""}
