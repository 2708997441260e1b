"""Scenes that are difficult for trees, compared with an ordinary scene of the same size."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from machine import Row
from numpy.typing import NDArray
from timing import interleaved

import jostle

LARGE = 1_000_000
MIDDLING = 100_000


@dataclass(frozen=True)
class Case:
    """Shapes, and the name of the case to compare with."""

    name: str
    centers: NDArray[np.float64]
    radii: float | NDArray[np.float64]
    beside: str | None = None

    def run(self) -> NDArray[np.int64]:
        """Find all overlapping pairs."""
        return jostle.find_pairs(self.centers, self.radii, method="quadtree", threads=1)


def cases(large: int, middling: int) -> list[Case]:
    """Return each hard case after the ordinary one that it is compared with."""
    random = np.random.default_rng(0)
    unit, some = random.random((large, 2)), random.random((middling, 2))
    far = np.array([[-1e7, -1e7], [1e7, 1e7]])
    line = np.column_stack([np.arange(large), np.full(large, 7.0)])
    tight = random.random((large, 2)) * 1e-9
    tight[:, 0] += np.arange(large) % 1000 * 1e3
    huge = np.full(large, 1e-6)
    huge[large // 2] = 10.0
    radius = np.sqrt(0.4 / middling / np.pi)
    discs, points = f"{middling:,} discs in a unit square", f"{large:,} uniform points"
    return [
        Case(discs, some, radius),
        Case("the same and two at ±1e7", np.vstack([some, far]), radius, discs),
        Case(points, unit, 0.0),
        Case(f"{large:,} coincident points", np.full((large, 2), 3.0), 0.0, points),
        Case(f"{large:,} discs on a line", line, 0.6, points),
        Case("1,000 clusters, each 1e-9 across", tight, 0.0, points),
        Case(f"one huge disc over {large:,} tiny", unit, huge, points),
    ]


def race(rounds: int, largest: int) -> Iterator[list[Row]]:
    """Yield the rows of all cases."""
    every = cases(min(LARGE, largest), min(MIDDLING, largest))
    timings = interleaved([case.run for case in every], rounds)
    medians = {case.name: timing.median for case, timing in zip(every, timings, strict=True)}
    yield [
        {
            "case": case.name,
            "beside": case.beside or "",
            "ratio": f"{timing.median / medians[case.beside]:.2f}" if case.beside else "",
            "version": jostle.__version__,
            **timing.columns(),
        }
        for case, timing in zip(every, timings, strict=True)
    ]
