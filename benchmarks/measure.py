"""Interleaved rounds: noise of the machine falls on all rivals alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from machine import describe


@dataclass(frozen=True)
class Timing:
    """Median and spread of one rival's rounds, in seconds."""

    median: float
    low: float
    high: float

    def columns(self) -> dict[str, object]:
        """The timing as columns of a results file."""
        return {
            "median_s": f"{self.median:.6g}",
            "low_s": f"{self.low:.6g}",
            "high_s": f"{self.high:.6g}",
            "machine": describe(),
        }


def interleaved(calls: Sequence[Callable[[], object]], rounds: int) -> list[Timing]:
    """Time every call once a round, `rounds` times over, after one round to warm up."""
    times: list[list[float]] = [[] for _ in calls]
    for number in range(rounds + 1):
        for own, call in zip(times, calls, strict=True):
            start = time.perf_counter()
            call()
            if number > 0:
                own.append(time.perf_counter() - start)
    return [Timing(statistics.median(own), min(own), max(own)) for own in times]
