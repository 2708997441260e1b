"""The engine: makes short steps at once, and long ones in a worker thread.

Only one thread at a time uses a simulation. While a long step is under way the window goes on
with the last frame, and edits wait; so a million particles slow the picture, never the hand.

What a step refuses, such as speeds beyond every measure, is kept in `error` and ends nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

from jostle.app.simulate.fixed_timestep import MAX_STEPS, FixedTimestep
from jostle.app.simulate.simulation import Frame, FrameRequest, Simulation

Edit = Callable[[Simulation], None]
Then = Callable[[], None]

SHORT = 0.020  # seconds: steps up to this long are made at once, so that they are never late
FEW = 50_000  # particles whose edits and first step are short, as far as anybody can tell
SMOOTH = 0.2  # share of a new measurement
REFUSALS = (ValueError, OverflowError, MemoryError)


@dataclass(frozen=True)
class _Waiting:
    """An edit, and what the window does when the frame shows it."""

    work: Edit
    changes: bool
    then: Then | None
    key: str | None
    many: bool


@dataclass(frozen=True)
class _Done:
    """What came of work beside the window: nothing of the engine is touched before it is taken."""

    frame: Frame
    taken: tuple[float, float] | None = None  # seconds of a step alone, and with its hooks
    error: str = ""
    then: tuple[Then, ...] = ()


def message_of(error: BaseException) -> str:
    """Return what to say of a refusal."""
    return str(error) or "There is not enough memory for that."


class Engine:
    """Steps a simulation in real time and keeps its last frame.

    Parameters
    ----------
    simulation
        What to step. Nobody else may use it from now on, but by `edit`.
    short
        Steps up to so many seconds are made at once. Less than usual also means caution: a step
        whose time is not known yet is then made beside the window too.

    Attributes
    ----------
    frame
        The last state, for everybody to look at.
    request
        What the next frames shall hold.
    last_step
        `advance` makes no more than so many steps; None to go on.
    last_seconds
        What the last step took, alone.
    before, after
        Called with the simulation around each step, in the thread that steps.
    touched
        Called with the simulation before a person changes it.
    error
        Why the last step was refused; nothing goes on until it is taken with `take_error`.
    """

    def __init__(self, simulation: Simulation, short: float = SHORT) -> None:
        self.short = short
        self.request = FrameRequest()
        self.before: list[Edit] = []
        self.after: list[Edit] = []
        self.touched: list[Edit] = []
        self.steps = 0
        self.last_step: int | None = None
        self.last_seconds = 0.0
        self._worker: ThreadPoolExecutor | None = None
        self._job: Future[_Done] | None = None
        self._edits: list[_Waiting] = []
        self.take(simulation)

    def take(self, simulation: Simulation, frame: Frame | None = None) -> None:
        """Go on with another simulation, and its frame if there is one already.

        A step of the one before that is under way is abandoned, and edits that wait are forgotten.
        """
        self.abandon()
        self._edits.clear()
        self._single, self.error = False, ""  # a single step that is asked for; a refusal
        self.simulation = simulation
        self.settings, self.scene, self.view = (
            simulation.settings,
            simulation.scene,
            simulation.view,
        )
        self.time_step, self.adjustable = simulation.time_step, simulation.adjustable
        self.effective_settings = simulation.effective_settings
        self._pace = FixedTimestep(simulation.time_step)
        self._seconds = 0.0  # one step and its frame, smoothed
        self.frame: Frame = simulation.frame(self.request) if frame is None else frame

    @property
    def busy(self) -> bool:
        """Whether a step, or an edit of many particles, is under way beside the window."""
        return self._job is not None and not self._job.done()

    @property
    def step_seconds(self) -> float:
        """The smoothed time of a step with all that belongs to it."""
        return self._seconds

    def edit(
        self,
        work: Edit,
        *,
        changes: bool = True,
        then: Then | None = None,
        key: str | None = None,
        many: bool = False,
    ) -> None:
        """Change the simulation: now, or as soon as the step under way is done.

        Edits of very many particles are made beside the window: the frame shows them later.

        Parameters
        ----------
        changes
            False for what only reads, or brings back a state that was.
        then
            Called in the window, when the frame shows the edit.
        key
            An edit that still waits under the same key is left out: this one replaces it.
        many
            Whether it brings very many particles.
        """
        if key is not None:
            self._edits = [edit for edit in self._edits if edit.key != key]
        self._edits.append(_Waiting(work, changes, then, key, many))
        self.settle()

    def settle(self) -> None:
        """Once a frame of a pause: take what was done beside the window, and go on with edits."""
        if not self.busy:
            self._collect()
            self._settle_edits()
            if self._single and self._job is None:
                self._single = False
                self._start()

    def look(self, *, at_once: bool = True) -> None:
        """Renew the frame, where `request` has changed and no step does it.

        Where that need not be `at_once`, very many particles are looked at beside the window.
        """
        if self.busy:
            return
        self._collect()
        if at_once or len(self.simulation) <= FEW:
            self.frame = self.simulation.frame(self.request)
        else:
            self._beside()

    def advance(self, elapsed: float) -> int:
        """Take `elapsed` simulated seconds; return the steps that were done since the last call."""
        if self.busy:
            self._pace.advance(elapsed, lambda: None, most=0)
            return 0
        before, self._single = self.steps, False
        self._collect()
        self._settle_edits()
        if self._job is not None or self.error:  # edits are under way
            self._pace.advance(elapsed, lambda: None, most=0)
        elif self._in_the_window():
            if self._pace.advance(elapsed, self._try_step, most=min(MAX_STEPS, self._left())):
                self.frame = self.simulation.frame(self.request)
        else:
            self._pace.advance(elapsed, self._start, most=min(1, self._left()))
        return self.steps - before

    def _left(self) -> int:
        """Return how many steps may still be made."""
        return MAX_STEPS if self.last_step is None else max(self.last_step - self.steps, 0)

    def _in_the_window(self) -> bool:
        """Tell whether steps are made at once; the first of many particles is not even tried."""
        if self._seconds:
            return self._seconds <= self.short
        return self.short >= SHORT and len(self.simulation) <= FEW

    def step(self) -> None:
        """Make one step now, however long it takes; what it refuses is raised."""
        self.wait()
        self._note_step(*self._step())
        self.frame = self.simulation.frame(self.request)

    def step_soon(self) -> None:
        """Make one step: now if it is short, else beside the window, as `settle` goes on."""
        short = self._seconds <= self.short if self._seconds else self.short >= SHORT
        if not self.busy and short and len(self.simulation) <= FEW:
            self.wait()
            self._try_step()
            self.frame = self.simulation.frame(self.request)
        else:
            self._single = True
            self.settle()

    def take_error(self) -> str:
        """Return why the last step was refused, once."""
        error, self.error = self.error, ""
        return error

    def wait(self) -> None:
        """Wait for the step under way, if there is one, and for the edits that wait for it."""
        self._collect()
        self._apply_edits()
        if self._single:
            self._single = False
            self._try_step()
            self.frame = self.simulation.frame(self.request)

    def close(self) -> None:
        """Wait for the step under way and let the thread go."""
        try:
            self._collect()
        finally:
            if self._worker is not None:
                self._worker.shutdown()
                self._worker = None

    def abandon(self) -> None:
        """Let go of what is under way without waiting: it ends by itself, unseen."""
        if self._worker is not None and self._job is not None and not self._job.done():
            self._worker.shutdown(wait=False)
            self._worker = None
        self._job = None

    def _step(self) -> tuple[float, float]:
        return _step(self.simulation, self.before, self.after)

    def _try_step(self) -> None:
        """Make one step in the window, unless one was refused."""
        if not self.error:
            try:
                self._note_step(*self._step())
            except REFUSALS as error:
                self.error = message_of(error)

    def _note_step(self, alone: float, taken: float) -> None:
        self.last_seconds = alone
        self.steps += 1
        self._seconds += (taken - self._seconds) * (SMOOTH if self._seconds else 1.0)

    def _start(self) -> None:
        """Begin a step beside the window."""
        self._beside(step=True)

    def _beside(self, edits: Sequence[_Waiting] = (), *, step: bool = False) -> None:
        """Edit the simulation or step it beside the window, and look at it afterwards.

        The work holds all it needs, so that an abandoned one finds nothing that has changed.
        """
        if self._worker is None:
            self._worker = ThreadPoolExecutor(1, "jostle-step")
        simulation, request, touched = self.simulation, self.request, tuple(self.touched)
        before, after = tuple(self.before), tuple(self.after)

        def work() -> _Done:
            then = _do(simulation, edits, touched)
            taken, error = None, ""
            try:
                taken = _step(simulation, before, after) if step else None
            except REFUSALS as refusal:
                error = message_of(refusal)
            return _Done(simulation.frame(request), taken, error, then)

        self._job = self._worker.submit(work)

    def _collect(self) -> None:
        """Take what was done beside the window, or wait for it.

        A mistake in it, which is no refusal, is raised here.
        """
        if self._job is not None:
            job, self._job = self._job, None
            done = job.result()
            self.frame = done.frame
            if done.taken is not None:
                self._note_step(*done.taken)
            self.error = done.error or self.error
            self._note_settings()
            for then in done.then:
                then()

    def _settle_edits(self) -> None:
        """Do what waits to be done: at once, or for very many particles beside the window."""
        if len(self.simulation) <= FEW and not any(edit.many for edit in self._edits):
            self._apply_edits()
        elif self._edits and self._job is None:
            edits, self._edits = self._edits, []
            self._beside(edits)

    def _apply_edits(self) -> None:
        """Do at once what waits to be done."""
        while self._edits:
            edits, self._edits = self._edits, []
            then = _do(self.simulation, edits, self.touched)
            self._note_settings()
            self.frame = self.simulation.frame(self.request)
            for act in then:
                act()

    def _note_settings(self) -> None:
        """Keep what everybody may ask for while the simulation is at work."""
        simulation = self.simulation
        self.settings, self.adjustable = simulation.settings, simulation.adjustable
        self.effective_settings, self.view = simulation.effective_settings, simulation.view


def _step(
    simulation: Simulation, before: Sequence[Edit], after: Sequence[Edit]
) -> tuple[float, float]:
    """Make one step; return its seconds, alone and with all that belongs to it."""
    start = time.perf_counter()
    for hook in before:
        hook(simulation)
    began = time.perf_counter()
    simulation.step()
    alone = time.perf_counter() - began
    for hook in after:
        hook(simulation)
    return alone, time.perf_counter() - start


def _do(
    simulation: Simulation, edits: Sequence[_Waiting], touched: Sequence[Edit]
) -> tuple[Then, ...]:
    """Do edits in their order; return what the window does next."""
    for edit in edits:
        if edit.changes:
            for hook in touched:
                hook(simulation)
        edit.work(simulation)
    return tuple(edit.then for edit in edits if edit.then is not None)
