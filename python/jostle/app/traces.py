"""The lines of the statistics panel: the series, binned for a plot, and renewed now and then.

A plot of a few hundred points tells no more than one of a hundred, and a picture that changes ten
times a second can be read; so everything here stands still in between.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle.app.statistics import Statistics

Floats = NDArray[np.float64]

SPAN = 5.0  # seconds of times that are shown
BINS = 100
EVERY = 0.1  # seconds between two pictures
SMOOTH = 0.35  # share of a new mean in the numbers: they rest enough to be read
_NICE = np.array([1.0, 2.0, 5.0, 10.0])


class Traces:
    """What the plots show now.

    Attributes
    ----------
    ages
        Seconds before now of each bin, ascending to 0.
    stacked
        (stages + 1, bins): the times of the stages on top of each other, from zeros upwards.
    frames
        The time between two pictures, a bin each.
    means
        Of each stage, in milliseconds, over about the last second.
    top
        Of the axis of milliseconds: 1, 2 or 5 times a power of ten.
    """

    def __init__(self, statistics: Statistics) -> None:
        self._statistics = statistics
        self._stages: tuple[str, ...] = ()
        self._due = 0.0
        self.ages = np.linspace(-SPAN, 0.0, BINS)
        self.frames = np.zeros(BINS)
        self.stacked = np.zeros((1, BINS))
        self.means: dict[str, float] = {}
        self.frame_mean = 0.0
        self.top = 20.0
        self.sums = np.zeros((len(statistics.sums.names), 0))

    def refresh(self, now: float) -> bool:
        """Renew everything if it is time; return whether it was."""
        fresh = self._statistics.stages != self._stages
        if not fresh and 0 <= self._due - now <= EVERY:
            return False
        self._due = now + EVERY
        self._bin(now, fresh=fresh)
        self.sums = self._thinned()
        return True

    def sum(self, name: str) -> Floats:
        """Return a column of the sums."""
        column: Floats = self.sums[self._statistics.sums.names.index(name)]
        return column

    def _bin(self, now: float, *, fresh: bool) -> None:
        times = self._statistics.times
        if fresh:
            self._stages = self._statistics.stages
            self.stacked = np.zeros((len(self._stages) + 1, BINS))
            self.means = {}
        at = np.floor((times["now"] - now) * (BINS - 1) / SPAN).astype(np.intp) + BINS - 1
        shown = at >= 0
        at, table = np.minimum(at[shown], BINS - 1), times.table[1:, shown]
        counts = np.bincount(at, minlength=BINS)
        rows = [np.bincount(at, row, BINS) / np.maximum(counts, 1) for row in table]
        _fill(rows, counts)
        self.frames[:] = rows[0]
        np.cumsum(rows[1:], axis=0, out=self.stacked[1:])
        self._average(table[:, -30:])
        highest = max(float(self.frames.max()), float(self.stacked[-1].max()), 1e-2)
        power = 10.0 ** np.floor(np.log10(highest))
        self.top = float(power * _NICE[np.searchsorted(_NICE, highest / power - 1e-9)])

    def _average(self, table: Floats) -> None:
        """Let the numbers follow the means of the last frames."""
        if not table.shape[1]:
            return
        frame, *stages = table.mean(axis=1).tolist()
        self.frame_mean += (frame - self.frame_mean) * (SMOOTH if self.frame_mean else 1.0)
        for name, mean in zip(self._stages, stages, strict=True):
            old = self.means.get(name, mean)
            self.means[name] = old + (mean - old) * SMOOTH

    def _thinned(self) -> Floats:
        """Return the sums, every second, third … of them where there are many."""
        table = self._statistics.sums.table
        step = -(-table.shape[1] // (3 * BINS)) or 1
        return np.ascontiguousarray(table[:, ::-step][:, ::-1])


def _fill(rows: list[Floats], counts: NDArray[np.intp]) -> None:
    """Give a bin that no frame fell into the value of the one before it."""
    last = np.maximum.accumulate(np.where(counts > 0, np.arange(BINS), -1))
    known = last >= 0
    for row in rows:
        row[known] = row[last[known]]
