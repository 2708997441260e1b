"""Conversion of real time to whole steps of fixed length."""

from __future__ import annotations

import time
from collections.abc import Callable

MOST_OWED = 3  # steps; what a slow machine owes beyond is dropped, so simulated time slows
BUDGET = 0.025  # seconds of stepping a frame: beyond it the window would answer late


class Pace:
    """Collects real time and pays it out in steps of `time_step` seconds."""

    def __init__(self, time_step: float, clock: Callable[[], float] = time.perf_counter) -> None:
        self._time_step = time_step
        self._clock = clock
        self._owed = 0.0

    def advance(self, elapsed: float, step: Callable[[], None], most: int = MOST_OWED) -> int:
        """Take `elapsed` seconds; call `step` as often as due, at most `most` times.

        Returns how often it was called.
        """
        self._owed = min(self._owed + elapsed, MOST_OWED * self._time_step)
        start, steps = self._clock(), 0
        # Half a step ahead to half a step behind: a screen near 60 Hz then gets one step a frame,
        # where a sharp limit would now and then miss one and double the next, which stutters.
        while steps < most and self._owed >= self._time_step / 2:
            if steps and self._clock() - start > BUDGET:
                break
            step()
            self._owed -= self._time_step
            steps += 1
        return steps
