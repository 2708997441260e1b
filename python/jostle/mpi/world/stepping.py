"""Steps of a distributed world."""

from __future__ import annotations

import time

from ..exchange import passed_on, together
from ..interrupts import held
from .part import Part

#: Share of the last step in the mean time that a rank needs for a particle.
_SMOOTHING = 0.1


class Stepping(Part):
    """A world that makes steps."""

    __slots__ = ()

    def step(self, dt: float, steps: int = 1) -> None:
        """Advance the world.

        Parameters
        ----------
        dt : float
            Duration of a step, in seconds; the same on all ranks.
        steps : int, default 1
            Number of steps.

        Raises
        ------
        ValueError
            If the step is refused, as by `jostle.World.step`, or if `dt` or `steps` is not the same
            on all ranks. Then the world is as before this step, on all ranks.
        RankError
            If another rank cannot do the step, or if a signal handler raises there.

        Notes
        -----
        Signal handlers, such as that of Ctrl-C, run after the current step. If one raises on any
        rank, no rank makes a further step.
        """
        with held() as run_handlers:
            with together(self._comm):
                dt, steps = self._core._arguments_of_step(dt, steps)
            self._check_same(dt=dt, steps=steps)
            with together(self._comm):
                self._core._begin_steps(dt)
            for _ in range(steps):
                self._step(dt)
                with together(self._comm):
                    run_handlers()
            self._core._end_steps()

    def _step(self, dt: float) -> None:
        self._own_world = None
        start, waited = time.perf_counter(), self._messages.seconds
        with passed_on(self._comm):
            self._core._step_distributed(dt)
        busy = time.perf_counter() - start - (self._messages.seconds - waited)
        work = busy / max(self._core._counts()[2], 1)
        # One step may be disturbed by other processes.
        self._work = work if self._work is None else self._work + _SMOOTHING * (work - self._work)
        self._core._set_work(self._work)
