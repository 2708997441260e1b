"""All overlapping pairs of equal discs over 40 % of the area, build included.

    python benchmarks/pairs.py [--counts 1000 10000 100000] [--rounds 9]

The answers are compared as sets of pairs before anything is timed; rounds of the
rivals are interleaved; the table gives medians, and ratios to the first rival.
"""

from __future__ import annotations

import argparse

import numpy as np
from machine import describe, write
from measure import interleaved
from numpy.typing import NDArray
from rivals import RIVALS, Pairs, Rival

COVERAGE = 0.4
RADIUS = 0.5


def uniform(count: int, seed: int = 0) -> NDArray[np.float64]:
    """Centres of `count` discs that cover the share COVERAGE of a square.

    They are float32 numbers held in float64, so that all rivals see the same discs.
    """
    side = np.sqrt(count * np.pi * RADIUS**2 / COVERAGE)
    places = np.random.default_rng(seed).random((count, 2)) * side
    return places.astype(np.float32).astype(np.float64)


def as_set(pairs: Pairs) -> NDArray[np.int64]:
    """The pairs in one order, the smaller first."""
    ordered = np.sort(np.asarray(pairs, dtype=np.int64).reshape(-1, 2), axis=1)
    return ordered[np.lexsort((ordered[:, 1], ordered[:, 0]))]


def check(rivals: list[Rival], centers: NDArray[np.float64]) -> None:
    """Stop unless all answer alike, but for pairs that touch to float32's last bit."""
    expected = as_set(rivals[0].find(centers, RADIUS))
    for rival in rivals[1:]:
        found = as_set(rival.find(centers, RADIUS))
        if np.array_equal(found, expected):
            continue
        differing = set(map(tuple, found.tolist())) ^ set(map(tuple, expected.tolist()))
        distances = [np.hypot(*(centers[i] - centers[j])) for i, j in differing]
        if any(abs(distance - 2 * RADIUS) > 1e-4 for distance in distances):
            raise SystemExit(f"{rival.name} does not find the same pairs")
        print(f"  ({rival.name}: {len(differing)} pairs differ, all touching to the last bit)")


def run(count: int, rounds: int) -> list[dict[str, object]]:
    """Compare and time all rivals that can manage `count` discs."""
    centers = uniform(count)
    rivals = [rival for rival in RIVALS if count <= rival.most]
    check(rivals, centers)
    calls = [lambda rival=rival: rival.find(centers, RADIUS) for rival in rivals]
    timings = interleaved(calls, rounds)
    print(f"\n{count:,} discs, {rounds} rounds")
    rows: list[dict[str, object]] = []
    for rival, timing in zip(rivals, timings, strict=True):
        each, ratio = 1e9 * timing.median / count, timing.median / timings[0].median
        spread = f"{1e9 * timing.low / count:,.0f} to {1e9 * timing.high / count:,.0f}"
        print(f"  {rival.name:28} {each:10,.1f} ns a disc   ×{ratio:<8.2f} ({spread})")
        rows.append(
            {
                "count": count,
                "rival": rival.name,
                "version": rival.version,
                "rounds": rounds,
                **timing.columns(),
            }
        )
    return rows


def main() -> None:
    """Run, print and write the results of this machine."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--counts", type=int, nargs="+", default=[100, 1_000, 10_000, 100_000])
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()
    print(describe())
    rows = [row for count in options.counts for row in run(count, options.rounds)]
    write("pairs", rows)


if __name__ == "__main__":
    main()
