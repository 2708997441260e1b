"""Expected pairs: the formula for overlap over all pairs, in plain NumPy.

Also hard cases of shapes: coincident, touching, nested, collinear, on the borders of cells, huge
and tiny ones together, and very far ones.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

DTYPES = [np.float32, np.float64]
ALL_BITS = 0xFFFFFFFF
Bits = NDArray[Any]


class Shapes(NamedTuple):
    """Arguments for `find_pairs` and `Quadtree`, all of one dtype."""

    centers: NDArray[Any]
    radii: NDArray[Any]
    half_sizes: NDArray[Any] | None

    def take(self, rows: NDArray[Any]) -> Shapes:
        """Return some of the shapes, in that order."""
        half_sizes = None if self.half_sizes is None else self.half_sizes[rows]
        return Shapes(self.centers[rows], self.radii[rows], half_sizes)

    def distinct(self) -> Shapes:
        """Return every shape once."""
        columns = [self.centers, self.radii[:, None]]
        if self.half_sizes is not None:
            columns.append(self.half_sizes)
        return self.take(np.sort(np.unique(np.hstack(columns), axis=0, return_index=True)[1]))


def open_overlap(gap: NDArray[Any], reach: NDArray[Any]) -> NDArray[np.bool_]:
    """Return whether cores with these gaps along the axes are nearer than `reach`, or overlap."""
    outside = np.maximum(gap, 0)
    near = outside[..., 0] ** 2 + outside[..., 1] ** 2 < reach**2
    return near | (gap < 0).all(axis=-1)


def overlap(a: Shapes, b: Shapes) -> NDArray[np.bool_]:
    """Return which shapes overlap; the columns of the two are broadcast."""
    with np.errstate(over="ignore", under="ignore"):
        distance = np.abs(a.centers - b.centers)
        if a.half_sizes is not None or b.half_sizes is not None:
            halves = [np.zeros_like(s.centers) if s[2] is None else s[2] for s in (a, b)]
            distance = distance - (halves[0] + halves[1])
        return open_overlap(distance, a.radii + b.radii)


def overlaps(a: Shapes, b: Shapes) -> NDArray[np.bool_]:
    """Return for each shape of `a` (a row) whether it overlaps each of `b` (a column)."""
    rows = Shapes(*(None if column is None else column[:, None] for column in a))
    columns = Shapes(*(None if column is None else column[None] for column in b))
    return overlap(rows, columns)


def may_pair(
    categories_a: Bits, masks_a: Bits, categories_b: Bits, masks_b: Bits
) -> NDArray[np.bool_]:
    """Return for each row and column whether the filters allow the pair."""
    forth = categories_a[:, None] & masks_b[None]
    back = categories_b[None] & masks_a[:, None]
    return (forth != 0) & (back != 0)


def pairs_within(shapes: Shapes, allowed: NDArray[np.bool_] | None = None) -> NDArray[np.intp]:
    """Return the pairs i < j, sorted."""
    hits = overlaps(shapes, shapes)
    if allowed is not None:
        hits &= allowed
    return np.argwhere(np.triu(hits, k=1))


def pairs_between(
    a: Shapes, b: Shapes, allowed: NDArray[np.bool_] | None = None
) -> NDArray[np.intp]:
    """Return the pairs (row of a, row of b), sorted."""
    hits = overlaps(a, b)
    if allowed is not None:
        hits &= allowed
    return np.argwhere(hits)


def by_row(pairs: NDArray[Any]) -> NDArray[Any]:
    """Return pairs sorted by first, then by second."""
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


# Small integers, and even more powers of two, touch, coincide and are on the borders of cells.
_borders = st.one_of(
    st.integers(-8, 8).map(float),
    st.integers(-20, 20).map(lambda k: 2.0**k),
    st.integers(-20, 20).map(lambda k: -(2.0**k)),
)
_anywhere = st.floats(-100, 100, width=32)
_extreme = st.sampled_from([1e30, -1e30, 1e-30, -1e-30, 0.0, -0.0, 1e15, -1e15])
coordinates = st.one_of(_borders, _anywhere, _extreme)
sizes = st.one_of(
    st.integers(0, 4).map(lambda k: k / 2),
    st.floats(2**-59, 20, width=32),  # below it float32 has no radii but 0
    st.sampled_from([0.0, 1e-6, 1e6, 2e-18, 1e15]),
)


@st.composite
def few_shapes(draw: st.DrawFn, dtype: Any = None, boxes: bool | None = None) -> Shapes:
    """Up to 40 shapes, each number drawn independently."""
    dtype = draw(st.sampled_from(DTYPES)) if dtype is None else dtype
    boxes = draw(st.booleans()) if boxes is None else boxes
    shape = st.tuples(coordinates, coordinates, sizes, sizes, sizes)
    rows = np.array(draw(st.lists(shape, max_size=40)), np.float64).reshape(-1, 5).astype(dtype)
    return Shapes(rows[:, :2], rows[:, 2], rows[:, 3:] if boxes else None)


def _with_outliers(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    centers = rng.uniform(0, 1, (n, 2)) * np.sqrt(n)
    centers[: n // 50 + 1] = rng.choice([-1e30, 1e30, 1e7, -1e7], (n // 50 + 1, 2))[:n]
    return centers


ARRANGEMENTS: dict[str, Callable[[np.random.Generator, int], NDArray[Any]]] = {
    "uniform": lambda rng, n: rng.uniform(0, np.sqrt(n), (n, 2)),
    "on a line": lambda rng, n: np.outer(rng.uniform(0, n, n), rng.choice([0.0, 1.0, -2.0], 2)),
    "on a grid": lambda rng, n: rng.integers(0, max(1, int(np.sqrt(n))), (n, 2)).astype(float),
    "coincident": lambda rng, n: np.tile(rng.uniform(-5, 5, 2), (n, 1)),
    # Points that converge to one point, so that every subdivision leaves most in one quarter.
    "nested": lambda rng, n: rng.choice([-1.0, 1.0], (n, 2)) * 0.5 ** rng.uniform(0, 60, (n, 1)),
    "clusters": lambda rng, n: (
        rng.uniform(-1e6, 1e6, (5, 2))[rng.integers(0, 5, n)] + rng.normal(size=(n, 2))
    ),
    "with outliers": _with_outliers,
}


@st.composite
def many_shapes(draw: st.DrawFn, dtype: Any = None, boxes: bool | None = None) -> Shapes:
    """Up to 400 shapes: enough for a tree of several levels."""
    dtype = draw(st.sampled_from(DTYPES)) if dtype is None else dtype
    boxes = draw(st.booleans()) if boxes is None else boxes
    n = draw(st.integers(0, 400))
    arrange = ARRANGEMENTS[draw(st.sampled_from(sorted(ARRANGEMENTS)))]
    spread = draw(st.sampled_from(["none", "equal", "some", "huge and tiny"]))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = {
        "none": lambda *shape: np.zeros(shape),
        "equal": lambda *shape: np.full(shape, 0.5),
        "some": lambda *shape: rng.uniform(0, 1, shape),
        "huge and tiny": lambda *shape: 10 ** rng.uniform(-6, 6, shape) * rng.integers(0, 2, shape),
    }[spread]
    centers = arrange(rng, n) + rng.choice([0.0, -1000.0])
    half_sizes = size(n, 2).astype(dtype) if boxes else None
    return Shapes(centers.astype(dtype), size(n).astype(dtype), half_sizes)


def any_shapes(dtype: Any = None, boxes: bool | None = None) -> st.SearchStrategy[Shapes]:
    """Few or many shapes."""
    return few_shapes(dtype, boxes) | many_shapes(dtype, boxes)


def uniform(n: int, dtype: Any = np.float64, seed: int = 0) -> NDArray[Any]:
    """Centres of n discs of radius 0.5 that cover 40 % of a square."""
    side = np.sqrt(n * np.pi * 0.25 / 0.4)
    return np.random.default_rng(seed).uniform(0, side, (n, 2)).astype(dtype)
