"""`Index` with the calls and the answers of the package pyqtree, on a jostle quadtree.

Change ``from pyqtree import Index`` into ``from jostle.pyqtree import Index``; pyqtree itself is
not needed. Boxes that only touch intersect, as in pyqtree.

A `Quadtree` never changes, so items that are inserted later are in a list that each query reads.
When reading this list has taken as long as building a tree, the tree is built again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from jostle._core import Quadtree

__all__ = ["Index", "Quad"]

# Beyond this the width of a box might overflow.
_FAR = 1e300
# Up to this number of boxes a loop in Python is faster than NumPy.
_FEW = 24
# Building a box into a tree takes about as long as reading it this many times.
_READS_PER_BUILD = 3


class Quad(NamedTuple):
    """A box of the tree.

    Attributes
    ----------
    center : tuple of float
        Its centre, x and y.
    width, height : float
        Its size.
    """

    center: tuple[float, float]
    width: float
    height: float


class Index:
    """A spatial index of items with bounding boxes.

    As in pyqtree, either `bbox` or all of `x`, `y`, `width` and `height` are required. They have no
    effect: a jostle tree has no bounds, so items may be anywhere.

    Parameters
    ----------
    bbox : sequence of 4 numbers, optional
        Sides min_x, min_y, max_x, max_y of the area.
    x, y : float, optional
        Centre of the area.
    width, height : float, optional
        Size of the area.
    max_items : int, default 10
        Maximum number of items in a quad of pyqtree; no effect.
    max_depth : int, default 20
        Maximum depth of pyqtree's tree; no effect.

    Raises
    ------
    TypeError
        If neither `bbox` nor all of `x`, `y`, `width` and `height` are given.

    See Also
    --------
    jostle.Space : A dynamic index with arrays, ids and events.

    Examples
    --------
    >>> from jostle.pyqtree import Index
    >>> index = Index(bbox=(0, 0, 100, 100))
    >>> index.insert("duck", (50, 30, 53, 60))
    >>> index.insert("cookie", (10, 20, 15, 25))
    >>> index.insert("python", (40, 50, 95, 90))
    >>> index.intersect((51, 51, 86, 86))
    ['duck', 'python']
    """

    def __init__(
        self,
        bbox: Sequence[Any] | None = None,
        x: Any = None,
        y: Any = None,
        width: Any = None,
        height: Any = None,
        max_items: int = 10,
        max_depth: int = 20,
    ) -> None:
        if bbox is not None:
            x1, y1, x2, y2 = bbox
            width, height = abs(x2 - x1), abs(y2 - y1)
            x, y = x1 + width / 2.0, y1 + height / 2.0
        elif x is None or y is None or width is None or height is None:
            raise TypeError("give either bbox, or all of x, y, width and height")
        self.center = (x, y)
        self.width, self.height = width, height
        self.max_items, self.max_depth = max_items, max_depth
        # Items are numbered in the order of insertion; a number is never used again.
        self._next = 0
        self._items: dict[int, Any] = {}
        self._numbers: dict[_Box, list[int]] = {}
        # Not in the tree: boxes that were inserted since it was built, and boxes that float64
        # would round.
        self._recent: dict[int, _Box] = {}
        self._odd: dict[int, _Box] = {}
        self._read = 0  # boxes of `_recent` that queries have read since then
        self._built = _Built(np.empty(0, np.int64), np.empty((0, 4)))

    def insert(self, item: Any, bbox: Sequence[Any]) -> None:
        """Insert an item.

        Parameters
        ----------
        item : object
            Any object; it need not be hashable. It may be inserted again, with the same box or
            another.
        bbox : sequence of 4 numbers, or of 2
            Two opposite corners, or one point.

        Examples
        --------
        >>> index = Index(bbox=(0, 0, 9, 9))
        >>> index.insert("far outside", (100, 100, 90, 90))
        >>> index.intersect((0, 0, 90, 90))
        ['far outside']
        """
        box = _box(bbox)
        exact = _as_floats(box)
        if exact:
            self._recent[self._next] = exact
        else:
            self._odd[self._next] = box
        self._numbers.setdefault(box, []).append(self._next)
        self._items[self._next] = item
        self._next += 1

    def remove(self, item: Any, bbox: Sequence[Any]) -> None:
        """Remove an item.

        Parameters
        ----------
        item : object
            The item, or an equal object. If there are several, the first inserted one is removed.
        bbox : sequence of 4 numbers, or of 2
            The box with which it was inserted.

        Raises
        ------
        ValueError
            If the index does not contain the item with this box.

        Examples
        --------
        >>> index = Index(bbox=(0, 0, 9, 9))
        >>> index.insert("duck", (1, 1, 2, 2))
        >>> index.remove("duck", (1, 1, 2, 2))
        >>> index.intersect((0, 0, 9, 9))
        []
        """
        box = _box(bbox)
        numbers = self._numbers.get(box, [])
        number = next((n for n in numbers if _same(self._items[n], item)), None)
        if number is None:
            raise ValueError(f"{item!r} is not in the index with the box {box}")
        numbers.remove(number)
        if not numbers:
            del self._numbers[box]
        del self._items[number]
        if self._recent.pop(number, None) is None and self._odd.pop(number, None) is None:
            self._built.forget(number)

    def intersect(self, bbox: Sequence[Any]) -> list[Any]:
        """Find the items whose boxes overlap or touch a box.

        Parameters
        ----------
        bbox : sequence of 4 numbers, or of 2
            Two opposite corners, or one point.

        Returns
        -------
        list
            The items in the order of insertion, each object once.

        See Also
        --------
        intersect_many : The same for many boxes in one call.

        Examples
        --------
        >>> index = Index(bbox=(0, 0, 9, 9))
        >>> index.insert("left", (0, 0, 1, 1))
        >>> index.insert("right", (1, 0, 2, 1))
        >>> index.intersect((2, 0, 3, 1)), index.intersect((1, 1))
        (['right'], ['left', 'right'])
        """
        box = _box(bbox)
        exact = _as_floats(box)
        if exact is None:
            return self._items_of(_touching(self._boxes(), box))
        self._refresh(queries=1)
        return self._items_of(self._built.touching(exact) + self._touching_outside(exact))

    def intersect_many(self, bboxes: Iterable[Sequence[Any]]) -> list[list[Any]]:
        """Find the items of `intersect` for each of many boxes, on all cores.

        Parameters
        ----------
        bboxes : iterable of sequences of 4 numbers, or of 2
            One box for each query.

        Returns
        -------
        list of list
            The result of `intersect` for each box.

        Examples
        --------
        >>> index = Index(bbox=(0, 0, 9, 9))
        >>> index.insert("left", (0, 0, 1, 1))
        >>> index.insert("right", (1, 0, 2, 1))
        >>> index.intersect_many([(0, 0), (1, 1), (5, 5, 6, 6)])
        [['left'], ['left', 'right'], []]
        """
        boxes = [_box(bbox) for bbox in bboxes]
        exact = [floats for floats in map(_as_floats, boxes) if floats]
        if len(exact) < len(boxes):
            return [self.intersect(box) for box in boxes]
        self._refresh(queries=len(boxes))
        results = self._built.touching_each(exact)
        for numbers, box in zip(results, exact, strict=True):
            numbers += self._touching_outside(box)
        return list(map(self._items_of, results))

    def __len__(self) -> int:
        """Return the number of items; one that was inserted twice counts twice."""
        return len(self._items)

    def __iter__(self) -> Iterator[Quad]:
        """Yield the boxes of the tree except the root, without items, as pyqtree does."""
        self._rebuild()
        for min_x, min_y, max_x, max_y in self._built.tree.nodes().boxes[1:].tolist():
            center = (min_x + max_x) / 2, (min_y + max_y) / 2
            yield Quad(center, max_x - min_x, max_y - min_y)

    def __getstate__(self) -> dict[str, Any]:
        """Return the state for copies and pickles: the boxes, from which a tree is built again."""
        self._rebuild()
        return {**vars(self), "_built": (self._built.numbers, self._built.corners)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._built = _Built(*state["_built"])

    def _refresh(self, queries: int) -> None:
        """Build the tree again if that takes less time than the queries without it have taken."""
        self._read += queries * len(self._recent)
        too_many_reads = self._read > _READS_PER_BUILD * len(self._items)
        if too_many_reads or self._built.removed > len(self._items):
            self._rebuild()

    def _rebuild(self) -> None:
        """Build the tree again, with recent boxes and without removed ones."""
        if not self._recent and not self._built.removed:
            return
        numbers, corners = self._built.remaining()
        recent = np.array(list(self._recent.values()), np.float64).reshape(-1, 4)
        numbers = np.concatenate([numbers, np.fromiter(self._recent, np.int64)])
        self._built = _Built(numbers, np.concatenate([corners, recent]))
        self._recent, self._read = {}, 0

    def _touching_outside(self, box: _Floats) -> list[int]:
        """Return the numbers of boxes outside the tree that overlap or touch a box."""
        found = _touching(self._recent.items(), box) if self._recent else []
        return found + _touching(self._odd.items(), box) if self._odd else found

    def _boxes(self) -> Iterator[tuple[int, _Box]]:
        return ((number, box) for box, numbers in self._numbers.items() for number in numbers)

    def _items_of(self, numbers: list[int]) -> list[Any]:
        """Return the items of some numbers in the order of insertion, each object once."""
        numbers.sort()
        items = self._items
        return list({id(item := items[number]): item for number in numbers}.values())


_Box: TypeAlias = tuple[Any, Any, Any, Any]
_Floats: TypeAlias = tuple[float, float, float, float]


def _box(bbox: Sequence[Any]) -> _Box:
    """Return a box as pyqtree reads it: two numbers are a point, corners may be in any order."""
    if len(bbox) == 2:
        x1, y1 = x2, y2 = bbox
    else:
        x1, y1, x2, y2 = bbox
    if x1 > x2:
        x1, x2 = x2, x1
    if y1 > y2:
        y1, y2 = y2, y1
    return x1, y1, x2, y2


def _as_floats(box: _Box) -> _Floats | None:
    """Return a box in float64, or None if that would round it or could overflow."""
    try:
        x1, y1, x2, y2 = floats = tuple(map(float, box))
    except OverflowError:
        return None
    near = -_FAR <= x1 <= x2 <= _FAR and -_FAR <= y1 <= y2 <= _FAR
    return (x1, y1, x2, y2) if near and floats == box else None


def _same(item: Any, other: Any) -> bool:
    return item is other or bool(item == other)


def _touching(boxes: Iterable[tuple[int, Any]], box: _Box) -> list[int]:
    """Return the numbers of the boxes that overlap or touch a box, by brute force."""
    x1, y1, x2, y2 = box
    return [
        number
        for number, (a1, b1, a2, b2) in boxes
        if a1 <= x2 and b1 <= y2 and a2 >= x1 and b2 >= y1
    ]


def _touches(boxes: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether each box overlaps or touches its row of the others, or the only row."""
    below = (boxes[:, :2] <= others[..., 2:]).all(axis=1)
    above = (boxes[:, 2:] >= others[..., :2]).all(axis=1)
    return cast("NDArray[np.bool_]", below & above)


