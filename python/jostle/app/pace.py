"""Real time to whole steps of fixed length."""

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

    def advance(self, elapsed: float, step: Callable[[], None]) -> int:
        """Take `elapsed` seconds of real time; call `step` as often as due; return how often."""
        # Screens beat near 60 Hz, never at it: without this a step would be missed or doubled
        # every second or so, which shows as a stutter.
        if abs(elapsed - self._time_step) < 0.2 * self._time_step:
            elapsed = self._time_step
        self._owed = min(self._owed + elapsed, MOST_OWED * self._time_step)
        start, steps = self._clock(), 0
        while self._owed >= self._time_step * (1 - 1e-9):
            if steps and self._clock() - start > BUDGET:
                break
            step()
            self._owed = max(self._owed - self._time_step, 0.0)
            steps += 1
        return steps
