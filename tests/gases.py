"""Hard discs for tests: a lattice to start from, Maxwellian velocities, and a period.

Lengths are in radii, and the mean speed is 1: a step of `dt` is one of `dt` radii of mean
displacement.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Period = NDArray[np.float64] | None


def lattice(n: int, width: float, height: float) -> Floats:
    """Return n points of a triangular lattice that is periodic in the rectangle."""
    columns = max(1, round(math.sqrt(n * width / height * math.sqrt(3) / 2)))
    rows = 2 * math.ceil(n / columns / 2)
    k = np.arange(n)
    shift = np.where(k // columns % 2, 0.75, 0.25)
    return np.stack(
        [(k % columns + shift) * width / columns, (k // columns + 0.5) * height / rows], 1
    )


def random_velocities(n: int, rng: np.random.Generator) -> Floats:
    """Return Maxwellian velocities of mean speed 1 and total momentum 0, for equal masses."""
    velocities = rng.normal(size=(n, 2))
    velocities -= velocities.mean(axis=0)
    scaled: Floats = velocities * math.sqrt(4 / math.pi / (velocities**2).sum(axis=1).mean())
    return scaled


def henderson(eta: Any) -> Any:
    """Return the compressibility factor Z = P/(n kT) of hard discs.

    D. Henderson, *A simple equation of state for hard discs*, Molecular Physics 30 (1975).
    """
    return (1 + eta**2 / 8) / (1 - eta) ** 2


def period_of(n: int, eta: float) -> Floats:
    """Return the square period in which n discs of radius 1 cover the share eta of the area."""
    return np.full(2, np.float32(math.sqrt(n * math.pi / eta)), float)


def displacements(a: ArrayLike, b: ArrayLike, period: Period = None) -> Floats:
    """Return the vectors from positions b to positions a, with a period the minimum images."""
    d: Floats = np.asarray(a, float) - np.asarray(b, float)
    if period is not None:
        d -= period * np.rint(d / period)
    return d
