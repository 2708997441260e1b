"""Conclusions from the measurements: crossings of curves, particles within a frame time."""

from __future__ import annotations

import math
from itertools import pairwise

from jostle_lab.tune.candidates import Method
from jostle_lab.tune.sweep import Outcomes, Tuning
from jostle_lab.tune.timing import Outcome, Ratio, compare

Curve = list[tuple[int, float]]  # particles, seconds

FRAME = 1 / 60


def curve(counts: Outcomes, method: Method) -> Curve:
    """Return the measured points of a method, by number of particles."""
    return sorted(
        (setting.n, outcome.median)
        for setting, outcome in counts.items()
        if setting.method == method and outcome.rounds
    )


def particles_within(points: Curve, seconds: float = FRAME) -> float | None:
    """Return the number of particles within a time; None if all measured numbers are."""
    for (n1, t1), (n2, t2) in pairwise(points):
        if t1 <= seconds < t2:
            return math.exp(_between(math.log(seconds), (math.log(t1), math.log(t2)), (n1, n2)))
    return None


def crossing(counts: Outcomes) -> float | None:
    """Return the number of particles above which the tree is faster than brute force."""
    brute = dict(curve(counts, "brute force"))
    both = [(n, math.log(t / brute[n])) for n, t in curve(counts, "quadtree") if n in brute]
    for (n1, lead1), (n2, lead2) in reversed(list(pairwise(both))):
        if lead1 > 0 >= lead2:
            return math.exp(_between(0.0, (lead1, lead2), (n1, n2)))
    return None


def _between(at: float, ends: tuple[float, float], counts: tuple[int, int]) -> float:
    """Return the logarithm of a count, by linear interpolation."""
    share = (at - ends[0]) / (ends[1] - ends[0])
    return math.log(counts[0]) + share * (math.log(counts[1]) - math.log(counts[0]))


def size_gain(tuning: Tuning, world_size: float) -> tuple[Outcome, int, Ratio] | None:
    """Return, for one world size, the default's outcome, the best leaf capacity and its gain."""
    here = {
        setting.leaf_capacity: outcome
        for setting, outcome in tuning.sizes.items()
        if setting.world_size == world_size and outcome.rounds
    }
    if tuning.default.leaf_capacity not in here:
        return None
    best = min(here, key=lambda capacity: here[capacity].median)
    default = here[tuning.default.leaf_capacity]
    return default, best, compare(default, here[best])


def two_digits(value: float) -> int:
    """Return a number with two significant digits."""
    unit = 10 ** max(math.floor(math.log10(value)) - 1, 0)
    return int(round(value / unit) * unit)
