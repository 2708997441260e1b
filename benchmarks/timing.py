"""Interleaved rounds, so that noise of the machine affects all compared calls equally."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

__all__ = ["THREADS", "Effort", "Timing", "clock", "interleaved"]

LEAST_SECONDS = 1e-3
"""Seconds of a measurement; faster calls are repeated in a round."""

WARM_UP_SECONDS = 0.1
"""A call that takes less is made once, untimed, before each measurement."""

THREADS = (1, 2)
"""Numbers of threads that are compared."""

Call = Callable[[], object]


@dataclass(frozen=True)
class Effort:
    """The time that a comparison takes."""

    rounds: int = 9
    """Number of timings of each."""
    patience: float = 1.0
    """Seconds; what takes longer is timed once, or omitted."""
    report: Callable[[str], object] = lambda text: None
    """Called with a description of the progress."""


@dataclass(frozen=True)
class Timing:
    """Median and quartiles of one call over all rounds, in seconds."""

    rounds: tuple[float, ...]

    @property
    def median(self) -> float:
        """The middle round."""
        return statistics.median(self.rounds)

    @property
    def quartiles(self) -> tuple[float, float]:
        """A quarter of the rounds lies below the first, a quarter above the second."""
        if len(self.rounds) < 2:
            return self.median, self.median
        low, _, high = statistics.quantiles(self.rounds, n=4, method="inclusive")
        return low, high

    def columns(self) -> dict[str, object]:
        """Return the columns of a results file."""
        low, high = self.quartiles
        return {
            "rounds": len(self.rounds),
            "median_s": f"{self.median:.4g}",
            "low_s": f"{low:.4g}",
            "high_s": f"{high:.4g}",
        }


def clock(call: Call) -> float:
    """Time one call."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def interleaved(calls: Sequence[Call], rounds: int) -> list[Timing]:
    """Time every call once a round, after one round to warm up.

    In each round a call is first made once untimed, because the other calls have evicted its data
    from the caches.

    Examples
    --------
    >>> from timing import interleaved
    >>> [len(timing.rounds) for timing in interleaved([dict, list], 9)]
    [9, 9]
    """
    first = [max(clock(call), 1e-7) for call in calls]
    repeats = [math.ceil(LEAST_SECONDS / seconds) for seconds in first]
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(rounds):
        for own, call, count, seconds in zip(times, calls, repeats, first, strict=True):
            if seconds < WARM_UP_SECONDS:
                call()
            start = time.perf_counter()
            for _ in range(count):
                call()
            own.append((time.perf_counter() - start) / count)
    return [Timing(tuple(own)) for own in times]
