"""`Index` with the calls and the answers of the package pyqtree, on a jostle quadtree.

Change ``from pyqtree import Index`` into ``from jostle.pyqtree import Index``; pyqtree itself is
not needed. Boxes that only touch intersect, as they do there.

A `Quadtree` never changes, so the index keeps what came since it was built in a short list that
each question reads through. Once that reading has taken as long as building, it builds anew.
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
# Up to so many boxes a loop in Python is quicker than NumPy.
_FEW = 24
# To build a box into a tree takes about as long as to read it so often.
_PATIENCE = 3


class Quad(NamedTuple):
    """A box of the tree, to look at.

    Attributes
    ----------
    center : tuple of float
        x and y of its middle.
    width, height : float
        Its size.
    """

    center: tuple[float, float]
    width: float
    height: float


class Index:
    """A spatial index of anything that has a bounding box.

    Give either `bbox` or all of `x`, `y`, `width` and `height`, as pyqtree wants it. They decide
    nothing here: a jostle tree finds its own bounds, and an item outside costs no more than one
    inside.

    Parameters
    ----------
    bbox : sequence of 4 numbers, optional
        min_x, min_y, max_x, max_y of the area.
    x, y : float, optional
        Its middle.
    width, height : float, optional
        Its size.
    max_items : int, default 10
    max_depth : int, default 20
        pyqtree's limits for a quad; jostle keeps to its own.

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
        # Items are numbered as they come; a number is never used again.
        self._next = 0
        self._items: dict[int, Any] = {}
        self._numbers: dict[_Box, list[int]] = {}
        # Not in the tree: what came since it was built, and what it could not hold exactly.
        self._recent: dict[int, _Box] = {}
        self._odd: dict[int, _Box] = {}
        self._read = 0  # boxes of `_recent` that questions have read since then
        self._built = _Built(np.empty(0, np.int64), np.empty((0, 4)))

    def insert(self, item: Any, bbox: Sequence[Any]) -> None:
        """Put an item into the index.

        Parameters
        ----------
        item : object
            Anything; it need not be hashable. The same object may come again, with the same
            box or another.
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
        """Take an item out of the index.

        Parameters
        ----------
        item : object
            The item, or what is equal to it. Of several the one that came first is removed.
        bbox : sequence of 4 numbers, or of 2
            The box that it was put in with.

        Raises
        ------
        ValueError
            If it is not in the index with this box.

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
        """Find the items whose boxes a box meets, edges included.

        Parameters
        ----------
        bbox : sequence of 4 numbers, or of 2
            Two opposite corners, or one point.

        Returns
        -------
        list
            The items in the order in which they came, each object once.

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
            return self._items_of(_meeting(self._boxes(), box))
        self._refresh(questions=1)
        return self._items_of(self._built.meeting(exact) + self._meeting_outside(exact))

    def intersect_many(self, bboxes: Iterable[Sequence[Any]]) -> list[list[Any]]:
        """Answer `intersect` for many boxes, on all cores.

        Parameters
        ----------
        bboxes : iterable of sequences of 4 numbers, or of 2
            One box for each question.

        Returns
        -------
        list of list
            What `intersect` would answer to each.

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
        self._refresh(questions=len(boxes))
        answers = self._built.meeting_each(exact)
        for numbers, box in zip(answers, exact, strict=True):
            numbers += self._meeting_outside(box)
        return list(map(self._items_of, answers))

    def __len__(self) -> int:
        """Count the items; one that was inserted twice counts twice."""
        return len(self._items)

    def __iter__(self) -> Iterator[Quad]:
        """Yield the quads below the outermost, as pyqtree does; the items are not among them."""
        self._rebuild()
        for min_x, min_y, max_x, max_y in self._built.tree.nodes().boxes[1:].tolist():
            middle = (min_x + max_x) / 2, (min_y + max_y) / 2
            yield Quad(middle, max_x - min_x, max_y - min_y)

    def __getstate__(self) -> dict[str, Any]:
        """Make copies and pickles possible: a tree is built anew from its boxes."""
        self._rebuild()
        return {**vars(self), "_built": (self._built.numbers, self._built.corners)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._built = _Built(*state["_built"])

    def _refresh(self, questions: int) -> None:
        """Build anew if that costs less than to go on without."""
        self._read += questions * len(self._recent)
        if self._read > _PATIENCE * len(self._items) or self._built.gone > len(self._items):
            self._rebuild()

    def _rebuild(self) -> None:
        """Take into the tree what came since it was built, and leave out what went."""
        if not self._recent and not self._built.gone:
            return
        numbers, corners = self._built.remaining()
        recent = np.array(list(self._recent.values()), np.float64).reshape(-1, 4)
        numbers = np.concatenate([numbers, np.fromiter(self._recent, np.int64)])
        self._built = _Built(numbers, np.concatenate([corners, recent]))
        self._recent, self._read = {}, 0

    def _meeting_outside(self, box: _Floats) -> list[int]:
        """Return the numbers of the boxes outside the tree that one meets."""
        found = _meeting(self._recent.items(), box) if self._recent else []
        return found + _meeting(self._odd.items(), box) if self._odd else found

    def _boxes(self) -> Iterator[tuple[int, _Box]]:
        return ((number, box) for box, numbers in self._numbers.items() for number in numbers)

    def _items_of(self, numbers: list[int]) -> list[Any]:
        """Return the items of some numbers as they came, each object once."""
        numbers.sort()
        items = self._items
        return list({id(item := items[number]): item for number in numbers}.values())


_Box: TypeAlias = tuple[Any, Any, Any, Any]
_Floats: TypeAlias = tuple[float, float, float, float]


def _box(bbox: Sequence[Any]) -> _Box:
    """Read a box as pyqtree does: two numbers are a point, corners come in either order."""
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
    """Return a box in float64, or None if that would round it or strain it."""
    try:
        x1, y1, x2, y2 = floats = tuple(map(float, box))
    except OverflowError:
        return None
    near = -_FAR <= x1 <= x2 <= _FAR and -_FAR <= y1 <= y2 <= _FAR
    return (x1, y1, x2, y2) if near and floats == box else None


def _same(item: Any, other: Any) -> bool:
    return item is other or bool(item == other)


def _meeting(boxes: Iterable[tuple[int, Any]], box: _Box) -> list[int]:
    """Return the numbers of the boxes that meet one, by looking at each."""
    x1, y1, x2, y2 = box
    return [
        number
        for number, (a1, b1, a2, b2) in boxes
        if a1 <= x2 and b1 <= y2 and a2 >= x1 and b2 >= y1
    ]


def _meets(boxes: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether each row meets the row, or the one row, of the others."""
    below = (boxes[:, :2] <= others[..., 2:]).all(axis=1)
    above = (boxes[:, 2:] >= others[..., :2]).all(axis=1)
    return cast("NDArray[np.bool_]", below & above)


class _Built:
    """A tree over numbered boxes; it answers which of them a box meets, edges included.

    A `Quadtree` knows the middle and the half size of a box, both perhaps rounded, and what only
    touches does not count there. So it is given half sizes a little too large, which never miss
    what meets, and whatever it finds is compared with the corners themselves.
    """

    def __init__(self, numbers: NDArray[np.int64], corners: NDArray[np.float64]) -> None:
        self.numbers = numbers  # ascending
        self.corners = corners  # NaN, which meets nothing, once removed
        self.gone = 0
        low, high = corners[:, :2], corners[:, 2:]
        middles = low / 2 + high / 2
        # The tree subtracts in the same way, and rounding never swaps two numbers: what meets a
        # side is at most this far from the middle, so the next larger number is beyond it.
        half_sizes = np.nextafter(np.maximum(high - middles, middles - low), np.inf)
        self.tree = Quadtree(middles, 0.0, half_sizes)

    def meeting(self, box: _Floats) -> list[int]:
        """Return the numbers of the boxes that one meets."""
        rows = self.tree.query_rect(box)
        numbers, corners = self.numbers[rows], self.corners[rows]
        if len(rows) > _FEW:
            return cast("list[int]", numbers[_meets(corners, np.array(box))].tolist())
        return _meeting(zip(numbers.tolist(), corners.tolist(), strict=True), box)

    def meeting_each(self, boxes: list[_Floats]) -> list[list[int]]:
        """Return the numbers of the boxes that each of some meets."""
        asked = np.array(boxes, np.float64).reshape(-1, 4)
        offsets, rows = self.tree.query_rect(asked)
        fits = _meets(self.corners[rows], asked.repeat(np.diff(offsets), axis=0))
        numbers = self.numbers[rows[fits]].tolist()
        ends = np.append(0, np.cumsum(fits))[offsets].tolist()
        return [numbers[start:end] for start, end in pairwise(ends)]

    def forget(self, number: int) -> None:
        """Answer a number no more."""
        self.corners[np.searchsorted(self.numbers, number)] = np.nan
        self.gone += 1

    def remaining(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the numbers and corners that were not removed."""
        stay = ~np.isnan(self.corners[:, 0])
        return self.numbers[stay], self.corners[stay]
