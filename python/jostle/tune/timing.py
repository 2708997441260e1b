"""The protocol: every round times every contender once, in an order drawn anew.

So the noise of the machine falls on all alike, and two contenders can be compared round by round. A
measurement is the median of a few calls: what else the machine does now and then is not in it.
What would take too long is found out before it is run, or after it ran once, and left out.
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

LEAST = 5e-3  # seconds of one measurement; shorter calls are repeated within it
MOST_CALLS = 200  # in one measurement
FORGIVEN = 2  # times the limit: up to there a contender has a second chance,
STALL = 0.1  # and in any case up to this many seconds
CONFIDENCE = 0.95
FEWEST = 6  # rounds; the extremes of fewer hold the median less often than that


def _nothing() -> None:
    pass


@dataclass(frozen=True)
class Contender:
    """Something to be timed.

    Parameters
    ----------
    call
        What the clock sees.
    prepare
        Comes before every call, outside the clock.
    expect
        Returns the seconds that a call takes at the least; asked once, before the first call.
    """

    call: Callable[[], object]
    prepare: Callable[[], object] = _nothing
    expect: Callable[[], float] = lambda: 0.0


@dataclass
class Outcome:
    """Seconds a call, one for each round; and whether the contender was left out as too slow."""

    rounds: list[float] = field(default_factory=list)
    too_slow: bool = False

    @property
    def status(self) -> str:
        """Return "measured", "too slow" or "not reached"."""
        return "too slow" if self.too_slow else "measured" if self.rounds else "not reached"

    @property
    def median(self) -> float:
        """Return the median, infinite where nothing was measured."""
        return statistics.median(self.rounds) if self.rounds else math.inf

    @property
    def quartiles(self) -> tuple[float, float]:
        """Return what a quarter of the rounds stayed below, and a quarter above."""
        ordered = sorted(self.rounds)
        skip = len(ordered) // 4
        return (ordered[skip], ordered[-1 - skip]) if ordered else (math.inf, math.inf)


@dataclass(frozen=True)
class Ratio:
    """How many times as long one took as another: the median of all rounds, and its uncertainty.

    Of too few rounds nothing is certain: low is 0 and high infinite.
    """

    median: float
    low: float
    high: float

    @property
    def within_noise(self) -> bool:
        """Whether the two cannot be told apart."""
        return self.low <= 1.0 <= self.high

    @property
    def too_few(self) -> bool:
        """Whether there were too few rounds to tell anything apart."""
        return math.isinf(self.high)


def compare(slow: Outcome, quick: Outcome) -> Ratio:
    """Return `slow` over `quick`, round by round.

    Low and high hold the median of ever more rounds with 95 % confidence, whatever the noise is
    like; below six rounds nothing does, and they are 0 and infinity.
    """
    ratios = sorted(a / b for a, b in zip(slow.rounds, quick.rounds, strict=False) if b > 0)
    if len(ratios) < FEWEST:
        return Ratio(statistics.median(ratios) if ratios else math.nan, 0.0, math.inf)
    skip = _ranks_outside(len(ratios))
    return Ratio(statistics.median(ratios), ratios[skip], ratios[-1 - skip])


def _ranks_outside(count: int) -> int:
    """Return how many of the lowest ranks cannot be the median: heads of `count` coins."""
    chance, rank = 0.0, 0
    while True:
        chance += math.comb(count, rank) / 2**count
        if chance > (1 - CONFIDENCE) / 2:
            return max(rank - 1, 0)
        rank += 1


class Race(Generic[Key]):
    """Contenders, and what their calls took so far: `outcomes` can be read at any time.

    Parameters
    ----------
    contenders
        By any key.
    limit
        Seconds; a contender whose call takes longer is left out.
    clock
        Returns seconds.
    seed
        Of the order within the rounds.
    """

    def __init__(
        self,
        contenders: Mapping[Key, Contender],
        limit: float = math.inf,
        clock: Clock = time.perf_counter,
        seed: int = 0,
    ) -> None:
        self.limit = limit
        self.outcomes: dict[Key, Outcome] = {key: Outcome() for key in contenders}
        self._contenders = dict(contenders)
        self._clock = clock
        self._random = random.Random(seed)
        self._calls: dict[Key, int] = {}

    def run(
        self,
        rounds: int,
        seconds: float = math.inf,
        advance: Callable[[int], object] = lambda done: None,
    ) -> None:
        """Try everything once, then time whole rounds as long as they fit into `seconds`.

        There is always one round, of whatever was tried in time. `advance` is told how many of
        the (rounds + 1) × contenders measurements are behind us, be they made or left out.
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
        for key in self._shuffled(self._contenders):
            contender = self._contenders[key]
            if self._clock() > end and self._calls:
                advance(1 + rounds)
                continue
            seconds = contender.expect()
            if seconds <= self.limit:
                seconds = self._time(contender)
                if (
                    self.limit < seconds <= max(FORGIVEN * self.limit, STALL)
                    and self._clock() < end
                ):
                    seconds = self._time(contender)  # the machine may have been elsewhere
            if seconds > self.limit:
                self.outcomes[key].too_slow = True
            else:
                self._calls[key] = min(math.ceil(LEAST / max(seconds, 1e-9)), MOST_CALLS)
            advance(1 if key in self._calls else 1 + rounds)

    def _round(self, advance: Callable[[int], object]) -> None:
        """Time everything once; a round that is broken off leaves no trace."""
        found: dict[Key, float] = {}
        for key in self._shuffled(self._calls):
            calls, contender = self._calls[key], self._contenders[key]
            found[key] = statistics.median(self._time(contender) for _ in range(calls))
            advance(1)
        for key, seconds in found.items():
            self.outcomes[key].rounds.append(seconds)

    def _shuffled(self, keys: Mapping[Key, object]) -> Sequence[Key]:
        return self._random.sample(list(keys), len(keys))

    def _time(self, contender: Contender) -> float:
        contender.prepare()
        start = self._clock()
        contender.call()
        return self._clock() - start
