"""The engine: steps and edits a simulation on a worker thread.

Only one thread at a time uses a simulation. The UI thread starts a job (edits, then steps, then a
frame), continues with the last finished frame, and takes the result later. In synchronous mode, for
tests and videos, each job is run at its start.

An error of a step, such as a speed beyond the limits, is kept in `error`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial

from jostle.app.simulate.fixed_timestep import MAX_STEPS, FixedTimestep
from jostle.app.simulate.simulation import Frame, FrameRequest, Simulation
from jostle.app.simulate.worker import Worker

Edit = Callable[[Simulation], None]
Then = Callable[[], None]

SMOOTH = 0.2  # weight of a new measurement
REFUSALS = (ValueError, OverflowError, MemoryError)


@dataclass(frozen=True)
class _Waiting:
    """An edit, and what the UI thread does after it."""

    work: Edit
    changes: bool
    then: Then | None
    key: str | None


@dataclass(frozen=True)
class _Result:
    """The result of a job; nothing of the engine changes before the UI thread takes it."""

    frame: Frame
    steps: tuple[tuple[float, float], ...]  # seconds of each step, alone and with its hooks
    error: str
    then: tuple[Then, ...]


def message_of(error: BaseException) -> str:
    """Return the message of an error."""
    return str(error) or "There is not enough memory for that."


class Engine:
    """Steps a simulation in real time and keeps its last frame.

    Parameters
    ----------
    simulation
        Used by nothing else from now on, except through `edit`.
    synchronous
        Whether jobs are run by the calling thread.

    Attributes
    ----------
    frame
        The last finished state.
    request
        What the next frames must contain.
    last_step
        Number of steps after which `advance` makes no more; None without a limit.
    last_seconds
        Time of the last step, alone.
    before, after
        Called with the simulation before and after each step, by the thread that steps.
    touched
        Called with the simulation before an edit by the user.
    error
        Message of a failed step; no further steps are made until `take_error`.
    """

    def __init__(self, simulation: Simulation, *, synchronous: bool = False) -> None:
        self.synchronous = synchronous
        self.request = FrameRequest()
        self.before: list[Edit] = []
        self.after: list[Edit] = []
        self.touched: list[Edit] = []
        self.steps = 0
        self.last_step: int | None = None
        self.last_seconds = 0.0
        self._worker = Worker("jostle-step", synchronous=synchronous)
        self._job: Future[_Result] | None = None
        self._edits: list[_Waiting] = []
        self.take(simulation)

    def take(self, simulation: Simulation, frame: Frame | None = None) -> None:
        """Continue with another simulation, and its frame if there is one.

        A job of the previous one is abandoned, and its edits are discarded.
        """
        self.abandon()
        self._edits.clear()
        self._single = self._stale = False  # a single step, or a frame, is requested
        self._elapsed, self.error = 0.0, ""
        self.simulation = simulation
        self.scene, self.time_step = simulation.scene, simulation.time_step
        self._note_settings()
        self._timestep = FixedTimestep(simulation.time_step)
        self.step_seconds = 0.0  # of a step with its hooks, smoothed
        self.frame: Frame = simulation.frame(self.request) if frame is None else frame

    @property
    def busy(self) -> bool:
        """Whether a job is in progress."""
        return self._job is not None and not self._job.done()

    def edit(
        self,
        work: Edit,
        *,
        changes: bool = True,
        then: Then | None = None,
        key: str | None = None,
    ) -> None:
        """Change the simulation after the current job; a later frame shows it.

        Parameters
        ----------
        changes
            False for an edit that only reads, or restores an earlier state.
        then
            Called on the UI thread, when the frame shows the edit.
        key
            An edit that still waits with the same key is replaced by this one.
        """
        if key is not None:
            self._edits = [edit for edit in self._edits if edit.key != key]
        self._edits.append(_Waiting(work, changes, then, key))
        self.poll()

    def refresh(self) -> None:
        """Request a frame without a step, after a change of `request`."""
        self._stale = True
        self.poll()

    def request_step(self) -> None:
        """Request a single step."""
        self._single = True
        self.poll()

    def poll(self) -> None:
        """Take a finished job, and start one for what was requested."""
        if not self.busy:
            self._collect()
            if self._job is None and (self._edits or self._single or self._stale):
                self._start()

    def advance(self, elapsed: float) -> int:
        """Add `elapsed` simulated seconds; return the steps finished since the last call."""
        self._elapsed += elapsed
        if self.busy:
            return 0
        before = self.steps
        self._collect()
        if self._job is None:
            if self._left() and not self.error and self._timestep.is_due(self._elapsed):
                self._start(self._elapsed)
                self._elapsed = 0.0
            else:
                self.poll()
        return self.steps - before

    def step(self) -> None:
        """Make one step on the calling thread; its error is raised."""
        self.wait()
        self._note_step(*_step(self.simulation, self.before, self.after))
        self.frame = self.simulation.frame(self.request)

    def take_error(self) -> str:
        """Return the message of a failed step, once."""
        error, self.error = self.error, ""
        return error

    def wait(self) -> None:
        """Wait for the current job, and for everything that was requested."""
        self._collect()
        while self._edits or self._single or self._stale:
            if self._job is None:
                self._start()
            self._collect()

    def close(self) -> None:
        """Wait for the current job, and end the thread."""
        try:
            self._collect()
        finally:
            self._worker.close()

    def abandon(self) -> None:
        """Discard the current job without waiting for it."""
        if self.busy:
            self._worker.abandon()
        self._job = None

    def _left(self) -> int:
        """Return the number of steps that may be made at once."""
        return MAX_STEPS if self.last_step is None else max(self.last_step - self.steps, 0)

    def _note_step(self, alone: float, whole: float) -> None:
        self.last_seconds = alone
        self.steps += 1
        self.step_seconds += (whole - self.step_seconds) * (SMOOTH if self.step_seconds else 1.0)

    def _note_settings(self) -> None:
        """Copy what can be read while the simulation is in use."""
        simulation = self.simulation
        self.settings, self.adjustable = simulation.settings, simulation.adjustable
        self.effective_settings, self.view = simulation.effective_settings, simulation.view

    def _start(self, elapsed: float = 0.0) -> None:
        """Start a job: the waiting edits, the due or requested steps, and a frame.

        It holds everything that it needs, so it has no effect on the engine if it is abandoned.
        """
        edits, self._edits = tuple(self._edits), []
        single, self._single, self._stale = self._single and not self.error, False, False
        steps: Callable[[Callable[[], None]], object]
        if elapsed:
            steps = partial(self._timestep.advance, elapsed, most=min(MAX_STEPS, self._left()))
        else:
            steps = partial(_repeat, int(single))
        self._job = self._worker.submit(
            partial(
                _run,
                *(self.simulation, self.request, edits, steps),
                *(tuple(self.before), tuple(self.after), tuple(self.touched)),
            )
        )
        if self.synchronous:
            self._collect()

    def _collect(self) -> None:
        """Wait for the current job, and take its result; an unexpected exception is raised."""
        if self._job is not None:
            job, self._job = self._job, None
            result = job.result()
            self.frame = result.frame
            for seconds in result.steps:
                self._note_step(*seconds)
            self.error = result.error or self.error
            self._note_settings()
            for then in result.then:
                then()


def _run(
    simulation: Simulation,
    request: FrameRequest,
    edits: Sequence[_Waiting],
    steps: Callable[[Callable[[], None]], object],
    before: Sequence[Edit],
    after: Sequence[Edit],
    touched: Sequence[Edit],
) -> _Result:
    """Run a job."""
    for edit in edits:
        if edit.changes:
            for hook in touched:
                hook(simulation)
        edit.work(simulation)
    seconds: list[tuple[float, float]] = []
    error = ""
    try:
        steps(lambda: seconds.append(_step(simulation, before, after)))
    except REFUSALS as refusal:
        error = message_of(refusal)
    then = tuple(edit.then for edit in edits if edit.then is not None)
    return _Result(simulation.frame(request), tuple(seconds), error, then)


def _repeat(count: int, step: Callable[[], None]) -> None:
    for _ in range(count):
        step()


def _step(
    simulation: Simulation, before: Sequence[Edit], after: Sequence[Edit]
) -> tuple[float, float]:
    """Make one step; return its seconds, alone and with its hooks."""
    start = time.perf_counter()
    for hook in before:
        hook(simulation)
    began = time.perf_counter()
    simulation.step()
    alone = time.perf_counter() - began
    for hook in after:
        hook(simulation)
    return alone, time.perf_counter() - start
