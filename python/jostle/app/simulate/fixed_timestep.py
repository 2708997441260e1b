"""Fixed time steps: an accumulator converts real time to whole steps."""

from __future__ import annotations

import time
from collections.abc import Callable

MAX_STEPS = 3  # steps; more are dropped, so simulated time slows down on a slow machine
BUDGET = 0.025  # seconds of steps per frame, so that the window stays responsive


class FixedTimestep:
    """Accumulates real time, and converts it to steps of `time_step` seconds."""

    def __init__(self, time_step: float, clock: Callable[[], float] = time.perf_counter) -> None:
        self._time_step = time_step
        self._clock = clock
        self._accumulated = 0.0

    def advance(self, elapsed: float, step: Callable[[], None], most: int = MAX_STEPS) -> int:
        """Add `elapsed` seconds; call `step` for each due step, at most `most` times.

        Returns the number of calls.
        """
        self._accumulated = min(self._accumulated + elapsed, MAX_STEPS * self._time_step)
        start, steps = self._clock(), 0
        # The remainder is within ± half a step. So a screen near 60 Hz gets one step per frame;
        # with a remainder of 0 to 1 step, it would sometimes get none and then two.
        while steps < most and self._accumulated >= self._time_step / 2:
            if steps and self._clock() - start > BUDGET:
                break
            step()
            self._accumulated -= self._time_step
            steps += 1
        return steps
