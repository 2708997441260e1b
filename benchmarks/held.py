"""The largest number of discs at 60 steps per second, with all positions read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import step_rivals as rivals
from machine import Row, version_of
from timing import Timing, clock

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
"""Numbers of discs, each about 10 % above the last."""

BUDGET = rivals.FRAME
HOPELESS = 1.5
"""Times the budget per frame; if the fall of a pile takes longer, the pile is not tried."""

TRIES = 3
"""A number holds if it does in one of these tries: another process may disturb one."""

Report = Callable[[str], None]


def largest(holds: Callable[[int], bool], guess: int) -> int:
    """Return the largest number of the ladder that holds, 0 if none does.

    Doubles or halves from the guess until the limit is bracketed, then bisects.

    Examples
    --------
    >>> from held import largest
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
    scene: str,
    threads: int,
    frames: int = 31,
    guess: int = 10_000,
    report: Report = lambda text: None,
) -> Row:
    """Find the largest number of discs whose median frame takes at most 1/60 s.

    Parameters
    ----------
    scene : {"gas", "pile", "article"}
        A gas, a pile at rest, or the article's own program with its tree.
    threads : int
        Threads of a step.
    frames : int
        Timed frames for each number of discs.
    guess : int
        Initial number.
    report : callable
        Called with a description of the progress.
    """
    timings: dict[int, Timing] = {}

    def holds(count: int) -> bool:
        report(f"{scene}, {threads} threads: {count:,}")
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
    """Return the frame to be timed; None if it is certainly too slow."""
    if scene == "article":
        frame = rivals.article(count, "quadtree")
        for _ in range(60):  # the particles fall to the floor
            frame()
        return frame
    start = rivals.gas(count) if scene == "gas" else rivals.pile(count, HOPELESS * BUDGET)
    return next(iter(rivals.jostle_world(start, threads).frames.values())) if start else None


def searches(threads: Sequence[int] = (1, 2), report: Report = lambda text: None) -> Iterator[Row]:
    """Search for the article's tree, then for jostle; a column has the ratio."""
    article = search("article", 1, guess=1_000, report=report)
    base = article["held"]
    yield {**article, "times_article": 1}
    for scene in ("gas", "pile"):
        for number in threads:
            row = search(scene, number, report=report)
            held = row["held"]
            assert isinstance(held, int) and isinstance(base, int)
            yield {**row, "times_article": f"{held / base:.1f}" if base else ""}
