"""Numbers over time: a ring buffer of rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Series:
    """A ring buffer with named columns.

    Every row is written twice, half the buffer apart, so the rows in order are always contiguous,
    and a plot gets a view instead of a copy.

    Parameters
    ----------
    names
        Of the columns.
    most
        Number of rows.
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
        """Append a row."""
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
