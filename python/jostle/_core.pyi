"""The compiled part of jostle; `help` on each name tells more."""

import math
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import (
    Any,
    Final,
    Literal,
    Protocol,
    SupportsFloat,
    SupportsIndex,
    TypeAlias,
    final,
    overload,
)

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray
from typing_extensions import Self

from jostle.results import (
    Contacts,
    GaltonBoard,
    Hits,
    Neighbors,
    Nodes,
    Nozzle,
    RayHit,
    RayHits,
    Stats,
)

__all__ = [
    "Attractor",
    "Box",
    "Circle",
    "Events",
    "Gravitation",
    "Quadtree",
    "Space",
    "Springs",
    "Thermostat",
    "Torus",
    "World",
    "__version__",
    "abandon_threads",
    "create_scene",
    "describe_scene",
    "find_pairs",
    "scene_default_count",
    "scene_fountains",
    "scene_galton_board",
    "scene_names",
    "scene_view",
    "scene_wall",
    "sprite_dict",
    "sprite_pairs",
    "sprite_sides",
]

__version__: Final[str]

_Number: TypeAlias = SupportsFloat | SupportsIndex

class _Vector(Protocol):
    """Two numbers with names, such as a vector of pygame."""

    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...

class _Rect(Protocol):
    """A rectangle that knows its sides, such as one of pygame."""

    @property
    def left(self) -> float: ...
    @property
    def top(self) -> float: ...
    @property
    def right(self) -> float: ...
    @property
    def bottom(self) -> float: ...

class _Array(Protocol):
    """An array, or what NumPy makes one of, such as a table of pandas; a number is none."""

    def __array__(self) -> NDArray[Any]: ...
    def __len__(self) -> int: ...

# One or many: a query given one point answers `RayHit` or an array of ids, given many `RayHits` or
# `Hits`. Its overloads stand in this order, in which mypy and pyright choose alike:
#
# 1. One: a tuple or a vector. A tuple of two values of type Any is one.
# 2. Many: an array, or a sequence of anything but numbers. A list of values of type Any is many.
# 3. One: any other sequence of numbers.
# 4. An argument of type Any, which matches every overload. mypy then answers Any; pyright does so
#    only if the last result is a union with Any, else strict mode reports an unknown type.
#
# Type checkers rarely know how many dimensions an array has, so an array is many. A point that is
# an array is passed as `tuple(array)`.
@final
class _Undecided:
    """Stands for an argument of type Any; no value has this type."""

# `_Number` does not do where a number is told from an array, which has `__float__` and `__index__`.
_Real: TypeAlias = float | np.floating[Any] | np.integer[Any]
_Id: TypeAlias = int | np.integer[Any]
_Reals: TypeAlias = _Array | Sequence[_Real]
_IdList: TypeAlias = _Array | Sequence[_Id]
_Point: TypeAlias = tuple[_Real, _Real] | _Vector
_Points: TypeAlias = _Array | Sequence[Sequence[_Real] | _Vector | _Array]
_AnyPoint: TypeAlias = _Point | Sequence[_Real]
_OneOrMorePoints: TypeAlias = _AnyPoint | _Points
_Vectors: TypeAlias = ArrayLike | _Vector | Sequence[_Vector]
_Boxes: TypeAlias = ArrayLike | Sequence[_Rect]
_Ids: TypeAlias = NDArray[np.int64]
_Pairs: TypeAlias = NDArray[np.int64]
_Container: TypeAlias = Box | Circle | Torus
_Force: TypeAlias = Attractor | Gravitation | Springs | Thermostat

def abandon_threads() -> None:
    """Forgets the threads of the process that this one was forked from."""

def find_pairs(
    centers: _Vectors | None = None,
    radii: ArrayLike = 0.0,
    half_sizes: ArrayLike | None = None,
    *,
    boxes: _Boxes | None = None,
    method: Literal["auto", "brute", "quadtree"] = "auto",
    sort: bool = False,
    max_pairs: SupportsIndex = 134217728,
    threads: SupportsIndex | None = None,
) -> _Pairs:
    """Find every pair of overlapping shapes.

    A shape is a rounded box: every point within `radius` of its core, the axis-aligned box
    ``center ± half_size`` or one of `boxes`. Circles have no half size, rectangles no radius.
    Touching is not overlapping.

    Parameters
    ----------
    centers : array_like, shape (n, 2), optional
        Centres, in any unit of length; to be given unless `boxes` is.
    radii : array_like, a number or shape (n,), default 0.0
        Radii, in the same unit.
    half_sizes : array_like, a number, shape (2,) or (n, 2), optional
        Half widths and half heights. Left out, every shape is a circle.
    boxes : array_like, shape (n, 4), optional
        min_x, min_y, max_x, max_y of each shape, in place of `centers` and `half_sizes`.
        What has the attributes `left`, `top`, `right` and `bottom`, as pygame's Rect, is
        read by them, in a list or a tuple. The four numbers are compared as they are:
        boxes that share an edge never overlap, while sides that are
        ``center ± half_size`` are rounded. With `radii`, the boxes are rounded by them.
    method : {"auto", "brute", "quadtree"}, default "auto"
        How the pairs are found, never which: "auto" takes brute force where that
        is faster.
    sort : bool, default False
        Whether to sort the pairs by first, then by second shape. Without, their
        order says nothing.
    max_pairs : int, default 134217728
        The most pairs to return; the default is two gibibytes of them.
    threads : int, optional
        How many threads work, at most one for each core, which is the default. The answer is the
        same for every number.

    Returns
    -------
    ndarray of int64, shape (m, 2)
        Row numbers ``i < j`` of each pair, every pair once.

    Raises
    ------
    TypeError
        If an argument does not hold numbers, or if not exactly one of `centers` and `boxes`
        is given.
    ValueError
        If a shape is wrong, a value is not finite, a size is negative or out of range, or
        more than `max_pairs` pairs overlap.
    MemoryError
        If there is no memory for the pairs.

    Notes
    -----
    Arithmetic is float32 if every array given is float32, else float64. A plain
    number, or a plain pair of half sizes, takes the precision of the arrays
    beside it.

    Centres may lie anywhere. A radius is 0, or between 1e-18 and 1e18 in float32 and between
    1e-150 and 1e150 in float64: squares of other numbers overflow or lose digits. A half size
    is at most an eighth of the largest number of the type, a box at most twice as wide and
    high as that.

    Examples
    --------
    >>> import jostle
    >>> jostle.find_pairs([(0, 0), (3, 0), (4, 0)], radii=1.0)
    array([[1, 2]])
    >>> jostle.find_pairs(boxes=[(0, 0, 0.1, 1), (0.1, 0, 0.3, 1), (0.2, 0, 0.4, 1)])
    array([[1, 2]])
    """

def sprite_pairs(
    left: list[Any],
    right: list[Any] | None,
    rule: Literal["rect", "rects", "circle", "mask", "within"],
    scale: float,
    types: tuple[type, type],
    radius_of: Callable[[Any], float] | None = None,
) -> tuple[NDArray[np.uint32], NDArray[np.bool_] | None] | None:
    """Find which sprites collide.

    Parameters
    ----------
    left, right : list
        Sprites. None for `right` asks for the pairs i < j within `left`.
    rule : {"rect", "rects", "circle", "mask", "within"}
        "rect" is `collide_rect` and its ratio, "circle" `collide_circle` and its ratio;
        "rects" is "rect" for lists of rectangles instead of sprites. No pair of "mask" and
        "within" is sure: "mask" finds masks that may overlap, "within" rectangles that
        collide or are at most `scale` apart along each axis.
    scale : float
        Factor for rectangles or radii, 1.0 leaves them as they are; of "within" the gap.
    types : tuple of type
        `pygame.Rect` and `pygame.FRect`.
    radius_of : callable, optional
        Is asked for the radius of a sprite that has none.

    Returns
    -------
    tuple of ndarray of uint32, shape (m, 2), and ndarray of bool, shape (m,), or None
        Rows of `left` and of `right`, sorted, and whether each pair is sure; None where
        all are. None altogether where only pygame itself can tell.
    """

def sprite_sides(sprites: list[Any], types: tuple[type, type]) -> NDArray[np.float64] | None:
    """Read the rects of sprites.

    Parameters
    ----------
    sprites : list
        Sprites.
    types : tuple of type
        `pygame.Rect` and `pygame.FRect`.

    Returns
    -------
    ndarray of float64, shape (n, 4)
        x, y, width and height as they are; None where a rect is something of its own.
    """

def sprite_dict(
    pairs: NDArray[np.uint32], keys: list[Any], values: list[Any]
) -> dict[Any, list[Any]]:
    """Put together what belongs to each first row of some sorted pairs.

    Parameters
    ----------
    pairs : ndarray of uint32, shape (m, 2)
        Sorted by first.
    keys, values : list
        What the first and the second rows stand for.

    Returns
    -------
    dict of key to list of value
        What `groupcollide` answers for these pairs.
    """

