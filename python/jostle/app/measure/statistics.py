"""The data of the statistics panel: times, pairs, energy and momentum, and their change."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jostle.app.simulate.simulation import Energies, Frame, Tags

Floats = NDArray[np.float64]

FRAMES = 1024  # rows of times: five seconds at 200 FPS
SAMPLES = 1200  # rows of sums: two minutes
EVERY = 0.1  # seconds between two sums, which take time for many particles
STEPS_BETWEEN = 3  # steps between two sums at least
QUIET = 1.0  # simulated seconds with the same particles before the change is meaningful
SUMS = ("time", "kinetic", "potential", "total", "momentum_x", "momentum_y", "drift",
        "pairs_tested", "touching")  # fmt: skip


class Series:
    """A ring buffer of at most `most` rows with named columns.

    Every row is written twice, half the buffer apart, so the rows in order are always contiguous,
    and a plot gets a view instead of a copy.
    """

    def __init__(self, names: Sequence[str], most: int) -> None:
        self.names = tuple(names)
        self.most = most
        self._rows = np.zeros((len(self.names), 2 * most))
        self._columns = {name: k for k, name in enumerate(self.names)}
        self._next, self._count = 0, 0

    def __len__(self) -> int:
        return self._count

    def add(self, *values: float) -> None:
        at = self._next % self.most
        self._rows[:, at] = self._rows[:, at + self.most] = values
        self._next, self._count = at + 1, min(self._count + 1, self.most)

    def drop(self, rows: int) -> None:
        """Remove the newest rows."""
        rows = min(rows, self._count)
        self._next, self._count = (self._next - rows) % self.most, self._count - rows

    def __getitem__(self, name: str) -> Floats:
        """Return a column, oldest first, as a view that the next row may change."""
        column: Floats = self.table[self._columns[name]]
        return column

    @property
    def table(self) -> Floats:
        """Return all columns, (names, rows), oldest first, as a view."""
        end = self._next if self._next >= self._count else self._next + self.most
        return self._rows[:, end - self._count : end]


@dataclass(frozen=True)
class Reference:
    """The state that the change of energy and momentum refers to."""

    time: float
    energies: Energies
    mass: float
    tags: Tags


class Statistics:
    """Collects measurements of every frame, and sums of a few states per second."""

    def __init__(self) -> None:
        self.runs: dict[str, tuple[Floats, Floats]] = {}  # by name: times, changes of energy
        self._drawing = {"draw": 0.0, "panels": 0.0}
        self.restart()

    def restart(self) -> None:
        """Discard the data of a run."""
        # A row per frame, in milliseconds except the time `now` in seconds: `frame` is the time
        # between two frames; then the stages of the last step, `draw` and `panels`.
        self.times = Series(("now", "frame", *self._drawing), FRAMES)
        self.sums = Series(SUMS, SAMPLES)  # a row for each summed state
        self.reset_reference()
        self._due = 0.0

    def remember(self, name: str) -> None:
        """Store the change of energy of this run under a name, for comparison."""
        if self.reference is not None and len(self.sums):
            since = self.sums["time"] - self.reference.time
            self.runs[name] = since[since >= 0], self.sums["drift"][since >= 0]

    def drift_of(self, name: str) -> float | None:
        """Return the relative change that an earlier run had after the same time."""
        run, reference = self.runs.get(name), self.reference
        if run is None or reference is None or not len(self.sums):
            return None
        return float(np.interp(self.sums["time"][-1] - reference.time, *run)) / 100

    def reset_reference(self) -> None:
        """Use the next state as the reference."""
        self.origin: Reference | None = None  # the first state with the present rules
        # The first state with these particles: adding, removing and merging changes the energy.
        self.reference: Reference | None = None
        self.changing = False  # whether the particles changed just before: no drift is shown
        self._lowest = self._highest = 0.0

    @property
    def stages(self) -> tuple[str, ...]:
        return self.times.names[2:]

    # Collecting

    def measure(self, **milliseconds: float) -> None:
        """Record the milliseconds of the last frame for `draw` and `panels`."""
        self._drawing.update(milliseconds)

    def energies_due(self, now: float) -> bool:
        """Whether the next state is to be summed."""
        return self.reference is None or now >= self._due

    def follow(
        self, frame: Frame, now: float, elapsed: float, *, running: bool, step_seconds: float = 0.0
    ) -> None:
        """Record a frame, new or not.

        `now` is the time of the session, and `elapsed` that since the last frame, in seconds. While
        the simulation does not run, its stages take no time.
        """
        stages = frame.stats.stage_times
        names = ("now", "frame", *stages, *self._drawing)
        if names != self.times.names:
            self.times = Series(names, FRAMES)
        times = stages.values() if running else [0.0] * len(stages)
        self.times.add(now, elapsed * 1e3, *times, *self._drawing.values())
        if frame.energies is not None:
            self.sum_up(frame)
            if now >= self._due:
                self._due = now + max(EVERY, STEPS_BETWEEN * step_seconds)

    def sum_up(self, frame: Frame) -> None:
        """Add a row, unless this state has one; after a rewind, later rows are removed."""
        time, energies = frame.stats.time, frame.energies
        if energies is None:
            return
        seen = self.sums["time"]
        if self.reference is not None and time < self.reference.time:
            self.reset_reference()
        if self.reference is None or not np.array_equal(self.reference.tags, frame.tags):
            self.changing = self.reference is not None
            mass = float(frame.masses.sum(dtype=float))
            self.reference = Reference(time, energies, mass, frame.tags)
            self.origin = self.origin or self.reference
            self._lowest = self._highest = energies.potential
        elif len(seen) and time == seen[-1] and energies.kinetic == self.sums["kinetic"][-1]:
            return
        self.sums.drop(len(seen) - int(seen.searchsorted(time)))
        self.changing = self.changing and time - self.reference.time < QUIET
        self._lowest = min(self._lowest, energies.potential)
        self._highest = max(self._highest, energies.potential)
        scale = self.energy_scale
        drift = (energies.total - self.reference.energies.total) / scale if scale > 0 else 0.0
        self.sums.add(
            time, energies.kinetic, energies.potential, energies.total, *energies.momentum,
            100 * drift, frame.stats.pairs_tested, frame.stats.touching,
        )  # fmt: skip

    # Drift

    @property
    def energy_scale(self) -> float:
        """Return the energy that the change is divided by.

        It is the kinetic energy of the reference, or the range of the potential energy since if
        that is larger: the zero of the potential energy is arbitrary.
        """
        if self.reference is None:
            return 0.0
        return max(self.reference.energies.kinetic, self._highest - self._lowest)

    @property
    def measured(self) -> float:
        """Return the simulated seconds since the reference."""
        return float(self.sums["time"][-1]) - self.reference.time if self.reference else 0.0

    @property
    def energy_drift(self) -> float:
        """Return the relative change of the energy since the reference."""
        return float(self.sums["drift"][-1]) / 100 if len(self.sums) else 0.0

    @property
    def momentum_drift(self) -> float:
        """Return the change of momentum, relative to that of all particles moving one way."""
        most = self.reference and math.sqrt(2 * self.reference.mass * self.energy_scale)
        if not (self.reference and most and len(self.sums)):
            return 0.0
        x, y = self.reference.energies.momentum
        change = self.sums["momentum_x"][-1] - x, self.sums["momentum_y"][-1] - y
        return math.hypot(*change) / most
