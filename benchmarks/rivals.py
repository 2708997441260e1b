"""The ways to find all overlapping pairs of equal discs that are compared.

A rival is a function of (centers (n, 2) float64, radius) that returns the pairs as
an (m, 2) array, with everything it needs to build inside the call.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import jostle

Pairs = NDArray[np.integer]
Find = Callable[[NDArray[np.float64], float], Pairs]


@dataclass(frozen=True)
class Rival:
    """One way, under the name and version that the results give it."""

    name: str
    version: str
    find: Find
    most: int
    """Largest number of discs that it finishes in reasonable time."""


def ours(threads: int) -> Find:
    """Our tree in float32, the arithmetic that games and simulations use."""

    def find(centers: NDArray[np.float64], radius: float) -> Pairs:
        single = centers.astype(np.float32)
        return jostle.find_pairs(single, radius, method="quadtree", threads=threads)

    return find


def ours_exact(centers: NDArray[np.float64], radius: float) -> Pairs:
    """Our tree in float64, bit for bit what brute force in float64 answers."""
    return jostle.find_pairs(centers, radius, method="quadtree", threads=1)


def brute(centers: NDArray[np.float64], radius: float) -> Pairs:
    """Our brute force, the oracle."""
    return jostle.find_pairs(centers, radius, method="brute", threads=1)


def scipy_tree(*, quick_build: bool) -> Find:
    """SciPy's k-d tree; `quick_build` gives up balance and tight nodes for build time."""

    def find(centers: NDArray[np.float64], radius: float) -> Pairs:
        balance = not quick_build
        tree = cKDTree(centers, balanced_tree=balance, compact_nodes=balance)
        return tree.query_pairs(2 * radius, output_type="ndarray")

    return find


RIVALS = [
    Rival("jostle, 1 thread", jostle.__version__, ours(1), 10_000_000),
    Rival("jostle, 2 threads", jostle.__version__, ours(2), 10_000_000),
    Rival("jostle, float64, 1 thread", jostle.__version__, ours_exact, 10_000_000),
    Rival("jostle, brute force", jostle.__version__, brute, 10_000),
    Rival("SciPy cKDTree", scipy.__version__, scipy_tree(quick_build=False), 1_000_000),
    Rival("SciPy cKDTree, quick build", scipy.__version__, scipy_tree(quick_build=True), 1_000_000),
]
