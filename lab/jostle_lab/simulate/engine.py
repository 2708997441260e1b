"""The engine: one queue of jobs that step, edit and load simulations on worker threads.

The UI thread starts a job (the inputs, the due steps, a frame), continues with the last finished
frame, and takes the result later; nothing calls back. Only one thread at a time uses a simulation.
In synchronous mode, for tests and videos, each job is run at its start.
"""

import sys
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

from jostle_lab.schema import Settings
from jostle_lab.simulate.frame import Frame, FrameRequest
from jostle_lab.simulate.history import History, Undo
from jostle_lab.simulate.simulation import Edit, Inputs, Simulation, Work

T = TypeVar("T")
Create = Callable[[], Simulation]

SWITCH_INTERVAL = 0.001  # seconds after which a thread releases the interpreter
MAX_STEPS = 3  # due steps at real time in a short frame; more are dropped if steps are slow
LONGEST = 0.25  # seconds of real time in a frame; longer if the machine was suspended
BUDGET = 0.025  # seconds of steps per frame, so that the window stays responsive
UNLIMITED = 10_000  # steps of a job that runs as fast as possible
SMOOTH = 0.2  # weight of a new measurement
MESSAGE_DELAY = 0.3  # seconds after which the message of a loading scene is shown
REFUSALS = (ValueError, OverflowError, MemoryError)


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


class FixedTimestep:
    """Accumulates simulated time, and converts it to steps of `time_step` seconds."""

    def __init__(self, time_step: float) -> None:
        self._time_step, self._accumulated = time_step, 0.0

    def add(self, elapsed: float, speed: float = 1.0) -> None:
        """Add seconds of real time at a speed; what exceeds the limits is dropped."""
        elapsed = min(elapsed, LONGEST)
        most = max(MAX_STEPS * self._time_step, elapsed) * max(speed, 1.0)
        self._accumulated = min(self._accumulated + elapsed * speed, most)

    @property
    def due(self) -> int:
        """Return the number of due steps.

        The remainder is within ± half a step. So a screen near 60 Hz gets one step per frame; with
        a remainder of 0 to 1 step, it would sometimes get none and then two.
        """
        return int(self._accumulated / self._time_step + 0.5)

    def take(self, steps: int) -> None:
        """Subtract steps that were made, due or not."""
        left = self._accumulated - steps * self._time_step
        self._accumulated = max(left, -self._time_step / 2)


def message_of(error: BaseException) -> str:
    return str(error) or "There is not enough memory for that."


@dataclass(frozen=True)
class Job:
    """What the worker thread does: first the inputs' edits, then steps, then a frame.

    It has everything that it needs, so it has no effect on the engine if it is abandoned.
    """

    simulation: Simulation
    request: FrameRequest
    history: History | None
    undo: Undo
    inputs: Inputs
    steps: int = 0
    budget: float = BUDGET  # seconds; at least one step is made

    def run(self) -> "Result":
        simulation, inputs = self.simulation, self.inputs
        results = [self._edit(edit) for edit in inputs.edits]
        if not inputs.holds:
            simulation.hold(inputs)
        seconds: list[tuple[float, float]] = []
        error, end = "", time.perf_counter() + self.budget
        try:
            while len(seconds) < self.steps and (not seconds or time.perf_counter() < end):
                start = time.perf_counter()
                if inputs.holds:
                    self._touch(inputs.holds)  # now, since the force stays if the step is refused
                began = time.perf_counter()
                simulation.step(inputs)
                alone = time.perf_counter() - began
                if self.history is not None:
                    self.history.after(simulation)
                seconds.append((alone, time.perf_counter() - start))
        except REFUSALS as refusal:
            error = message_of(refusal)
        return Result(simulation.frame(self.request), seconds, error, results)

    def _edit(self, edit: Edit) -> object:
        if edit.changes:
            self._touch(edit.key)
        try:
            return edit.work(self.simulation)
        except REFUSALS as error:
            return message_of(error)

    def _touch(self, key: str) -> None:
        """Record the state before a change by the user."""
        self.undo.record(key, self.simulation, self.history)
        if self.history is not None:
            self.history.touch()


@dataclass(frozen=True)
class Result:
    """The result of a job; nothing of the engine changes before the UI thread takes it."""

    frame: Frame
    seconds: list[tuple[float, float]]  # of each step, alone and with recording
    error: str
    results: list[object]  # of the edits


