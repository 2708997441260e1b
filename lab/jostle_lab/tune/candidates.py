"""The timed calls: the search for the pairs of a sample, or a step of its world."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle_lab.tune.sample import TIME_STEP, Sample
from jostle_lab.tune.timing import Candidate

Method = Literal["quadtree", "brute force", "article's tree"]
Work = Literal["pairs", "step"]

RATE_SAMPLE = 2_000  # shapes, to measure the time of one test


@dataclass(frozen=True)
class Setting:
    """One point of the sweeps; capacity and depth are 0 for methods without them."""

    n: int
    world_size: float
    leaf_capacity: int
    max_depth: int
    method: Method = "quadtree"


@cache
def defaults() -> tuple[int, int]:
    """Return the default leaf capacity and maximum depth of the library."""
    world = jostle.World(np.empty((0, 2)), np.empty((0, 2)), 1.0)
    return world.leaf_capacity, world.max_depth


def candidate(sample: Sample, setting: Setting, work: Work, threads: int | None) -> Candidate:
    """Return the candidate of one setting."""
    if setting.method == "article's tree":
        return _article(sample)
    if work == "step":
        return _step(sample, setting, threads)
    return _pairs(sample, setting, threads)


def tree(sample: Sample, setting: Setting, threads: int | None) -> jostle.Quadtree:
    """Build the tree of a setting."""
    return jostle.Quadtree(
        sample.positions,
        sample.radii,
        leaf_capacity=setting.leaf_capacity,
        max_depth=setting.max_depth,
        threads=threads,
    )


def _pairs(sample: Sample, setting: Setting, threads: int | None) -> Candidate:
    """Build the tree and find the pairs, or find them by brute force."""
    positions, radii = sample.positions, sample.radii
    expect = _expectation(sample, setting, threads)
    if setting.method == "brute force":
        return Candidate(
            lambda: jostle.find_pairs(positions, radii, method="brute", threads=threads),
            expect=expect,
        )
    return Candidate(lambda: tree(sample, setting, threads).pairs(), expect=expect)


def _step(sample: Sample, setting: Setting, threads: int | None) -> Candidate:
    """Time one step of the world, always from the same state."""
    world = sample.world
    brute = setting.method == "brute force"

    def prepare() -> None:
        world.positions, world.velocities = sample.positions, sample.velocities
        world.threads, world.method = threads, "brute" if brute else "quadtree"
        if not brute:
            world.leaf_capacity, world.max_depth = setting.leaf_capacity, setting.max_depth

    expect = _expectation(sample, setting, threads)
    return Candidate(lambda: world.step(TIME_STEP), prepare, expect)


def _article(sample: Sample) -> Candidate:
    """Time one frame of the article's program: tree, collisions and motion."""
    program = [sample.article_program()]

    def prepare() -> None:
        program[0] = sample.article_program()

    return Candidate(lambda: program[0].frame(), prepare)


def _expectation(sample: Sample, setting: Setting, threads: int | None) -> Callable[[], float]:
    """Return a lower bound of the time: all pairs in each leaf, or of all shapes, are tested."""

    def expect() -> float:
        if setting.method == "brute force":
            return _tests(np.array([len(sample)])) * seconds_a_test(threads)
        nodes = tree(sample, setting, threads).nodes()
        return _tests(nodes.counts[nodes.is_leaf]) * seconds_a_test(threads)

    return expect


def _tests(counts: NDArray[np.integer[Any]]) -> float:
    """Return the number of pairs within each group, summed."""
    sizes = counts.astype(np.float64)
    return float((sizes * (sizes - 1) / 2).sum())


@cache
def seconds_a_test(threads: int | None) -> float:
    """Return the time of one of many tests: the best of three."""
    points = np.random.default_rng(0).random((RATE_SAMPLE, 2), np.float32)
    spent = []
    for _ in range(3):
        start = time.perf_counter()
        jostle.find_pairs(points, 0.0, method="brute", threads=threads)
        spent.append(time.perf_counter() - start)
    return min(spent) / _tests(np.array([RATE_SAMPLE]))
