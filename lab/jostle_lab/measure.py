"""Numbers over time: times, pairs, energy and momentum, their change, and the lines of plots."""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jostle_lab.simulate.frame import Energies, Frame, StepStats, Tags

Floats = NDArray[np.float64]

FRAMES = 1024  # rows of times: five seconds at 200 FPS
SAMPLES = 1200  # rows of sums: two minutes
EVERY = 0.1  # seconds between two sums, which take time for many particles
STEPS_BETWEEN = 3  # steps between two sums at least
QUIET = 1.0  # simulated seconds with the same particles before the change is meaningful
SUMS = ("time", "kinetic", "potential", "total", "momentum_x", "momentum_y", "drift",
        "pairs_tested", "touching")  # fmt: skip

# Of the lines of plots
SPAN = 5.0  # seconds of times
BINS = 75
MOST_POINTS = 200  # of a line of sums
RENEWED = 0.15  # seconds between two updates
SMOOTH = 0.35  # weight of a new mean, so that the numbers can be read
RECENT = 30  # frames of a mean
USUAL = 0.97  # quantile of the times that is below `top`
_NICE = np.array([1.0, 2.0, 5.0, 10.0])

ENERGIES = ("time", "total", "kinetic", "potential")
MOMENTA = ("time", "momentum_x", "momentum_y")


class Series:
    """At most `most` rows with named columns, oldest first."""

    def __init__(self, names: Sequence[str], most: int) -> None:
        self.names = tuple(names)
        self._rows = deque[tuple[float, ...]](maxlen=most)

    def __len__(self) -> int:
        return len(self._rows)

    def add(self, *values: float) -> None:
        self._rows.append(values)

    def drop(self, rows: int) -> None:
        """Remove the newest rows."""
        for _ in range(min(rows, len(self))):
            self._rows.pop()

    @property
    def table(self) -> Floats:
        """Return the rows as an array, (names, rows)."""
        return np.array(self._rows, np.float64).reshape(-1, len(self.names)).T

    def __getitem__(self, name: str) -> Floats:
        at = self.names.index(name)
        return np.array([row[at] for row in self._rows], np.float64)


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

    def reset_reference(self) -> None:
        """Use the next state as the reference."""
        self.origin: Reference | None = None  # the first state with the present settings
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


class Traces:
    """The lines of the statistics panel: the series, binned for plots, a few times per second."""

    def __init__(self, statistics: Statistics) -> None:
        self._statistics = statistics
        self.ages = np.linspace(-SPAN, 0.0, BINS)  # seconds before now of each bin, ascending to 0
        self.frames = np.zeros(BINS)  # the time between two frames, per bin
        self.frame_mean = 0.0  # milliseconds between two frames
        self.top = 20.0  # upper end of the axis of milliseconds: 1, 2 or 5 times a power of ten
        self.count, self.stats = 0, StepStats()  # particles, and the numbers of the last step
        self.energy_drift = self.momentum_drift = self.measured = 0.0  # as in `Statistics`
        self.changing, self._done = False, -math.inf
        self._forget()

    def refresh(self, frame: Frame, now: float) -> None:
        """Update all lines if they are old, or of another run."""
        statistics, origin = self._statistics, self._statistics.origin
        if statistics.stages != self._stages or not len(statistics.sums):
            self._forget()
        if abs(now - self._done) < RENEWED:
            return
        self._done = now
        self._renew_times(now)
        self.count, self.stats = len(frame), frame.stats
        if origin is not None:  # otherwise the lines stay until the next sum
            self.energies = self._columns(ENERGIES, origin.time)
            for name in ("total", "potential"):
                self.energies[ENERGIES.index(name)] -= origin.energies.potential
            self.momenta = self._columns(MOMENTA, origin.time)
            self.energy_drift, self.momentum_drift = (
                statistics.energy_drift, statistics.momentum_drift
            )  # fmt: skip
            self.measured, self.changing = statistics.measured, statistics.changing

    def _forget(self) -> None:
        self._stages = self._statistics.stages
        # (stages + 1, bins): the cumulative times of the stages, from zeros on.
        self.stacked = np.zeros((len(self._stages) + 1, BINS))
        self.means: dict[str, float] = {}  # milliseconds of each stage
        # Sums since the last change of the rules; the potential energy is 0 at their beginning.
        self.energies = np.zeros((len(ENERGIES), 0))
        self.momenta = np.zeros((len(MOMENTA), 0))
        self._done = -math.inf

    def _renew_times(self, now: float) -> None:
        times = self._statistics.times
        at = np.floor((times["now"] - now) * (BINS - 1) / SPAN).astype(np.intp) + BINS - 1
        shown = at >= 0
        at, table = np.minimum(at[shown], BINS - 1), times.table[1:, shown]
        counts = np.bincount(at, minlength=BINS)
        rows = [np.bincount(at, row, BINS) / np.maximum(counts, 1) for row in table]
        _fill(rows, counts)
        self.frames[:] = rows[0]
        np.cumsum(rows[1:], axis=0, out=self.stacked[1:])
        self._average(table[:, -RECENT:])
        highest = max(_usual(self.frames), _usual(self.stacked[-1]), 1e-2)
        power = 10.0 ** np.floor(np.log10(highest))
        self.top = float(power * _NICE[np.searchsorted(_NICE, highest / power - 1e-9)])

    def _average(self, table: Floats) -> None:
        if not table.shape[1]:
            return
        frame, *stages = table.mean(axis=1).tolist()
        self.frame_mean += (frame - self.frame_mean) * (SMOOTH if self.frame_mean else 1.0)
        for name, mean in zip(self._stages, stages, strict=True):
            old = self.means.get(name, mean)
            self.means[name] = old + (mean - old) * SMOOTH

    def _columns(self, names: tuple[str, ...], since: float) -> Floats:
        """Return columns of the sums; of many rows, every k-th one."""
        sums = self._statistics.sums
        first = int(sums["time"].searchsorted(since))
        step = -(-(len(sums) - first) // MOST_POINTS) or 1
        return np.array([sums[name][first:][::-step][::-1] for name in names])


def _usual(times: Floats) -> float:
    """Return a high quantile of the times, of non-empty bins."""
    known = times[times > 0]
    return float(np.quantile(known, USUAL)) if len(known) else 0.0


def _fill(rows: list[Floats], counts: NDArray[np.intp]) -> None:
    """Fill empty bins with the value of the bin before."""
    last = np.maximum.accumulate(np.where(counts > 0, np.arange(BINS), -1))
    known = last >= 0
    for row in rows:
        row[known] = row[last[known]]