@dataclass(frozen=True)
class Scene:
    """A simulation that can be shown: its frame and its history."""

    simulation: Simulation
    frame: Frame
    history: History | None


@dataclass(frozen=True)
class Loading:
    """A scene that is being made, and the message to show meanwhile."""

    job: Future[Scene]
    message: str
    settings: Settings | None  # None if it is read from a file
    name: str  # of what the caller does with it
    began: float


def load(create: Create, request: FrameRequest) -> Scene:
    simulation = create()
    return Scene(simulation, simulation.frame(request), History(simulation))


class Engine:
    """Steps a simulation in real time and keeps its last frame.

    Nothing else uses the simulation from now on, except through `edit`.
    """

    def __init__(self, simulation: Simulation, *, synchronous: bool = False) -> None:
        self.synchronous = synchronous
        self.request = FrameRequest()  # what the next frames must contain
        self.undo = Undo()  # the states before the edits; also of earlier scenes
        self.steps = 0
        self.last_step: int | None = None  # after so many steps `advance` makes no more
        self.unlimited = False  # whether steps are made as fast as possible
        self.last_seconds = 0.0  # time of the last step, alone
        self.loading: Loading | None = None
        self.inputs = Inputs()  # of the next job
        self._worker = Worker("jostle-step", synchronous=synchronous)
        self._loader = Worker("jostle-load", synchronous=synchronous)
        self._job: Future[Result] | None = None
        self._at_work: tuple[Edit, ...] = ()  # the edits of that job
        self._finished: list[tuple[str, object]] = []
        self.take(Scene(simulation, simulation.frame(self.request), None))

    def take(self, scene: Scene) -> None:
        """Continue with another scene.

        A job of the previous one is abandoned, and its edits are discarded.
        """
        self.abandon()
        self.error = ""  # message of a failed step; no more steps are made until `take_error`
        self.simulation, self.frame, self.history = scene.simulation, scene.frame, scene.history
        self.time_step = scene.simulation.time_step
        self._note_settings()
        self._timestep = FixedTimestep(self.time_step)
        self.step_seconds = 0.0  # of a step alone, smoothed
        self.whole_seconds = 0.0  # of a step with recording, smoothed

    @property
    def scene(self) -> str:
        return self.settings.scene

    @property
    def busy(self) -> bool:
        return self._job is not None and not self._job.done()

    @property
    def idle(self) -> bool:
        """Whether no thread uses the simulation, and nothing is requested."""
        return self._job is None and not self._requested

    # Inputs

    def edit(
        self, work: Work, key: str = "", *, changes: bool = True, latest: bool = False
    ) -> Future[object]:
        """Change the simulation after the current job; return the future result.

        `take_finished` returns the result too, when the frame shows the edit. `changes` is False
        for an edit that only reads, or restores an earlier state. With `latest` an edit that still
        waits with the same key is replaced by this one.
        """
        edit = Edit(work, key, changes)
        waiting = self.inputs.edits
        if latest:
            waiting = tuple(other for other in waiting if other.key != key)
        self.inputs = replace(self.inputs, edits=(*waiting, edit))
        self.poll()
        return edit.result

    def take_finished(self) -> list[tuple[str, object]]:
        """Return the keys and results of the edits that were finished since the last call."""
        finished, self._finished = self._finished, []
        return finished

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
            if self._requested:
                self._start(self._single)

    def hold(self, inputs: Inputs) -> None:
        """Use what the user holds in the next jobs; a frame shows its end."""
        self._stale |= bool(self.inputs.holds) and not inputs.holds
        self.inputs = replace(inputs, edits=self.inputs.edits + inputs.edits)

    def advance(self, elapsed: float, inputs: Inputs, *, paused: bool = False) -> int:
        """Add `elapsed` seconds of real time; return the steps finished since the last call.

        In a pause only what was requested is done.
        """
        self.hold(inputs)
        if not paused:
            self._timestep.add(elapsed, self.settings.time_scale)
        if self.busy:
            return 0
        before = self.steps
        self._collect()
        due = UNLIMITED if self.unlimited and elapsed > 0 else self._timestep.due
        if self.last_step is not None:
            due = min(due, self.last_step - self.steps)
        if due > 0 and not self.error and not paused:
            # Where drawing is slow, steps have as much time as a frame; so both sides of a
            # comparison have more time alike.
            self._start(due, max(BUDGET, min(elapsed, LONGEST)))
        else:
            self.poll()
        return self.steps - before

    def step(self) -> None:
        """Make one step on the calling thread; its error is raised."""
        self.wait()
        result = self._job_of(1).run()
        self._take_result(result)
        if self.error:
            raise ValueError(self.take_error())

    def take_error(self) -> str:
        """Return the message of a failed step, once."""
        error, self.error = self.error, ""
        return error

    def wait(self) -> None:
        """Wait for the current job, and for everything that was requested."""
        self._collect()
        while self._requested:
            self._start(self._single)
            self._collect()

    def close(self) -> None:
        """Wait for the current job, and end the threads."""
        self.cancel_loading()
        try:
            self.wait()
        finally:
            self._worker.close()

    def abandon(self) -> None:
        """Discard the current job without waiting for it, and all that was requested."""
        if self.busy:
            self._worker.abandon()
            self.undo = self.undo.copy()
        self._job = None
        self.inputs = Inputs()
        self._single = self._stale = False  # a single step, or a frame, is requested

    @property
    def _requested(self) -> bool:
        return bool(self.inputs.edits) or self._single or self._stale

    def _job_of(self, steps: int, budget: float = BUDGET) -> Job:
        """Return a job with the waiting inputs."""
        inputs, self.inputs = self.inputs, replace(self.inputs, edits=())
        self._at_work = inputs.edits
        request = self.request
        return Job(self.simulation, request, self.history, self.undo, inputs, steps, budget)

    def _start(self, steps: int, budget: float = BUDGET) -> None:
        steps = 0 if self.error else steps
        self._single = self._stale = False
        self._job = self._worker.submit(self._job_of(steps, budget).run)
        if self.synchronous:
            self._collect()

    def _collect(self) -> None:
        """Wait for the current job, and take its result; an unexpected exception is raised."""
        if self._job is not None:
            job, self._job = self._job, None
            result = job.result()
            self._timestep.take(len(result.seconds))
            self._take_result(result)

    def _take_result(self, result: Result) -> None:
        self.frame = result.frame
        for alone, whole in result.seconds:
            self.last_seconds = alone
            self.steps += 1
            self.step_seconds = _smoothed(self.step_seconds, alone)
            self.whole_seconds = _smoothed(self.whole_seconds, whole)
        self.error = result.error or self.error
        self._note_settings()
        for edit, value in zip(self._at_work, result.results, strict=True):
            edit.result.set_result(value)
            self._finished.append((edit.key, value))

    def _note_settings(self) -> None:
        """Copy what can be read while the simulation is in use."""
        simulation = self.simulation
        self.settings, self.view = simulation.settings, simulation.view
        self.effective_settings = simulation.effective_settings

    # Scenes

    def load(
        self, create: Create, request: FrameRequest, message: str, settings: Settings | None = None,
        name: str = "",
    ) -> None:  # fmt: skip
        """Begin to make a scene, while the present one is stepped; one in progress is cancelled."""
        self.cancel_loading()
        job = self._loader.submit(partial(load, create, request))
        self.loading = Loading(job, message, settings, name, time.perf_counter())

    @property
    def message(self) -> str:
        """Return the message to show while a scene is loading, or an empty string."""
        loading = self.loading
        late = loading is not None and time.perf_counter() - loading.began >= MESSAGE_DELAY
        return loading.message if loading is not None and late else ""

    def cancel_loading(self) -> None:
        """Discard the scene in progress; its thread ends by itself."""
        if self.loading is not None and not (self.loading.job.done() or self.loading.job.cancel()):
            self._loader.abandon()
        self.loading = None

    def take_loaded(self) -> tuple[Scene | str, str] | None:
        """Return a finished scene or an error message, and its name, once; None without."""
        loading = self.loading
        if loading is None or not loading.job.done():
            return None
        self.cancel_loading()
        try:
            return loading.job.result(), loading.name
        except REFUSALS as error:
            return message_of(error), loading.name

    def wait_for_loading(self) -> None:
        if self.loading is not None:
            self.loading.job.exception()


def _smoothed(mean: float, new: float) -> float:
    return mean + (new - mean) * (SMOOTH if mean else 1.0)


def expected(settings: Settings) -> int:
    """Return the number of particles that the settings name; the defaults of scenes are small."""
    return (settings.n or 0) + sum(group.count for group in settings.particles)
