"""Overlapping pairs of shapes that are distributed over ranks."""

from __future__ import annotations

from typing import Any, SupportsIndex

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

import jostle

from .exchange import deliver, extremes, first_id, joined, send, together, totals
from .interrupts import collective
from .shares import Cells, Scale, cuts, morton_keys

#: Large shapes at most; all ranks know them.
_MOST_LARGE = 1024


@collective
def find_pairs(
    comm: MPI.Intracomm,
    positions: ArrayLike,
    radii: ArrayLike = 0.0,
    half_sizes: ArrayLike | None = None,
    *,
    categories: ArrayLike | None = None,
    masks: ArrayLike | None = None,
    distance: float = 0.0,
    period: float | tuple[float | None, float | None] | None = None,
    sort: bool = False,
    max_pairs: SupportsIndex = 134217728,
    threads: SupportsIndex | None = 1,
) -> NDArray[np.int64]:
    """Find every pair of overlapping shapes that are distributed over ranks.

    A collective call: each rank gives a share of the shapes, which may lie anywhere. The ids of
    the shapes count those of rank 0 first, then those of rank 1, and so on. All pairs together
    are those of `jostle.find_pairs` for all shapes in this order.

    Parameters
    ----------
    comm : mpi4py.MPI.Intracomm
        The ranks.
    positions : array_like, shape (n, 2)
        Centres of this rank's share, in any unit of length; n may be 0.
    radii : array_like, a number or shape (n,), default 0.0
        Radii, in the same unit.
    half_sizes : array_like, a number, shape (2,) or (n, 2), optional
        Half widths and half heights. If omitted, every shape is a circle.
    categories, masks : array_like of int, a number or shape (n,), optional
        As for `jostle.find_pairs`.
    distance : float, default 0.0
        Find pairs whose gap is below this; the same on all ranks.
    period : float or (float, float), optional
        Width and height of a periodic plane, as for `jostle.find_pairs`; the same on all ranks.
    sort : bool, default False
        Whether each rank sorts its pairs by the first, then by the second id.
    max_pairs : int, default 134217728
        Maximum number of pairs that one rank finds.
    threads : int, default 1
        Number of threads of each rank; None for all cores.

    Returns
    -------
    ndarray of int64, shape (m, 2)
        Ids ``i < j`` of the pairs that this rank has found. Each pair is on exactly one rank.

    Raises
    ------
    TypeError, ValueError
        As by `jostle.find_pairs`; indices are those in the share of the rank.
    RankError
        If the call fails on another rank.

    See Also
    --------
    jostle.find_pairs : The same in one process.

    Notes
    -----
    The shapes are sent to ranks by ranges of the Morton curve of their centres, so each rank gets
    about as many, wherever the shares lie. Then each rank receives the shapes near its own from the
    ranks before it. The largest shapes, 1024 at most, are sent to all ranks, and no rank receives
    all others because of them. Coincident centres are on one rank.

    Arithmetic is float32 if the arrays of all ranks are float32, as if they were one array.

    Examples
    --------
    >>> from mpi4py import MPI
    >>> import jostle.mpi
    >>> jostle.mpi.find_pairs(MPI.COMM_SELF, [(0, 0), (3, 0), (4, 0)], radii=1.0)
    array([[1, 2]])
    """
    with together(comm):
        share = _Share(positions, radii, half_sizes, categories, masks)
        share.check(distance, period)
    own = share.rows(comm)
    spread = _Spread(comm, own, float(distance), period)
    own = send(comm, own, spread.homes(own))
    is_large = spread.extents(own) > spread.limit
    large = joined(comm, own[is_large])
    small = own[~is_large]
    near = spread.near(small)
    with together(comm):
        everything = np.concatenate([small, near, large])
        found = jostle.find_pairs(
            np.ascontiguousarray(everything["center"]),
            np.ascontiguousarray(everything["radius"]),
            np.ascontiguousarray(everything["half_size"]),
            categories=np.ascontiguousarray(everything["category"]),
            masks=np.ascontiguousarray(everything["mask"]),
            distance=distance,
            period=period,
            max_pairs=max_pairs,
            threads=threads,
        )
        pairs = _own_pairs(found, everything["id"], len(small), len(near), own["id"][is_large])
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))] if sort else pairs


def _own_pairs(
    found: NDArray[np.int64],
    ids: NDArray[np.int64],
    small: int,
    near: int,
    own_large: NDArray[np.int64],
) -> NDArray[np.int64]:
    """The ids of the pairs that belong to this rank: those of an own small shape, and those of two
    large shapes of which the smaller id is its own."""
    pairs = np.sort(ids[found], axis=1)
    is_first_own = found.min(axis=1, initial=len(ids)) < small
    are_large = found.min(axis=1, initial=len(ids)) >= small + near
    own: NDArray[np.int64] = pairs[is_first_own | (are_large & np.isin(pairs[:, 0], own_large))]
    return own


