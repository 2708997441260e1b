"""Comparisons of two calls that were timed in the same rounds."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from timing import Timing

__all__ = ["Ratio", "compare", "crossing"]

CONFIDENCE = 0.95
FEWEST = 6
"""Rounds; with fewer there is no such confidence interval."""


@dataclass(frozen=True)
class Ratio:
    """Ratio of two times: the median of all rounds, and its confidence interval."""

    median: float
    low: float
    high: float

    @property
    def within_noise(self) -> bool:
        """Whether the difference is not significant."""
        return self.low <= 1.0 <= self.high


def compare(slow: Timing, quick: Timing) -> Ratio:
    """Return `slow` over `quick`, round by round.

    Low and high are the 95 % confidence interval of the median, for any distribution of the noise;
    with fewer than six rounds they are 0 and infinity.

    Examples
    --------
    >>> from ratios import compare
    >>> from timing import Timing
    >>> compare(Timing((2.0, 2.2, 2.4, 2.0, 2.2, 2.4)), Timing((1.0,) * 6))
    Ratio(median=2.2, low=2.0, high=2.4)
    """
    ratios = sorted(a / b for a, b in zip(slow.rounds, quick.rounds, strict=True))
    if len(ratios) < FEWEST:
        return Ratio(statistics.median(ratios), 0.0, math.inf)
    skip = _ranks_outside(len(ratios))
    return Ratio(statistics.median(ratios), ratios[skip], ratios[-1 - skip])


def _ranks_outside(count: int) -> int:
    """Return the number of the lowest ranks outside the interval, by the binomial distribution."""
    probability, rank = 0.0, 0
    while True:
        probability += math.comb(count, rank) / 2**count
        if probability > (1 - CONFIDENCE) / 2:
            return max(rank - 1, 0)
        rank += 1


def crossing(counts: Sequence[int], ratios: Sequence[float]) -> float | None:
    """Return the count from which on ratios are below 1, interpolated; None if there is none.

    Examples
    --------
    >>> from ratios import crossing
    >>> crossing([100, 200, 400], [4.0, 1.0, 0.5])
    200.0
    """
    points = list(zip(counts, ratios, strict=True))
    for (n1, ratio1), (n2, ratio2) in reversed(list(pairwise(points))):
        if ratio1 > 1 >= ratio2:
            share = math.log(ratio1) / math.log(ratio1 / ratio2)
            return float(n1 * (n2 / n1) ** share)
    return None
