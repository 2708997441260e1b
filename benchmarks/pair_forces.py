"""A step of particle life with six kinds in jostle and in NumPy with SciPy's cKDTree.

    python benchmarks/pair_forces.py              1,000 to 100,000 particles
    python benchmarks/pair_forces.py 1000 5000    other numbers

Both begin with the same mixed particles and make the same steps with the same forces, on one
thread. The times are medians of alternating steps. The last column compares the velocities after
the first step.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator

import numpy as np
from machine import Row, describe
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from timing import clock

import jostle
from jostle import life

DT, CUTOFF, CORE, STRENGTH, DRAG = 1 / 60, 40.0, 0.3, 120.0, 10.0
AREA = 145.0  # for each particle: about 35 neighbours
KINDS = 6
ROUNDS = 7
COUNTS = (1_000, 10_000, 100_000)

Numbers = NDArray[np.float64]


class Plain:
    """Particle life as NumPy users write it: all pairs from a tree, then arrays."""

    def __init__(self, positions: Numbers, kinds: NDArray[np.int64], side: float) -> None:
        self.positions, self.kinds, self.side = positions.copy(), kinds, side
        self.velocities = np.zeros_like(positions)
        self.matrix = np.array(life.MATRICES["dragons"])

    def step(self) -> None:
        """Advance by one leapfrog step with the exact damping."""
        middle = (self.positions + self.velocities * DT / 2) % self.side
        i, j = cKDTree(middle, boxsize=self.side).query_pairs(CUTOFF, output_type="ndarray").T
        offset = middle[j] - middle[i]
        offset -= self.side * np.round(offset / self.side)
        distance = np.sqrt((offset**2).sum(axis=1))
        share = distance / CUTOFF
        pull = 1 - np.abs(2 * share - 1 - CORE) / (1 - CORE)
        along = offset / np.maximum(distance, 1e-12)[:, None]
        force = np.zeros_like(middle)
        for a, b, sign in ((i, j, 1.0), (j, i, -1.0)):
            by = np.where(
                share < CORE, share / CORE - 1, pull * self.matrix[self.kinds[a], self.kinds[b]]
            )
            for k in range(2):
                force[:, k] += np.bincount(a, sign * by * along[:, k], len(force))
        force *= STRENGTH
        decay = np.exp(-DRAG * DT)
        tau = (1 - decay) / DRAG
        before = (DT - tau) / DRAG / tau
        start = self.velocities + force * before
        self.positions = (self.positions + start * tau) % self.side
        self.velocities = start * decay + force * (tau - before * decay)


def world_of(positions: Numbers, kinds: NDArray[np.int64], side: float) -> jostle.World:
    """Return the same particles in jostle."""
    force = jostle.PairForce.particle_life(
        life.MATRICES["dragons"], CUTOFF, CORE, strength=STRENGTH
    )
    rules = {"on_touch": "ignore", "drag": DRAG, "forces": [force], "threads": 1}
    return jostle.World(positions, 2.0, masses=1.0, kinds=kinds, period=side, **rules)


def measure(n: int) -> Row:
    """Return a row of the results."""
    side = float(np.sqrt(n * AREA))
    positions, kinds = np.random.default_rng(0).uniform(0, side, (n, 2)), np.arange(n) % KINDS
    positions = positions.astype(np.float32).astype(float)
    plain, world = Plain(positions, kinds, side), world_of(positions, kinds, side)
    plain.step()
    world.step(DT)
    error = np.abs(plain.velocities - world.velocities).max() / np.abs(plain.velocities).max()
    rounds: list[tuple[Callable[[], None], list[float]]]
    rounds = [(lambda: world.step(DT), []), (plain.step, [])]
    for _ in range(ROUNDS):
        for step, times in rounds:
            times.append(1e3 * clock(step))
    ours, theirs = (float(np.median(times)) for _, times in rounds)
    ratio = float(np.median(np.array(rounds[1][1]) / np.array(rounds[0][1])))
    return {
        "count": n,
        "jostle_ms": f"{ours:.2f}",
        "numpy_ms": f"{theirs:.1f}",
        "ratio": f"{ratio:.0f}",
        "difference": f"{error:.0e}",
    }


def race(largest: int) -> Iterator[list[Row]]:
    """Yield the times of each number of particles."""
    for count in (count for count in COUNTS if count <= largest):
        yield [measure(count)]


if __name__ == "__main__":
    print(describe())
    print("| particles | jostle, ms | NumPy + cKDTree, ms | ratio | difference |")
    print("|--:|--:|--:|--:|--:|")
    for count in [int(word) for word in sys.argv[1:]] or COUNTS:
        print("|", " | ".join(map(str, measure(count).values())), "|", flush=True)
