"""Times the search for all pairs with trees of many leaf capacities and maximum depths.

Each tree finds the pairs once before it is timed, and all must find the same. Every round times
each tree once, in random order, so noise of the machine affects all alike. Medians are compared.
"""

from __future__ import annotations

import math
import random
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import jostle

CAPACITIES = (3, 8, 16, 24, 32, 40, 48, 64, 96, 128, 256)
DEPTHS = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 16, 24)
ROUNDS = 15
TOO_SLOW = 20.0  # times the default; slower trees are not timed further
MEASUREMENT = 8e-3  # seconds; of shorter calls several are timed, and the fastest counts
SETTLING = 1_000_000  # particles times steps before the search; 60 steps at most


class Setting(NamedTuple):
    """The settings of a tree."""

    leaf_capacity: int
    max_depth: int


ARTICLE = Setting(3, 5)  # of 2015; its depth of 4 allows five subdivisions


@dataclass
class Map:
    """The times of a scene's trees.

    A limit of the depth that no branch reaches changes nothing. Such a tree is timed once, with the
    default depth, which is no limit.
    """

    scene: str
    n: int
    threads: int | None
    default: Setting
    depths: dict[int, int] = field(default_factory=dict)
    """Leaf capacity: depth of the tree without a limit."""
    rounds: dict[Setting, list[float]] = field(default_factory=dict)
    """Seconds of each round; trees that are too slow are missing."""

    def same_tree(self, capacity: int, depth: int) -> Setting:
        """Return the setting under which a tree was timed."""
        unlimited = depth >= self.depths[capacity]
        return Setting(capacity, self.default.max_depth if unlimited else depth)

    def rows(self) -> list[int]:
        """Return the depths of the map: those that limit some tree, and no limit."""
        deepest = max(self.depths.values())
        return [*(depth for depth in DEPTHS if depth < deepest), self.default.max_depth]

    def seconds(self, setting: Setting) -> float:
        """Return the median of the rounds; infinite if the tree was too slow."""
        return statistics.median(self.rounds.get(setting, [math.inf]))

    def over_best(self, setting: Setting) -> float:
        """Return the time of a setting, relative to the best."""
        return self.seconds(setting) / self.seconds(self.best)

    @property
    def best(self) -> Setting:
        """The fastest setting."""
        return min(self.rounds, key=self.seconds)


@dataclass(frozen=True)
class Search:
    """The discs of a scene, whose pairs are searched."""

    positions: NDArray[np.float32]
    radii: NDArray[np.float32]
    default: Setting
    threads: int | None

    @classmethod
    def of(cls, scene: str, n: int, threads: int | None = 1) -> Search:
        """Make a scene of `n` particles, and let them move for a second."""
        world = jostle.scenes.create(scene, n=n)
        world.sleeping = False
        world.step(1 / 60, min(60, max(SETTLING // max(n, 1), 1)))
        default = Setting(world.leaf_capacity, world.max_depth)
        return cls(world.positions, world.radii, default, threads)

    def tree(self, setting: Setting) -> jostle.Quadtree:
        """Build the tree of a setting."""
        return jostle.Quadtree(
            *(self.positions, self.radii),
            leaf_capacity=setting.leaf_capacity,
            max_depth=setting.max_depth,
            threads=self.threads,
        )

    def pairs(self, setting: Setting) -> NDArray[np.int64]:
        """Build a tree and find all pairs; this is what is timed."""
        return self.tree(setting).pairs()


def measure(
    scene: str,
    n: int,
    *,
    threads: int | None = 1,
    rounds: int = ROUNDS,
    report: Callable[[float], object] = lambda share: None,
) -> Map:
    """Time the trees of a scene; `report` is called with the share that is done."""
    search = Search.of(scene, n, threads)
    found = Map(scene, n, threads, search.default)
    calls = {
        setting: min(math.ceil(MEASUREMENT / seconds), 100)
        for setting, seconds in _tried(search, found, report).items()
    }
    for number in range(rounds):
        for setting in random.sample(list(calls), len(calls)):
            times = (_timed(search, setting)[0] for _ in range(calls[setting]))
            found.rounds[setting].append(min(times))  # other programs only add time
        report((number + 2) / (rounds + 1))
    return found


def _tried(search: Search, found: Map, report: Callable[[float], object]) -> dict[Setting, float]:
    """Find the pairs with each tree; return the seconds of those that are fast enough.

    A smaller depth makes larger leaves, so after a depth that is too slow no smaller one is tried.
    """
    expected = _keys(search.pairs(found.default))
    limit = TOO_SLOW * max(_timed(search, found.default)[0] for _ in range(3))
    capacities = sorted({*CAPACITIES, found.default.leaf_capacity})
    quick: dict[Setting, float] = {}
    for number, capacity in enumerate(capacities):
        unlimited = Setting(capacity, found.default.max_depth)
        found.depths[capacity] = deepest = search.tree(unlimited).stats.depth
        limits = (depth for depth in reversed(DEPTHS) if depth < deepest)
        for setting in (unlimited, *(Setting(capacity, depth) for depth in limits)):
            seconds, pairs = _timed(search, setting)
            if not np.array_equal(_keys(pairs), expected):
                raise RuntimeError(f"trees of {setting} and {found.default} find other pairs")
            if seconds > limit and _timed(search, setting)[0] > limit:  # not by chance
                break
            quick[setting], found.rounds[setting] = seconds, []
        report((number + 1) / len(capacities) / (ROUNDS + 1))
    return quick


def _timed(search: Search, setting: Setting) -> tuple[float, NDArray[np.int64]]:
    start = time.perf_counter()
    pairs = search.pairs(setting)
    return time.perf_counter() - start, pairs


def _keys(pairs: NDArray[np.integer[Any]]) -> NDArray[np.int64]:
    """Return a number for each pair, sorted."""
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    return np.sort((low.astype(np.int64) << 32) | high.astype(np.int64))