class _Built:
    """A tree over numbered boxes, for queries in which boxes that touch count.

    In a `Quadtree` boxes that only touch do not overlap, and centres and half sizes are rounded. So
    the tree has half sizes that are slightly too large, and the corners decide about its results.
    """

    def __init__(self, numbers: NDArray[np.int64], corners: NDArray[np.float64]) -> None:
        self.numbers = numbers  # ascending
        self.corners = corners  # of a removed box: NaN, with which all comparisons are false
        self.removed = 0
        low, high = corners[:, :2], corners[:, 2:]
        centers = low / 2 + high / 2
        # The tree computes the same differences, and rounding is monotone: a box that touches a
        # side is at most this far from the centre, so the next larger number is beyond it.
        half_sizes = np.nextafter(np.maximum(high - centers, centers - low), np.inf)
        self.tree = Quadtree(centers, 0.0, half_sizes)

    def touching(self, box: _Floats) -> list[int]:
        """Return the numbers of the boxes that overlap or touch a box."""
        rows = self.tree.query_rect(box)
        numbers, corners = self.numbers[rows], self.corners[rows]
        if len(rows) > _FEW:
            return cast("list[int]", numbers[_touches(corners, np.array(box))].tolist())
        return _touching(zip(numbers.tolist(), corners.tolist(), strict=True), box)

    def touching_each(self, boxes: list[_Floats]) -> list[list[int]]:
        """Return, for each of many boxes, the numbers of the boxes that overlap or touch it."""
        queries = np.array(boxes, np.float64).reshape(-1, 4)
        found = self.tree.query_rect(queries)
        rows, offsets = found.ids, found.offsets
        fits = _touches(self.corners[rows], queries.repeat(found.counts, axis=0))
        numbers = self.numbers[rows[fits]].tolist()
        ends = np.append(0, np.cumsum(fits))[offsets].tolist()
        return [numbers[start:end] for start, end in pairwise(ends)]

    def forget(self, number: int) -> None:
        """Remove a number from the results."""
        self.corners[np.searchsorted(self.numbers, number)] = np.nan
        self.removed += 1

    def remaining(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the numbers and corners that were not removed."""
        remain = ~np.isnan(self.corners[:, 0])
        return self.numbers[remain], self.corners[remain]
