"""Interleaved timing: every round times every candidate once, in random order.

So noise of the machine affects all alike, and candidates are compared round by round. A measurement
is the median of a few calls. Candidates that take too long are omitted, by an estimate before the
first call or after it.
"""

from __future__ import annotations

import math
import random
import statistics
import time
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

Key = TypeVar("Key", bound=Hashable)
Clock = Callable[[], float]

LEAST = 5e-3  # seconds of one measurement; shorter calls are repeated
MOST_CALLS = 200  # in one measurement
FORGIVEN = 2  # times the limit; up to here a candidate is tried twice,
STALL = 0.1  # and up to this many seconds
CONFIDENCE = 0.95
FEWEST = 6  # rounds; with fewer there is no such confidence interval


def _nothing() -> None:
    pass


@dataclass(frozen=True)
class Candidate:
    """A call to be timed.

    Parameters
    ----------
    call
        The timed function.
    prepare
        Called before each call, not timed.
    expect
        Returns a lower bound of the seconds of a call; called once, before the first call.
    """

    call: Callable[[], object]
    prepare: Callable[[], object] = _nothing
    expect: Callable[[], float] = lambda: 0.0


@dataclass
class Outcome:
    """Seconds per call, one for each round; and whether the candidate was omitted as too slow."""

    rounds: list[float] = field(default_factory=list)
    too_slow: bool = False

    @property
    def status(self) -> str:
        """Return "measured", "too slow" or "not reached"."""
        return "too slow" if self.too_slow else "measured" if self.rounds else "not reached"

    @property
    def median(self) -> float:
        """Return the median, infinite without measurements."""
        return statistics.median(self.rounds) if self.rounds else math.inf

    @property
    def quartiles(self) -> tuple[float, float]:
        """Return the lower and the upper quartile."""
        ordered = sorted(self.rounds)
        skip = len(ordered) // 4
        return (ordered[skip], ordered[-1 - skip]) if ordered else (math.inf, math.inf)


@dataclass(frozen=True)
class Ratio:
    """Ratio of two times: the median of all rounds, and its confidence interval.

    With too few rounds, low is 0 and high infinite.
    """

    median: float
    low: float
    high: float

    @property
    def within_noise(self) -> bool:
        """Whether the difference is not significant."""
        return self.low <= 1.0 <= self.high

    @property
    def too_few(self) -> bool:
        """Whether there were too few rounds."""
        return math.isinf(self.high)


def compare(slow: Outcome, quick: Outcome) -> Ratio:
    """Return `slow` over `quick`, round by round.

    Low and high are the 95 % confidence interval of the median, for any distribution of the noise;
    with fewer than six rounds they are 0 and infinity.
    """
    ratios = sorted(a / b for a, b in zip(slow.rounds, quick.rounds, strict=False) if b > 0)
    if len(ratios) < FEWEST:
        return Ratio(statistics.median(ratios) if ratios else math.nan, 0.0, math.inf)
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


class InterleavedTiming(Generic[Key]):
    """Candidates and their times so far: `outcomes` can be read at any time.

    Parameters
    ----------
    candidates
        By any key.
    limit
        Seconds; slower candidates are omitted.
    clock
        Returns seconds.
    seed
        Seed of the order within the rounds.
    """

    def __init__(
        self,
        candidates: Mapping[Key, Candidate],
        limit: float = math.inf,
        clock: Clock = time.perf_counter,
        seed: int = 0,
    ) -> None:
        self.limit = limit
        self.outcomes: dict[Key, Outcome] = {key: Outcome() for key in candidates}
        self._candidates = dict(candidates)
        self._clock = clock
        self._random = random.Random(seed)
        self._calls: dict[Key, int] = {}

    def run(
        self,
        rounds: int,
        seconds: float = math.inf,
        advance: Callable[[int], object] = lambda done: None,
    ) -> None:
        """Try every candidate once, then time complete rounds within `seconds`.

        There is at least one round, of the candidates tried in time. `advance` is called with the
        number of measurements, of (rounds + 1) × candidates, that are finished or omitted.
        """
        end = self._clock() + seconds
        self._try_all(end, rounds, advance)
        longest = 0.0
        for number in range(rounds):
            start = self._clock()
            if number and start + longest > end:
                advance((rounds - number) * len(self._calls))
                return
            self._round(advance)
            longest = max(longest, self._clock() - start)

    def _try_all(self, end: float, rounds: int, advance: Callable[[int], object]) -> None:
        for key in self._shuffled(self._candidates):
            candidate = self._candidates[key]
            if self._clock() > end and self._calls:
                advance(1 + rounds)
                continue
            seconds = candidate.expect()
            if seconds <= self.limit:
                seconds = self._time(candidate)
                if (
                    self.limit < seconds <= max(FORGIVEN * self.limit, STALL)
                    and self._clock() < end
                ):
                    seconds = self._time(candidate)  # another process may have delayed it
            if seconds > self.limit:
                self.outcomes[key].too_slow = True
            else:
                self._calls[key] = min(math.ceil(LEAST / max(seconds, 1e-9)), MOST_CALLS)
            advance(1 if key in self._calls else 1 + rounds)

    def _round(self, advance: Callable[[int], object]) -> None:
        """Time every candidate once; an interrupted round is discarded."""
        found: dict[Key, float] = {}
        for key in self._shuffled(self._calls):
            calls, candidate = self._calls[key], self._candidates[key]
            found[key] = statistics.median(self._time(candidate) for _ in range(calls))
            advance(1)
        for key, seconds in found.items():
            self.outcomes[key].rounds.append(seconds)

    def _shuffled(self, keys: Mapping[Key, object]) -> Sequence[Key]:
        return self._random.sample(list(keys), len(keys))

    def _time(self, candidate: Candidate) -> float:
        candidate.prepare()
        start = self._clock()
        candidate.call()
        return self._clock() - start
