"""The lines of the statistics panel: the series, binned for plots.

They are updated a few times per second, one part per frame: drawing changed parts takes time
without a graphics card.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle.app.measure.statistics import Statistics
from jostle.app.simulate.simulation import Frame, StepStats

Floats = NDArray[np.float64]

SPAN = 5.0  # seconds of times
BINS = 75
MOST = 200  # points of a line of sums
EVERY = 0.15  # seconds between two updates of a part
SMOOTH = 0.35  # weight of a new mean, so that the numbers can be read
RECENT = 30  # frames of a mean
USUAL = 0.97  # quantile of the times that is below `top`
_NICE = np.array([1.0, 2.0, 5.0, 10.0])

ENERGIES = ("time", "total", "kinetic", "potential")
MOMENTA = ("time", "momentum_x", "momentum_y")


class Traces:
    """The present data of the plots."""

    def __init__(self, statistics: Statistics) -> None:
        self._statistics = statistics
        self._stages: tuple[str, ...] = ()
        self._parts = (self._renew_times, self._renew_stats, self._renew_energies,
                       self._renew_momenta)  # fmt: skip
        self._done = [-np.inf] * len(self._parts)
        self.ages = np.linspace(-SPAN, 0.0, BINS)  # seconds before now of each bin, ascending to 0
        self.frames = np.zeros(BINS)  # the time between two frames, per bin
        self.means: dict[str, float] = {}  # milliseconds of each stage
        self.frame_mean = 0.0  # milliseconds between two frames
        self.top = 20.0  # upper end of the axis of milliseconds: 1, 2 or 5 times a power of ten
        self.count, self.stats = 0, StepStats()  # particles, and the numbers of the last step
        self.energy_drift = self.momentum_drift = self.measured = 0.0  # as in `Statistics`
        self.changing = False
        self._forget()

    def refresh(self, frame: Frame, now: float) -> None:
        """Update the part that is overdue the longest; all parts at the beginning of a run."""
        if self._statistics.stages != self._stages or not len(self._statistics.sums):
            self._forget()
        late = [k for k, done in enumerate(self._done) if abs(now - done) >= EVERY]
        if -np.inf not in self._done:
            late = sorted(late, key=self._done.__getitem__)[:1]
        for k in late:
            self._parts[k](frame, now)
            self._done[k] = now

    def _forget(self) -> None:
        self._stages = self._statistics.stages
        # (stages + 1, bins): the cumulative times of the stages, from zeros on.
        self.stacked = np.zeros((len(self._stages) + 1, BINS))
        self.means = {}
        # Sums since the last change of the rules; the potential energy is 0 at their beginning.
        self.energies = np.zeros((len(ENERGIES), 0))
        self.momenta = np.zeros((len(MOMENTA), 0))
        self._done = [-np.inf] * len(self._parts)

    def _renew_times(self, _: Frame, now: float) -> None:
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

    def _renew_stats(self, frame: Frame, _: float) -> None:
        self.count, self.stats = len(frame), frame.stats

    def _renew_energies(self, *_: object) -> None:
        origin = self._statistics.origin
        if origin is None:  # the lines stay until the next sum
            return
        self.energies = self._columns(ENERGIES, origin.time)
        for name in ("total", "potential"):
            self.energies[ENERGIES.index(name)] -= origin.energies.potential
        self.energy_drift, self.measured = self._statistics.energy_drift, self._statistics.measured
        self.changing = self._statistics.changing

    def _renew_momenta(self, *_: object) -> None:
        origin = self._statistics.origin
        if origin is not None:
            self.momenta = self._columns(MOMENTA, origin.time)
            self.momentum_drift = self._statistics.momentum_drift

    def _columns(self, names: tuple[str, ...], since: float) -> Floats:
        """Return columns of the sums; of many rows, every k-th one."""
        sums = self._statistics.sums
        first = int(sums["time"].searchsorted(since))
        step = -(-(len(sums) - first) // MOST) or 1
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
