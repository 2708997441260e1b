"""Who steps the simulation, and when: short steps at once, long ones beside the window.

Only one thread at a time uses a simulation. While a long step is under way the window goes on
with the last frame, and edits wait; so a million particles slow the picture, never the hand.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from jostle.app.simulate.pace import MOST_OWED, Pace
from jostle.app.simulate.simulation import Frame, Simulation, Wants

Edit = Callable[[Simulation], None]

SHORT = 0.020  # seconds: steps up to this long are made at once, so that they are never late
FEW = 50_000  # particles whose edits and first step are short, as far as anybody can tell
SMOOTH = 0.2  # share of a new measurement


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
    wants
        What the next frames shall hold.
    last_step
        `advance` makes no more than so many steps; None to go on.
    last_seconds
        What the last step took, alone.
    before, after
        Called with the simulation around each step, in the thread that steps.
    touched
        Called with the simulation before a person changes it.
    """

    def __init__(self, simulation: Simulation, short: float = SHORT) -> None:
        self.short = short
        self.wants = Wants()
        self.before: list[Edit] = []
        self.after: list[Edit] = []
        self.touched: list[Edit] = []
        self.steps = 0
        self.last_step: int | None = None
        self.last_seconds = 0.0
        self._worker: ThreadPoolExecutor | None = None
        self._job: Future[Frame] | None = None
        self._edits: list[tuple[Edit, bool]] = []
        self.take(simulation)

    def take(self, simulation: Simulation) -> None:
        """Go on with another simulation; a step under way is waited for, its edits forgotten."""
        self._finish()
        self._edits.clear()
        self.simulation = simulation
        self.settings, self.scene, self.view = (
            simulation.settings,
            simulation.scene,
            simulation.view,
        )
        self.time_step, self.adjustable = simulation.time_step, simulation.adjustable
        self.rules = simulation.rules
        self._pace = Pace(simulation.time_step)
        self._seconds = 0.0  # one step and its frame, smoothed
        self.frame: Frame = simulation.frame(self.wants)

    @property
    def busy(self) -> bool:
        """Whether a step, or an edit of many particles, is under way beside the window."""
        return self._job is not None and not self._job.done()

    @property
    def step_seconds(self) -> float:
        """The smoothed time of a step with all that belongs to it."""
        return self._seconds

    def edit(self, work: Edit, *, changes: bool = True) -> None:
        """Change the simulation: now, or as soon as the step under way is done.

        Edits of very many particles are made beside the window: the frame shows them later.

        What only reads it, or brings back a state that was, `changes` nothing.
        """
        self._edits.append((work, changes))
        if not self.busy:
            self._collect()
            self._settle_edits()

    def settle(self) -> None:
        """Once a frame of a pause: take what was done beside the window, and go on with edits."""
        if not self.busy:
            self._collect()
            self._settle_edits()

    def look(self, *, at_once: bool = True) -> None:
        """Renew the frame, where `wants` has changed and no step does it.

        Where that need not be `at_once`, very many particles are looked at beside the window.
        """
        if self.busy:
            return
        self._collect()
        if at_once or len(self.simulation) <= FEW:
            self.frame = self.simulation.frame(self.wants)
        else:
            self._beside(lambda: None)

    def advance(self, elapsed: float) -> int:
        """Take `elapsed` simulated seconds; return the steps that were done since the last call."""
        if self.busy:
            self._pace.advance(elapsed, lambda: None, most=0)
            return 0
        before = self.steps
        self._collect()
        self._settle_edits()
        if self._job is not None:  # edits are under way
            self._pace.advance(elapsed, lambda: None, most=0)
        elif self._in_the_window():
            if self._pace.advance(elapsed, self._step, most=min(MOST_OWED, self._left())):
                self.frame = self.simulation.frame(self.wants)
        else:
            self._pace.advance(elapsed, self._start, most=min(1, self._left()))
        return self.steps - before

    def _left(self) -> int:
        """Return how many steps may still be made."""
        return MOST_OWED if self.last_step is None else max(self.last_step - self.steps, 0)

    def _in_the_window(self) -> bool:
        """Tell whether steps are made at once; the first of many particles is not even tried."""
        if self._seconds:
            return self._seconds <= self.short
        return self.short >= SHORT and len(self.simulation) <= FEW

    def step(self) -> None:
        """Make one step now, however long it takes."""
        self._finish()
        self._apply_edits()
        self._step()
        self.frame = self.simulation.frame(self.wants)

    def wait(self) -> None:
        """Wait for the step under way, if there is one, and for the edits that wait for it."""
        self._finish()
        self._apply_edits()

    def close(self) -> None:
        """Wait for the step under way and let the thread go."""
        self._finish()
        if self._worker is not None:
            self._worker.shutdown()
            self._worker = None

    def _step(self) -> None:
        start = time.perf_counter()
        for hook in self.before:
            hook(self.simulation)
        began = time.perf_counter()
        self.simulation.step()
        self.last_seconds = time.perf_counter() - began
        for hook in self.after:
            hook(self.simulation)
        self.steps += 1
        taken = time.perf_counter() - start
        self._seconds += (taken - self._seconds) * (SMOOTH if self._seconds else 1.0)

    def _start(self) -> None:
        """Begin a step beside the window."""
        self._beside(self._step)

    def _beside(self, act: Callable[[], None]) -> None:
        """Do something to the simulation beside the window, and look at it afterwards."""
        if self._worker is None:
            self._worker = ThreadPoolExecutor(1, "jostle-step")

        def work() -> Frame:
            act()
            return self.simulation.frame(self.wants)

        self._job = self._worker.submit(work)

    def _collect(self) -> None:
        """Take the frame of a step that is done; what went wrong in it is raised here."""
        if self._job is not None:
            job, self._job = self._job, None
            self.frame = job.result()
            self._note_rules()

    _finish = _collect  # the result of a job that is not done is waited for

    def _settle_edits(self) -> None:
        """Do what waits to be done: at once, or for very many particles beside the window."""
        if len(self.simulation) <= FEW:
            self._apply_edits()
        elif self._edits:
            edits, self._edits = self._edits, []
            self._beside(lambda: self._do(edits))

    def _apply_edits(self) -> None:
        """Do at once what waits to be done."""
        if self._edits:
            edits, self._edits = self._edits, []
            self._do(edits)
            self._note_rules()
            self.frame = self.simulation.frame(self.wants)

    def _do(self, edits: list[tuple[Edit, bool]]) -> None:
        for work, changes in edits:
            if changes:
                for hook in self.touched:
                    hook(self.simulation)
            work(self.simulation)

    def _note_rules(self) -> None:
        """Keep what everybody may ask for while the simulation is at work."""
        simulation = self.simulation
        self.settings, self.adjustable = simulation.settings, simulation.adjustable
        self.rules, self.view = simulation.rules, simulation.view
