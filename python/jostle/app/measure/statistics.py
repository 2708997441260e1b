"""What the statistics panel shows: times, pairs and sums over the last seconds, and their drift."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from jostle.app.measure.series import Floats, Series
from jostle.app.simulate.simulation import Energies, Frame, Tags

FRAMES = 1024  # rows of times: five seconds even at 200 frames a second
SAMPLES = 1200  # rows of sums: two minutes
EVERY = 0.1  # seconds between two sums, which take time where there are many particles
STEPS_BETWEEN = 3  # steps between two sums at least, where steps are slow
QUIET = 1.0  # simulated seconds with the same particles, before drift tells anything

SUMS = ("time", "kinetic", "potential", "total", "momentum_x", "momentum_y", "drift",
        "pairs_tested", "touching")  # fmt: skip


@dataclass(frozen=True)
class Beginning:
    """What drift is measured from."""

    time: float
    energies: Energies
    mass: float
    tags: Tags

    @classmethod
    def of(cls, frame: Frame, energies: Energies) -> Beginning:
        """Return it for a state."""
        mass = float(frame.masses.sum(dtype=float))
        return cls(frame.facts.time, energies, mass, frame.tags)

    def has_particles_of(self, frame: Frame) -> bool:
        """Whether a state has the same particles: none came, went or merged."""
        return self.tags is frame.tags or np.array_equal(self.tags, frame.tags)

    @property
    def total(self) -> float:
        """Return the energy."""
        return self.energies.kinetic + self.energies.potential


class Statistics:
    """Collects measurements of every frame and sums of a few states a second.

    Attributes
    ----------
    times
        A row a frame, in milliseconds but for the clock `now` in seconds: `frame` is the time
        between two pictures; then come the stages of the last step, `draw` and `panels`.
    sums
        A row for each state that was summed up, over the simulated `time`.
    origin
        Where sums begin that can be compared with each other: the rules have not changed since.
    beginning
        What drift is measured from: the same particles have been there since. What comes brings
        energy, what goes takes it along, and of what merges no energy of the pair is left.
    changing
        Whether particles came, went or merged a moment ago, so that drift tells nothing yet.
    runs
        Time and drift of earlier runs, by the names that they were remembered under.
    """

    def __init__(self) -> None:
        self.runs: dict[str, tuple[Floats, Floats]] = {}
        self._drawing = {"draw": 0.0, "panels": 0.0}
        self.restart()

    def restart(self) -> None:
        """Forget a run that is over."""
        self.times = Series(("now", "frame", *self._drawing), FRAMES)
        self.sums = Series(SUMS, SAMPLES)
        self.begin_again()
        self._due = 0.0

    def remember(self, name: str) -> None:
        """Keep the drift of this run under a name, to be compared with the next ones."""
        if self.beginning is not None and len(self.sums):
            since = self.sums["time"] - self.beginning.time
            self.runs[name] = since[since >= 0], self.sums["drift"][since >= 0]

    def drift_of(self, name: str) -> float | None:
        """Return the drift, as a share, that a run had after the time that this one has taken."""
        run, beginning = self.runs.get(name), self.beginning
        if run is None or beginning is None or not len(self.sums):
            return None
        return float(np.interp(self.sums["time"][-1] - beginning.time, *run)) / 100

    def begin_again(self) -> None:
        """Measure drift from the next state on."""
        self.origin: Beginning | None = None
        self.beginning: Beginning | None = None
        self.changing = False
        self._lowest = self._highest = 0.0

    @property
    def stages(self) -> tuple[str, ...]:
        """Return the names of the stages whose times add up, in the order of work."""
        return self.times.names[2:]

    # Collecting

    def measure(self, **milliseconds: float) -> None:
        """Take what drawing the last frame took: `draw`, `panels`."""
        self._drawing.update(milliseconds)

    def wants_energies(self, now: float) -> bool:
        """Whether it is time to sum up a state again."""
        return self.beginning is None or now >= self._due

    def follow(
        self, frame: Frame, now: float, elapsed: float, *, at_work: bool, step_seconds: float = 0.0
    ) -> None:
        """Take in a frame, whether it is new or not.

        Parameters
        ----------
        now, elapsed
            Seconds since the session and the last frame began.
        at_work
            Whether the simulation goes on; while it is paused, its stages take no time.
        step_seconds
            What a step takes.
        """
        stages = frame.facts.stage_times
        names = ("now", "frame", *stages, *self._drawing)
        if names != self.times.names:
            self.times = Series(names, FRAMES)
        worked = stages.values() if at_work else [0.0] * len(stages)
        self.times.add(now, elapsed * 1e3, *worked, *self._drawing.values())
        if frame.energies is not None:
            self.sum_up(frame)
            if now >= self._due:
                self._due = now + max(EVERY, STEPS_BETWEEN * step_seconds)

    def sum_up(self, frame: Frame) -> None:
        """Add a row, unless this state has one; time that was turned back takes rows along."""
        time, energies = frame.facts.time, frame.energies
        if energies is None:
            return
        seen = self.sums["time"]
        if self.beginning is not None and time < self.beginning.time:
            self.begin_again()
        if self.beginning is None or not self.beginning.has_particles_of(frame):
            self.changing = self.beginning is not None
            self.beginning = Beginning.of(frame, energies)
            self.origin = self.origin or self.beginning
            self._lowest = self._highest = energies.potential
        elif len(seen) and time == seen[-1] and energies.kinetic == self.sums["kinetic"][-1]:
            return
        self.sums.drop(len(seen) - int(seen.searchsorted(time)))
        self.changing = self.changing and time - self.beginning.time < QUIET
        self._lowest = min(self._lowest, energies.potential)
        self._highest = max(self._highest, energies.potential)
        total = energies.kinetic + energies.potential
        self.sums.add(
            time, energies.kinetic, energies.potential, total, *energies.momentum,
            100 * self._drift(total), frame.facts.pairs_tested, frame.facts.touching,
        )  # fmt: skip

    # Drift

    @property
    def energy_in_play(self) -> float:
        """Return what drift is compared with.

        It is the kinetic energy of the beginning, or how far the potential energy has moved since
        if that is more: the potential energy itself has an arbitrary zero.
        """
        if self.beginning is None:
            return 0.0
        return max(self.beginning.energies.kinetic, self._highest - self._lowest)

    @property
    def measured(self) -> float:
        """Return for how many simulated seconds drift has been measured."""
        return float(self.sums["time"][-1]) - self.beginning.time if self.beginning else 0.0

    @property
    def energy_drift(self) -> float:
        """Return the change of the energy since the beginning, as a share of that in play."""
        return float(self.sums["drift"][-1]) / 100 if len(self.sums) else 0.0

    @property
    def momentum_drift(self) -> float:
        """Return the change of momentum, as a share of what it were if all flew one way."""
        most = self.beginning and math.sqrt(2 * self.beginning.mass * self.energy_in_play)
        if not (self.beginning and most and len(self.sums)):
            return 0.0
        x, y = self.beginning.energies.momentum
        way = self.sums["momentum_x"][-1] - x, self.sums["momentum_y"][-1] - y
        return math.hypot(*way) / most

    def _drift(self, total: float) -> float:
        play = self.energy_in_play
        return (total - self.beginning.total) / play if self.beginning and play > 0 else 0.0
