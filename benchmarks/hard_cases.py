"""Scenes that break trees: what they cost beside an ordinary scene of the same size.

    python benchmarks/hard_cases.py [--rounds 9]

Every line gives the time of `find_pairs` (tree, one thread) and its ratio to the
ordinary scene named with it.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from machine import describe, write
from measure import interleaved
from numpy.typing import NDArray

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

    def run(self) -> NDArray[np.uint32]:
        """All overlapping pairs."""
        return jostle.find_pairs(self.centers, self.radii, method="quadtree", threads=1)


def one_large(count: int) -> NDArray[np.float64]:
    """Tiny radii, and one that covers everything."""
    radii = np.full(count, 1e-6)
    radii[count // 2] = 10.0
    return radii


def cases() -> list[Case]:
    """Each hard case behind the ordinary one that it is compared with."""
    random = np.random.default_rng(0)
    unit, cluster = random.random((LARGE, 2)), random.random((MIDDLING, 2))
    radius = np.sqrt(0.4 / MIDDLING / np.pi)
    far = np.array([[-1e7, -1e7], [1e7, 1e7]])
    line = np.column_stack([np.arange(LARGE), np.full(LARGE, 7.0)])
    tight = random.random((LARGE, 2)) * 1e-9
    tight[:, 0] += np.repeat(np.arange(1000), LARGE // 1000) * 1e3
    return [
        Case("100,000 discs in a unit square", cluster, radius),
        Case(
            "the same and two at ±1e7",
            np.vstack([cluster, far]),
            radius,
            "100,000 discs in a unit square",
        ),
        Case("1,000,000 uniform points", unit, 0.0),
        Case(
            "1,000,000 coincident points",
            np.full((LARGE, 2), 3.0),
            0.0,
            "1,000,000 uniform points",
        ),
        Case("1,000,000 discs on a line", line, 0.6, "1,000,000 uniform points"),
        Case("1,000 clusters of 1e-9", tight, 0.0, "1,000,000 uniform points"),
        Case(
            "one huge disc over 1,000,000 tiny",
            unit,
            one_large(LARGE),
            "1,000,000 uniform points",
        ),
    ]


def main() -> None:
    """Run, print and write the results of this machine."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=9)
    rounds = parser.parse_args().rounds
    print(describe())
    every = cases()
    timings = interleaved([case.run for case in every], rounds)
    medians = {case.name: timing.median for case, timing in zip(every, timings, strict=True)}
    rows: list[dict[str, object]] = []
    for case, timing in zip(every, timings, strict=True):
        ratio = timing.median / medians[case.beside] if case.beside else 1.0
        print(f"  {case.name:36} {1e3 * timing.median:9.1f} ms   ×{ratio:.2f}")
        rows.append(
            {
                "case": case.name,
                "beside": case.beside or "",
                "version": jostle.__version__,
                "rounds": rounds,
                **timing.columns(),
            }
        )
    write("hard-cases", rows)


if __name__ == "__main__":
    main()
