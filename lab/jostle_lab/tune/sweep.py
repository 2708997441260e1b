"""The sweeps of settings: leaf capacity × depth, world size, number of particles."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from jostle_lab.tune.candidates import Method, Setting, Work, candidate, defaults, tree
from jostle_lab.tune.sample import Sample
from jostle_lab.tune.timing import FEWEST, LEAST, InterleavedTiming, Outcome, Ratio, compare

ARTICLE_CAPACITY, ARTICLE_DEPTH = 3, 5  # its "4" allows one more subdivision
CAPACITIES = (ARTICLE_CAPACITY, 8, 16, 24, 32, 40, 48, 64, 96, 128, 256)
DEPTHS = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 16, 24)
WORLD_SIZES = (0.5, 0.7, 1.0, 1.4, 2.0, 4.0)
SIZE_CAPACITIES = (8, 16, 32, 48, 64, 128)
COUNTS = (50, 100, 200, 500, 1_000, 2_000, 5_000, 10_000, 20_000, 50_000, 100_000)
COUNT_METHODS: tuple[Method, ...] = ("quadtree", "brute force", "article's tree")
ARTICLE_MOST = 10_000  # particles; a frame with more takes many seconds

TOO_SLOW = 20.0  # times the default; slower settings are skipped
EQUAL = 1.02  # times the fastest; up to here a setting without a depth limit is preferred
FINAL_ROUNDS = 10  # times those of a sweep
FINALISTS = 2  # of the sweep's best, with and without a depth limit


@dataclass(frozen=True)
class Effort:
    """The limits of the measuring time.

    Attributes
    ----------
    rounds
        Of each sweep, within `seconds`.
    seconds
        For all sweeps together.
    limit
        Seconds per call; slower calls are omitted in the sweep over numbers of particles.
    most
        Maximum number of particles in that sweep, at least the requested number.
    """

    rounds: int
    seconds: float
    limit: float
    most: int


THOROUGH = Effort(rounds=31, seconds=80.0, limit=0.5, most=100_000)
QUICK = Effort(rounds=11, seconds=11.0, limit=0.1, most=20_000)

Outcomes = dict[Setting, Outcome]
Watch = Callable[[str, int, int], object]


@dataclass
class Tuning:
    """The measurements so far."""

    scene: str
    n: int
    work: Work
    threads: int | None
    default: Setting
    settings: Outcomes = field(default_factory=dict)
    """Leaf capacity × depth. A depth that no branch reaches gives the same tree as no limit: such
    trees are timed once, under the default depth."""
    tree_depths: dict[int, int] = field(default_factory=dict)
    """Leaf capacity: depth of the tree without a limit."""
    sizes: Outcomes = field(default_factory=dict)
    counts: Outcomes = field(default_factory=dict)
    final: Outcomes = field(default_factory=dict)

    def sweeps(self) -> Iterator[tuple[str, Outcomes]]:
        """Return each sweep with its name."""
        yield "settings", self.settings
        yield "world size", self.sizes
        yield "particles", self.counts
        yield "final", self.final

    def cell(self, leaf_capacity: int, max_depth: int) -> Setting:
        """Return the timed setting with the same tree."""
        if max_depth >= self.tree_depths.get(leaf_capacity, max_depth + 1):
            max_depth = self.default.max_depth
        return Setting(self.n, 1.0, leaf_capacity, max_depth)

    def best(self) -> Setting:
        """Return the fastest setting of the final, or of the sweep before the final.

        Among those that are not significantly slower, one without a depth limit is preferred: the
        best limit depends on the number of particles.
        """
        outcomes = self._latest()
        measured = sorted(
            (setting for setting in outcomes if outcomes[setting].rounds),
            key=lambda setting: outcomes[setting].median,
        )
        if not measured:
            return self.default
        quickest = measured[0]
        for setting in measured:
            behind = compare(outcomes[setting], outcomes[quickest])
            close = setting == quickest or (behind.within_noise and behind.median <= EQUAL)
            if close and setting.max_depth == self.default.max_depth:
                return setting
        return quickest

    def _latest(self) -> Outcomes:
        fresh = any(outcome.rounds for outcome in self.final.values())
        return self.final if fresh else self.settings

    def gain(self) -> Ratio:
        """Return the time of the default over that of the best."""
        return self.default_over(self.best())

    def outcome(self, setting: Setting) -> Outcome:
        """Return the outcome of a setting, of the final if it was in it."""
        return {**self.settings, **self._latest()}.get(setting, Outcome())

    def default_over(self, setting: Setting) -> Ratio:
        """Return the time of the default over that of a setting."""
        return self._compare(self.default, setting)

    def is_as_good(self, setting: Setting) -> bool:
        """Whether a setting is the best one, or not significantly slower."""
        best = self.best()
        return setting == best or self._compare(setting, best).low <= 1.0

    def too_few(self) -> bool:
        """Whether the sweep had too few rounds for comparisons."""
        return max((len(o.rounds) for o in self.settings.values()), default=0) < FEWEST

    def one_leaf(self) -> bool:
        """Whether the tree of the default has one leaf, so there is nothing to tune."""
        return self.n <= self.default.leaf_capacity

    def _compare(self, slow: Setting, quick: Setting) -> Ratio:
        """Compare two settings in the same rounds: of the final, if both were in it."""
        latest = self._latest()
        outcomes = latest if slow in latest and quick in latest else self.settings
        return compare(outcomes.get(slow, Outcome()), outcomes.get(quick, Outcome()))


class Tuner:
    """Fills a `Tuning`, sweep by sweep; measurements are kept if a sweep is interrupted."""

    def __init__(
        self,
        scene: str,
        n: int,
        *,
        work: Work = "pairs",
        threads: int | None = None,
        effort: Effort = THOROUGH,
        seed: int = 0,
    ) -> None:
        capacity, depth = defaults()
        self.tuning = Tuning(scene, n, work, threads, Setting(n, 1.0, capacity, depth))
        self.effort = effort
        self._seed = seed
        self._sample = Sample.of(scene, n, seed)

    def settings(self, watch: Watch, share: float = 0.4) -> None:
        """Sweep leaf capacity × depth."""
        tuning, default = self.tuning, self.tuning.default
        for capacity in sorted({*CAPACITIES, default.leaf_capacity}):
            unlimited = Setting(tuning.n, 1.0, capacity, default.max_depth)
            depth = tree(self._sample, unlimited, tuning.threads).stats.depth
            tuning.tree_depths[capacity] = depth
        tries = {
            tuning.cell(capacity, depth): self._sample
            for capacity in tuning.tree_depths
            for depth in (*DEPTHS, default.max_depth)
        }
        limit = max(TOO_SLOW * self._once(default), LEAST)
        self._time(tuning.settings, "leaf capacity × depth", tries, watch, share, limit)

    def sizes(self, watch: Watch, share: float = 0.15) -> None:
        """Sweep the size of the world, with a few leaf capacities in each."""
        default = self.tuning.default
        capacities = sorted({*SIZE_CAPACITIES, default.leaf_capacity})
        tries = {}
        for size in WORLD_SIZES:
            if size < 1 and self.tuning.work == "step":
                continue  # overlapping particles do not move like those of a scene
            sample = self._sample.resized(size)
            for capacity in capacities:
                tries[Setting(self.tuning.n, size, capacity, default.max_depth)] = sample
        limit = max(10 * TOO_SLOW * self._once(default), LEAST)
        self._time(self.tuning.sizes, "world size", tries, watch, share, limit)

    def counts(self, watch: Watch, share: float = 0.35) -> None:
        """Sweep the number of particles, with the tree, brute force and the article's tree."""
        tuning, effort = self.tuning, self.effort
        tries = {}
        most = max(effort.most, tuning.n)
        for n in sorted({*(n for n in COUNTS if n <= most), tuning.n}):
            sample = self._sample if n == tuning.n else Sample.of(tuning.scene, n, self._seed)
            for method in COUNT_METHODS:
                if method == "article's tree" and n > ARTICLE_MOST:
                    continue
                ours = method == "quadtree"
                capacity, depth = defaults() if ours else (0, 0)
                tries[Setting(n, 1.0, capacity, depth, method)] = sample
        limit = max(effort.limit, 2 * self._once(tuning.default))
        self._time(tuning.counts, "number of particles", tries, watch, share, limit)

    def final(self, watch: Watch, share: float = 0.1) -> None:
        """Time the best of the sweep, the default and the article's setting again.

        The minimum of many noisy times is biased; new rounds remove the bias.
        """
        tuning, found = self.tuning, self.tuning.settings
        measured = [setting for setting in found if found[setting].rounds]
        measured.sort(key=lambda setting: found[setting].median)
        unlimited = [s for s in measured if s.max_depth == tuning.default.max_depth]
        article = tuning.cell(ARTICLE_CAPACITY, ARTICLE_DEPTH)
        also = [article] if article in measured else []
        finalists = [tuning.default, *measured[:FINALISTS], *unlimited[:FINALISTS], *also]
        tries = dict.fromkeys(finalists, self._sample)
        rounds = FINAL_ROUNDS * self.effort.rounds
        self._time(tuning.final, "final", tries, watch, share, rounds=rounds)

    def _time(
        self,
        into: Outcomes,
        name: str,
        tries: dict[Setting, Sample],
        watch: Watch,
        share: float,
        limit: float = float("inf"),
        rounds: int | None = None,
    ) -> None:
        rounds = rounds or self.effort.rounds
        tuning = self.tuning
        timing = InterleavedTiming(
            {
                setting: candidate(sample, setting, tuning.work, tuning.threads)
                for setting, sample in tries.items()
            },
            limit,
            seed=random.Random(name).randrange(2**32),
        )
        steps, done = len(tries) * (rounds + 1), 0

        def advance(more: int) -> None:
            nonlocal done
            done += more
            watch(name, done, steps)

        into.update(
            timing.outcomes
        )  # the same objects, so measurements are kept if the run is interrupted
        advance(0)
        timing.run(rounds, share * self.effort.seconds, advance)

    def _once(self, setting: Setting) -> float:
        """Return the approximate time of a setting: the best of three calls."""
        timing = InterleavedTiming(
            {0: candidate(self._sample, setting, self.tuning.work, self.tuning.threads)}
        )
        timing.run(3)
        return min(timing.outcomes[0].rounds)