@final
class Quadtree:
    """A quadtree over shapes that do not change.

    A shape is a rounded box: every point within `radius` of its core, the axis-aligned box
    ``center ± half_size`` or one of `boxes`. Circles have no half size, rectangles no radius. The
    tree is built once, around whatever positions it is given; there are no bounds
    to choose. Several threads may ask it at the same time.

    Parameters
    ----------
    centers : array_like, shape (n, 2), optional
        Centres, in any unit of length; to be given unless `boxes` is.
    radii : array_like, a number or shape (n,), default 0.0
        Radii, in the same unit.
    half_sizes : array_like, a number, shape (2,) or (n, 2), optional
        Half widths and half heights. Left out, every shape is a circle.
    boxes : array_like, shape (n, 4), optional
        min_x, min_y, max_x, max_y of each shape, in place of `centers` and `half_sizes`.
        What has the attributes `left`, `top`, `right` and `bottom`, as pygame's Rect, is
        read by them, in a list or a tuple. The four numbers are compared as they are:
        boxes that share an edge never overlap, while sides that are
        ``center ± half_size`` are rounded. With `radii`, the boxes are rounded by them.
    categories : array_like of int, a number or shape (n,), optional
        What each shape is, as a set of 32 bits; 1 where left out.
    masks : array_like of int, a number or shape (n,), optional
        What each shape may pair with, as a set of 32 bits; all of them where left
        out. Shapes i and j may pair only if both ``categories[i] & masks[j]`` and
        ``categories[j] & masks[i]`` have a bit. A negative integer stands for its low 32
        bits, so ``masks=~SHIP`` is every category but SHIP. Of a uint8 or uint16 array ``~``
        gives no bits above the 8th or 16th.
    leaf_capacity : int, default 96
        Shapes that a box may hold before it splits into four.
    max_depth : int, default 4096
        Subdivisions allowed: 0 keeps everything in one box, 2 allows two. The
        default never stops a split.
    threads : int, optional
        How many threads work, at most one for each core, which is the default. Every answer is
        the same for every number.

    Raises
    ------
    TypeError
        If an argument does not hold numbers, or if not exactly one of `centers` and `boxes`
        is given.
    ValueError
        If a shape is wrong, a value is not finite, or a size or a setting is out of range.

    Notes
    -----
    Arithmetic is float32 if every array given is float32, else float64. A plain
    number, or a plain pair of half sizes, takes the precision of the arrays
    beside it.

    Centres may lie anywhere. A radius is 0, or between 1e-18 and 1e18 in float32 and between
    1e-150 and 1e150 in float64: squares of other numbers overflow or lose digits. A half size
    is at most an eighth of the largest number of the type, a box at most twice as wide and
    high as that.

    Examples
    --------
    >>> import jostle
    >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
    >>> tree.pairs()
    array([[1, 2]])
    >>> tree.stats
    Stats(nodes=1, leaves=1, depth=0, tests=3)
    """

    def __new__(
        cls,
        centers: _Vectors | None = None,
        radii: ArrayLike = 0.0,
        half_sizes: ArrayLike | None = None,
        *,
        boxes: _Boxes | None = None,
        categories: ArrayLike | None = None,
        masks: ArrayLike | None = None,
        leaf_capacity: SupportsIndex = 96,
        max_depth: SupportsIndex = 4096,
        threads: SupportsIndex | None = None,
    ) -> Self: ...
    def pairs(
        self,
        other: Quadtree | None = None,
        *,
        sort: bool = False,
        max_pairs: SupportsIndex = 134217728,
        mask: SupportsIndex | None = None,
    ) -> _Pairs:
        """Find every pair of overlapping shapes in this tree, or between it and another.

        Parameters
        ----------
        other : Quadtree, optional
            A tree of the same dtype. Left out, the pairs are those within this tree, ``i < j``.
            This tree given as `other` is treated as any other tree: each pair comes in both
            orders, and each shape of some size pairs with itself.
        sort : bool, default False
            Whether to sort the pairs by first, then by second shape. Without, they
            come in the order of this tree, the same for every number of threads.
        max_pairs : int, default 134217728
            The most pairs to return; the default is two gibibytes of them.
        mask : int, optional
            Find only pairs of which both have a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m, 2)
            Row numbers ``i < j`` of each pair, every pair once; with `other`, i is
            a row of this tree and j a row of the other.

        Raises
        ------
        TypeError
            If the dtypes of the two trees differ.
        ValueError
            If more than `max_pairs` pairs overlap.

        Examples
        --------
        >>> import jostle
        >>> rocks = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> shots = jostle.Quadtree([(0.5, 0), (9, 0)], radii=0.1)
        >>> rocks.pairs(shots)
        array([[0, 0]])
        """
    def contacts(self, *, max_pairs: SupportsIndex = 134217728) -> Contacts:
        """Find every pair of overlapping shapes, and how each overlaps.

        Parameters
        ----------
        max_pairs : int, default 134217728
            The most pairs to return. Each takes 32 bytes, in float32 20, and about as much
            while they are searched; nothing is set aside for more than there are.

        Returns
        -------
        Contacts
            pairs : ndarray of int64, shape (m, 2)
                As :meth:`pairs` gives them, in the order of the tree.
            normals : ndarray of the tree's dtype, shape (m, 2)
                Unit vectors from i to j. Where the boxes inside the shapes overlap, the
                axis along which the way out is shortest; +x for coincident centres.
            depths : ndarray of the tree's dtype, shape (m,)
                How far j has to move along the normal until the two only touch.

        Raises
        ------
        ValueError
            If more than `max_pairs` pairs overlap.
        MemoryError
            If there is no memory for them.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (0, 1.5)], radii=1.0)
        >>> tree.contacts()
        Contacts(pairs=array([[0, 1]]), normals=array([[0., 1.]]), depths=array([0.5]))
        """
    @overload
    def query_rect(
        self, rect: tuple[_Real, _Real, _Real, _Real] | _Rect | Box, *, mask: SupportsIndex | None = None
    ) -> _Ids:
        """Find the shapes that overlap a rectangle, or each of many.

        Parameters
        ----------
        rect : array_like, shape (4,) or (k, 4)
            min_x, min_y, max_x, max_y; no width and height. What has the attributes `left`,
            `top`, `right` and `bottom`, as pygame's Rect, or `min_x`, `min_y`, `max_x` and
            `max_y`, as :class:`jostle.Box`, is read by them, also in a list.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m,), or Hits
            Row numbers, ascending. For many rectangles a `Hits` of all of them. What only
            touches a rectangle does not overlap it.

        Raises
        ------
        ValueError
            If a number is not finite, a minimum is above its maximum, or there are more
            than 134217728 ids.

        Notes
        -----
        Every question is read in the tree's dtype and answered as brute force would, in
        that arithmetic. Many questions are answered on all threads of the tree. A shape
        of no category (0) is found only where no mask is given.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> tree.query_rect((2.5, -1, 9, 1))
        array([1, 2])
        >>> hits = tree.query_rect([(0, 0, 1, 1), (2.5, -1, 9, 1)])
        >>> hits.ids[hits.offsets[1]:hits.offsets[2]]
        array([1, 2])
        """
    @overload
    def query_rect(
        self,
        rect: _Array | Sequence[Sequence[_Real] | _Rect | Box | _Array],
        *,
        mask: SupportsIndex | None = None,
    ) -> Hits: ...
    @overload
    def query_rect(self, rect: Sequence[_Real], *, mask: SupportsIndex | None = None) -> _Ids: ...
    @overload
    def query_rect(
        self, rect: _Undecided, *, mask: SupportsIndex | None = None
    ) -> _Ids | Hits | Any: ...
    @overload
    def query_circle(
        self, center: _Point, radius: _Real, *, mask: SupportsIndex | None = None
    ) -> _Ids:
        """Find the shapes that overlap a disc, or each of many.

        Parameters
        ----------
        center : array_like, shape (2,) or (k, 2)
            Centres.
        radius : array_like, a number or shape (k,)
            Radii. With one centre and many radii, all discs have that centre.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m,), or Hits
            Row numbers, ascending. For many discs a `Hits` of all of them. What only
            touches a disc does not overlap it.

        Raises
        ------
        ValueError
            If a number is not finite, a radius is out of range, or there are more than
            134217728 ids.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> tree.query_circle((1, 0), 1.5)
        array([0, 1])
        """
    @overload
    def query_circle(
        self, center: _Points, radius: _Real | _Reals, *, mask: SupportsIndex | None = None
    ) -> Hits: ...
    @overload
    def query_circle(
        self, center: _OneOrMorePoints, radius: _Reals, *, mask: SupportsIndex | None = None
    ) -> Hits: ...
    @overload
    def query_circle(
        self, center: Sequence[_Real], radius: _Real, *, mask: SupportsIndex | None = None
    ) -> _Ids: ...
    @overload
    def query_circle(
        self,
        center: _AnyPoint | _Undecided,
        radius: _Real | _Undecided,
        *,
        mask: SupportsIndex | None = None,
    ) -> _Ids | Hits | Any: ...
    @overload
    def query_point(self, point: _Point, *, mask: SupportsIndex | None = None) -> _Ids:
        """Find the shapes that a point is in, or each of many points.

        A point is in a circle, or in a rounded box, up to and with its edge. It is in a
        rectangle as pygame has it: the left and the upper edge are in, the right and the
        lower are not, so tiles side by side share no point. A rectangle without width and
        height is a circle of radius 0.

        Parameters
        ----------
        point : array_like, shape (2,) or (k, 2)
            Points.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m,), or Hits
            Row numbers, ascending. For many points a `Hits` of all of them.

        Raises
        ------
        ValueError
            If a coordinate is not finite, or there are more than 134217728 ids.

        Examples
        --------
        >>> import jostle
        >>> tiles = jostle.Quadtree(boxes=[(0, 0, 1, 1), (1, 0, 2, 1)])
        >>> tiles.query_point((1.0, 0.2))
        array([1])
        """
    @overload
    def query_point(self, point: _Points, *, mask: SupportsIndex | None = None) -> Hits: ...
    @overload
    def query_point(self, point: Sequence[_Real], *, mask: SupportsIndex | None = None) -> _Ids: ...
    @overload
    def query_point(
        self, point: _Undecided, *, mask: SupportsIndex | None = None
    ) -> _Ids | Hits | Any: ...
    @overload
    def query_polygon(
        self, vertices: _Array | Sequence[_Point], *, mask: SupportsIndex | None = None
    ) -> _Ids:
        """Find the shapes that overlap a convex polygon, or each of many.

        Parameters
        ----------
        vertices : array_like, shape (v, 2) or (k, v, 2)
            Corners in their order, in either direction of turning.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m,), or Hits
            Row numbers, ascending. For many polygons a `Hits` of all of them. What only
            touches a polygon does not overlap it.

        Raises
        ------
        ValueError
            If a polygon has less than three corners, is not convex or has no area, if a
            coordinate is not finite, or there are more than 134217728 ids.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> tree.query_polygon([(1, 2), (5, 0.5), (5, 2)])
        array([2])
        """
    @overload
    def query_polygon(
        self, vertices: Sequence[_Points], *, mask: SupportsIndex | None = None
    ) -> Hits: ...
    @overload
    def query_polygon(
        self, vertices: Sequence[Sequence[_Real]], *, mask: SupportsIndex | None = None
    ) -> _Ids: ...
    @overload
    def query_polygon(
        self, vertices: _Undecided, *, mask: SupportsIndex | None = None
    ) -> _Ids | Hits | Any: ...
    def nearest(
        self,
        point: _OneOrMorePoints,
        k: SupportsIndex = 1,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> Neighbors:
        """Find the shapes nearest to a point, or to each of many.

        Parameters
        ----------
        point : array_like, shape (2,) or (n, 2)
            Points.
        k : int, default 1
            How many shapes to find.
        max_distance : float, default inf
            Find nothing farther than this.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        Neighbors
            Unpacks as ``distances, ids``, in this order, as `cKDTree.query` of SciPy
            (:meth:`raycast` gives the row first).

            distances : ndarray of the tree's dtype, shape (k,) or (n, k)
                How far it is to the surface of each shape, nearest first; 0 inside,
                infinity where there are fewer than k.
            ids : ndarray of int64, shape (k,) or (n, k)
                Row numbers, of shapes as near the smaller first; -1 where there are
                fewer than k: leave those out before you index with them. A point that is
                a shape of the tree has itself for its nearest.

        Raises
        ------
        ValueError
            If a coordinate is not finite, k is less than 1, k times the number of points is more
            than 134217728, or `max_distance` is negative.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (3, 0), (5, 0)], radii=1.0)
        >>> distances, ids = tree.nearest((2, 0), k=2)
        >>> distances, ids
        (array([0., 1.]), array([1, 0]))
        """
    @overload
    def raycast(
        self,
        origin: _Point,
        direction: _Point,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit:
        """Find what a ray hits first, or each of many.

        Parameters
        ----------
        origin : array_like, shape (2,) or (k, 2)
            Where each ray begins.
        direction : array_like, shape (2,) or (k, 2)
            Where each ray goes; the length does not matter. One origin may have many
            directions, and many origins one.
        max_distance : float, default inf
            How far the rays reach, in units of length.
        mask : int, optional
            Hit only shapes with a category in this set of bits; the others are as air.

        Returns
        -------
        RayHit or RayHits
            Unpacks as ``row, distance``, in this order (:meth:`nearest` gives distances
            first). Of shapes at one distance the smaller row; -1 and infinity where nothing is
            hit, so look at the row before you index with it. The distance is that to the
            surface, 0 where a ray begins in a shape. Arrays of them for many rays. A ray that
            touches an edge hits it.

        Raises
        ------
        ValueError
            If a number is not finite, a direction is (0, 0), or `max_distance` is negative.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (3, 0), (5, 0)], radii=1.0)
        >>> tree.raycast((-4, 0), (1, 0))
        RayHit(id=0, distance=3.0)
        >>> tree.raycast((1.5, 0), [(1, 0), (0, 1), (-1, 0)])
        RayHits(ids=array([ 1, -1,  0]), distances=array([0.5, inf, 0.5]))
        """
    @overload
    def raycast(
        self,
        origin: _Points,
        direction: _OneOrMorePoints,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def raycast(
        self,
        origin: _OneOrMorePoints,
        direction: _Points,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def raycast(
        self,
        origin: _AnyPoint,
        direction: _AnyPoint,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit: ...
    @overload
    def raycast(
        self,
        origin: _AnyPoint | _Undecided,
        direction: _AnyPoint | _Undecided,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit | RayHits | Any: ...
    @overload
    def circle_cast(
        self,
        origin: _Point,
        direction: _Point,
        radius: _Real,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit:
        """Find what a disc that is thrown hits first, or each of many.

        Parameters
        ----------
        origin : array_like, shape (2,) or (k, 2)
            Where the centre of each disc begins.
        direction : array_like, shape (2,) or (k, 2)
            Where it goes; the length does not matter.
        radius : array_like, a number or shape (k,)
            Radii of the discs.
        max_distance : float, default inf
            How far the discs fly, in units of length.
        mask : int, optional
            Hit only shapes with a category in this set of bits; the others are as air.

        Returns
        -------
        RayHit or RayHits
            Row number and how far the disc gets, as :meth:`raycast` gives them.

        Raises
        ------
        ValueError
            If a number is not finite, a direction is (0, 0), a radius is out of range, or
            `max_distance` is negative.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (3, 0), (5, 0)], radii=1.0)
        >>> tree.circle_cast((-4, 0.5), (1, 0), radius=0.5)
        RayHit(id=0, distance=2.585786437626905)
        """
    @overload
    def circle_cast(
        self,
        origin: _Points,
        direction: _OneOrMorePoints,
        radius: _Real | _Reals,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def circle_cast(
        self,
        origin: _OneOrMorePoints,
        direction: _Points,
        radius: _Real | _Reals,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def circle_cast(
        self,
        origin: _OneOrMorePoints,
        direction: _OneOrMorePoints,
        radius: _Reals,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def circle_cast(
        self,
        origin: _AnyPoint,
        direction: _AnyPoint,
        radius: _Real,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit: ...
    @overload
    def circle_cast(
        self,
        origin: _AnyPoint | _Undecided,
        direction: _AnyPoint | _Undecided,
        radius: _Real | _Undecided,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit | RayHits | Any: ...
    def nodes(self) -> Nodes:
        """Look at the boxes of the tree.

        Returns
        -------
        Nodes
            boxes : ndarray of float64, shape (k, 4)
                min_x, min_y, max_x, max_y of each box. It holds the centres of its
                shapes; a shape may reach over its border. Quarters without a shape
                are left out, and so are subdivisions that would part nothing: shapes at
                one place are in one box, however many they are.
            depths : ndarray of int64, shape (k,)
                Subdivisions above each box.
            counts : ndarray of int64, shape (k,)
                Shapes in each box and all below it.
            is_leaf : ndarray of bool, shape (k,)
                Whether the box did not split.

            Parents stand before their children; the first box is the root. A tree
            without shapes has no boxes.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (1, 1), (7, 7)], leaf_capacity=2)
        >>> tree.nodes().boxes
        array([[0., 0., 8., 8.],
               [0., 0., 4., 4.],
               [4., 4., 8., 8.]])
        """
    @property
    def stats(self) -> Stats:
        """What the tree looks like and how much work its last answer was.

        A `Stats` of four integers: `nodes` (boxes), `leaves` (boxes that did not
        split), `depth` (subdivisions above the deepest box) and `tests` (how often
        the last question tested a shape, against another or against what was asked
        for; 0 before the first).
        """
    def __len__(self) -> int: ...

@final
class Space:
    """A living collection of shapes: they come, move, change and go, and pairs are told as they
    form and part.

    A shape is a rounded box: every point within `radius` of its core, the axis-aligned box
    ``center ± half_size`` or one of `boxes`. Circles have no half size, rectangles no radius.
    Each has an id of its own that is never given to another. What changes costs time, what does not costs
    next to none: a million still shapes may stand around a thousand that move. Every question
    sees every change made before it.

    Parameters
    ----------
    dtype : {"float64", "float32"}, default "float64"
        Precision of all arithmetic. Other numbers are converted.
    leaf_capacity : int, default 96
        Shapes that a box of a tree may hold before it splits into four. Trees of a few
        among many shapes take fewer.
    max_depth : int, default 4096
        Subdivisions allowed; the default never stops a split.
    threads : int, optional
        How many threads work, at most one for each core, which is the default. Every answer
        is the same for every number.

    Raises
    ------
    TypeError
        If an argument is not what it should be.
    ValueError
        If a setting is out of range.

    Notes
    -----
    Wherever ids are wanted, one may be given instead of an array, and then one value for each
    other argument. A refused call changes nothing.

    Examples
    --------
    >>> import jostle
    >>> space = jostle.Space()
    >>> ids = space.add([(0, 0), (5, 0)], radii=1.0)
    >>> space.move(ids[1], (1.5, 0))
    >>> space.update().entered
    array([[0, 1]])
    >>> space.remove(0)
    >>> space.update().left
    array([[0, 1]])
    """

    def __new__(
        cls,
        *,
        dtype: DTypeLike = "float64",
        leaf_capacity: SupportsIndex = 96,
        max_depth: SupportsIndex = 4096,
        threads: SupportsIndex | None = None,
    ) -> Self: ...
    @overload
    def add(
        self,
        centers: _Point,
        radii: ArrayLike = 0.0,
        half_sizes: ArrayLike | None = None,
        *,
        boxes: None = None,
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> int:
        """Add shapes, or one.

        Parameters
        ----------
        centers : array_like, shape (k, 2) or (2,), optional
            Centres; to be given unless `boxes` is.
        radii : array_like, a number or shape (k,), default 0.0
            Radii.
        half_sizes : array_like, a number, shape (2,) or (k, 2), optional
            Half widths and half heights. Left out, the shapes are circles.
        boxes : array_like, shape (k, 4) or (4,), optional
            min_x, min_y, max_x, max_y of each shape, in place of `centers` and `half_sizes`.
            What has the attributes `left`, `top`, `right` and `bottom`, as pygame's Rect, is
            read by them, also in a list or a tuple. The four numbers are compared as they
            are: boxes that share an edge never overlap, while sides that are
            ``center ± half_size`` are rounded.
        categories : array_like of int, a number or shape (k,), default 1
            What each shape is, as a set of 32 bits.
        masks : array_like of int, a number or shape (k,), default 0xFFFFFFFF
            What each shape may pair with, as a set of 32 bits. Shapes i and j may pair only
            if both ``categories[i] & masks[j]`` and ``categories[j] & masks[i]`` have a bit.
            A negative integer stands for its low 32 bits, so ``masks=~SHIP`` is every category
            but SHIP. Of a uint8 or uint16 array ``~`` gives no bits above the 8th or 16th.

        Returns
        -------
        ndarray of int64, shape (k,), or int
            Their ids; one id for one centre or one box. The first are 0, 1, 2, ...

        Raises
        ------
        TypeError
            If an argument does not hold numbers, or if not exactly one of `centers` and
            `boxes` is given.
        ValueError
            If a shape is wrong, a value is not finite, or a size is out of range: a radius is 0,
            or between 1e-18 and 1e18 in float32 and between 1e-150 and 1e150 in float64.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> space.add([(0, 0), (5, 0)], radii=1.0)
        array([0, 1])
        >>> space.add((2, 2), half_sizes=(1, 0.5))
        2
        >>> space.add(boxes=[(0, 3, 0.1, 4), (0.1, 3, 0.2, 4)])
        array([3, 4])
        """
    @overload
    def add(
        self,
        centers: _Points,
        radii: ArrayLike = 0.0,
        half_sizes: ArrayLike | None = None,
        *,
        boxes: None = None,
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> _Ids: ...
    @overload
    def add(
        self,
        centers: Sequence[_Real],
        radii: ArrayLike = 0.0,
        half_sizes: ArrayLike | None = None,
        *,
        boxes: None = None,
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> int: ...
    @overload
    def add(
        self,
        centers: _Undecided,
        radii: ArrayLike = 0.0,
        half_sizes: ArrayLike | None = None,
        *,
        boxes: None = None,
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> int | _Ids | Any: ...
    @overload
    def add(
        self,
        centers: None = None,
        radii: ArrayLike = 0.0,
        half_sizes: None = None,
        *,
        boxes: tuple[_Real, _Real, _Real, _Real] | _Rect,
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> int: ...
    @overload
    def add(
        self,
        centers: None = None,
        radii: ArrayLike = 0.0,
        half_sizes: None = None,
        *,
        boxes: _Array | Sequence[Sequence[_Real] | _Rect | _Array],
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> _Ids: ...
    @overload
    def add(
        self,
        centers: None = None,
        radii: ArrayLike = 0.0,
        half_sizes: None = None,
        *,
        boxes: Sequence[_Real],
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> int: ...
    @overload
    def add(
        self,
        centers: None = None,
        radii: ArrayLike = 0.0,
        half_sizes: None = None,
        *,
        boxes: _Undecided,
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> int | _Ids | Any: ...
    def move(
        self,
        ids: ArrayLike,
        centers: _Vectors | None = None,
        *,
        boxes: _Boxes | _Rect | None = None,
    ) -> None:
        """Give shapes other centres, or other boxes.

        What does not move thereby costs as little as if it had not been named.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Which shapes, none of them twice.
        centers : array_like, shape (k, 2), or (2,) for one id, optional
            Where they are now. A shape that was given as a box, and whose centre changes, is
            ``center ± half_size`` from now on, with half the size of its box, and compared
            as such: its sides are rounded. Give `boxes` to keep them exact.
        boxes : array_like, shape (k, 4), or (4,) for one id, optional
            In place of `centers`: min_x, min_y, max_x, max_y of each shape, or pygame's Rects,
            as in :meth:`add`. This may change the size, too. Radii stay as they are.

        Raises
        ------
        TypeError
            If an argument does not hold numbers, or if not exactly one of `centers` and
            `boxes` is given.
        ValueError
            If no shape has an id, or one is named twice, a coordinate is not finite, or a
            minimum is above its maximum; then nothing moves.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (5, 0)], radii=1.0)
        >>> space.move(ids, [(1, 0), (6, 0)])
        >>> space.move(0, (2, 0))
        >>> space.centers(ids)
        array([[2., 0.],
               [6., 0.]])
        >>> tile = space.add(boxes=(0, 0, 0.1, 0.1))
        >>> space.move(tile, boxes=(0.1, 0, 0.2, 0.1))
        """
    def resize(
        self, ids: ArrayLike, radii: ArrayLike | None = None, half_sizes: ArrayLike | None = None
    ) -> None:
        """Give shapes other radii, half sizes or both.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Which shapes, none of them twice.
        radii : array_like, a number or shape (k,), optional
            Left out, they stay as they are.
        half_sizes : array_like, a number, shape (2,) or (k, 2), optional
            Left out, they stay as they are. A shape that was given as a box, and whose size
            changes, is ``center ± half_size`` from now on; ``move(ids, boxes=...)`` gives it
            another box.

        Raises
        ------
        TypeError
            If an argument does not hold numbers.
        ValueError
            If no shape has an id, or one is named twice, or a size is not finite or out of
            range; then nothing changes.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (3, 0)], radii=1.0)
        >>> space.resize(ids, 2.0)
        >>> space.update().entered
        array([[0, 1]])
        """
    def set_filter(
        self, ids: ArrayLike, categories: ArrayLike | None = None, masks: ArrayLike | None = None
    ) -> None:
        """Give shapes other categories, masks or both.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Which shapes, none of them twice.
        categories : array_like of int, a number or shape (k,), optional
            Left out, they stay as they are.
        masks : array_like of int, a number or shape (k,), optional
            Left out, they stay as they are.

        Raises
        ------
        TypeError
            If an argument does not hold integers.
        ValueError
            If no shape has an id, or one is named twice, or a set of bits has more than 32;
            then nothing changes.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (1, 0)], radii=1.0)
        >>> space.set_filter(0, masks=0)  # it pairs with nothing any more
        >>> len(space.pairs())
        0
        """
    def remove(self, ids: ArrayLike) -> None:
        """Remove shapes. Their ids are never given again.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Which shapes, none of them twice.

        Raises
        ------
        TypeError
            If `ids` does not hold integers.
        ValueError
            If no shape has an id or one is named twice; then none is removed.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (5, 0), (9, 0)])
        >>> space.remove(ids[:2])
        >>> space.ids
        array([2])
        """
    def update(self, *, max_pairs: SupportsIndex = 134217728) -> Events:
        """Tell which pairs have formed and which have parted since the last update.

        Two states are compared, that of the last update and that of now; the first update
        compares with a space without shapes. What was added and removed in between never
        shows. Only shapes that changed cost time.

        Parameters
        ----------
        max_pairs : int, default 134217728
            The most overlapping pairs of shapes that changed.

        Returns
        -------
        Events
            entered, stayed, left : ndarray of int64, shape (m, 2)
                Pairs of ids, the smaller first, sorted. `left` may name shapes that are
                removed. `stayed` is worked out when it is asked for.

        Raises
        ------
        ValueError
            If there are more than `max_pairs`; then the last update stays the last.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (1, 0), (8, 0)], radii=1.0)
        >>> entered, stayed, left = space.update()
        >>> entered
        array([[0, 1]])
        >>> space.move(2, (2, 0))
        >>> entered, stayed, left = space.update()
        >>> entered, stayed
        (array([[1, 2]]), array([[0, 1]]))
        """
    def pairs(
        self,
        *,
        sort: bool = False,
        max_pairs: SupportsIndex = 134217728,
        mask: SupportsIndex | None = None,
    ) -> _Pairs:
        """Find every pair of overlapping shapes.

        Parameters
        ----------
        sort : bool, default False
            Whether to sort the pairs by first, then by second id. Without, they come in an
            order that depends on what was called before, and not on the number of threads.
        max_pairs : int, default 134217728
            The most pairs to return; the default is two gibibytes of them.
        mask : int, optional
            Find only pairs of which both have a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m, 2)
            Ids of each pair, the smaller first, every pair once.

        Raises
        ------
        ValueError
            If more than `max_pairs` pairs overlap.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> space.pairs()
        array([[1, 2]])
        """
    @overload
    def query_rect(
        self, rect: tuple[_Real, _Real, _Real, _Real] | _Rect | Box, *, mask: SupportsIndex | None = None
    ) -> _Ids:
        """Find the shapes that overlap a rectangle, or each of many.

        Parameters
        ----------
        rect : array_like, shape (4,) or (k, 4)
            min_x, min_y, max_x, max_y; no width and height. What has the attributes `left`,
            `top`, `right` and `bottom`, as pygame's Rect, or `min_x`, `min_y`, `max_x` and
            `max_y`, as :class:`jostle.Box`, is read by them, also in a list.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m,), or Hits
            Ids, ascending. For many rectangles a `Hits` of all of them. What only
            touches a rectangle does not overlap it.

        Raises
        ------
        ValueError
            If a number is not finite, a minimum is above its maximum, or there are more
            than 134217728 ids.

        Notes
        -----
        Every question is read in the space's dtype and answered as brute force would, in
        that arithmetic. Many questions are answered on all threads of the tree.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> space.query_rect((2.5, -1, 9, 1))
        array([1, 2])
        >>> hits = space.query_rect([(0, 0, 1, 1), (2.5, -1, 9, 1)])
        >>> hits.ids[hits.offsets[1]:hits.offsets[2]]
        array([1, 2])
        """
    @overload
    def query_rect(
        self,
        rect: _Array | Sequence[Sequence[_Real] | _Rect | Box | _Array],
        *,
        mask: SupportsIndex | None = None,
    ) -> Hits: ...
    @overload
    def query_rect(self, rect: Sequence[_Real], *, mask: SupportsIndex | None = None) -> _Ids: ...
    @overload
    def query_rect(
        self, rect: _Undecided, *, mask: SupportsIndex | None = None
    ) -> _Ids | Hits | Any: ...
    @overload
    def query_circle(
        self, center: _Point, radius: _Real, *, mask: SupportsIndex | None = None
    ) -> _Ids:
        """Find the shapes that overlap a disc, or each of many.

        Parameters
        ----------
        center : array_like, shape (2,) or (k, 2)
            Centres.
        radius : array_like, a number or shape (k,)
            Radii. With one centre and many radii, all discs have that centre.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m,), or Hits
            Ids, ascending. For many discs a `Hits` of all of them. What only
            touches a disc does not overlap it.

        Raises
        ------
        ValueError
            If a number is not finite, a radius is out of range, or there are more than
            134217728 ids.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> space.query_circle((1, 0), 1.5)
        array([0, 1])
        """
    @overload
    def query_circle(
        self, center: _Points, radius: _Real | _Reals, *, mask: SupportsIndex | None = None
    ) -> Hits: ...
    @overload
    def query_circle(
        self, center: _OneOrMorePoints, radius: _Reals, *, mask: SupportsIndex | None = None
    ) -> Hits: ...
    @overload
    def query_circle(
        self, center: Sequence[_Real], radius: _Real, *, mask: SupportsIndex | None = None
    ) -> _Ids: ...
    @overload
    def query_circle(
        self,
        center: _AnyPoint | _Undecided,
        radius: _Real | _Undecided,
        *,
        mask: SupportsIndex | None = None,
    ) -> _Ids | Hits | Any: ...
    @overload
    def query_point(self, point: _Point, *, mask: SupportsIndex | None = None) -> _Ids:
        """Find the shapes that a point is in, or each of many points.

        A point is in a circle, or in a rounded box, up to and with its edge. It is in a
        rectangle as pygame has it: the left and the upper edge are in, the right and the
        lower are not, so tiles side by side share no point. A rectangle without width and
        height is a circle of radius 0.

        Parameters
        ----------
        point : array_like, shape (2,) or (k, 2)
            Points.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m,), or Hits
            Ids, ascending. For many points a `Hits` of all of them.

        Raises
        ------
        ValueError
            If a coordinate is not finite, or there are more than 134217728 ids.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add(boxes=[(0, 0, 1, 1), (1, 0, 2, 1)])
        >>> space.query_point((1.0, 0.2))
        array([1])
        """
    @overload
    def query_point(self, point: _Points, *, mask: SupportsIndex | None = None) -> Hits: ...
    @overload
    def query_point(self, point: Sequence[_Real], *, mask: SupportsIndex | None = None) -> _Ids: ...
    @overload
    def query_point(
        self, point: _Undecided, *, mask: SupportsIndex | None = None
    ) -> _Ids | Hits | Any: ...
    @overload
    def query_polygon(
        self, vertices: _Array | Sequence[_Point], *, mask: SupportsIndex | None = None
    ) -> _Ids:
        """Find the shapes that overlap a convex polygon, or each of many.

        Parameters
        ----------
        vertices : array_like, shape (v, 2) or (k, v, 2)
            Corners in their order, in either direction of turning.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        ndarray of int64, shape (m,), or Hits
            Ids, ascending. For many polygons a `Hits` of all of them. What only
            touches a polygon does not overlap it.

        Raises
        ------
        ValueError
            If a polygon has less than three corners, is not convex or has no area, if a
            coordinate is not finite, or there are more than 134217728 ids.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> space.query_polygon([(1, 2), (5, 0.5), (5, 2)])
        array([2])
        """
    @overload
    def query_polygon(
        self, vertices: Sequence[_Points], *, mask: SupportsIndex | None = None
    ) -> Hits: ...
    @overload
    def query_polygon(
        self, vertices: Sequence[Sequence[_Real]], *, mask: SupportsIndex | None = None
    ) -> _Ids: ...
    @overload
    def query_polygon(
        self, vertices: _Undecided, *, mask: SupportsIndex | None = None
    ) -> _Ids | Hits | Any: ...
    def nearest(
        self,
        point: _OneOrMorePoints,
        k: SupportsIndex = 1,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> Neighbors:
        """Find the shapes nearest to a point, or to each of many.

        Parameters
        ----------
        point : array_like, shape (2,) or (n, 2)
            Points.
        k : int, default 1
            How many shapes to find.
        max_distance : float, default inf
            Find nothing farther than this.
        mask : int, optional
            Find only shapes with a category in this set of bits.

        Returns
        -------
        Neighbors
            Unpacks as ``distances, ids``, in this order, as `cKDTree.query` of SciPy
            (:meth:`raycast` gives the id first).

            distances : ndarray of the space's dtype, shape (k,) or (n, k)
                How far it is to the surface of each shape, nearest first; 0 inside,
                infinity where there are fewer than k.
            ids : ndarray of int64, shape (k,) or (n, k)
                Ids, of shapes as near the smaller first; -1 where there are
                fewer than k.

        Raises
        ------
        ValueError
            If a coordinate is not finite, k is less than 1, k times the number of points is more
            than 134217728, or `max_distance` is negative.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (3, 0), (5, 0)], radii=1.0)
        >>> distances, ids = space.nearest((2, 0), k=2)
        >>> distances, ids
        (array([0., 1.]), array([1, 0]))
        """
    @overload
    def raycast(
        self,
        origin: _Point,
        direction: _Point,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit:
        """Find what a ray hits first, or each of many.

        Parameters
        ----------
        origin : array_like, shape (2,) or (k, 2)
            Where each ray begins.
        direction : array_like, shape (2,) or (k, 2)
            Where each ray goes; the length does not matter. One origin may have many
            directions, and many origins one.
        max_distance : float, default inf
            How far the rays reach, in units of length.
        mask : int, optional
            Hit only shapes with a category in this set of bits; the others are as air.

        Returns
        -------
        RayHit or RayHits
            Unpacks as ``id, distance``, in this order (:meth:`nearest` gives distances first).
            Of shapes at one distance the smaller id; -1 and infinity where nothing is hit. The
            distance is that to the surface, 0 where a ray begins in a shape. Arrays of them for
            many rays. A ray that touches an edge hits it.

        Raises
        ------
        ValueError
            If a number is not finite, a direction is (0, 0), or `max_distance` is negative.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (3, 0), (5, 0)], radii=1.0)
        >>> space.raycast((-4, 0), (1, 0))
        RayHit(id=0, distance=3.0)
        >>> space.raycast((1.5, 0), [(1, 0), (0, 1), (-1, 0)])
        RayHits(ids=array([ 1, -1,  0]), distances=array([0.5, inf, 0.5]))
        """
    @overload
    def raycast(
        self,
        origin: _Points,
        direction: _OneOrMorePoints,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def raycast(
        self,
        origin: _OneOrMorePoints,
        direction: _Points,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def raycast(
        self,
        origin: _AnyPoint,
        direction: _AnyPoint,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit: ...
    @overload
    def raycast(
        self,
        origin: _AnyPoint | _Undecided,
        direction: _AnyPoint | _Undecided,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit | RayHits | Any: ...
    @overload
    def circle_cast(
        self,
        origin: _Point,
        direction: _Point,
        radius: _Real,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit:
        """Find what a disc that is thrown hits first, or each of many.

        Parameters
        ----------
        origin : array_like, shape (2,) or (k, 2)
            Where the centre of each disc begins.
        direction : array_like, shape (2,) or (k, 2)
            Where it goes; the length does not matter.
        radius : array_like, a number or shape (k,)
            Radii of the discs.
        max_distance : float, default inf
            How far the discs fly, in units of length.
        mask : int, optional
            Hit only shapes with a category in this set of bits; the others are as air.

        Returns
        -------
        RayHit or RayHits
            Id and how far the disc gets, as :meth:`raycast` gives them.

        Raises
        ------
        ValueError
            If a number is not finite, a direction is (0, 0), a radius is out of range, or
            `max_distance` is negative.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (3, 0), (5, 0)], radii=1.0)
        >>> space.circle_cast((-4, 0.5), (1, 0), radius=0.5)
        RayHit(id=0, distance=2.585786437626905)
        """
    @overload
    def circle_cast(
        self,
        origin: _Points,
        direction: _OneOrMorePoints,
        radius: _Real | _Reals,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def circle_cast(
        self,
        origin: _OneOrMorePoints,
        direction: _Points,
        radius: _Real | _Reals,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def circle_cast(
        self,
        origin: _OneOrMorePoints,
        direction: _OneOrMorePoints,
        radius: _Reals,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHits: ...
    @overload
    def circle_cast(
        self,
        origin: _AnyPoint,
        direction: _AnyPoint,
        radius: _Real,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit: ...
    @overload
    def circle_cast(
        self,
        origin: _AnyPoint | _Undecided,
        direction: _AnyPoint | _Undecided,
        radius: _Real | _Undecided,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit | RayHits | Any: ...
    def centers(self, ids: ArrayLike | None = None) -> NDArray[np.floating[Any]]:
        """Read centres; ``(min + max) / 2`` of shapes given as boxes.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,), optional
            Which shapes; all of them, in the order of `ids`, where left out.

        Returns
        -------
        ndarray of the space's dtype, shape (k, 2), or (2,) for one id
            A copy.

        Raises
        ------
        ValueError
            If no shape has an id.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add([(0, 0), (3, 4)])
        >>> space.centers(1)
        array([3., 4.])
        """
    def half_sizes(self, ids: ArrayLike | None = None) -> NDArray[np.floating[Any]]:
        """Read half widths and half heights; 0 for circles, ``(max - min) / 2`` of shapes given as
        boxes.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,), optional
            Which shapes; all of them where left out.

        Returns
        -------
        ndarray of the space's dtype, shape (k, 2), or (2,) for one id
            A copy.

        Raises
        ------
        ValueError
            If no shape has an id.
        """
    def boxes(self, ids: ArrayLike | None = None) -> NDArray[np.floating[Any]]:
        """Read boxes: the corners of the shapes, their radii left out.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,), optional
            Which shapes; all of them where left out.

        Returns
        -------
        ndarray of the space's dtype, shape (k, 4), or (4,) for one id
            A copy: min_x, min_y, max_x, max_y, as they were given, or ``center ± half_size``;
            for a circle twice its centre.

        Raises
        ------
        ValueError
            If no shape has an id.

        Examples
        --------
        >>> import jostle
        >>> space = jostle.Space()
        >>> ids = space.add(boxes=[(0, 0, 0.1, 0.1), (0.1, 0, 0.2, 0.1)])
        >>> space.boxes(1)
        array([0.1, 0. , 0.2, 0.1])
        """
    @overload
    def radii(self, ids: _Id) -> float:
        """Read radii.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,), optional
            Which shapes; all of them where left out.

        Returns
        -------
        ndarray of the space's dtype, shape (k,), or float for one id
            A copy.

        Raises
        ------
        ValueError
            If no shape has an id.
        """
    @overload
    def radii(self, ids: _IdList | None = None) -> NDArray[np.floating[Any]]: ...
    @overload
    def radii(self, ids: _Undecided) -> float | NDArray[np.floating[Any]] | Any: ...
    @overload
    def categories(self, ids: _Id) -> int:
        """Read categories.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,), optional
            Which shapes; all of them where left out.

        Returns
        -------
        ndarray of uint32, shape (k,), or int for one id
            A copy.

        Raises
        ------
        ValueError
            If no shape has an id.
        """
    @overload
    def categories(self, ids: _IdList | None = None) -> NDArray[np.uint32]: ...
    @overload
    def categories(self, ids: _Undecided) -> int | NDArray[np.uint32] | Any: ...
    @overload
    def masks(self, ids: _Id) -> int:
        """Read masks.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,), optional
            Which shapes; all of them where left out.

        Returns
        -------
        ndarray of uint32, shape (k,), or int for one id
            A copy.

        Raises
        ------
        ValueError
            If no shape has an id.
        """
    @overload
    def masks(self, ids: _IdList | None = None) -> NDArray[np.uint32]: ...
    @overload
    def masks(self, ids: _Undecided) -> int | NDArray[np.uint32] | Any: ...
    @property
    def ids(self) -> _Ids:
        """The ids of all shapes, ascending: ndarray of int64, shape (n,)."""
    @property
    def dtype(self) -> Literal["float32", "float64"]:
        """The precision of its arithmetic: "float32" or "float64"."""
    def __contains__(self, id: object, /) -> bool: ...
    def __len__(self) -> int: ...

@final
class Events:
    """What became of the pairs of a space from one update to the next.

    Each part holds ids, the smaller first, and is sorted by first, then by second. Unpacking
    gives all three: ``entered, stayed, left = space.update()``. To go without `stayed`, which
    takes time for every pair there is, ask for the others by name.

    Examples
    --------
    >>> import jostle
    >>> space = jostle.Space()
    >>> ids = space.add([(0, 0), (1, 0), (9, 0)], radii=1.0)
    >>> events = space.update()
    >>> events
    <jostle.Events: 1 entered, 0 left>
    >>> events.entered
    array([[0, 1]])
    """

    @property
    def entered(self) -> _Pairs:
        """Pairs that overlap now and did not at the update before: ndarray of int64, shape (m, 2)."""
    @property
    def stayed(self) -> _Pairs:
        """Pairs that overlapped at both updates: ndarray of int64, shape (m, 2).

        They are worked out when they are first asked for, which has to be before the next
        update of the space.
        """
    @property
    def left(self) -> _Pairs:
        """Pairs that overlapped at the update before and do not now, be it that a shape was
        removed: ndarray of int64, shape (m, 2).
        """
    def __iter__(self) -> Iterator[_Pairs]: ...

@final
class World:
    """Circles that move, collide and bounce off walls.

    Particles are rows, in the order of adding; their row numbers are their ids.
    Everything is float32; other numbers are converted. The same input gives the
    same bits on every machine, for every number of threads and for both methods.

    Parameters
    ----------
    positions : array_like, shape (n, 2)
        Centres, in units of length.
    velocities : array_like, shape (n, 2)
        In units of length a second.
    radii : array_like, a number or shape (n,)
        In units of length, at least 0.
    masses : array_like, a number or shape (n,), optional
        Above 0. Left out, density times radius squared, as in the article; so a
        particle of radius 0 needs its mass given.
    densities : array_like, a number or shape (n,), default 1.0
        Used where `masses` are left out.
    movable : array_like of bool, one or shape (n,), optional
        Whether anything can move the particle. Left out, all are movable. What is
        not movable stands still: its velocity becomes 0.
    gravity : array_like, shape (2,), default (0.0, 0.0)
        Acceleration, in units of length a second squared.
    drag : float, default 0.0
        Rate at which speeds die away, per second: dv/dt = -drag v.
    restitution : array_like, a number or shape (n,), default 1.0
        Share of its speed that a bounce gives back, 0 to 1. A number is the world's,
        an array has one for each particle. Two particles bounce with the product of
        the world's and both of theirs, one and a wall with that of the world's and
        its own.
    container : Box, Circle, Torus or None, optional
        The walls. A particle outside is brought in by the first step.
    forces : sequence of Attractor, Gravitation, Springs and Thermostat, default ()
        What accelerates particles, apart from gravity and contacts.
    on_touch : {"bounce", "merge", "ignore"}, default "bounce"
        What becomes of particles that touch. "merge" makes them one at the end of the
        step: area, mass and momentum are summed up at the centre of mass, restitution is
        the mean by mass, and the id is the smallest; ids behind the others close up, see
        `renumbered`. What is not movable holds those that merge with it, and their
        momentum is lost. What would not fit between the walls as one stays apart.
        "ignore" lets them pass through each other.
    method : {"quadtree", "brute"}, default "quadtree"
        How pairs are found, never which.
    threads : int, optional
        How many threads work, at most one for each core, which is the default.
    leaf_capacity : int, default 96
        Particles that a box of the tree may hold before it splits.
    max_depth : int, default 4096
        Subdivisions that the tree may make; the default never stops a split.
    substeps : int, default 4
        Parts of a step in which contacts are solved. Piles rest with the default; a
        gas needs one.

    Raises
    ------
    TypeError
        If an argument does not hold what it should.
    ValueError
        If a shape is wrong, a value is out of range, or a particle does not fit
        between the walls; the sentence says which.

    Examples
    --------
    >>> import jostle
    >>> world = jostle.World([(0, 0), (3, 0)], [(1, 0), (0, 0)], radii=1.0)
    >>> world.step(0.1, steps=20)  # the left disc meets the right one after a second
    >>> world.velocities
    array([[0., 0.],
           [1., 0.]], dtype=float32)
    """

    def __new__(
        cls,
        positions: _Vectors,
        velocities: _Vectors,
        radii: ArrayLike,
        *,
        masses: ArrayLike | None = None,
        densities: ArrayLike = 1.0,
        movable: ArrayLike | None = None,
        gravity: _Vectors = (0.0, 0.0),
        drag: _Number = 0.0,
        restitution: ArrayLike = 1.0,
        container: _Container | None = None,
        forces: Iterable[_Force] = (),
        on_touch: Literal["bounce", "merge", "ignore"] = "bounce",
        method: Literal["quadtree", "brute"] = "quadtree",
        threads: SupportsIndex | None = None,
        leaf_capacity: SupportsIndex = 96,
        max_depth: SupportsIndex = 4096,
        substeps: SupportsIndex = 4,
    ) -> Self: ...
    def step(self, dt: _Number, steps: SupportsIndex = 1) -> None:
        """Let time pass.

        Other threads may look at the world meanwhile; they see it between two steps. A step
        is done whole or not at all: when one is refused, or interrupted with Ctrl-C, the
        world is as it was before that step. Of a call with `steps` above 1, the steps before
        it stay.

        Parameters
        ----------
        dt : float
            Length of a step in seconds, above 0.
        steps : int, default 1
            Number of steps.

        Raises
        ------
        ValueError
            If `dt` is not finite and above 0, if it would carry a particle too far, if too
            many particles are in one place, or if a number would become infinite or NaN; the
            sentence names the particle then.
        KeyboardInterrupt
            After Ctrl-C, which a long step notices within a fraction of a second.

        Examples
        --------
        >>> import jostle
        >>> world = jostle.World([(0, 0)], [(8, 0)], radii=1.0)
        >>> world.step(0.25, steps=2)
        >>> world.positions
        array([[4., 0.]], dtype=float32)
        """
    def add(
        self,
        positions: _Vectors,
        velocities: _Vectors,
        radii: ArrayLike,
        *,
        masses: ArrayLike | None = None,
        densities: ArrayLike = 1.0,
        restitutions: ArrayLike = 1.0,
        movable: ArrayLike | None = None,
    ) -> _Ids:
        """Add particles behind the others.

        Parameters
        ----------
        positions, velocities : array_like, shape (k, 2)
        radii : array_like, a number or shape (k,)
        masses : array_like, a number or shape (k,), optional
            Left out, density times radius squared.
        densities : array_like, a number or shape (k,), default 1.0
        restitutions : array_like, a number or shape (k,), default 1.0
        movable : array_like of bool, one or shape (k,), optional

        Returns
        -------
        ndarray of int64, shape (k,)
            Their ids: the rows that they have in every column.

        Raises
        ------
        TypeError, ValueError
            As for a new world; then nothing is added.

        Examples
        --------
        >>> import jostle
        >>> world = jostle.World([(0, 0)], [(0, 0)], radii=1.0)
        >>> world.add([(5, 0), (9, 0)], [(0, 0), (0, 0)], radii=0.5)
        array([1, 2])
        """
    def remove(self, ids: ArrayLike) -> None:
        """Remove particles, which changes the ids of others.

        An id is a row number: the rows behind a removed one close up, so an old id may name
        another particle afterwards. `renumbered` gives the new id of each old one. Springs
        and attractors that name a removed particle are removed too; the others follow their
        particles.

        Parameters
        ----------
        ids : array_like of int, shape (k,)
            Row numbers, none of them twice.

        Raises
        ------
        ValueError
            If there is no such particle or one is named twice; then none is removed.

        Examples
        --------
        >>> import jostle
        >>> world = jostle.World([(0, 0), (5, 0), (9, 0)], [(0, 0)] * 3, radii=1.0)
        >>> world.remove([1])
        >>> world.positions
        array([[0., 0.],
               [9., 0.]], dtype=float32)
        >>> world.renumbered  # the particle 2 is now 1, and 1 is gone
        array([ 0, -1,  1])
        """
    def set(
        self,
        ids: ArrayLike,
        *,
        positions: _Vectors | None = None,
        velocities: _Vectors | None = None,
        radii: ArrayLike | None = None,
        masses: ArrayLike | None = None,
        restitutions: ArrayLike | None = None,
        movable: ArrayLike | None = None,
    ) -> None:
        """Change some columns of some particles.

        Parameters
        ----------
        ids : array_like of int, shape (k,)
            Row numbers, none of them twice.
        positions, velocities : array_like, shape (k, 2), optional
        radii, masses, restitutions : array_like, a number or shape (k,), optional
            A new radius leaves the mass as it is.
        movable : array_like of bool, one or shape (k,), optional
            What is left out stays as it is.

        Raises
        ------
        TypeError, ValueError
            As for a new world, or if there is no such particle or one is named twice;
            then nothing is changed.

        Examples
        --------
        >>> import jostle
        >>> world = jostle.World([(0, 0), (5, 0)], [(0, 0), (0, 0)], radii=1.0)
        >>> world.set([1], velocities=[(2, 0)], masses=3.0)
        >>> world.momentum
        (6.0, 0.0)
        """
    @property
    def positions(self) -> NDArray[np.float32]:
        """Centres: ndarray of float32, shape (n, 2), a read-only copy in units of length.

        Writing into the copy, as in ``world.positions[0] = (1, 2)`` or
        ``world.positions += 1``, raises ValueError. Assign a whole column instead,
        ``world.positions = world.positions + 1``, or change some rows with
        ``world.set([0], positions=[(1, 2)])``. The same holds for every column.
        """
    @positions.setter
    def positions(self, value: _Vectors) -> None: ...
    @property
    def velocities(self) -> NDArray[np.float32]:
        """Velocities: ndarray of float32, shape (n, 2), a read-only copy in units of length a
        second.

        To change them, assign a whole column, ``world.velocities = world.velocities * 2``,
        or change some rows with ``world.set([0], velocities=[(7, 7)])``.
        """
    @velocities.setter
    def velocities(self, value: _Vectors) -> None: ...
    @property
    def radii(self) -> NDArray[np.float32]:
        """Radii: ndarray of float32, shape (n,), a read-only copy in units of length.

        To change all, assign an array or one number; to change some, use `set`. Masses stay
        as they are.
        """
    @radii.setter
    def radii(self, value: ArrayLike) -> None: ...
    @property
    def masses(self) -> NDArray[np.float32]:
        """Masses: ndarray of float32, shape (n,), a read-only copy.

        To change all, assign an array or one number; to change some, use `set`.
        """
    @masses.setter
    def masses(self, value: ArrayLike) -> None: ...
    @property
    def restitutions(self) -> NDArray[np.float32]:
        """Restitutions of the particles: ndarray of float32, shape (n,), a read-only copy.

        To change all, assign an array or one number; to change some, use `set`.
        """
    @restitutions.setter
    def restitutions(self, value: ArrayLike) -> None: ...
    @property
    def movable(self) -> NDArray[np.bool_]:
        """Which particles can be moved: ndarray of bool, shape (n,), a read-only copy.

        To change all, assign an array or one bool; to change some, use `set`.
        """
    @movable.setter
    def movable(self, value: ArrayLike) -> None: ...
    @property
    def gravity(self) -> tuple[float, float]:
        """Acceleration of everything movable, (x, y), units of length a second squared."""
    @gravity.setter
    def gravity(self, value: _Vectors) -> None: ...
    @property
    def drag(self) -> float:
        """Rate at which speeds die away, per second."""
    @drag.setter
    def drag(self, value: _Number) -> None: ...
    @property
    def restitution(self) -> float:
        """The world's share of every bounce, 0 to 1; `restitutions` are the particles' own."""
    @restitution.setter
    def restitution(self, value: _Number) -> None: ...
    @property
    def container(self) -> _Container | None:
        """The walls: a Box, Circle, Torus or None."""
    @container.setter
    def container(self, value: _Container | None) -> None: ...
    @property
    def forces(self) -> tuple[_Force, ...]:
        """What accelerates particles: a tuple of `Attractor`, `Gravitation`, `Springs` and
        `Thermostat`. Assign any sequence of them. They name particles by id; when one is
        removed, its attractors and springs go with it; when one merges, they are tied to
        what it becomes, and a spring whose ends become one goes.
        """
    @forces.setter
    def forces(self, value: Iterable[_Force]) -> None: ...
    @property
    def on_touch(self) -> Literal["bounce", "merge", "ignore"]:
        """What becomes of particles that touch: "bounce", "merge" or "ignore"."""
    @on_touch.setter
    def on_touch(self, value: Literal["bounce", "merge", "ignore"]) -> None: ...
    @property
    def renumbered(self) -> _Ids | None:
        """New ids after the last call of `step` or `remove`: a read-only ndarray of int64, shape
        (n before the call,), or None if that call changed no id.

        The new id of each old one: ``ids = world.renumbered[ids]`` follows particles.
        Particles that merged share an id; a removed one has -1, so drop those with
        ``ids = ids[ids >= 0]`` before the next call. Each call of `step` or `remove` replaces
        the array: read it after every call that may merge or remove particles.
        """
    @property
    def method(self) -> Literal["quadtree", "brute"]:
        """How pairs are found: "quadtree" or "brute"."""
    @method.setter
    def method(self, value: Literal["quadtree", "brute"]) -> None: ...
    @property
    def threads(self) -> int | None:
        """How many threads work; None for one on each core."""
    @threads.setter
    def threads(self, value: SupportsIndex | None) -> None: ...
    @property
    def leaf_capacity(self) -> int:
        """Particles that a box of the tree may hold before it splits."""
    @leaf_capacity.setter
    def leaf_capacity(self, value: SupportsIndex) -> None: ...
    @property
    def max_depth(self) -> int:
        """Subdivisions that the tree may make."""
    @max_depth.setter
    def max_depth(self, value: SupportsIndex) -> None: ...
    @property
    def substeps(self) -> int:
        """Parts of a step in which contacts are solved."""
    @substeps.setter
    def substeps(self, value: SupportsIndex) -> None: ...
    @property
    def contacts(self) -> Contacts:
        """The pairs that touched during the last step: a `Contacts` of `pairs` (m, 2),
        ``i < j``, unit `normals` (m, 2) from i to j, and `depths` (m,), how far they
        overlapped when it ended, negative where they had parted again. Where `on_touch` is
        not "bounce", the pairs that overlap now.
        """
    @property
    def momentum(self) -> tuple[float, float]:
        """Sum of mass times velocity, (x, y)."""
    @property
    def kinetic_energy(self) -> float:
        """Sum of ½ m v²."""
    @property
    def potential_energy(self) -> float:
        """Energy of everything movable in the fields of gravity (0 at the origin) and of
        attractors (harmonic 0 at the point, inverse square 0 far away), of springs that
        have not broken (½ stiffness times stretch squared) and of gravitation (0 far
        away), which is summed up as its forces are, by boxes where particles are many.
        """
    @property
    def time(self) -> float:
        """Seconds that have passed."""
    @property
    def profile(self) -> dict[str, float]:
        """Milliseconds that each stage of the last step took: a dict of "integrate",
        "build", "pairs", "contacts" and "resolve", and "forces" where there are any.
        """
    @property
    def stats(self) -> Stats:
        """What the search of the last step looked like: a `Stats` of four integers, `nodes`,
        `leaves` and `depth` of the tree, and `tests`, the pairs that were tested.
        """
    def state_hash(self) -> int:
        """Sum up all particles in 64 bits.

        Returns
        -------
        int
            The same for the same particles on every machine.

        Examples
        --------
        >>> import jostle
        >>> worlds = [jostle.World([(0, 0)], [(1, 0)], radii=1.0) for _ in range(2)]
        >>> worlds[0].state_hash() == worlds[1].state_hash()
        True
        """
    def snapshot(self) -> bytes:
        """Put all of the world into bytes.

        Returns
        -------
        bytes
            Particles, settings, forces, the time, and what leans on what. They are the same
            on every machine, and a world that `restore` makes of them goes on to the bit.

        Examples
        --------
        >>> import jostle
        >>> world = jostle.World([(0, 0)], [(1, 0)], radii=1.0)
        >>> before = world.snapshot()
        >>> world.step(0.5, steps=4)
        >>> world.time, jostle.World.restore(before).time
        (2.0, 0.0)
        """
    @classmethod
    def restore(cls, data: bytes | bytearray | memoryview) -> World:
        """Make a world of the bytes of `snapshot`.

        Parameters
        ----------
        data : bytes, bytearray or memoryview

        Returns
        -------
        World

        Raises
        ------
        TypeError
            If `data` are no bytes.
        ValueError
            If they are not from `snapshot`, or cut off or damaged since.

        Examples
        --------
        >>> import jostle
        >>> world = jostle.scenes.create("gas", n=100)
        >>> copy = jostle.World.restore(world.snapshot())
        >>> world.step(0.01, steps=50); copy.step(0.01, steps=50)
        >>> copy.state_hash() == world.state_hash()
        True
        """
    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the world into a file.

        Parameters
        ----------
        path : str or os.PathLike
            A file that is there is replaced, once the new one is whole; it keeps its
            permissions. A symbolic link stays, and the file that it leads to is replaced.

        Raises
        ------
        OSError
            If the file cannot be written; then an old one is left as it was.

        Examples
        --------
        >>> import jostle, os, tempfile
        >>> path = os.path.join(tempfile.mkdtemp(), "gas.jostle")
        >>> jostle.scenes.create("gas", n=100).save(path)
        >>> len(jostle.World.load(path))
        100
        """
    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> World:
        """Read a world from a file that `save` has written.

        Parameters
        ----------
        path : str or os.PathLike

        Returns
        -------
        World

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If there is no world in it, or it is cut off or damaged; the sentence names the
            file.

        Examples
        --------
        >>> import jostle, os, tempfile
        >>> path = os.path.join(tempfile.mkdtemp(), "pile.jostle")
        >>> jostle.scenes.create("pile", n=50).save(path)
        >>> jostle.World.load(path)
        <jostle.World of 50 particles after 0.000 s>
        """
    def __reduce__(self) -> tuple[Callable[[bytes], World], tuple[bytes]]: ...
    def __len__(self) -> int: ...

@final
class Box:
    """Four walls around a rectangle.

    Parameters
    ----------
    min_x, min_y, max_x, max_y : float
        Its sides, in units of length; min below max. Kept as float32.

    Raises
    ------
    TypeError
        If an argument is not a number.
    ValueError
        If a side is not finite or min is not below max.

    Examples
    --------
    >>> import jostle
    >>> jostle.Box(0, 0, 800, 500).max_x
    800.0
    >>> jostle.Box(0, 0, 800, 500) == jostle.Box(0.0, 0.0, 800.0, 500.0)
    True
    """

    __match_args__: Final = ("min_x", "min_y", "max_x", "max_y")
    def __new__(cls, min_x: _Number, min_y: _Number, max_x: _Number, max_y: _Number) -> Self: ...
    @property
    def min_x(self) -> float:
        """Left side."""
    @property
    def min_y(self) -> float:
        """Top side where y grows downwards."""
    @property
    def max_x(self) -> float:
        """Right side."""
    @property
    def max_y(self) -> float:
        """Bottom side where y grows downwards."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[float, float, float, float]: ...

@final
class Circle:
    """One round wall.

    Parameters
    ----------
    center : array_like, shape (2,)
        Its centre, in units of length. Kept as float32.
    radius : float
        Its radius, above 0. Kept as float32.

    Raises
    ------
    TypeError
        If an argument does not hold numbers.
    ValueError
        If a number is not finite or the radius not above 0.

    Examples
    --------
    >>> import jostle
    >>> jostle.Circle((400, 250), radius=240).center
    (400.0, 250.0)
    """

    __match_args__: Final = ("center", "radius")
    def __new__(cls, center: ArrayLike | _Vector, radius: _Number) -> Self: ...
    @property
    def center(self) -> tuple[float, float]:
        """Its centre, (x, y)."""
    @property
    def radius(self) -> float:
        """Its radius."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[tuple[float, float], float]: ...

@final
class Torus:
    """A rectangle from (0, 0) whose opposite sides are one: what leaves on the right
    comes in on the left.

    Parameters
    ----------
    width, height : float
        Its sides, in units of length, above 0. Kept as float32.

    Raises
    ------
    TypeError
        If an argument is not a number.
    ValueError
        If a side is not finite and above 0.

    Examples
    --------
    >>> import jostle
    >>> jostle.Torus(800, 500)
    Torus(800.0, 500.0)
    """

    __match_args__: Final = ("width", "height")
    def __new__(cls, width: _Number, height: _Number) -> Self: ...
    @property
    def width(self) -> float:
        """From left to right."""
    @property
    def height(self) -> float:
        """From top to bottom."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[float, float]: ...

@final
class Attractor:
    """A pull to a point, or to a particle.

    A particle of the world feels nothing of what it attracts. On a torus the nearest
    image of the point pulls.

    Parameters
    ----------
    point : array_like, shape (2,), optional
        Where to, in units of length; or give `particle`.
    strength : float
        Acceleration for each unit of distance ("harmonic"), or G times the mass that
        pulls ("inverse_square"). Below 0 it pushes.
    law : {"harmonic", "inverse_square"}, default "harmonic"
        Acceleration is strength times distance, as in the article, or strength over
        distance squared; nearer than its own radius a particle is then pulled as by a
        ball of that radius.
    particle : int, optional
        Id of the particle that it follows, and with which it goes.

    Raises
    ------
    TypeError
        If not one of `point` and `particle` is given, or one holds no numbers.
    ValueError
        If a number is not finite, or there is no such law.

    Examples
    --------
    >>> import jostle
    >>> pull = jostle.Attractor((0, 0), 4.0)
    >>> world = jostle.World([(3, 0)], [(0, 0)], radii=1.0, forces=[pull])
    >>> world.step(0.0078539816, steps=200)  # half a swing, π/2 seconds
    >>> world.positions.round(3)
    array([[-3.,  0.]], dtype=float32)
    >>> jostle.Attractor(particle=0, strength=9.0, law="inverse_square")
    Attractor(None, 9.0, 'inverse_square', particle=0)
    """

    def __new__(
        cls,
        point: ArrayLike | _Vector | None = None,
        strength: _Number | None = None,
        law: Literal["harmonic", "inverse_square"] = "harmonic",
        *,
        particle: SupportsIndex | None = None,
    ) -> Self: ...
    @property
    def point(self) -> tuple[float, float] | None:
        """Where it pulls to, (x, y); None if it follows a particle."""
    @property
    def strength(self) -> float:
        """Acceleration for each unit of distance, or G times the mass that pulls."""
    @property
    def law(self) -> Literal["harmonic", "inverse_square"]:
        """ "harmonic" or "inverse_square"."""
    @property
    def particle(self) -> int | None:
        """Id of the particle that it follows, or None. It changes in a world when particles
        before this one are removed.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs_ex__(
        self,
    ) -> tuple[tuple[tuple[float, float] | None, float, str], dict[str, int | None]]: ...

@final
class Gravitation:
    """All particles pull each other by their masses.

    The acceleration of each is the sum of G m d / (d² + softening²)^(3/2) over all
    others; on a torus everything pulls from its nearest image. Many particles are
    summed up by Barnes and Hut's method on a quadtree, to about half a percent with
    the default `theta`; few are added one by one. Momentum is kept.

    Parameters
    ----------
    G : float
        The constant of gravitation.
    softening : float, default 0.0
        A distance below which the pull weakens.
    theta : float, default 0.5
        A box counts as one body where its diagonal over its distance is less; 0 to 1.
        With 0 every pair is added up.

    Raises
    ------
    TypeError
        If an argument is not a number.
    ValueError
        If a number is out of range.

    Examples
    --------
    >>> import jostle
    >>> pull = jostle.Gravitation(1.0)
    >>> world = jostle.World([(-2, 0), (2, 0)], [(0, -.25), (0, .25)], .1, masses=1.0, forces=[pull])
    >>> world.step(0.1, steps=100)
    >>> [abs(round(p, 5)) for p in world.momentum]
    [0.0, 0.0]
    """

    __match_args__: Final = ("G", "softening", "theta")
    def __new__(cls, G: _Number, softening: _Number = 0.0, theta: _Number = 0.5) -> Self: ...
    @property
    def G(self) -> float:
        """The constant of gravitation."""
    @property
    def softening(self) -> float:
        """A distance below which the pull weakens."""
    @property
    def theta(self) -> float:
        """Diagonal over distance below which a box counts as one body."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[float, float, float]: ...

@final
class Springs:
    """Pairs of particles that are tied together.

    Each spring pulls its ends with stiffness times its stretch, and with damping times
    the speed at which it gets longer. Stiff ones act in short parts of a sub-step; what
    is too stiff even for these is softened. A spring goes with either of its ends.

    Parameters
    ----------
    pairs : array_like of int, shape (m, 2)
        Ids of the two ends of each.
    lengths : array_like, a number or shape (m,)
        At rest, in units of length.
    stiffness : array_like, a number or shape (m,)
        Force for each unit of length.
    damping : array_like, a number or shape (m,), default 0.0
        Force for each unit of speed.
    max_stretch : array_like, a number or shape (m,), optional
        A spring that is longer than at rest by more than this, in units of length,
        breaks at the end of a step. Left out, none breaks.

    Raises
    ------
    TypeError
        If an argument does not hold what it should.
    ValueError
        If a shape is wrong or a number is out of range; the sentence says which.

    Examples
    --------
    >>> import jostle
    >>> tie = jostle.Springs([(0, 1)], lengths=2.0, stiffness=40.0, damping=4.0)
    >>> world = jostle.World([(0, 0), (3, 0)], [(0, 0)] * 2, radii=0.5, masses=1.0, forces=[tie])
    >>> world.step(0.01, steps=500)
    >>> world.positions.round(3)
    array([[0.5, 0. ],
           [2.5, 0. ]], dtype=float32)
    """

    __match_args__: Final = ("pairs", "lengths", "stiffness", "damping", "max_stretch")
    def __new__(
        cls,
        pairs: ArrayLike,
        lengths: ArrayLike,
        stiffness: ArrayLike,
        damping: ArrayLike = 0.0,
        max_stretch: ArrayLike | None = None,
    ) -> Self: ...
    @property
    def pairs(self) -> _Pairs:
        """Ids of the ends: read-only ndarray of int64, shape (m, 2). They change in a world when
        particles before them are removed.
        """
    @property
    def lengths(self) -> NDArray[np.float32]:
        """Lengths at rest: ndarray of float32, shape (m,)."""
    @property
    def stiffness(self) -> NDArray[np.float32]:
        """Force for each unit of length: ndarray of float32, shape (m,)."""
    @property
    def damping(self) -> NDArray[np.float32]:
        """Force for each unit of speed: ndarray of float32, shape (m,)."""
    @property
    def max_stretch(self) -> NDArray[np.float32]:
        """Stretch beyond which each breaks: ndarray of float32, shape (m,); infinite where
        it never does.
        """
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]
    def __getnewargs__(self) -> tuple[NDArray[Any], ...]: ...

@final
class Thermostat:
    """Walls that drive what bounces off them towards a speed.

    Every bounce off a wall changes a particle's speed s to s + rate (speed - s), as in
    the article's lesson about gases. A world has one at most.

    Parameters
    ----------
    speed : float
        In units of length a second, at least 0.
    rate : float
        The walls' share, 0 to 1; with 1 everything leaves them at `speed`.

    Raises
    ------
    TypeError
        If an argument is not a number.
    ValueError
        If a number is out of range.

    Examples
    --------
    >>> import jostle
    >>> warm = jostle.Thermostat(speed=3.0, rate=0.5)
    >>> box = jostle.Box(0, 0, 10, 10)
    >>> world = jostle.World([(5, 5)], [(1, 0)], radii=1.0, container=box, forces=[warm])
    >>> world.step(0.1, steps=60)  # it bounces off the right wall after four seconds
    >>> world.velocities
    array([[-2.,  0.]], dtype=float32)
    """

    __match_args__: Final = ("speed", "rate")
    def __new__(cls, speed: _Number, rate: _Number) -> Self: ...
    @property
    def speed(self) -> float:
        """The speed of the walls."""
    @property
    def rate(self) -> float:
        """Their share in a bounce."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[float, float]: ...

def scene_names() -> list[str]:
    """List the scenes.

    Returns
    -------
    list of str
        Their names.

    Examples
    --------
    >>> import jostle
    >>> "gas" in jostle.scenes.names()
    True
    """

def describe_scene(name: str) -> str:
    """Say what there is to see in a scene.

    Parameters
    ----------
    name : str
        One of `names()`.

    Returns
    -------
    str
        Two sentences.

    Raises
    ------
    ValueError
        If there is no such scene.

    Examples
    --------
    >>> import jostle
    >>> print(jostle.scenes.describe("billiards"))
    A cue ball breaks a rack of balls. Follow how the momentum of one spreads over all.
    """

def create_scene(name: str, n: SupportsIndex | None = None, seed: SupportsIndex = 0) -> World:
    """Set a scene up.

    Parameters
    ----------
    name : str
        One of `names()`.
    n : int, optional
        Number of particles; as many as suit the scene unless given. Sizes follow. The
        beads that walls are strung of, and the pegs of `galton`, come in addition, and
        first. For `emitters` it is the most drops that there will be.
    seed : int, default 0
        The same seed gives the same world on every machine.

    Returns
    -------
    World
        In pixels and seconds, y growing downwards, made for steps of 1/60 s.

    Raises
    ------
    ValueError
        If there is no such scene, or `n` or `seed` is out of range.

    Examples
    --------
    >>> import jostle
    >>> world = jostle.scenes.create("pile", n=100)
    >>> world.step(1 / 60)
    >>> len(world)
    100
    """

def scene_view(name: str, n: SupportsIndex | None = None) -> tuple[float, float, float, float]:
    """Say which part of a scene's world to look at.

    Parameters
    ----------
    name : str
        One of `names()`.
    n : int, optional
        Number of particles, as for `create`.

    Returns
    -------
    tuple of float
        min_x, min_y, max_x, max_y, in pixels.

    Raises
    ------
    ValueError
        If there is no such scene or `n` is out of range.

    Examples
    --------
    >>> import jostle
    >>> jostle.scenes.view("article")
    (0.0, 0.0, 800.0, 500.0)
    """

def scene_default_count(name: str) -> int:
    """Say how many particles suit a scene.

    Parameters
    ----------
    name : str
        One of `names()`.

    Returns
    -------
    int
        What `create` takes where no `n` is given.

    Raises
    ------
    ValueError
        If there is no such scene.

    Examples
    --------
    >>> import jostle
    >>> jostle.scenes.default_count("billiards")
    16
    """

def scene_fountains(n: SupportsIndex | None = None) -> list[Nozzle]:
    """Say where the drops of the scene `emitters` come from.

    A world has nothing that makes particles: whoever steps it adds what is due, and takes
    the oldest drops away where there would be more than `n`.

    Parameters
    ----------
    n : int, optional
        Most drops that there will be, as for `create`.

    Returns
    -------
    list of Nozzle
        Each with position, velocity, width, spread, radii, density and drops_per_second.

    Raises
    ------
    ValueError
        If `n` is out of range.

    Examples
    --------
    >>> import jostle
    >>> nozzles = jostle.scenes.fountains(3000)
    >>> [nozzle.position for nozzle in nozzles]
    [(-380.0, -135.0), (0.0, -342.0), (380.0, -135.0)]
    """

def scene_galton_board(n: SupportsIndex | None = None) -> GaltonBoard:
    """Say where things are on the board of the scene `galton`.

    Parameters
    ----------
    n : int, optional
        Number of balls, as for `create`.

    Returns
    -------
    GaltonBoard
        rows, bin_edges, bin_top, floor and ball_radius.

    Raises
    ------
    ValueError
        If `n` is out of range.

    Examples
    --------
    >>> import jostle
    >>> board = jostle.scenes.galton_board(400)
    >>> board.rows, len(board.bin_edges)
    (10, 12)
    """

def scene_wall(start: _Point, end: _Point, radius: _Number) -> NDArray[np.float32]:
    """String beads in a straight line, for a wall of immovable discs.

    They lie so close that what slides along them feels a smooth wall, and nothing gets
    through between two.

    Parameters
    ----------
    start, end : tuple of float
        Centres of the first bead and the last, x and y.
    radius : float
        Of each bead; half the thickness of the wall.

    Returns
    -------
    ndarray of float32, shape (k, 2)
        Their centres, from `start` to `end`, at most 0.4 radii apart. One, if the two are
        the same.

    Raises
    ------
    ValueError
        If a number is not finite, `radius` is not above 0, or so thin a wall would have
        more than a million beads.

    Examples
    --------
    >>> import jostle
    >>> beads = jostle.scenes.wall((0, 0), (30, 40), radius=5)
    >>> beads.shape
    (26, 2)
    >>> world = jostle.World(beads, 0 * beads, 5, movable=False)
    """
