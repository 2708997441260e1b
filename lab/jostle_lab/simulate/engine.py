"""The engine: steps and edits a simulation on a worker thread.

Only one thread at a time uses a simulation. The UI thread starts a job (edits, then steps, then a
frame), continues with the last finished frame, and takes the result later. In synchronous mode, for
tests and videos, each job is run at its start. New simulations are made on another thread, while
the present one is shown.

An error of a step, such as a speed beyond the limits, is kept in `error`.
"""

import sys
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from jostle_lab.schema import Settings
from jostle_lab.simulate.frame import Frame, FrameRequest
from jostle_lab.simulate.history import History
from jostle_lab.simulate.simulation import Simulation

T = TypeVar("T")

SWITCH_INTERVAL = 0.001  # seconds after which a thread releases the interpreter


class Worker:
    """Runs jobs on a thread, which is started by the first of them.

    In synchronous mode `submit` runs the job itself.
    """

    def __init__(self, name: str, *, synchronous: bool = False) -> None:
        self._name, self._synchronous = name, synchronous
        self._pool: ThreadPoolExecutor | None = None

    def submit(self, job: Callable[[], T]) -> Future[T]:
        """Run a job; return its future, which is done in synchronous mode."""
        if not self._synchronous:
            if self._pool is None:
                # The UI thread waits for the interpreter several times per frame.
                sys.setswitchinterval(SWITCH_INTERVAL)
                self._pool = ThreadPoolExecutor(1, self._name)
            return self._pool.submit(job)
        future: Future[T] = Future()
        try:
            future.set_result(job())
        except Exception as error:
            future.set_exception(error)
        return future

    def abandon(self) -> None:
        """Let a job in progress end by itself; later jobs run on another thread."""
        if self._pool is not None:
            self._pool.shutdown(wait=False)
            self._pool = None

    def close(self) -> None:
        """Wait for all jobs, and end the thread."""
        if self._pool is not None:
            self._pool.shutdown()
            self._pool = None


MAX_STEPS = 3  # steps; more are dropped, so simulated time slows down on a slow machine
BUDGET = 0.025  # seconds of steps per frame, so that the window stays responsive
SMOOTH = 0.2  # weight of a new measurement
REFUSALS = (ValueError, OverflowError, MemoryError)

Edit = Callable[[Simulation], object]
Act = Callable[[Simulation], bool]
Then = Callable[[], None]
MakeSteps = Callable[[Callable[[], None]], object]  # calls its argument for each step


class FixedTimestep:
    """Accumulates real time, and converts it to steps of `time_step` seconds."""

    def __init__(self, time_step: float, clock: Callable[[], float] = time.perf_counter) -> None:
        self._time_step = time_step
        self._clock = clock
        self._accumulated = 0.0

    def is_due(self, elapsed: float) -> bool:
        """Return whether a step would be due after `elapsed` more seconds."""
        return self._accumulated + elapsed >= self._time_step / 2

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


def message_of(error: BaseException) -> str:
    return str(error) or "There is not enough memory for that."


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
    seconds: list[tuple[float, float]]  # of each step, alone and with recording
    error: str
    then: list[Then]


def _run(
    simulation: Simulation,
    request: FrameRequest,
    history: History | None,
    act: Act,
    edits: list[_Waiting],
    make_steps: MakeSteps,
) -> _Result:
    """Do a job on the worker thread: edits, steps, and a frame.

    It is given everything that it needs, so it has no effect on the engine if it is abandoned.
    """
    for edit in edits:
        if edit.changes and history is not None:
            history.touch()
        edit.work(simulation)
    seconds: list[tuple[float, float]] = []
    error = ""
    try:
        make_steps(lambda: seconds.append(_step(simulation, history, act)))
    except REFUSALS as refusal:
        error = message_of(refusal)
    then = [edit.then for edit in edits if edit.then is not None]
    return _Result(simulation.frame(request), seconds, error, then)


def _step(simulation: Simulation, history: History | None, act: Act) -> tuple[float, float]:
    """Make and record one step; return its seconds, alone and with recording."""
    start = time.perf_counter()
    if act(simulation) and history is not None:
        history.touch()  # now, since the act stays if the step is refused
    began = time.perf_counter()
    simulation.step()
    alone = time.perf_counter() - began
    if history is not None:
        history.after(simulation)
    return alone, time.perf_counter() - start


