"""Scenes for the search of pairs: seeded, of any size, as plain arrays.

Every number is a float32 stored as float64, so all libraries get the same shapes in any precision.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

__all__ = ["SCENES", "Floats", "Shapes", "create"]

Floats = NDArray[np.float64]

COVERAGE = 0.4
"""Fraction of the area that the shapes cover."""


@dataclass(frozen=True)
class Shapes:
    """Discs, or rectangles if `half_sizes` is given.

    `radii` is one number for equal discs and a column otherwise.
    """

    scene: str
    centers: Floats
    radii: float | Floats
    half_sizes: Floats | None = None

    def __len__(self) -> int:
        return len(self.centers)

    @property
    def equal(self) -> bool:
        """Whether they are discs of one radius."""
        return self.half_sizes is None and isinstance(self.radii, float)

    def column(self) -> Floats:
        """Return a radius for each shape."""
        return np.broadcast_to(np.asarray(self.radii, np.float64), (len(self),))

    def boxes(self) -> Floats:
        """Return min_x, min_y, max_x and max_y of each shape."""
        reach = self.column()[:, None] if self.half_sizes is None else self.half_sizes
        return np.hstack([self.centers - reach, self.centers + reach])

    def bounds(self) -> tuple[float, float, float, float]:
        """Return bounds of all shapes, with a margin."""
        boxes = self.boxes()
        low, high = boxes[:, :2].min(axis=0) - 1.0, boxes[:, 2:].max(axis=0) + 1.0
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def create(scene: str, count: int, seed: int = 0) -> Shapes:
    """Make a scene of `count` shapes.

    Examples
    --------
    >>> import shapes
    >>> [len(shapes.create(name, 50)) for name in shapes.SCENES]
    [50, 50, 50, 50, 50]
    """
    return SCENES[scene](count, np.random.default_rng(seed))


def discs(count: int, random: Generator) -> Shapes:
    """Equal discs, uniform over a square, of which they cover 40 %."""
    side = np.sqrt(count * np.pi * 0.25 / COVERAGE)
    return Shapes("discs", _single(random.random((count, 2)) * side), 0.5)


def mixed(count: int, random: Generator) -> Shapes:
    """Radii from 1 to 100, mostly small, every octave covering the same area."""
    quantiles = (np.arange(count) + 0.5) / count
    radii = _single(random.permutation(1 / np.sqrt(1 - quantiles * (1 - 1e-4))))
    side = np.sqrt(np.pi * float(np.sum(radii**2)) / COVERAGE)
    return Shapes("mixed", _single(random.random((count, 2)) * side), radii)


def clusters(count: int, random: Generator) -> Shapes:
    """Twelve Gaussian clusters of equal discs, with densities from 1 to 1/1000.

    The world is twenty times as wide as the widest cluster.
    """
    kinds = 12
    coverages = np.geomspace(2.0, 0.002, kinds)
    widths = np.sqrt(0.25 * count / kinds / (4 * coverages))
    middles = random.random((kinds, 2)) * 20 * widths[-1]
    which = np.arange(count) % kinds
    places = middles[which] + random.standard_normal((count, 2)) * widths[which, None]
    return Shapes("clusters", _single(places), 0.5)


def rectangles(count: int, random: Generator) -> Shapes:
    """Rectangles with sides from 1 to 50, uniform in the logarithm."""
    half_sizes = _single(0.5 * 50 ** random.random((count, 2)))
    side = np.sqrt(4 * float(np.sum(np.prod(half_sizes, axis=1))) / COVERAGE)
    return Shapes("rectangles", _single(random.random((count, 2)) * side), 0.0, half_sizes)


def points(count: int, random: Generator) -> Shapes:
    """Points of the unit square with a distance below 2 / sqrt(count): 0.002 for a million."""
    radius = float(np.float32(1.0 / np.sqrt(count)))
    return Shapes("points", _single(random.random((count, 2))), radius)


SCENES: dict[str, Callable[[int, Generator], Shapes]] = {
    make.__name__: make for make in (discs, mixed, clusters, rectangles, points)
}


def _single(values: Floats) -> Floats:
    return values.astype(np.float32).astype(np.float64)