class _Share:
    """The shapes that a rank is given."""

    def __init__(
        self,
        positions: ArrayLike,
        radii: ArrayLike,
        half_sizes: ArrayLike | None,
        categories: ArrayLike | None,
        masks: ArrayLike | None,
    ) -> None:
        self.given: list[Any] = [positions, radii, half_sizes]
        self.bits: dict[str, Any] = {"categories": categories, "masks": masks}
        self.centers = _numbers("positions", positions)
        if self.centers.size == 0:
            self.centers = self.centers.reshape(0, 2)

    def check(self, distance: float, period: Any) -> None:
        """Raise what `jostle.find_pairs` raises for this share."""
        positions, radii, half_sizes = self.given
        if len(self.centers) == 0:
            positions = np.zeros((0, 2))
        # The tree checks the columns of all shapes. The search, of none, checks the distance.
        jostle.Quadtree(positions, radii, half_sizes, period=period, **self.bits)
        jostle.find_pairs(np.zeros((0, 2)), distance=distance, period=period)

    def rows(self, comm: MPI.Intracomm) -> NDArray[Any]:
        """The shapes with their ids, in the precision of all ranks."""
        positions, radii, half_sizes = self.given
        arrays = [positions]
        arrays += [radii] if np.ndim(radii) > 0 else []
        arrays += [half_sizes] if np.ndim(half_sizes) > 1 or hasattr(half_sizes, "dtype") else []
        is_double = len(self.centers) > 0 and any(
            getattr(array, "dtype", None) != np.float32 for array in arrays
        )
        number = np.float64 if extremes(comm, np.array([float(is_double)]))[0] else np.float32
        count = len(self.centers)
        fields = [
            ("id", np.int64),
            ("center", number, 2),
            ("radius", number),
            ("half_size", number, 2),
            ("category", np.uint32),
            ("mask", np.uint32),
        ]
        rows = np.zeros(count, fields)
        rows["id"] = first_id(comm, count) + np.arange(count)
        rows["center"] = self.centers
        rows["radius"] = radii
        if half_sizes is not None and count > 0:  # those of an empty share may have any shape
            rows["half_size"] = half_sizes
        for name, bits, default in (
            ("category", self.bits["categories"], 1),
            ("mask", self.bits["masks"], 0xFFFFFFFF),
        ):
            rows[name] = default if bits is None else bits
        return rows


def _numbers(name: str, given: ArrayLike) -> NDArray[Any]:
    array = np.asarray(given)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{name} must hold real numbers, not {array.dtype}")
    return array


class _Spread:
    """How the shapes of all ranks are spread over the plane."""

    def __init__(
        self, comm: MPI.Intracomm, own: NDArray[Any], distance: float, period: Any
    ) -> None:
        self._comm = comm
        self._distance = distance
        pair = np.broadcast_to(np.array(period if period is not None else 0.0, object), 2)
        self._period = np.array([side or 0.0 for side in pair], np.float64)
        self._rounding = 16 * float(np.finfo(own["radius"].dtype).eps)
        centers = self._wrapped(own["center"])
        self._scales = [Scale(comm, numbers) for numbers in centers.T]
        self.limit = self._limit(own)
        self._cuts = cuts(comm, self._keys(own))

    def _wrapped(self, centers: NDArray[Any]) -> NDArray[np.float64]:
        centers = centers.astype(np.float64)
        for axis, side in enumerate(self._period):
            if side > 0:
                centers[:, axis] %= side
        return centers

    def _keys(self, rows: NDArray[Any]) -> NDArray[np.int64]:
        centers = self._wrapped(rows["center"])
        shares = zip(self._scales, centers.T, strict=True)
        return morton_keys([scale.shares(numbers) for scale, numbers in shares])

    def homes(self, rows: NDArray[Any]) -> NDArray[np.intp]:
        """The rank of each shape."""
        return np.searchsorted(self._cuts, self._keys(rows), side="right")

    def extents(self, rows: NDArray[Any]) -> NDArray[np.float64]:
        """Distances from the centre within which each shape is, along the longer side; rounding
        is included."""
        halves = rows["half_size"].astype(np.float64).max(axis=1, initial=0.0)
        sizes = halves + rows["radius"] + 0.5 * self._distance
        far = np.abs(rows["center"]).astype(np.float64).max(axis=1, initial=0.0)
        with np.errstate(over="ignore"):
            extents: NDArray[np.float64] = (
                sizes + (sizes + far + self._period.max()) * self._rounding
            )
        return extents

    def _limit(self, own: NDArray[Any]) -> float:
        """The largest extent of shapes that are not large: a power of two that few exceed, and
        several times that of most shapes."""
        _, exponents = np.frexp(np.maximum(self.extents(own), np.finfo(float).tiny))
        lowest, highest = -1030, 1030
        counts = np.bincount(exponents - lowest, minlength=highest - lowest)
        above = np.cumsum(totals(self._comm, counts.astype(np.int64))[::-1])[::-1]
        few, median = np.argmax(above <= _MOST_LARGE), np.argmax(above <= above[0] // 2)
        return float(np.ldexp(1.0, int(max(few, median + 2)) + lowest - 1))

    def near(self, small: NDArray[Any]) -> NDArray[Any]:
        """The small shapes of the ranks before this one that are near its own."""
        comm = self._comm
        extents = self.extents(small)
        largest = extremes(comm, np.array([extents.max(initial=0.0)]))[0]
        # A box is not wider than a cell, so its corners are in all cells that it overlaps.
        cells = Cells(self._scales, 2 * largest * (1 + self._rounding), self._period)
        corners = cells.corners(self._wrapped(small["center"]), extents)
        occupied = cells.ranks_of(comm, corners)
        parts = [small[:0]] * comm.size
        for rank in range(comm.rank + 1, comm.size):
            is_near = np.zeros(len(small), np.bool_)
            for numbers in corners:
                is_near |= occupied[rank][numbers]
            parts[rank] = small[is_near]
        return deliver(comm, parts)