class Engine:
    """Steps a simulation in real time and keeps its last frame.

    Nothing else uses the simulation from now on, except through `edit`.
    """

    def __init__(self, simulation: Simulation, *, synchronous: bool = False) -> None:
        self.synchronous = synchronous
        self.request = FrameRequest()  # what the next frames must contain
        self.history: History | None = None  # records the steps, if there is one
        # Applies what the user does during a step, such as a drag; returns whether it is anything.
        self.act: Act = lambda simulation: False
        self.steps = 0
        self.last_step: int | None = None  # after so many steps `advance` makes no more
        self.last_seconds = 0.0  # time of the last step, alone
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
        self._elapsed = 0.0
        self.error = ""  # message of a failed step; no more steps are made until `take_error`
        self.simulation = simulation
        self.scene, self.time_step = simulation.settings.scene, simulation.time_step
        self._note_settings()
        self._timestep = FixedTimestep(simulation.time_step)
        self.step_seconds = 0.0  # of a step alone, smoothed
        self.whole_seconds = 0.0  # of a step with recording, smoothed
        self.frame = simulation.frame(self.request) if frame is None else frame  # the last state

    @property
    def busy(self) -> bool:
        return self._job is not None and not self._job.done()

    def edit(
        self, work: Edit, *, changes: bool = True, then: Then | None = None, key: str | None = None
    ) -> None:
        """Change the simulation after the current job; a later frame shows it.

        `changes` is False for an edit that only reads, or restores an earlier state. `then` is
        called on the UI thread, when the frame shows the edit. An edit that still waits with the
        same `key` is replaced by this one.
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
            self._collect()  # which may start a job
            if self._job is None and self._requested:
                self._start()

    def advance(self, elapsed: float) -> int:
        """Add `elapsed` simulated seconds; return the steps finished since the last call."""
        self._elapsed += elapsed
        if self.busy:
            return 0
        before = self.steps
        self._collect()
        left = MAX_STEPS if self.last_step is None else min(MAX_STEPS, self.last_step - self.steps)
        due = left > 0 and not self.error and self._timestep.is_due(self._elapsed)
        if due and self._job is None:
            self._start(partial(self._timestep.advance, self._elapsed, most=left))
            self._elapsed = 0.0
        else:
            self.poll()
        return self.steps - before

    def step(self) -> None:
        """Make one step on the calling thread; its error is raised."""
        self.wait()
        self._note_step(*_step(self.simulation, self.history, self.act))
        self.frame = self.simulation.frame(self.request)

    def take_error(self) -> str:
        """Return the message of a failed step, once."""
        error, self.error = self.error, ""
        return error

    def wait(self) -> None:
        """Wait for the current job, and for everything that was requested."""
        self._collect()
        while self._requested:
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

    @property
    def _requested(self) -> bool:
        return bool(self._edits) or self._single or self._stale

    def _note_step(self, alone: float, whole: float) -> None:
        self.last_seconds = alone
        self.steps += 1
        self.step_seconds = _smoothed(self.step_seconds, alone)
        self.whole_seconds = _smoothed(self.whole_seconds, whole)

    def _note_settings(self) -> None:
        """Copy what can be read while the simulation is in use."""
        simulation = self.simulation
        self.settings, self.view = simulation.settings, simulation.view
        self.effective_settings = simulation.effective_settings

    def _start(self, steps: MakeSteps | None = None) -> None:
        """Start a job with the waiting edits, and the requested step unless others are given."""
        edits, self._edits = self._edits, []
        single, self._single, self._stale = self._single and not self.error, False, False
        make_steps = steps or (lambda step: step() if single else None)
        job = partial(_run, self.simulation, self.request, self.history, self.act)
        self._job = self._worker.submit(partial(job, edits, make_steps))
        if self.synchronous:
            self._collect()

    def _collect(self) -> None:
        """Wait for the current job, and take its result; an unexpected exception is raised."""
        if self._job is not None:
            job, self._job = self._job, None
            result = job.result()
            self.frame = result.frame
            for seconds in result.seconds:
                self._note_step(*seconds)
            self.error = result.error or self.error
            self._note_settings()
            for then in result.then:
                then()


def _smoothed(mean: float, new: float) -> float:
    return mean + (new - mean) * (SMOOTH if mean else 1.0)


Create = Callable[[], Simulation]

MESSAGE_DELAY = 0.3  # seconds after which a message is shown


@dataclass(frozen=True)
class LoadedScene:
    """A simulation in its initial state, with its first frame and the beginning of its history."""

    simulation: Simulation
    frame: Frame
    history: History


class SceneLoader:
    """Makes one simulation at a time."""

    def __init__(self, *, synchronous: bool = False) -> None:
        # Those of the simulation in progress, unless it is read from a file.
        self.settings: Settings | None = None
        self._message, self._began = "", 0.0
        self._then: Then | None = None
        self._worker = Worker("jostle-load", synchronous=synchronous)
        self._job: Future[LoadedScene] | None = None

    @property
    def message(self) -> str:
        """Return the message to show meanwhile, or an empty string."""
        late = time.perf_counter() - self._began >= MESSAGE_DELAY
        return self._message if self._job is not None and late else ""

    def start(
        self,
        create: Create,
        request: FrameRequest,
        message: str,
        settings: Settings | None = None,
        then: Then | None = None,
    ) -> None:
        """Begin to make a simulation; one in progress is cancelled.

        `then` is called after it has replaced the present one.
        """
        self.cancel()
        self.settings, self._then = settings, then
        self._message, self._began = message, time.perf_counter()
        self._job = self._worker.submit(partial(load, create, request))

    def cancel(self) -> None:
        """Discard the simulation in progress; its thread ends by itself."""
        if self._job is not None and not (self._job.done() or self._job.cancel()):
            self._worker.abandon()
        self._job = self.settings = self._then = None

    def take(self) -> tuple[LoadedScene, Then | None] | str | None:
        """Return a finished simulation, or an error message, once; None if there is none."""
        if self._job is None or not self._job.done():
            return None
        job, then = self._job, self._then
        self.cancel()
        try:
            return job.result(), then
        except REFUSALS as error:
            return message_of(error)

    def wait(self) -> None:
        if self._job is not None:
            self._job.exception()


def load(create: Create, request: FrameRequest) -> LoadedScene:
    simulation = create()
    return LoadedScene(simulation, simulation.frame(request), History(simulation))


def expected(settings: Settings) -> int:
    """Return the number of particles that the settings name; the defaults of scenes are small."""
    return (settings.n or 0) + sum(group.count for group in settings.particles)
