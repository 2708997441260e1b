"""The compiled module of jostle."""

import math
import os
from collections.abc import Callable, Iterable, Sequence
from typing import (Any, Final, Literal, Protocol, SupportsFloat, SupportsIndex, TypeAlias, final, overload,
    type_check_only)

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray
from typing_extensions import Self

from jostle.results import (Contacts, GaltonBoard, IdLists, LastCall, LastStep, Neighbors, Nodes, Particle, Particles,
    RayHit, RayHitLists, RayHits, Separated, Shape, Shapes, Slide, Slides, Stats, Wall, WallColumns, WallEvents,
    WorldEvents)
from jostle.walls import Side

__all__ = ["AndersenThermostat", "Attractor", "Box", "Circle", "Events", "Flocking", "Grab", "Gravitation", "Motor",
    "PairForce", "Pump", "Quadtree", "RankError", "Space", "Springs", "ThermalWalls", "Thermostat", "Walls", "World",
    "__version__", "abandon_threads", "begin_hash", "checksum", "create_scene", "create_scene_part", "describe_scene",
    "find_pairs", "hash_parts", "hash_records", "instructions", "record_fields", "restore_events", "restore_space",
    "scene_default_count", "scene_galton_board", "scene_names", "scene_view", "separate", "sprite_dict", "sprite_pairs",
    "sprite_sides", "wake_threads_always"]

__version__: Final[str]

_Number: TypeAlias = SupportsFloat | SupportsIndex

class _Vector(Protocol):
    """A point with the attributes x and y, such as pygame's Vector2."""

    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...

class _Rect(Protocol):
    """A rectangle with its sides as attributes, such as pygame's Rect."""

    @property
    def left(self) -> float: ...
    @property
    def top(self) -> float: ...
    @property
    def right(self) -> float: ...
    @property
    def bottom(self) -> float: ...

class _Array(Protocol):
    """An array, or an object that NumPy converts to one, such as a table of pandas; not a number."""

    def __array__(self) -> NDArray[Any]: ...
    def __len__(self) -> int: ...

# One or many: a query with one point returns `RayHit` or an array of ids, with many `RayHits` or
# `IdLists`. Its overloads are in this order, in which mypy and pyright choose the same:
#
# 1. One: a tuple or a vector. A tuple of two values of type Any is one.
# 2. Many: an array, or a sequence of anything but numbers. A list of values of type Any is many.
# 3. One: any other sequence of numbers.
# 4. An argument of type Any, which matches every overload. Then mypy infers Any; pyright does so
#    only if the last result is a union with Any, otherwise strict mode reports an unknown type.
#
# Type checkers rarely know the number of dimensions of an array, so an array is many. A point that
# is an array is passed as `tuple(array)`.
@final
class _Undecided:
    """Stands for an argument of type Any; no value has this type."""

# `_Number` cannot distinguish a number from an array, which has `__float__` and `__index__` too.
_Real: TypeAlias = float | np.floating[Any] | np.integer[Any]
_Id: TypeAlias = int | np.integer[Any]
_Reals: TypeAlias = _Array | Sequence[_Real]
_IdList: TypeAlias = _Array | Sequence[_Id]
_Mask: TypeAlias = SupportsIndex | None
_Exclude: TypeAlias = SupportsIndex | _IdList | None
_Point: TypeAlias = tuple[_Real, _Real] | _Vector
_Points: TypeAlias = _Array | Sequence[Sequence[_Real] | _Vector | _Array]
_AnyPoint: TypeAlias = _Point | Sequence[_Real]
_OneOrMorePoints: TypeAlias = _AnyPoint | _Points
_Vectors: TypeAlias = ArrayLike | _Vector | Sequence[_Vector]
_Boxes: TypeAlias = ArrayLike | Sequence[_Rect]
_Segment: TypeAlias = Sequence[Sequence[_Real] | _Vector]
_Segments: TypeAlias = _Array | Sequence[Sequence[Sequence[_Real] | _Vector] | _Array]
_Ids: TypeAlias = NDArray[np.int64]
_Pairs: TypeAlias = NDArray[np.int64]
_Period: TypeAlias = _Number | tuple[_Number | None, _Number | None] | Sequence[_Number] | _Array
_Container: TypeAlias = Box | Circle
_Coefficient: TypeAlias = float | tuple[float | None, float | None, float | None, float | None] | None
_Force: TypeAlias = (Attractor | Gravitation | Springs | Thermostat | ThermalWalls | AndersenThermostat | Pump | Motor
    | Grab | PairForce | Flocking)

def abandon_threads() -> None:
    """Abandons the threads of the parent process, which do not exist in a forked process."""

def instructions() -> str:
    """The vector instructions that searches and steps use on this processor: "AVX-512", "AVX2" or "baseline", those of
    every processor of the architecture. Results do not depend on them."""
def wake_threads_always(always: bool) -> None:
    """Lets small calls wake other threads. For tests."""

@overload
def find_pairs(positions: _Vectors, radii: ArrayLike = 0.0, half_sizes: ArrayLike | None = None, *, boxes: None = None,
        segments: None = None, categories: ArrayLike | None = None, masks: ArrayLike | None = None,
        distance: _Number = 0.0, period: _Period | None = None, method: Literal["auto", "brute", "quadtree"] = "auto",
        sort: bool = False, max_pairs: SupportsIndex = 134217728, threads: SupportsIndex | None = None) -> _Pairs:
    """Find every pair of overlapping shapes.

    A shape is every point within `radius` of its core: the axis-aligned box ``center ± half_size``, one of `boxes`, or
    one of `segments`. A circle has half size 0, a rectangle radius 0. Touching is not overlapping.

    Parameters
    ----------
    positions : array_like, shape (n, 2), optional
        Centres, in any unit of length; required unless `boxes` or `segments` are given.
    radii : array_like, a number or shape (n,), default 0.0
        Radii, in the same unit.
    half_sizes : array_like, a number, shape (2,) or (n, 2), optional
        Half widths and half heights. If omitted, every shape is a circle.
    boxes : array_like, shape (n, 4), optional
        Sides min_x, min_y, max_x, max_y of each shape, in place of `positions` and `half_sizes`. Objects with the
        attributes `left`, `top`, `right` and `bottom`, such as pygame's Rect, are accepted in a list or a tuple, but
        not in an array, which NumPy fills with x, y, width and height. The four numbers are compared without rounding:
        boxes that share an edge never overlap, whereas sides computed as ``center ± half_size`` are rounded. With
        `radii`, the shapes are rounded boxes.
    segments : array_like, shape (n, 2, 2), optional
        Start and end of each shape, in place of `positions` and `half_sizes`: line segments, or capsules with `radii`.
        Segments that cross overlap; those that share an end, or lie on one line, do not. With a period the ends are at
        most one period apart along each axis.
    categories, masks : array_like of int, a number or shape (n,), optional
        Bit sets of 32 bits: shapes i and j may pair only if ``categories[i] & masks[j]`` and
        ``categories[j] & masks[i]``. If omitted, categories are 1 and masks have all bits.
    distance : float, default 0.0
        Find pairs whose gap is below this, in units of length: each radius is increased by half of it. If 0, the shapes
        must overlap.
    period : float or (float, float), optional
        Width and height of a periodic plane, one number for both; 0 or None on an axis that is not periodic. Positions
        that differ by a multiple of the period are equal, and the gap along an axis is that of the minimum image.
    method : {"auto", "brute", "quadtree"}, default "auto"
        How the pairs are found; the pairs are the same. "auto" uses brute force for few shapes, a uniform grid for
        circles of one radius unless they are sparse, and otherwise the tree.
    sort : bool, default False
        Whether to sort the pairs by the first, then by the second shape. If False, their order is not specified.
    max_pairs : int, default 134217728
        Maximum number of pairs to return; the default corresponds to 2 GiB.
    threads : int, optional
        Number of threads, at most one for each core, which is the default. The answer is the same for every number.

    Returns
    -------
    ndarray of int64, shape (m, 2)
        Row numbers ``i < j`` of each pair, every pair once.

    Raises
    ------
    TypeError
        If an argument does not hold numbers, or if not exactly one of `positions`, `boxes` and `segments` is given.
    ValueError
        If a shape is wrong, a value is not finite, a size is negative or out of range, or more than `max_pairs` pairs
        overlap.
    MemoryError
        If there is no memory for the pairs.

    Notes
    -----
    Arithmetic is float32 if every given array is float32, otherwise float64; lists of numbers count as float64. A plain
    number, or a plain pair of half sizes, takes the precision of the given arrays.

    Centres may be anywhere. A radius is 0, or between 1e-18 and 1e18 in float32 and between 1e-150 and 1e150 in
    float64: squares of other numbers overflow or lose digits. A half size is at most an eighth of the largest number of
    the type, a box at most twice as wide and high as that."""

@overload
def find_pairs(positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *, boxes: _Boxes,
        segments: None = None, categories: ArrayLike | None = None, masks: ArrayLike | None = None,
        distance: _Number = 0.0, period: _Period | None = None, method: Literal["auto", "brute", "quadtree"] = "auto",
        sort: bool = False, max_pairs: SupportsIndex = 134217728, threads: SupportsIndex | None = None) -> _Pairs: ...
@overload
def find_pairs(positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *, boxes: None = None,
        segments: ArrayLike, categories: ArrayLike | None = None, masks: ArrayLike | None = None,
        distance: _Number = 0.0, period: _Period | None = None, method: Literal["auto", "brute", "quadtree"] = "auto",
        sort: bool = False, max_pairs: SupportsIndex = 134217728, threads: SupportsIndex | None = None) -> _Pairs: ...

class RankError(RuntimeError):
    """Another rank could not do its part of a call, so no rank completes it.

    The rank with the cause raises the cause itself. The others raise this error with the number of that rank and its
    message."""

def begin_hash(total: int) -> int:
    """Begin the hash of the state of `total` particles. For `jostle.mpi`."""
def checksum(bytes: bytes) -> int:
    """The checksum of bytes in files. For `jostle.mpi`."""
def hash_parts(records: bytes) -> list[int]:
    """The parts of the hash of the state that depend on the particles of records. For `jostle.mpi`."""
def hash_records(hash: int, records: bytes, part: int) -> int:
    """Continue the hash of the state with one part of the particles of records. For `jostle.mpi`."""
def record_fields() -> list[tuple[str, str]]:
    """The fields of a record after the id, as NumPy writes them. For `jostle.mpi`."""
def restore_events(entered: _Pairs, stayed: _Pairs, exited: _Pairs, categories: tuple[Any, ...]) -> Events:
    """Events with these pairs. For pickle."""
def restore_space(options: dict[str, Any], state: tuple[Any, ...]) -> Space:
    """A space with the contents that pickle has stored."""
def sprite_pairs(left: list[Any], right: list[Any] | None, rule: Literal["rect", "rects", "circle", "mask", "within"],
        scale: float, types: tuple[type, type],
        radius_of: Callable[[Any], float] | None = None) -> tuple[NDArray[np.uint32], NDArray[np.bool_] | None] | None:
    """Find which sprites collide."""
def sprite_sides(sprites: list[Any], types: tuple[type, type]) -> NDArray[np.float64] | None:
    """Read the rects of sprites."""
def sprite_dict(pairs: NDArray[np.uint32], keys: list[Any], values: list[Any]) -> dict[Any, list[Any]]:
    """Group the second rows of sorted pairs by their first rows."""

def separate(positions: _Vectors, radii: ArrayLike = 0.0, half_sizes: ArrayLike | None = None, *,
        weights: ArrayLike = 1.0, movable: ArrayLike = True, axis: SupportsIndex | None = None, gap: _Number = 0.0,
        bounds: ArrayLike | None = None, max_rounds: SupportsIndex = 1000, tolerance: _Number = 0.01,
        threads: SupportsIndex | None = None) -> Separated:
    """Move shapes apart until none overlap.

    Overlapping pairs move apart along their contact normals, in repeated rounds over all near pairs. Of each pair the
    shape with the larger weight moves less. A region with more shapes than fit into it is enlarged first. A few shapes
    that still overlap move to the nearest free positions. Shapes that overlap nothing do not move, unless others push
    them.

    Parameters
    ----------
    positions : array_like, shape (n, 2)
        Centres, in any unit of length.
    radii : array_like, a number or shape (n,), default 0.0
        Radii, in the same unit.
    half_sizes : array_like, a number, shape (2,) or (n, 2), optional
        Half widths and half heights. If omitted, every shape is a circle.
    weights : array_like, a number or shape (n,), default 1.0
        Weights above 0. Of two overlapping shapes, one with twice the weight of the other moves half as far.
    movable : array_like of bool, True or False or shape (n,), default True
        Whether shapes may move; the others stay where they are. Pairs of two others may overlap.
    axis : {0, 1}, optional
        Move the shapes only along x (0) or only along y (1). If rounds do not succeed, the shapes are placed one after
        another at the nearest free positions, as in a swarm plot.
    gap : float, default 0.0
        Least distance between the surfaces of two shapes.
    bounds : array_like, shape (4,), optional
        Region as min_x, min_y, max_x, max_y: all movable shapes are moved inside entirely; with `axis`, along that axis
        alone.
    max_rounds : int, default 1000
        Maximum number of rounds. A small number, such as 8, spreads motion over several calls; with fewer than 32,
        crowded regions are not enlarged.
    tolerance : float, default 0.01
        Overlapping shapes are moved apart by this share of their size more than needed. A smaller number needs more
        rounds.
    threads : int, optional
        Number of threads, at most one for each core, which is the default. The answer is the same for every number.

    Returns
    -------
    Separated
        The new positions, and the number of remaining overlaps.

        positions : ndarray of float32 or float64, shape (n, 2)
            The new centres.
        rounds : int
            Number of rounds, at most `max_rounds`; placing along an axis counts as one.
        overlaps : int
            Number of pairs that still overlap, or are closer than `gap`, without pairs of two that may not move; 0 if
            the shapes are separated.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If a shape is wrong, a value is out of range, or a shape is larger than `bounds`.

    Notes
    -----
    Arithmetic is float32 if every given array is float32, otherwise float64. The order of the shapes has no effect,
    except that it distinguishes shapes with equal values at the same place. If the bounds are too small for the shapes,
    some overlap at the end."""

@type_check_only
class _Queries:
    """The queries of every class that holds shapes."""

    @overload
    def query_rect(self, rect: tuple[_Real, _Real, _Real, _Real] | _Rect | Box, *, mask: _Mask = None,
            exclude: _Exclude = None) -> _Ids:
        """Find the shapes that overlap a rectangle, or each of many.

        Parameters
        ----------
        rect : array_like, shape (4,) or (k, 4)
            Sides min_x, min_y, max_x, max_y, not width and height. Objects with the attributes `left`, `top`, `right`
            and `bottom`, such as pygame's Rect, or `min_x`, `min_y`, `max_x` and `max_y`, such as :class:`jostle.Box`
            (float32), are accepted, also in a list.
        mask : int, optional
            Find only shapes with a category in this set of bits.
        exclude : int or array_like of int, shape (k,), optional
            An id that is not found, one for all queries or one for each; -1 is none, as is an id that nothing has.

        Returns
        -------
        ndarray of int64, shape (m,), or IdLists
            Ids, ascending; for many rectangles the list of each. A shape that only touches a rectangle does not overlap
            it.

        Raises
        ------
        ValueError
            If a number is not finite, a minimum is above its maximum, or there are more than 134217728 ids.

        Notes
        -----
        The ids of a `Quadtree` are row numbers. Queries are converted to its dtype; the result is that of brute force
        in this arithmetic. Many queries in one call use all threads. A shape without categories (0) is found only if no
        mask is given."""
    @overload
    def query_rect(self, rect: _Array | Sequence[Sequence[_Real] | _Rect | Box | _Array], *, mask: _Mask = None,
            exclude: _Exclude = None) -> IdLists: ...
    @overload
    def query_rect(self, rect: Sequence[_Real], *, mask: _Mask = None, exclude: _Exclude = None) -> _Ids: ...
    @overload
    def query_rect(self, rect: _Undecided, *, mask: _Mask = None, exclude: _Exclude = None) -> _Ids | IdLists | Any: ...
    @overload
    def query_circle(self, center: _Point, radius: _Real, *, mask: _Mask = None, exclude: _Exclude = None) -> _Ids:
        """Find the shapes that overlap a disc, or each of many.

        Parameters
        ----------
        center : array_like, shape (2,) or (k, 2)
            Centres.
        radius : array_like, a number or shape (k,)
            Radii. With one centre and many radii, all discs have that centre.
        mask : int, optional
            Find only shapes with a category in this set of bits.
        exclude : int or array_like of int, shape (k,), optional
            An id that is not found, one for all queries or one for each; -1 is none, as is an id that nothing has.

        Returns
        -------
        ndarray of int64, shape (m,), or IdLists
            Ids, ascending; for many discs the list of each. A shape that only touches a disc does not overlap it.

        Raises
        ------
        ValueError
            If a number is not finite, a radius is out of range, or there are more than 134217728 ids."""
    @overload
    def query_circle(self, center: _Points, radius: _Real | _Reals, *, mask: _Mask = None,
            exclude: _Exclude = None) -> IdLists: ...
    @overload
    def query_circle(self, center: _OneOrMorePoints, radius: _Reals, *, mask: _Mask = None,
            exclude: _Exclude = None) -> IdLists: ...
    @overload
    def query_circle(self, center: Sequence[_Real], radius: _Real, *, mask: _Mask = None,
            exclude: _Exclude = None) -> _Ids: ...
    @overload
    def query_circle(self, center: _AnyPoint | _Undecided, radius: _Real | _Undecided, *, mask: _Mask = None,
            exclude: _Exclude = None) -> _Ids | IdLists | Any: ...
    @overload
    def query_point(self, point: _Point, *, mask: _Mask = None, exclude: _Exclude = None) -> _Ids:
        """Find the shapes that contain a point, or each of many points.

        A circle, a rounded box, a segment or a capsule contains its edge. A rectangle contains its left and its upper
        edge, but not the right and the lower, as in pygame, so tiles side by side share no point. A rectangle of width
        and height 0 is a circle of radius 0.

        Parameters
        ----------
        point : array_like, shape (2,) or (k, 2)
            Points.
        mask : int, optional
            Find only shapes with a category in this set of bits.
        exclude : int or array_like of int, shape (k,), optional
            An id that is not found, one for all queries or one for each; -1 is none, as is an id that nothing has.

        Returns
        -------
        ndarray of int64, shape (m,), or IdLists
            Ids, ascending; for many points the list of each.

        Raises
        ------
        ValueError
            If a coordinate is not finite, or there are more than 134217728 ids."""
    @overload
    def query_point(self, point: _Points, *, mask: _Mask = None, exclude: _Exclude = None) -> IdLists: ...
    @overload
    def query_point(self, point: Sequence[_Real], *, mask: _Mask = None, exclude: _Exclude = None) -> _Ids: ...
    @overload
    def query_point(self, point: _Undecided, *, mask: _Mask = None,
            exclude: _Exclude = None) -> _Ids | IdLists | Any: ...
    @overload
    def query_polygon(self, vertices: _Array | Sequence[_Point], *, mask: _Mask = None,
            exclude: _Exclude = None) -> _Ids:
        """Find the shapes that overlap a convex polygon, or each of many.

        Parameters
        ----------
        vertices : array_like, shape (v, 2) or (k, v, 2)
            Corners in order, clockwise or counterclockwise.
        mask : int, optional
            Find only shapes with a category in this set of bits.
        exclude : int or array_like of int, shape (k,), optional
            An id that is not found, one for all queries or one for each; -1 is none, as is an id that nothing has.

        Returns
        -------
        ndarray of int64, shape (m,), or IdLists
            Ids, ascending; for many polygons the list of each. A shape that only touches a polygon does not overlap it.

        Raises
        ------
        ValueError
            If a polygon has fewer than three corners, is not convex or has no area, if a coordinate is not finite, or
            there are more than 134217728 ids."""
    @overload
    def query_polygon(self, vertices: Sequence[_Points], *, mask: _Mask = None,
            exclude: _Exclude = None) -> IdLists: ...
    @overload
    def query_polygon(self, vertices: Sequence[Sequence[_Real]], *, mask: _Mask = None,
            exclude: _Exclude = None) -> _Ids: ...
    @overload
    def query_polygon(self, vertices: _Undecided, *, mask: _Mask = None,
            exclude: _Exclude = None) -> _Ids | IdLists | Any: ...
    def nearest(self, point: _OneOrMorePoints, k: SupportsIndex = 1, *, max_distance: _Number | _Reals = math.inf,
            mask: _Mask = None, exclude: _Exclude = None) -> Neighbors:
        """Find the shapes nearest to a point, or to each of many.

        Parameters
        ----------
        point : array_like, shape (2,) or (n, 2)
            Points.
        k : int, default 1
            Number of shapes to find.
        max_distance : array_like, a number or shape (n,), default inf
            Ignore shapes farther than this, in units of length.
        mask : int, optional
            Find only shapes with a category in this set of bits.
        exclude : int or array_like of int, shape (n,), optional
            An id that is not found, one for all points or one for each; -1 is none, as is an id that nothing has.

        Returns
        -------
        Neighbors
            With the fields:

            ids : ndarray of int64, shape (k,) or (n, k)
                Ids, the smaller first at equal distances; -1 if fewer than k are found; remove those before you use
                them as an index.
            distances : ndarray of float32 or float64, shape (k,) or (n, k)
                Distances to the surfaces, nearest first; 0 inside a shape, infinity if fewer than k are found.

        Raises
        ------
        ValueError
            If a coordinate is not finite, k is less than 1, k times the number of points is more than 134217728, or
            `max_distance` is negative."""
    @overload
    def raycast(self, origin: _Point, direction: _Point, *, max_distance: _Number = math.inf, mask: _Mask = None,
            exclude: _Exclude = None) -> RayHit:
        """Find the first shape that a ray hits, or each of many rays.

        Parameters
        ----------
        origin : array_like, shape (2,) or (k, 2)
            Start of each ray.
        direction : array_like, shape (2,) or (k, 2)
            Direction of each ray, of any length except 0. One origin may have many directions, and many origins one
            direction.
        max_distance : array_like, a number or shape (k,), default inf
            Maximum length of each ray, in units of length. With a period it must be given, and be at most 1024 periods.
        mask : int, optional
            Hit only shapes with a category in this set of bits; other shapes are ignored.
        exclude : int or array_like of int, shape (k,), optional
            An id that rays pass, one for all or one for each, such as that of the shape in which a ray starts; -1 is
            none, as is an id that nothing has.

        Returns
        -------
        RayHit or RayHits
            The id, at equal distances the smaller; -1 if no shape is hit, so test it before you use it as an index. The
            distance to the surface; 0 if a ray starts in a shape, infinity if nothing is hit. A ray that only touches
            an edge hits it. The point that is hit, and the unit normal there, which points away from the shape. In a
            `World` the wall that is hit.

        Raises
        ------
        ValueError
            If a number is not finite, a direction is (0, 0), or `max_distance` is negative.

        Notes
        -----
        In a :class:`World` rays and moving shapes also hit walls and the container, which is solid outside. Then `id`
        is -1, and `wall` is the id of the wall or a :class:`Side`. A mask selects walls by their categories; sides have
        the category 1. A one-way wall is hit only if all of the moving shape starts strictly on the left of start → end
        and moves to the right. Walls that are sensors are not hit. At equal distances a particle comes first, then a
        side, then a wall. In queries of `World.walls`, `id` and `wall` are both the id of the wall; in other classes
        `wall` is always -1."""
    @overload
    def raycast(self, origin: _Points, direction: _OneOrMorePoints, *, max_distance: _Real | _Reals = math.inf,
            mask: _Mask = None, exclude: _Exclude = None) -> RayHits: ...
    @overload
    def raycast(self, origin: _OneOrMorePoints, direction: _Points, *, max_distance: _Real | _Reals = math.inf,
            mask: _Mask = None, exclude: _Exclude = None) -> RayHits: ...
    @overload
    def raycast(self, origin: _AnyPoint, direction: _AnyPoint, *, max_distance: _Number = math.inf, mask: _Mask = None,
            exclude: _Exclude = None) -> RayHit: ...
    @overload
    def raycast(self, origin: _AnyPoint | _Undecided, direction: _AnyPoint | _Undecided, *,
            max_distance: _Real | _Reals = math.inf, mask: _Mask = None,
            exclude: _Exclude = None) -> RayHit | RayHits | Any: ...
    @overload
    def shape_cast(self, origin: _Point, direction: _Point, *, radii: _Real = 0.0,
            half_sizes: _Real | Sequence[_Real] | None = None, max_distance: _Number = math.inf, mask: _Mask = None,
            exclude: _Exclude = None) -> RayHit:
        """Find the first shape that a moving shape hits, or each of many.

        Parameters
        ----------
        origin : array_like, shape (2,) or (k, 2)
            Start of the centre of each moving shape.
        direction : array_like, shape (2,) or (k, 2)
            Direction of the motion, of any length except 0.
        radii : array_like, a number or shape (k,), default 0.0
            Radii, as of other shapes: of discs, or by which boxes extend beyond their cores.
        half_sizes : array_like, a number, shape (2,) or (k, 2), optional
            Half widths and half heights of boxes.
        max_distance : array_like, a number or shape (k,), default inf
            Maximum distance of each motion, in units of length. With a period it must be given, and be at most 1024
            periods.
        mask : int, optional
            Hit only shapes with a category in this set of bits; other shapes are ignored.
        exclude : int or array_like of int, shape (k,), optional
            An id that is passed, one for all or one for each, such as that of the moving shape; -1 is none.

        Returns
        -------
        RayHit or RayHits
            The id and the distance of the motion until the hit, as from :meth:`raycast`; the point where the surfaces
            touch, in the middle if sides touch.

        Raises
        ------
        ValueError
            If a number is not finite, a direction is (0, 0), a size is out of range, or `max_distance` is negative."""
    @overload
    def shape_cast(self, origin: _Points, direction: _OneOrMorePoints, *, radii: _Real | _Reals = 0.0,
            half_sizes: _Real | _Reals | _Points | None = None, max_distance: _Real | _Reals = math.inf,
            mask: _Mask = None, exclude: _Exclude = None) -> RayHits: ...
    @overload
    def shape_cast(self, origin: _OneOrMorePoints, direction: _Points, *, radii: _Real | _Reals = 0.0,
            half_sizes: _Real | _Reals | _Points | None = None, max_distance: _Real | _Reals = math.inf,
            mask: _Mask = None, exclude: _Exclude = None) -> RayHits: ...
    @overload
    def shape_cast(self, origin: _OneOrMorePoints, direction: _OneOrMorePoints, *, radii: _Reals,
            half_sizes: _Real | _Reals | _Points | None = None, max_distance: _Real | _Reals = math.inf,
            mask: _Mask = None, exclude: _Exclude = None) -> RayHits: ...
    @overload
    def shape_cast(self, origin: _OneOrMorePoints, direction: _OneOrMorePoints, *, radii: _Real | _Reals = 0.0,
            half_sizes: _Points, max_distance: _Real | _Reals = math.inf, mask: _Mask = None,
            exclude: _Exclude = None) -> RayHits: ...
    @overload
    def shape_cast(self, origin: _AnyPoint, direction: _AnyPoint, *, radii: _Real = 0.0,
            half_sizes: _Real | Sequence[_Real] | None = None, max_distance: _Number = math.inf, mask: _Mask = None,
            exclude: _Exclude = None) -> RayHit: ...
    @overload
    def shape_cast(self, origin: _AnyPoint | _Undecided, direction: _AnyPoint | _Undecided, *,
            radii: _Real | _Reals = 0.0, half_sizes: _Real | _Reals | _Points | None = None,
            max_distance: _Real | _Reals = math.inf, mask: _Mask = None,
            exclude: _Exclude = None) -> RayHit | RayHits | Any: ...
    @overload
    def raycast_all(self, origin: _Point, direction: _Point, *, max_distance: _Real = math.inf, mask: _Mask = None,
            exclude: _Exclude = None) -> RayHits:
        """Find every shape that a ray hits, nearest first, or that each of many rays hits.

        Parameters
        ----------
        origin : array_like, shape (2,) or (k, 2)
            Start of each ray.
        direction : array_like, shape (2,) or (k, 2)
            Direction of each ray, of any length except 0.
        max_distance : array_like, a number or shape (k,), default inf
            Maximum length of each ray, in units of length. With a period it must be given, and be at most 1024 periods.
        mask : int, optional
            Hit only shapes with a category in this set of bits.
        exclude : int or array_like of int, shape (k,), optional
            An id that rays pass, one for all or one for each; -1 is none, as is an id that nothing has.

        Returns
        -------
        RayHits or RayHitLists
            All hits of one ray, each shape once, at equal distances the smaller id first; for many rays those of each.
            In a `World` also walls, and the side at which each ray leaves the container.

        Raises
        ------
        ValueError
            If a number is not finite, a direction is (0, 0), `max_distance` is negative, or there are more than
            134217728 hits."""
    @overload
    def raycast_all(self, origin: _Points, direction: _OneOrMorePoints, *, max_distance: _Real | _Reals = math.inf,
            mask: _Mask = None, exclude: _Exclude = None) -> RayHitLists: ...
    @overload
    def raycast_all(self, origin: _OneOrMorePoints, direction: _Points, *, max_distance: _Real | _Reals = math.inf,
            mask: _Mask = None, exclude: _Exclude = None) -> RayHitLists: ...
    @overload
    def raycast_all(self, origin: _AnyPoint, direction: _AnyPoint, *, max_distance: _Real = math.inf,
            mask: _Mask = None, exclude: _Exclude = None) -> RayHits: ...
    @overload
    def raycast_all(self, origin: _AnyPoint | _Undecided, direction: _AnyPoint | _Undecided, *,
            max_distance: _Real | _Reals = math.inf, mask: _Mask = None,
            exclude: _Exclude = None) -> RayHits | RayHitLists | Any: ...
    def __len__(self) -> int: ...

@type_check_only
class _ShapeQueries(_Queries):
    """Those of the classes whose shapes have neighbours among themselves."""

    def neighbors(self, distance: _Number, *, mask: _Mask = None) -> IdLists:
        """Find the neighbours of every shape within a distance.

        Parameters
        ----------
        distance : float
            Shapes are neighbours if the gap between their surfaces is below this, in units of length; each radius is
            increased by half of it.
        mask : int, optional
            Find only neighbours of which both have a category in this set of bits.

        Returns
        -------
        IdLists
            For each shape, in the order of its row, the ids of its neighbours, ascending, itself left out. The fields
            `offsets` and `ids` are compressed sparse rows.

        Raises
        ------
        ValueError
            If `distance` is negative or out of range, or there are more than 134217728 ids."""

@final
class Quadtree(_ShapeQueries):
    """A quadtree over shapes that do not change.

    A shape is every point within `radius` of its core: the axis-aligned box ``center ± half_size``, one of `boxes`, or
    one of `segments`. A circle has half size 0, a rectangle radius 0. The tree is built once, for any positions; there
    are no bounds to choose. Several threads may query it at the same time.

    Parameters
    ----------
    positions : array_like, shape (n, 2), optional
        Centres, in any unit of length; required unless `boxes` or `segments` are given.
    radii : array_like, a number or shape (n,), default 0.0
        Radii, in the same unit.
    half_sizes : array_like, a number, shape (2,) or (n, 2), optional
        Half widths and half heights. If omitted, every shape is a circle.
    boxes : array_like, shape (n, 4), optional
        Sides min_x, min_y, max_x, max_y of each shape, in place of `positions` and `half_sizes`. Objects with the
        attributes `left`, `top`, `right` and `bottom`, such as pygame's Rect, are accepted in a list or a tuple, but
        not in an array, which NumPy fills with x, y, width and height. The four numbers are compared without rounding:
        boxes that share an edge never overlap, whereas sides computed as ``center ± half_size`` are rounded. With
        `radii`, the shapes are rounded boxes.
    segments : array_like, shape (n, 2, 2), optional
        Start and end of each shape, in place of `positions` and `half_sizes`: line segments, or capsules with `radii`.
        Segments that cross overlap; those that share an end, or lie on one line, do not. With a period the ends are at
        most one period apart along each axis.
    categories : array_like of int, a number or shape (n,), optional
        Categories of each shape, as a set of 32 bits; 1 if omitted.
    masks : array_like of int, a number or shape (n,), optional
        Categories each shape may pair with, as a set of 32 bits; all of them if omitted. Shapes i and j may pair only
        if both ``categories[i] & masks[j]`` and ``categories[j] & masks[i]`` are not 0. A negative integer stands for
        its low 32 bits, so ``masks=~SHIP`` is every category except SHIP. For a uint8 or uint16 array, ``~`` sets no
        bits above the 8th or 16th.
    period : float or (float, float), optional
        Width and height of a periodic plane, one number for both; 0 or None on an axis that is not periodic. Centres
        are moved into ``[0, period)``; positions that differ by a multiple of the period are equal in every method, and
        each shape is found once.
    leaf_capacity : int, default 96
        Shapes that a box may hold before it splits into four.
    max_depth : int, default 4096
        Maximum number of subdivisions: with 0 there is one box, with 2 there are two levels below it. The default never
        prevents a split.
    threads : int, optional
        Number of threads, at most one for each core, which is the default. Every answer is the same for every number.

    Raises
    ------
    TypeError
        If an argument does not hold numbers, or if not exactly one of `positions`, `boxes` and `segments` is given.
    ValueError
        If a shape is wrong, a value is not finite, or a size or a setting is out of range.

    Notes
    -----
    Arithmetic is float32 if every given array is float32, otherwise float64; lists of numbers count as float64. A plain
    number, or a plain pair of half sizes, takes the precision of the given arrays.

    Centres may be anywhere. A radius is 0, or between 1e-18 and 1e18 in float32 and between 1e-150 and 1e150 in
    float64: squares of other numbers overflow or lose digits. A half size is at most an eighth of the largest number of
    the type, a box at most twice as wide and high as that."""

    @overload
    def __new__(cls, positions: _Vectors, radii: ArrayLike = 0.0, half_sizes: ArrayLike | None = None, *,
            boxes: None = None, segments: None = None, categories: ArrayLike | None = None,
            masks: ArrayLike | None = None, period: _Period | None = None, leaf_capacity: SupportsIndex = 96,
            max_depth: SupportsIndex = 4096, threads: SupportsIndex | None = None) -> Self: ...
    @overload
    def __new__(cls, positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *, boxes: _Boxes,
            segments: None = None, categories: ArrayLike | None = None, masks: ArrayLike | None = None,
            period: _Period | None = None, leaf_capacity: SupportsIndex = 96, max_depth: SupportsIndex = 4096,
            threads: SupportsIndex | None = None) -> Self: ...
    @overload
    def __new__(cls, positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *, boxes: None = None,
            segments: ArrayLike, categories: ArrayLike | None = None, masks: ArrayLike | None = None,
            period: _Period | None = None, leaf_capacity: SupportsIndex = 96, max_depth: SupportsIndex = 4096,
            threads: SupportsIndex | None = None) -> Self: ...
    def pairs(self, other: Quadtree | None = None, *, sort: bool = False, max_pairs: SupportsIndex = 134217728,
            mask: _Mask = None, distance: _Number = 0.0) -> _Pairs:
        """Find every pair of overlapping shapes in this tree, or between it and another.

        Parameters
        ----------
        other : Quadtree, optional
            A tree of the same dtype. If omitted, the pairs are those within this tree, ``i < j``. If `other` is this
            tree, it is treated as any other tree: each pair comes in both orders, and each shape with an area pairs
            with itself.
        sort : bool, default False
            Whether to sort the pairs by the first, then by the second shape. If False, they come in the order of this
            tree, which is the same for every number of threads.
        max_pairs : int, default 134217728
            Maximum number of pairs to return; the default corresponds to 2 GiB.
        mask : int, optional
            Find only pairs whose shapes both have a category in this set of bits.
        distance : float, default 0.0
            Find pairs whose gap is below this, in units of length: each radius is increased by half of it. If 0, the
            shapes must overlap.

        Returns
        -------
        ndarray of int64, shape (m, 2)
            Row numbers ``i < j`` of each pair, every pair once; with `other`, i is a row of this tree and j a row of
            the other.

        Raises
        ------
        TypeError
            If the dtypes of the two trees differ.
        ValueError
            If more than `max_pairs` pairs overlap."""
    def contacts(self, other: Quadtree | None = None, *, sort: bool = False, max_pairs: SupportsIndex = 134217728,
            mask: _Mask = None) -> Contacts:
        """Find every pair of overlapping shapes in this tree, or between it and another, and how each overlaps.

        Parameters
        ----------
        other : Quadtree, optional
            A tree of the same dtype and period. If omitted, the pairs are those within this tree, ``i < j``.
        sort : bool, default False
            Whether to sort the contacts by the first, then by the second shape of the pair. If False, they come in the
            order of :meth:`pairs`.
        max_pairs : int, default 134217728
            Maximum number of pairs to return. Each takes 80 bytes, in float32 52, and about as much during the search;
            memory is allocated only for the pairs that are found.
        mask : int, optional
            Find only pairs whose shapes both have a category in this set of bits.

        Returns
        -------
        Contacts
            Five arrays:

            pairs : ndarray of int64, shape (m, 2)
                As from :meth:`pairs`: row numbers i and j.
            normals : ndarray of the tree's dtype, shape (m, 2)
                Unit vectors from i to j. If the cores of the shapes overlap, the axis of least penetration; +x for
                coincident centres.
            depths : ndarray of the tree's dtype, shape (m,)
                Penetration: the distance that j must move along the normal until the two only touch.
            points : ndarray of the tree's dtype, shape (m, 2, 2)
                One or two points in the middle of the overlap; NaN for a second one that does not exist.
            categories : ndarray of uint32, shape (m, 2)
                The categories of i and j.

        Raises
        ------
        TypeError
            If the dtypes of the two trees differ.
        ValueError
            If the periods of the two trees differ, or more than `max_pairs` pairs overlap.
        MemoryError
            If there is no memory for the contacts."""
    def nodes(self) -> Nodes:
        """Return the boxes of the tree.

        Returns
        -------
        Nodes
            Four arrays:

            boxes : ndarray of float64, shape (k, 4)
                min_x, min_y, max_x, max_y of each box. It contains the centres of its shapes; a shape may extend beyond
                it. Quarters without shapes are omitted, and so are subdivisions that would separate nothing: coincident
                shapes are in one box, whatever their number.
            levels : ndarray of int64, shape (k,)
                Subdivisions above each box.
            counts : ndarray of int64, shape (k,)
                Shapes in each box and its descendants.
            is_leaf : ndarray of bool, shape (k,)
                Whether the box did not split.

            Parents precede their children; the first box is the root. A tree without shapes has no boxes."""
    @property
    def stats(self) -> Stats:
        """Size of the tree and number of tests of the last query.

        A `Stats` of four integers: `nodes` (boxes), `leaves` (boxes that did not split), `depth` (subdivisions above
        the deepest box) and `tests` (shapes that the last query tested, against another shape or against the query; 0
        before the first query)."""
    @property
    def positions(self) -> NDArray[np.floating[Any]]:
        """Centres, ``(min + max) / 2`` for shapes given as boxes: ndarray of the tree's dtype, shape (n, 2), a copy.
        With a period they are in ``[0, period)``."""
    @property
    def radii(self) -> NDArray[np.floating[Any]]:
        """Radii: ndarray of the tree's dtype, shape (n,), a copy."""
    @property
    def half_sizes(self) -> NDArray[np.floating[Any]]:
        """Half widths and half heights: ndarray of the tree's dtype, shape (n, 2), a copy; 0 for circles,
        ``(max - min) / 2`` for shapes given as boxes."""
    @property
    def boxes(self) -> NDArray[np.floating[Any]]:
        """The sides of the shapes without their radii: ndarray of the tree's dtype, shape (n, 4), a copy.

        They are min_x, min_y, max_x, max_y as they were given, or ``center ± half_size``."""
    @property
    def segments(self) -> NDArray[np.floating[Any]]:
        """Start and end of the segments: ndarray of the tree's dtype, shape (n, 2, 2), a copy; NaN for shapes that are
        none. With a period their centres are in ``[0, period)``."""
    @property
    def categories(self) -> NDArray[np.uint32]:
        """Categories: ndarray of uint32, shape (n,), a copy."""
    @property
    def masks(self) -> NDArray[np.uint32]:
        """Masks: ndarray of uint32, shape (n,), a copy."""
    @property
    def period(self) -> tuple[float, float]:
        """Width and height of the period: a tuple of two floats, 0 on an axis that is not periodic."""
    @property
    def dtype(self) -> Literal["float32", "float64"]:
        """The precision of its arithmetic: "float32" or "float64"."""
    def __getnewargs_ex__(self) -> tuple[tuple[()], dict[str, Any]]: ...

@final
class Space(_ShapeQueries):
    """A collection of shapes that can be added, moved, changed and removed, and of the pairs that overlap.

    A shape is every point within `radius` of its core: the axis-aligned box ``center ± half_size``, one of `boxes`, or
    one of `segments`. A circle has half size 0, a rectangle radius 0. Each shape has an id, which is never used again
    for another shape. The cost depends on the shapes that change: a million shapes at rest cost much less than a
    thousand that move. Every query includes all previous changes.

    Parameters
    ----------
    dtype : {"float64", "float32"}, default "float64"
        Precision of all arithmetic. Other numbers are converted.
    period : float or (float, float), optional
        Width and height of a periodic plane, one number for both; 0 or None on an axis that is not periodic. Centres
        are moved into ``[0, period)``; positions that differ by a multiple of the period are equal in every method, and
        each shape is found once.
    leaf_capacity : int, default 96
        Shapes that a box of a tree may hold before it splits into four. Small trees in a space with many shapes use a
        smaller number.
    max_depth : int, default 4096
        Maximum number of subdivisions; the default never prevents a split.
    threads : int, optional
        Number of threads, at most one for each core, which is the default. Every answer is the same for every number.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If a setting is out of range.

    Notes
    -----
    Where ids are an argument, one id may be given instead of an array; then the other arguments are one value each. A
    refused call changes nothing."""

    def __new__(cls, *, dtype: DTypeLike = "float64", period: _Period | None = None, leaf_capacity: SupportsIndex = 96,
            max_depth: SupportsIndex = 4096, threads: SupportsIndex | None = None) -> Self: ...
    @overload
    def add(self, positions: _Point, radii: ArrayLike = 0.0, half_sizes: ArrayLike | None = None, *, boxes: None = None,
            segments: None = None, categories: ArrayLike = 1, masks: ArrayLike = 0xFFFFFFFF) -> int:
        """Add one shape or many.

        Parameters
        ----------
        positions : array_like, shape (k, 2) or (2,), optional
            Centres; required unless `boxes` or `segments` are given.
        radii : array_like, a number or shape (k,), default 0.0
            Radii.
        half_sizes : array_like, a number, shape (2,) or (k, 2), optional
            Half widths and half heights. If omitted, the shapes are circles.
        boxes : array_like, shape (k, 4) or (4,), optional
            Sides min_x, min_y, max_x, max_y of each shape, in place of `positions` and `half_sizes`. Objects with the
            attributes `left`, `top`, `right` and `bottom`, such as pygame's Rect, are accepted, also in a list or a
            tuple, but not in an array, which NumPy fills with x, y, width and height. The four numbers are compared
            without rounding: boxes that share an edge never overlap, whereas sides computed as ``center ± half_size``
            are rounded.
        segments : array_like, shape (k, 2, 2) or (2, 2), optional
            Start and end of each shape, in place of `positions` and `half_sizes`: line segments, or capsules with
            `radii`. Segments that cross overlap; those that share an end do not. With a period the ends are at most one
            period apart along each axis.
        categories : array_like of int, a number or shape (k,), default 1
            Categories of each shape, as a set of 32 bits.
        masks : array_like of int, a number or shape (k,), default 0xFFFFFFFF
            Categories each shape may pair with, as a set of 32 bits. Shapes i and j may pair only if both
            ``categories[i] & masks[j]`` and ``categories[j] & masks[i]`` are not 0. A negative integer stands for its
            low 32 bits, so ``masks=~SHIP`` is every category except SHIP. For a uint8 or uint16 array, ``~`` sets no
            bits above the 8th or 16th.

        Returns
        -------
        ndarray of int64, shape (k,), or int
            Their ids; one id for one centre or one box. The first ids are 0, 1, 2, ... After removals, later shapes
            have ids of 2**32 and more, in any order: do not use ids as indices of arrays; :meth:`rows` gives those.

        Raises
        ------
        TypeError
            If an argument does not hold numbers, or if not exactly one of `positions`, `boxes` and `segments` is given.
        ValueError
            If a shape is wrong, a value is not finite, or a size is out of range: a radius is 0, or between 1e-18 and
            1e18 in float32 and between 1e-150 and 1e150 in float64."""
    @overload
    def add(self, positions: _Points, radii: ArrayLike = 0.0, half_sizes: ArrayLike | None = None, *,
            boxes: None = None, segments: None = None, categories: ArrayLike = 1,
            masks: ArrayLike = 0xFFFFFFFF) -> _Ids: ...
    @overload
    def add(self, positions: Sequence[_Real], radii: ArrayLike = 0.0, half_sizes: ArrayLike | None = None, *,
            boxes: None = None, segments: None = None, categories: ArrayLike = 1,
            masks: ArrayLike = 0xFFFFFFFF) -> int: ...
    @overload
    def add(self, positions: _Undecided, radii: ArrayLike = 0.0, half_sizes: ArrayLike | None = None, *,
            boxes: None = None, segments: None = None, categories: ArrayLike = 1,
            masks: ArrayLike = 0xFFFFFFFF) -> int | _Ids | Any: ...
    @overload
    def add(self, positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *,
            boxes: tuple[_Real, _Real, _Real, _Real] | _Rect, segments: None = None, categories: ArrayLike = 1,
            masks: ArrayLike = 0xFFFFFFFF) -> int: ...
    @overload
    def add(self, positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *,
            boxes: _Array | Sequence[Sequence[_Real] | _Rect | _Array], segments: None = None,
            categories: ArrayLike = 1, masks: ArrayLike = 0xFFFFFFFF) -> _Ids: ...
    @overload
    def add(self, positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *, boxes: Sequence[_Real],
            segments: None = None, categories: ArrayLike = 1, masks: ArrayLike = 0xFFFFFFFF) -> int: ...
    @overload
    def add(self, positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *, boxes: _Undecided,
            segments: None = None, categories: ArrayLike = 1, masks: ArrayLike = 0xFFFFFFFF) -> int | _Ids | Any: ...
    @overload
    def add(self, positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *, boxes: None = None,
            segments: _Segment, categories: ArrayLike = 1, masks: ArrayLike = 0xFFFFFFFF) -> int: ...
    @overload
    def add(self, positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *, boxes: None = None,
            segments: _Segments, categories: ArrayLike = 1, masks: ArrayLike = 0xFFFFFFFF) -> _Ids: ...
    @overload
    def add(self, positions: None = None, radii: ArrayLike = 0.0, half_sizes: None = None, *, boxes: None = None,
            segments: _Undecided, categories: ArrayLike = 1, masks: ArrayLike = 0xFFFFFFFF) -> int | _Ids | Any: ...
    @overload
    def move_and_slide(self, ids: _Id, displacements: _AnyPoint | _Array, *, mask: _Mask = None, up: _Vectors = (0, -1),
            floor_angle: _Number = 0.7853981633974483, snap: _Number = 0, step_height: _Number = 0,
            constant_speed: bool = False, one_way: SupportsIndex = 0, max_slides: SupportsIndex = 4) -> Slide:
        """Move shapes by displacements; they slide along the others and never enter them.

        A shape moves until it meets an obstacle, then along the surface of the obstacle, and so on. The time of impact
        is computed along the whole path, so nothing passes through an obstacle at any speed. A shape that touches an
        obstacle does not overlap it, and the joints between tiles do not stop it. Discs, boxes and rounded boxes move
        among discs, boxes, line segments and those with a radius.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The shapes to move, each at most once: circles and boxes, no segments. A shape that was given as a box, and
            that moves, is stored as ``center ± half_size`` from then on.
        displacements : array_like, shape (k, 2), or (2,) for one id
            By how much each is to move: its velocity times the duration of a step.
        mask : int, optional
            The categories of the shapes that are obstacles, as a set of bits; all if omitted. Shapes that may not pair
            by their own categories and masks are no obstacles either.
        up : array_like, shape (2,), default (0, -1)
            The direction in which floors face; y grows downwards on screens. With (0, 0), as seen from above, every
            obstacle is a wall.
        floor_angle : float, default pi / 4
            Largest angle between the normal of a floor and `up`, in radians. A shape stands on a floor without sliding
            down, and climbs it; a steeper slope is a wall.
        snap : float, default 0
            A shape that walks is put on a floor that is at most this far below it at the end, in units of length. So it
            does not hop downhill or down steps. See Notes.
        step_height : float, default 0
            A shape that walks climbs steps of at most this height onto a floor, in units of length, where there is
            room.
        constant_speed : bool, default False
            Whether a shape that walks moves along a floor as far as its displacement leads across `up`, uphill and
            downhill. Otherwise its way depends on the slope and on gravity.
        one_way : int, default 0
            Categories of the obstacles that stop only shapes that are above them and move down. To be above a segment
            is to be above the line through its ends; one along `up` stops nothing.
        max_slides : int, default 4
            Maximum number of obstacles along which a shape slides, at most 1000; it stops at the last one.

        Returns
        -------
        Slides or Slide
            One `Slide` for one id.

            displacement : ndarray of the space's dtype, shape (k, 2)
                How far each shape has moved.
            remaining : ndarray of the space's dtype, shape (k, 2)
                The displacements that were given, without their components into the obstacles: divided by the duration
                of the step, the velocities for the next step.
            hits : IdLists
                Ids of the obstacles that each shape has met, each once.
            normals : ndarray of the space's dtype, shape (m, 2)
                Unit normal of each hit, towards the shape.
            floor : ndarray of int64, shape (k,)
                Id of the last floor; -1 if there is none.
            platform_velocity : ndarray of the space's dtype, shape (k, 2)
                The displacement of that floor since the last call for the shape; without one, that of the floor on
                which the shape stood before.
            on_floor, on_wall, on_ceiling : ndarray of bool, shape (k,)
                Whether each shape has met one.
            crushed : ndarray of bool, shape (k,)
                Whether obstacles leave the shape no room, so that it overlaps one.

        Raises
        ------
        TypeError
            If an argument has the wrong type.
        IdError
            If an id does not exist; then nothing moves.
        ValueError
            If an id is given twice or belongs to a segment, or a value is not finite or out of range; then nothing
            moves.

        Notes
        -----
        Shapes of one call that may meet move one after another, in the order of `ids`, except that a floor moves before
        the shapes that stand on it, the foremost of shapes with the same displacement first, and shapes whose category
        `mask` leaves out last. The order of other shapes has no effect.

        A shape walks if its displacement has no component along `up`, and if it touches something below at the
        beginning or meets a floor on its way. To touch means a gap of at most 1/1024 of its size. So a jump leaves the
        floor, and what falls is not attracted by one. With `snap`, `remaining` has no component along `up` after a walk
        that ends on a floor. A step is climbed by moving up, on, and down onto a floor; the point that touches the
        floor is at most `step_height` above the lowest point of the shape.

        The motions that obstacles have made since the last call for a shape, by :meth:`set` or by another call, are
        repeated first, all at the same time: what meets the shape pushes it. A shape that met a floor in its last call
        is carried by it: it moves by the same vector, and other obstacles that move by this vector do not stop it.
        Several motions between two calls count as one along a straight line; of motions with calls between them, the
        last one counts. A shape that overlaps obstacles after that is moved out of them. Obstacles that it cannot leave
        do not stop it.

        A floor that moves in the same call first pushes the shapes that stand on it; one that cannot move stops the
        floor. Floors that touch and have the same displacement are one body: each pushes what stands on any of them,
        and nothing that does stops them. So no shape moves into an obstacle. There is one exception: an obstacle may
        push or carry a shape against another obstacle and overlap it there. This happens if it was moved before the
        call, if `mask` leaves out the category of the shape, or if it is a part of a body. `hits` includes what stops a
        shape that is carried or pushed, and what pushes it."""
    @overload
    def move_and_slide(self, ids: _IdList, displacements: _Points, *, mask: _Mask = None, up: _Vectors = (0, -1),
            floor_angle: _Number = 0.7853981633974483, snap: _Number = 0, step_height: _Number = 0,
            constant_speed: bool = False, one_way: SupportsIndex = 0, max_slides: SupportsIndex = 4) -> Slides: ...
    @overload
    def move_and_slide(self, ids: _Undecided, displacements: _Undecided, *, mask: _Mask = None, up: _Vectors = (0, -1),
            floor_angle: _Number = 0.7853981633974483, snap: _Number = 0, step_height: _Number = 0,
            constant_speed: bool = False, one_way: SupportsIndex = 0,
            max_slides: SupportsIndex = 4) -> Slide | Slides | Any: ...
    @overload
    def get(self, ids: _Id) -> Shape:
        """Return some shapes.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The shapes, in any order, also several times.

        Returns
        -------
        Shape or Shapes
            Copies of their columns; of one id the values of one shape.

        Raises
        ------
        TypeError
            If `ids` does not hold integers.
        IdError
            If an id does not exist."""
    @overload
    def get(self, ids: _IdList) -> Shapes: ...
    @overload
    def get(self, ids: _Undecided) -> Shape | Shapes | Any: ...
    def set(self, ids: ArrayLike, *, positions: _Vectors | None = None, radii: ArrayLike | None = None,
            half_sizes: ArrayLike | None = None, boxes: _Boxes | None = None, segments: ArrayLike | None = None,
            categories: ArrayLike | None = None, masks: ArrayLike | None = None) -> None:
        """Change some shapes. What is omitted stays the same.

        Shapes whose values are unchanged cost almost nothing. For shapes that slide, new positions or boxes are a
        motion along a straight line, however long: see :meth:`move_and_slide`. To put an obstacle elsewhere without a
        motion, remove it and add another one.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The shapes, each at most once.
        positions : array_like, shape (k, 2), or (2,) for one id, optional
            Centres. A shape that was given as a box, and whose centre changes, is stored as ``center ± half_size`` from
            then on, with half the size of its box, and its sides are rounded. Give `boxes` to keep them exact.
        radii : array_like, a number or shape (k,), optional
            Radii.
        half_sizes : array_like, a number, shape (2,) or (k, 2), optional
            Half widths and half heights. A shape that was given as a box, and whose size changes, is stored as
            ``center ± half_size`` from then on.
        boxes : array_like, shape (k, 4), or (4,) for one id, optional
            In place of `positions` and `half_sizes`, sides min_x, min_y, max_x, max_y of each shape, or pygame's Rects,
            as in :meth:`add`.
        segments : array_like, shape (k, 2, 2), or (2, 2) for one id, optional
            In place of `positions` and `half_sizes`, start and end of each shape.
        categories : array_like of int, a number or shape (k,), optional
            Categories, sets of 32 bits.
        masks : array_like of int, a number or shape (k,), optional
            Categories each shape may pair with.

        Raises
        ------
        TypeError
            If an argument does not hold numbers, or several of `positions`, `boxes` and `segments` are given, or one of
            the last two beside `half_sizes`.
        IdError
            If an id does not exist; then nothing changes.
        ValueError
            If an id is given twice, a value is not finite or out of range, or a minimum is above its maximum; then
            nothing changes."""
    @overload
    def rows(self, ids: _Id) -> int:
        """Return the rows that shapes have in the columns.

        Parameters
        ----------
        ids : int or array_like of int, of any shape
            The shapes.

        Returns
        -------
        ndarray of int64 of the same shape, or int
            Their rows, until a shape before them is removed.

        Raises
        ------
        TypeError
            If `ids` does not hold integers.
        IdError
            If an id does not exist."""
    @overload
    def rows(self, ids: _IdList | Sequence[_IdList]) -> _Ids: ...
    @overload
    def rows(self, ids: _Undecided) -> int | _Ids | Any: ...
    @property
    def positions(self) -> NDArray[np.floating[Any]]:
        """Centres, ``(min + max) / 2`` for shapes given as boxes: ndarray of the space's dtype, shape (n, 2), a
        read-only copy in the order of adding.

        Assign to it to move all shapes, as :meth:`set` does. With a period they are in ``[0, period)``. As of every
        column, the row of a shape is that of its id in `ids`; the first reading after shapes were removed visits all of
        them."""
    @positions.setter
    def positions(self, value: _Vectors) -> None: ...
    @property
    def radii(self) -> NDArray[np.floating[Any]]:
        """Radii: ndarray of the space's dtype, shape (n,), a read-only copy. Assign a number or an array to it to
        change all."""
    @radii.setter
    def radii(self, value: ArrayLike) -> None: ...
    @property
    def half_sizes(self) -> NDArray[np.floating[Any]]:
        """Half widths and half heights: ndarray of the space's dtype, shape (n, 2), a read-only copy; 0 for circles,
        ``(max - min) / 2`` for shapes given as boxes. Assign to it to change all."""
    @half_sizes.setter
    def half_sizes(self, value: ArrayLike) -> None: ...
    @property
    def boxes(self) -> NDArray[np.floating[Any]]:
        """The sides of the shapes without their radii: ndarray of the space's dtype, shape (n, 4), a read-only copy.
        Assign to it to give all shapes boxes.

        They are min_x, min_y, max_x, max_y as they were given, or ``center ± half_size``; for a circle its centre as
        both corners."""
    @boxes.setter
    def boxes(self, value: _Boxes) -> None: ...
    @property
    def segments(self) -> NDArray[np.floating[Any]]:
        """Start and end of the segments: ndarray of the space's dtype, shape (n, 2, 2), a read-only copy; NaN for
        shapes that are none.

        Assign to it to give all shapes segments. NaN is for shapes that are none and stay as they are. With a period
        the middle of a segment is in ``[0, period)``."""
    @segments.setter
    def segments(self, value: ArrayLike) -> None: ...
    def bounds(self) -> NDArray[np.floating[Any]]:
        """The sides of the bounding boxes: min_x, min_y, max_x, max_y of each shape with its radius.

        Returns
        -------
        ndarray of the space's dtype, shape (n, 4)
            In the order of adding."""
    @property
    def categories(self) -> NDArray[np.uint32]:
        """Categories, sets of 32 bits: ndarray of uint32, shape (n,), a read-only copy. Assign a number or an array to
        it to change all."""
    @categories.setter
    def categories(self, value: ArrayLike) -> None: ...
    @property
    def masks(self) -> NDArray[np.uint32]:
        """Masks, sets of 32 bits: ndarray of uint32, shape (n,), a read-only copy. Assign a number or an array to it to
        change all."""
    @masks.setter
    def masks(self, value: ArrayLike) -> None: ...
    def remove(self, ids: ArrayLike) -> None:
        """Remove shapes. Their ids are never used again.

        The next reading of a column, of `ids` or of rows visits all shapes once, however many were removed.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The shapes, each at most once.

        Raises
        ------
        TypeError
            If `ids` does not hold integers.
        IdError
            If an id does not exist; then none is removed.
        ValueError
            If an id is given twice; then none is removed."""
    def update(self, *, swept: bool = False, max_pairs: SupportsIndex = 134217728) -> Events:
        """Find the pairs that entered and left since the last update.

        The current state is compared with the state at the last update; the first update compares with an empty space.
        A shape that was both added and removed in between has no effect. The cost depends on the shapes that changed.

        Parameters
        ----------
        swept : bool, default False
            Whether to find also the pairs that overlap neither at the last update nor now, and overlapped on the way: a
            bullet that passes a small target between two updates. They are in `entered` and in `exited`.
        max_pairs : int, default 134217728
            Maximum number of overlapping pairs of shapes that changed. If `swept`, also the maximum number of pairs for
            which the bounding boxes of the paths overlap.

        Returns
        -------
        Events
            Three arrays:

            entered, stayed, exited : ndarray of int64, shape (m, 2)
                Pairs of ids, the smaller first, sorted. `exited` may contain the ids of removed shapes. `stayed` is
                computed when it is first read.

        Raises
        ------
        ValueError
            If there are more than `max_pairs`; then the call has no effect.

        Notes
        -----
        If `swept`, the path of a shape is the straight line from its centre at the last update to its present centre,
        whatever was set in between. All shapes travel along their paths at constant velocities in the same time. So two
        bullets that cross each other's path meet only if they are at the crossing at the same time. A shape that was
        added since the last update travels from where it was added. Removed shapes do not take part. Sizes, categories
        and masks are the present ones. With a period the path is the shortest of those to the images of the present
        centre, so a shape should move by less than half a period between two updates. To put a shape elsewhere without
        a path, remove it and add another one.

        A pair that touches on the way without overlapping is not found, as at rest. A pair that overlaps at the end has
        entered, and one that overlapped at the last update has exited, with `swept` or without."""
    def pairs(self, *, sort: bool = False, max_pairs: SupportsIndex = 134217728, mask: _Mask = None,
            distance: _Number = 0.0) -> _Pairs:
        """Find every pair of overlapping shapes.

        Parameters
        ----------
        sort : bool, default False
            Whether to sort the pairs by the first, then by the second id. If False, their order depends on previous
            calls, but not on the number of threads.
        max_pairs : int, default 134217728
            Maximum number of pairs to return; the default corresponds to 2 GiB.
        mask : int, optional
            Find only pairs whose shapes both have a category in this set of bits.
        distance : float, default 0.0
            Find pairs whose gap is below this, in units of length: each radius is increased by half of it. If 0, the
            shapes must overlap.

        Returns
        -------
        ndarray of int64, shape (m, 2)
            Ids of each pair, the smaller first, every pair once.

        Raises
        ------
        ValueError
            If more than `max_pairs` pairs overlap."""
    def contacts(self, *, sort: bool = False, max_pairs: SupportsIndex = 134217728, mask: _Mask = None) -> Contacts:
        """Find every pair of overlapping shapes, and how each overlaps.

        Parameters
        ----------
        sort : bool, default False
            Whether to sort the contacts by the first, then by the second id of the pair. If False, they come in the
            order of :meth:`pairs`.
        max_pairs : int, default 134217728
            Maximum number of pairs to return.
        mask : int, optional
            Find only pairs whose shapes both have a category in this set of bits.

        Returns
        -------
        Contacts
            The pairs with their normals, depths, points and categories.

            pairs : ndarray of int64, shape (m, 2)
                Ids i and j of each pair, the smaller first, every pair once.
            normals : ndarray of the space's dtype, shape (m, 2)
                Unit vectors from i to j. If the cores of the shapes overlap, the axis of least penetration; +x for
                coincident centres.
            depths : ndarray of the space's dtype, shape (m,)
                Penetration: the distance that j must move along the normal until the two only touch.
            points : ndarray of the space's dtype, shape (m, 2, 2)
                One or two points in the middle of the overlap; NaN for a second one that does not exist.
            categories : ndarray of uint32, shape (m, 2)
                The categories of i and j.

        Raises
        ------
        ValueError
            If more than `max_pairs` pairs overlap."""
    @property
    def ids(self) -> _Ids:
        """The ids of all shapes, in the order of adding: ndarray of int64, shape (n,), a read-only copy."""
    @property
    def dtype(self) -> Literal["float32", "float64"]:
        """The precision of its arithmetic: "float32" or "float64"."""
    @property
    def period(self) -> tuple[float, float]:
        """Width and height of the period: a tuple of two floats, 0 on an axis that is not periodic."""
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, memo: Any, /) -> Self: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __contains__(self, id: object, /) -> bool: ...

@final
class Events:
    """Changes of the overlapping pairs of a space between two updates.

    Each array contains pairs of ids, the smaller first, sorted by the first, then by the second. Pairs that only met on
    the way, in an update with ``swept=True``, are in `entered` and in `exited`. `stayed` takes time for every pair in
    the space, when it is first read. Copying and pickling read it too, so after the next update they are errors unless
    it was read before."""

    @property
    def entered(self) -> _Pairs:
        """Pairs that overlap now and did not at the previous update, of a swept update also those that met on the way:
        ndarray of int64, shape (m, 2)."""
    @property
    def stayed(self) -> _Pairs:
        """Pairs that overlapped at both updates: ndarray of int64, shape (m, 2).

        They are computed when they are first read, which must be before the next update of the space; afterwards there
        is a RuntimeError."""
    @property
    def exited(self) -> _Pairs:
        """Pairs that overlapped at the previous update and do not now, also because a shape was removed, of a swept
        update also those that met on the way: ndarray of int64, shape (m, 2)."""
    def between(self, a: SupportsIndex, b: SupportsIndex) -> Events:
        """Return the events between shapes of some categories and shapes of others.

        A pair is kept if one of its shapes has a category in `a` and the other one has a category in `b`. The shape in
        the first column then has one in `a`, and that in the second has one in `b`, so the smaller id may be the
        second. A pair that fits in both orders is kept once, as it is.

        Parameters
        ----------
        a, b : int
            Categories, sets of 32 bits, which may be the same or have some in common.

        Returns
        -------
        Events
            The pairs that are kept, in the same order.

        Raises
        ------
        TypeError
            If `a` or `b` is no integer.
        ValueError
            If `a` or `b` has more than 32 bits.

        Notes
        -----
        The categories are those that the shapes had at the update, also of shapes that were removed before or after it.
        Those of the pairs that stayed are read with `stayed`, and it can be read as long as that of the events from
        which these come."""
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class World(_ShapeQueries):
    """Particles: discs that move, collide and bounce off walls.

    Each particle has an id, which never changes and is never used again: 0, 1, 2, ... in the order of adding. The
    columns are in the order of `ids`, and `rows` gives the rows of ids; as long as no particle was removed and none
    merged, the id of a particle is its row. All columns are float32; other numbers are converted. The residuals of
    positions, which rounding to float32 removes, are kept from step to step; assigned positions are exact. The same
    input gives the same bits on every machine, for every number of threads and for both methods.

    Parameters
    ----------
    positions : array_like, shape (n, 2)
        Centres, in units of length.
    radii : array_like, a number or shape (n,)
        In units of length: 0, or between 1e-18 and 1e18.
    velocities : array_like, shape (2,) or (n, 2), default (0.0, 0.0)
        In units of length per second.
    masses : array_like, a number or shape (n,), optional
        In units of mass, above 0. If omitted, the squares of the radii, without π, as in the article; required for a
        particle of radius 0.
    angles : array_like, a number or shape (n,), default 0.0
        In radians, positive from +x to +y.
    angular_velocities : array_like, a number or shape (n,), default 0.0
        In radians per second. The moment of inertia of a disc is m r²/2. Particles of radius 0 do not rotate: their
        angular velocity becomes 0. `drag` does not change angular velocities.
    friction : array_like, a number or shape (n,), default 0.0
        Coefficient of friction of each particle (Coulomb), at least 0. A contact has the square root of the product of
        both. Without friction particles do not begin to rotate.
    restitution : array_like, a number or shape (n,), default 1.0
        Coefficient of restitution of each particle: 0 inelastic, 1 elastic. A contact has the square root of the
        product of both.
    movable : array_like of bool, one or shape (n,), default True
        Whether contacts and forces can change the velocity of the particle. An immovable particle keeps the velocity
        and the angular velocity that it is given: if both are 0 it is static, else kinematic. It pushes others and is
        not pushed, and walls and the container do not stop it.
    sensors : array_like of bool, one or shape (n,), default False
        Whether the particle is a sensor: it neither pushes others nor is pushed by them, and `events` and `contacts`
        report what touches it. See `World.sensors`.
    kinds : array_like of int, a number or shape (n,), default 0
        Kinds of the particles in each `PairForce`, from 0 to 63.
    categories, masks : array_like of int, a number or shape (n,), default 1 and all bits
        Bit sets of 32 bits: two particles may touch only if ``categories[i] & masks[j]`` and
        ``categories[j] & masks[i]``; others pass through each other at no cost. Walls have categories and masks, too.
        The container and forces do not depend on them.
    gravity : array_like, shape (2,), default (0.0, 0.0)
        Acceleration, in units of length per second squared.
    drag : float, default 0.0
        Linear damping, per second: dv/dt = -drag v.
    container : Box, Circle or None, optional
        The region of the particles, with the coefficients of its sides. The first step moves particles that are outside
        into it.
    period : float or array_like, shape (2,), optional
        Width and height of a periodic plane, in place of a container: a particle that leaves on one side enters on the
        other. Positions are from 0 to the period.
    walls : array_like, shape (m, 2, 2), or dict, optional
        Line segments, solid from both sides, from one end to the other; `polyline` makes them from points. A particle
        stays on the side on which its centre is. One that overlaps a wall is pushed out in several steps. On a periodic
        plane walls act across its sides, and a wall may extend over each side once at most. Or a dict of the arguments
        of `World.walls.add`: `segments`, `velocities`, `friction`, `restitution`, `sensors`, `one_way`, `categories`
        and `masks`. The walls have the ids 0, 1, 2, ...
    forces : sequence of forces, default ()
        `Attractor`, `Gravitation`, `Springs`, `PairForce`, `Flocking`, `Thermostat`, `ThermalWalls`,
        `AndersenThermostat`, `Motor`, `Grab` and `Pump`, in addition to gravity and contacts.
    on_touch : {"bounce", "merge", "ignore"}, default "bounce"
        What happens to particles that touch. "merge" merges them at the end of the step, at their centre of mass: area,
        mass and momentum are summed, restitution and friction are the means weighted by mass, and the id is the
        smallest, see `renumbered`. The merged particle has all bits of their categories and masks. If one has friction
        or rotates, angular momentum is conserved. If some of the particles are immovable, so is the merged one, which
        has the position and the velocity of the heaviest of these; momentum is lost. Particles do not merge if the
        result would not fit into the container. "ignore" lets them pass through each other.
    sleeping : bool, default True
        Whether islands of touching particles that rest fall asleep under gravity, if the coefficients of restitution at
        walls are below 1; see `asleep`. It stops motion with a mean speed below 0.01 √(g r), where r is the radius.
    substeps : int, optional
        Sub-steps of a step, in which forces act and resting contacts are solved. None, the default, takes as many as
        the scene needs: 4 with attractors, gravitation, springs or given accelerations, or with gravity or forces and
        friction or a restitution below 1; otherwise 1. If contacts may rest and a particle presses on a touching one
        with 1/10,000 to 1/128 of its mass, there are 2 to 8 times as many. A step whose particles travel far is divided
        into parts, which share the sub-steps; each part has at least one.
    track_events : bool, default False
        Whether `events` and `wall_events` report what began and ceased to touch in each call of `step`.
    method : {"quadtree", "brute"}, default "quadtree"
        How pairs are found; the pairs are the same.
    threads : int, optional
        Number of threads, at most one for each core, which is the default.
    leaf_capacity : int, default 96
        Particles that a box of the tree may hold before it splits.
    max_depth : int, default 4096
        Maximum number of subdivisions of the tree; the default never prevents a split.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If a shape is wrong, a value is out of range, a particle does not fit into the container, or there are a
        container and a period; the message says which.

    Notes
    -----
    Between collisions dv/dt = gravity - drag v + a, where a is the acceleration by `forces` and by `accelerations`.
    Surfaces that touch and approach at the normal speed u separate at e u, where e is the coefficient of restitution.
    An impulse P along the normal allows a friction impulse of at most μ P, where μ is the coefficient of friction."""

    def __new__(cls, positions: _Vectors | None = None, radii: ArrayLike | None = None, *,
            velocities: _Vectors = (0.0, 0.0), masses: ArrayLike | None = None, angles: ArrayLike = 0.0,
            angular_velocities: ArrayLike = 0.0, friction: ArrayLike = 0.0, restitution: ArrayLike = 1.0,
            movable: ArrayLike = True, sensors: ArrayLike = False, kinds: ArrayLike = 0, categories: ArrayLike = 1,
            masks: ArrayLike = 4294967295, gravity: _Vectors = (0.0, 0.0), drag: _Number = 0.0,
            container: _Container | None = None, period: ArrayLike | None = None,
            walls: ArrayLike | dict[str, Any] | None = None, forces: Iterable[_Force] = (),
            on_touch: Literal["bounce", "merge", "ignore"] = "bounce", sleeping: bool = True,
            substeps: SupportsIndex | None = None, track_events: bool = False,
            method: Literal["quadtree", "brute"] = "quadtree", threads: SupportsIndex | None = None,
            leaf_capacity: SupportsIndex = 96, max_depth: SupportsIndex = 4096) -> Self: ...
    def step(self, dt: _Number, steps: SupportsIndex = 1) -> None:
        """Advance the simulation.

        Other threads may read the world during the call; they see its state between two steps. If a step is refused, or
        interrupted with Ctrl-C, the world keeps the state before that step. In a call with `steps` above 1, the
        previous steps remain done.

        Parameters
        ----------
        dt : float
            Length of a step in seconds, above 0.
        steps : int, default 1
            Number of steps.

        Raises
        ------
        ValueError
            If `dt` is not finite and above 0, if too many particles are in one place, if a particle would move too far,
            or if one of its numbers would become infinite or NaN. In the last two cases the message names the particle.
        KeyboardInterrupt
            After Ctrl-C, within a fraction of a second also during a long step."""
    @overload
    def add(self, positions: _Point, radii: ArrayLike, *, velocities: _Vectors = (0.0, 0.0),
            masses: ArrayLike | None = None, angles: ArrayLike = 0.0, angular_velocities: ArrayLike = 0.0,
            friction: ArrayLike = 0.0, restitution: ArrayLike = 1.0, movable: ArrayLike = True,
            sensors: ArrayLike = False, kinds: ArrayLike = 0, categories: ArrayLike = 1,
            masks: ArrayLike = 4294967295) -> int:
        """Add one particle or many, after the others.

        Parameters
        ----------
        positions : array_like, shape (k, 2), or (2,) for one particle
            Centres, in units of length.
        radii : array_like, a number or shape (k,)
            In units of length.
        velocities : array_like, shape (2,) or (k, 2), default (0.0, 0.0)
            In units of length per second.
        masses : array_like, a number or shape (k,), optional
            In units of mass; the squares of the radii if omitted.
        angles, angular_velocities : array_like, a number or shape (k,), default 0.0
            In radians and in radians per second, positive from +x to +y.
        friction : array_like, a number or shape (k,), default 0.0
            Coefficients of friction.
        restitution : array_like, a number or shape (k,), default 1.0
            Coefficients of restitution.
        movable : array_like of bool, one or shape (k,), default True
            Whether contacts and forces can change the velocity.
        sensors : array_like of bool, one or shape (k,), default False
            Whether the particle is a sensor.
        kinds : array_like of int, a number or shape (k,), default 0
            Their kinds in each `PairForce`, from 0 to 63.
        categories, masks : array_like of int, a number or shape (k,), default 1 and all bits
            Bit sets of 32 bits. Omitted columns have these defaults, whatever the other particles have.

        Returns
        -------
        ndarray of int64, shape (k,), or int
            Their ids, above all ids before; one id for one position. Their rows are the last ones of every column.

        Raises
        ------
        TypeError, ValueError
            As for a new world; then nothing is added."""
    @overload
    def add(self, positions: _Points, radii: ArrayLike, *, velocities: _Vectors = (0.0, 0.0),
            masses: ArrayLike | None = None, angles: ArrayLike = 0.0, angular_velocities: ArrayLike = 0.0,
            friction: ArrayLike = 0.0, restitution: ArrayLike = 1.0, movable: ArrayLike = True,
            sensors: ArrayLike = False, kinds: ArrayLike = 0, categories: ArrayLike = 1,
            masks: ArrayLike = 4294967295) -> _Ids: ...
    @overload
    def add(self, positions: Sequence[_Real], radii: ArrayLike, *, velocities: _Vectors = (0.0, 0.0),
            masses: ArrayLike | None = None, angles: ArrayLike = 0.0, angular_velocities: ArrayLike = 0.0,
            friction: ArrayLike = 0.0, restitution: ArrayLike = 1.0, movable: ArrayLike = True,
            sensors: ArrayLike = False, kinds: ArrayLike = 0, categories: ArrayLike = 1,
            masks: ArrayLike = 4294967295) -> int: ...
    @overload
    def add(self, positions: _Undecided, radii: ArrayLike, *, velocities: _Vectors = (0.0, 0.0),
            masses: ArrayLike | None = None, angles: ArrayLike = 0.0, angular_velocities: ArrayLike = 0.0,
            friction: ArrayLike = 0.0, restitution: ArrayLike = 1.0, movable: ArrayLike = True,
            sensors: ArrayLike = False, kinds: ArrayLike = 0, categories: ArrayLike = 1,
            masks: ArrayLike = 4294967295) -> int | _Ids | Any: ...
    def remove(self, ids: ArrayLike) -> None:
        """Remove particles. Their ids are never used again.

        The ids of other particles stay the same; in the columns, the rows after a removed one move up. Springs and
        attractors of a removed particle are removed too.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The particles, each at most once.

        Raises
        ------
        IdError
            If an id does not exist; then none is removed.
        ValueError
            If an id is given twice; then none is removed."""
    def set(self, ids: ArrayLike, *, positions: _Vectors | None = None, velocities: _Vectors | None = None,
            radii: ArrayLike | None = None, masses: ArrayLike | None = None, restitution: ArrayLike | None = None,
            movable: ArrayLike | None = None, friction: ArrayLike | None = None, angles: ArrayLike | None = None,
            angular_velocities: ArrayLike | None = None, categories: ArrayLike | None = None,
            masks: ArrayLike | None = None, sensors: ArrayLike | None = None, kinds: ArrayLike | None = None) -> None:
        """Change some columns of some particles.

        Columns that are omitted stay the same. The arguments are those of :meth:`add`.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The particles, each at most once.
        positions, velocities : array_like, shape (k, 2), or (2,) for one id, optional
            Centres in units of length, and velocities in units of length per second.
        radii, masses, restitution : array_like, a number or shape (k,), optional
            A new radius does not change the mass.
        movable : array_like of bool, one or shape (k,), optional
            Whether contacts and forces can change the velocity.
        friction, angles, angular_velocities : array_like, a number or shape (k,), optional
            Coefficients of friction; radians, and radians per second.
        categories, masks : array_like of int, a number or shape (k,), optional
            Bit sets of 32 bits.
        sensors : array_like of bool, one or shape (k,), optional
            Whether the particle is a sensor.
        kinds : array_like of int, a number or shape (k,), optional
            Their kinds in each `PairForce`, from 0 to 63.

        Raises
        ------
        IdError
            If an id does not exist; then nothing is changed.
        TypeError, ValueError
            As for a new world, or if an id is given twice; then nothing is changed."""
    def apply_impulse(self, ids: ArrayLike, impulses: _Vectors, points: _Vectors | None = None) -> None:
        """Give impulses to some particles, at once.

        An impulse P changes the velocity by P/m, and, if it acts at a point, the angular velocity by r × P/I, where r
        is the offset of the point from the centre and I = m r²/2 the moment of inertia. Impulses on the same particle
        add up, and their sum is rounded once.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The particles; one may be given more than once. Immovable ones do not change.
        impulses : array_like, shape (k, 2), or (2,) for one id or as one for all
            In units of mass times length per second. An impulse wakes the particle.
        points : array_like, shape (k, 2), or (2,) for one id or as one for all, optional
            Where each acts, in units of length, the centres if omitted; on a periodic plane the nearest image. It need
            not be inside the disc. Particles of radius 0 do not begin to rotate.

        Raises
        ------
        IdError
            If an id does not exist; then nothing is changed.
        TypeError, ValueError
            If a shape is wrong, or a number is not finite or too large; then nothing is changed."""
    def apply_force(self, ids: ArrayLike, forces: _Vectors, points: _Vectors | None = None) -> None:
        """Add given forces on some particles, for the next call of `step`.

        They act during all steps of that call, beside gravity and `forces`, and end with it. Forces on the same
        particle add up. They are kept by snapshots and files. A force F at a point also has the torque r × F, where r
        is the offset of the point from the centre now, so the angular acceleration is r × F/I with the moment of
        inertia I = m r²/2. Force and torque stay the same while the particle moves and turns. If particles merge, their
        forces and torques add up.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The particles; one may be given more than once. Immovable ones, also those that move with a velocity of
            their own, are neither accelerated nor turned.
        forces : array_like, shape (k, 2), or (2,) for one id or as one for all
            In units of mass times length per second². A force wakes the particle.
        points : array_like, shape (k, 2), or (2,) for one id or as one for all, optional
            Where each acts, in units of length, the centres if omitted; on a periodic plane the nearest image. It need
            not be inside the disc. Particles of radius 0 do not begin to rotate.

        Raises
        ------
        IdError
            If an id does not exist; then nothing is changed.
        TypeError, ValueError
            If a shape is wrong, or a number is not finite or too large; then nothing is changed."""
    @property
    def ids(self) -> _Ids:
        """The ids of all particles, ascending: ndarray of int64, shape (n,), a read-only copy.

        The particle in row i of every column has the id ``ids[i]``. Ids never change and are never used again.
        ``id in world`` is True if a particle has the id."""
    @overload
    def rows(self, ids: _Id) -> int:
        """Return the rows that particles have in the columns.

        Parameters
        ----------
        ids : int or array_like of int, of any shape
            The particles.

        Returns
        -------
        ndarray of int64 of the same shape, or int
            Their rows, until a particle before them is removed or merges; one row for one id.

        Raises
        ------
        TypeError
            If `ids` does not hold integers.
        ValueError
            If no particle has an id."""
    @overload
    def rows(self, ids: _IdList) -> _Ids: ...
    @overload
    def rows(self, ids: _Undecided) -> int | _Ids | Any: ...
    @overload
    def get(self, ids: _Id) -> Particle:
        """Read all columns of one particle or some, without those of the others.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The particles; one may be given more than once.

        Returns
        -------
        Particles or Particle
            Copies of `positions`, `velocities`, `radii` and so on, by the names of the arguments of `add` and `set`,
            with a row for each id; single values for one id, those of float32 as the float with their shortest decimal:
            0.1, where ``float(world.radii[0])`` is 0.10000000149011612. The cost depends on the number of ids alone,
            except that the first call after a step reads all row numbers.

        Raises
        ------
        TypeError
            If `ids` does not hold integers.
        IdError
            If no particle has an id."""
    @overload
    def get(self, ids: _IdList) -> Particles: ...
    @overload
    def get(self, ids: _Undecided) -> Particle | Particles | Any: ...
    @property
    def positions(self) -> NDArray[np.float32]:
        """Centres: ndarray of float32, shape (n, 2), a read-only copy in units of length.

        Writing into the copy, as in ``world.positions[0] = (1, 2)`` or ``world.positions += 1``, raises ValueError.
        Assign a whole column instead, ``world.positions = world.positions + 1``, or change some particles with
        ``world.set([0], positions=[(1, 2)])``. The same holds for every column. Assigning what was read changes nothing
        and wakes nothing: a position that is the present one in float32 keeps what rounding removed."""
    @positions.setter
    def positions(self, value: _Vectors) -> None: ...
    @property
    def velocities(self) -> NDArray[np.float32]:
        """Velocities: ndarray of float32, shape (n, 2), a read-only copy in units of length per second.

        To change them, assign a whole column, ``world.velocities = world.velocities * 2``, or change some particles
        with ``world.set([0], velocities=[(7, 7)])``."""
    @velocities.setter
    def velocities(self, value: _Vectors) -> None: ...
    @property
    def accelerations(self) -> NDArray[np.float32]:
        """Given accelerations in the next call of `step`: ndarray of float32, shape (n, 2), a read-only copy in units
        of length per second².

        Assign an array of this shape, or one vector for all, before each call, or None for none. It replaces what
        `apply_force` has given before, torques included; `apply_force` adds to it. They act during all steps of the
        call, beside gravity and `forces`, and are 0 after it. Immovable particles are not accelerated. The others wake
        if theirs is not 0, and do not fall asleep in the call.

        Raises
        ------
        ValueError
            If the shape is wrong, or a number is not finite or too large."""
    @accelerations.setter
    def accelerations(self, value: _Vectors | None) -> None: ...
    @property
    def radii(self) -> NDArray[np.float32]:
        """Radii: ndarray of float32, shape (n,), a read-only copy in units of length.

        To change all, assign an array or one number; to change some, use `set`. Masses stay the same."""
    @radii.setter
    def radii(self, value: ArrayLike) -> None: ...
    @property
    def masses(self) -> NDArray[np.float32]:
        """Masses: ndarray of float32, shape (n,), a read-only copy in units of mass.

        To change all, assign an array or one number; to change some, use `set`."""
    @masses.setter
    def masses(self, value: ArrayLike) -> None: ...
    @property
    def restitution(self) -> NDArray[np.float32]:
        """Coefficients of restitution, 0 to 1: ndarray of float32, shape (n,), a read-only copy.

        A contact has the square root of the product of both. To change all, assign an array or one number; to change
        some, use `set`."""
    @restitution.setter
    def restitution(self, value: ArrayLike) -> None: ...
    @property
    def movable(self) -> NDArray[np.bool_]:
        """Which particles are movable: ndarray of bool, shape (n,), a read-only copy.

        The others keep their velocities: a disc that is made immovable while it moves becomes kinematic.

        To change all, assign an array or one bool; to change some, use `set`."""
    @movable.setter
    def movable(self, value: ArrayLike) -> None: ...
    @property
    def friction(self) -> NDArray[np.float32]:
        """Coefficients of friction: ndarray of float32, shape (n,), a read-only copy.

        To change all, assign an array or one number; to change some, use `set`.

        Raises
        ------
        ValueError
            If an assigned coefficient is not finite or below 0, or the shape is wrong."""
    @friction.setter
    def friction(self, value: ArrayLike) -> None: ...
    @property
    def angles(self) -> NDArray[np.float32]:
        """Angles: ndarray of float32, shape (n,), a read-only copy in radians, -π to π without π.

        Positive angles are from +x to +y. To change all, assign an array or one number; to change some, use `set`.
        Numbers outside the range are wrapped into it.

        Raises
        ------
        ValueError
            If an assigned angle is not finite, or the shape is wrong."""
    @angles.setter
    def angles(self, value: ArrayLike) -> None: ...
    @property
    def angular_velocities(self) -> NDArray[np.float32]:
        """Angular velocities: ndarray of float32, shape (n,), a read-only copy in radians per second.

        Those of particles of radius 0 are 0. To change all, assign an array or one number; to change some, use `set`.

        Raises
        ------
        ValueError
            If an assigned angular velocity is not finite or above 1e18, or the shape is wrong."""
    @angular_velocities.setter
    def angular_velocities(self, value: ArrayLike) -> None: ...
    @property
    def categories(self) -> NDArray[np.uint32]:
        """Categories: ndarray of uint32, shape (n,), a read-only copy of bit sets.

        Particles i and j may touch only if ``categories[i] & masks[j]`` and ``categories[j] & masks[i]``. To change
        all, assign an array or one number; to change some, use `set`. The islands of changed particles wake."""
    @categories.setter
    def categories(self, value: ArrayLike) -> None: ...
    @property
    def masks(self) -> NDArray[np.uint32]:
        """Masks: ndarray of uint32, shape (n,), a read-only copy of bit sets of the categories that each particle may
        touch, see `categories`.

        To change all, assign an array or one number; to change some, use `set`."""
    @masks.setter
    def masks(self, value: ArrayLike) -> None: ...
    @property
    def kinds(self) -> NDArray[np.uint8]:
        """Kinds: ndarray of uint8, shape (n,), a read-only copy of the rows of the particles in the tables of each
        `PairForce`.

        To change all, assign an array or one number; to change some, use `set`."""
    @kinds.setter
    def kinds(self, value: ArrayLike) -> None: ...
    @property
    def sensors(self) -> NDArray[np.bool_]:
        """Which particles are sensors: ndarray of bool, shape (n,), a read-only copy.

        A sensor and another particle pass through each other; `contacts` and `events` report that they touch, without
        impulses. A disc that passes through a sensor within a step, at any speed, is found too: it has entered and
        left. Walls, the container and forces act on sensors that are movable, as on other particles. One with
        ``movable=False`` stands still or moves with its velocity, and also reports other immovable particles. Two
        sensors report each other if one is movable. Categories and masks determine what they report. They never merge.

        To change all, assign an array or one bool; to change some, use `set`."""
    @sensors.setter
    def sensors(self, value: ArrayLike) -> None: ...
    @property
    def gravity(self) -> NDArray[np.float64]:
        """Acceleration of all movable particles: ndarray of float64, shape (2,), a read-only copy in units of length
        per second squared."""
    @gravity.setter
    def gravity(self, value: _Vectors) -> None: ...
    @property
    def drag(self) -> float:
        """Linear damping, per second."""
    @drag.setter
    def drag(self, value: _Number) -> None: ...
    @property
    def container(self) -> _Container | None:
        """The region of the particles: a Box, Circle or None."""
    @container.setter
    def container(self, value: _Container | None) -> None: ...
    @property
    def period(self) -> NDArray[np.float64] | None:
        """Width and height of the periodic plane: ndarray of float64, shape (2,), or None.

        A particle that leaves on one side enters on the other; positions are from 0 to the period. A world has a
        container or a period.

        Raises
        ------
        ValueError
            If there is a container, or a side is not finite and above 0."""
    @period.setter
    def period(self, value: ArrayLike | None) -> None: ...
    @property
    def walls(self) -> Walls:
        """The walls of the world: a `Walls`, which shows and changes them.

        It cannot be assigned; ``world.walls.segments = ...`` moves all walls."""
    @property
    def forces(self) -> tuple[_Force, ...]:
        """The forces: a tuple of `Attractor`, `Gravitation`, `Springs`, `PairForce`, `Flocking`, `Grab`, `Thermostat`,
        `ThermalWalls`, `AndersenThermostat`, `Motor` and `Pump`. Assign any sequence of them. They refer to particles
        by id. If a particle is removed, its attractors and springs are removed too, and motors drive the others. If
        particles merge, forces refer to the merged particle, and a spring between two of them is removed."""
    @forces.setter
    def forces(self, value: Iterable[_Force]) -> None: ...
    @property
    def on_touch(self) -> Literal["bounce", "merge", "ignore"]:
        """What happens to particles that touch: "bounce", "merge" or "ignore"."""
    @on_touch.setter
    def on_touch(self, value: Literal["bounce", "merge", "ignore"]) -> None: ...
    @property
    def renumbered(self) -> _Ids | None:
        """The new id of each id after the last call of `step`: a read-only ndarray of int64, or None if no particles
        merged.

        It has one number for each id that was ever given: ``ids = world.renumbered[ids]`` updates ids. Particles that
        merged share the smallest of their ids; all other ids stay the same. -1 stands for an id that no particle has,
        also if it was removed since. Each call of `step` replaces the array: read it after every call that may merge
        particles. If its first step is refused, the array stays. Snapshots, files and copies do not contain it.

        Raises
        ------
        MemoryError
            If more than 134217728 ids were given, or there is not enough memory."""
    @property
    def method(self) -> Literal["quadtree", "brute"]:
        """How pairs are found: "quadtree" or "brute"."""
    @method.setter
    def method(self, value: Literal["quadtree", "brute"]) -> None: ...
    @property
    def threads(self) -> int | None:
        """Number of threads that was set; None for one on each core. A call uses at most one on each core."""
    @threads.setter
    def threads(self, value: SupportsIndex | None) -> None: ...
    @property
    def leaf_capacity(self) -> int:
        """Particles that a box of the tree may hold before it splits."""
    @leaf_capacity.setter
    def leaf_capacity(self, value: SupportsIndex) -> None: ...
    @property
    def max_depth(self) -> int:
        """Maximum number of subdivisions of the tree."""
    @max_depth.setter
    def max_depth(self, value: SupportsIndex) -> None: ...
    @property
    def substeps(self) -> int | None:
        """Sub-steps of a step, or None for as many as the scene needs."""
    @substeps.setter
    def substeps(self, value: SupportsIndex | None) -> None: ...
    @property
    def sleeping(self) -> bool:
        """Whether resting islands may fall asleep, see `asleep`. If it is set to False, all wake."""
    @sleeping.setter
    def sleeping(self, value: bool) -> None: ...
    @property
    def unwrapped_positions(self) -> NDArray[np.float64]:
        """Where the particles would be without a period: ndarray of float64, shape (n, 2), a read-only copy in units of
        length.

        A particle that leaves a periodic plane on one side enters on the other, and `positions` are from 0 to the
        period. Here the periods that it has travelled are added, so differences from step to step are displacements.
        All digits of the state are included, also those that float32 removes from `positions`. A particle that is
        added, or is given another position by `set` or by assigning `positions`, begins at that position. If the period
        changes, all begin at their `positions`. A merged particle continues the path of that whose id it has.

        Without a period they are the positions. They are kept by snapshots and files."""
    @property
    def asleep(self) -> NDArray[np.bool_]:
        """Which particles are asleep: ndarray of bool, shape (n,), a read-only copy.

        An island of particles that touch or nearly touch falls asleep under gravity if each of them rests on something
        and has been slow for half a second, and if their motion is steady and does not grow. Sleeping particles do not
        move, and cost almost nothing. Their contacts in `last_step` are those of the last step in which they were
        awake.

        An island wakes if a moving particle could touch it in the step, or if one of its particles is changed or
        removed (also if `world.positions` is assigned: to move a few, use `world.set`). All islands wake if the forces,
        an immovable particle or a setting other than `method`, `threads`, `leaf_capacity` and `max_depth` changes, or
        if an immovable particle is added. If only the velocities of an immovable particle change, the islands that
        touch it wake.

        Nothing falls asleep if there is a force other than a `Thermostat` or a `Motor`, while a wall moves, or with an
        `on_touch` other than "bounce". Immovable particles are never asleep, and nothing sleeps on a kinematic one."""
    def free_positions(self, n: int, radii: ArrayLike, *, region: Box | Circle | None = None, gap: float = 0.0,
            seed: int = 0) -> NDArray[np.float32]:
        """Return random positions at which new discs touch nothing.

        The discs touch neither each other nor particles, walls or the sides of the container, at their present places.
        Sensors, walls among them, do not count; filters make no difference. Nothing is added. The positions are those
        of random sequential addition: one after the other, large discs first, each uniform among the positions that are
        still free. So discs of one radius fill at most about 54 % of a region.

        Parameters
        ----------
        n : int
            Number of discs.
        radii : array_like, a number or shape (n,)
            In units of length.
        region : Box or Circle, optional
            The discs lie inside of it entirely. If omitted, the container or the period of the world; required in a
            world that has neither.
        gap : float, default 0
            Least distance of surfaces from each other, in units of length, also from walls and the sides of the
            container.
        seed : int, default 0
            Seed of the random numbers, below 2³². The same seed gives the same positions on every machine.

        Returns
        -------
        ndarray of float32, shape (n, 2)
            Centres in the order of `radii`.

        Raises
        ------
        TypeError
            If an argument has the wrong type.
        ValueError
            If there is no room for all discs, with the number that found room; if a radius does not fit into the region
            or the container; if there is no region, or a number is out of range.

        Notes
        -----
        For each disc up to 100,000 positions are tried. A disc finds room if about one position in 10,000 is free."""
    def net_forces(self) -> NDArray[np.float64]:
        """Return the sum of the forces on each particle at the present state, without those of contacts.

        It is m (gravity - drag v), and the forces of `forces` that accelerate particles: `Attractor`, `Gravitation`,
        `PairForce`, `Flocking`, `Grab` and `Springs`, with their damping; and what is given for the next call of
        `step`. Contacts, walls and sides are left out: `last_step` has their impulses. So are the speed limits of
        `Flocking`, and thermostats.

        Returns
        -------
        ndarray of float64, shape (n, 2)
            In units of mass times length per second squared, in the order of `ids`; 0 for immovable particles.

        Notes
        -----
        Positions are those of float32. Accelerations are computed in float32, as in a step, for all particles, so the
        cost is about that of the forces in a sub-step."""
    def force_virial(self) -> NDArray[np.float64]:
        """Return the virial of the forces between pairs at the present state: the sum of offset times force over all
        pairs, as `collision_virial` of `last_call` is that of offset times impulse.

        The offset is from one particle of the pair to the nearest image of the other, the force is that on the other:
        repulsion is positive. The forces are those of `PairForce`, `Gravitation` and `Springs`, with their damping. If
        those of a `PairForce` are not equal and opposite, a pair has the mean of both. Gravity, `Attractor` and
        `Flocking` do not act between pairs and are left out.

        Returns
        -------
        ndarray of float64, shape (2, 2)
            In units of energy. The first index is the axis of the offset, the second that of the force.

        Notes
        -----
        The pressure on an area A is (n T + ½ tr W) / A, where T is the temperature and W the mean of the virial. The
        mean of collisions is `collision_virial` over `duration`."""
    def pairs(self, *, sort: bool = False, max_pairs: SupportsIndex = 134217728, mask: _Mask = None,
            distance: _Number = 0.0) -> _Pairs:
        """Find every pair of particles that overlap now.

        Parameters
        ----------
        sort : bool, default False
            Whether to sort the pairs by the first, then by the second id. If False, they come in the order of a tree,
            which is the same for every number of threads.
        max_pairs : int, default 134217728
            Maximum number of pairs to return; the default corresponds to 2 GiB.
        mask : int, optional
            Find only pairs whose particles both have a category in this set of bits.
        distance : float, default 0.0
            Find pairs whose gap is below this, in units of length: each radius is increased by half of it. If 0, the
            particles must overlap.

        Returns
        -------
        ndarray of int64, shape (m, 2)
            Ids of each pair, the smaller first, every pair once.

        Raises
        ------
        ValueError
            If more than `max_pairs` pairs overlap.

        Notes
        -----
        All queries of a world take the particles where they are now, awake and asleep, in float32, and on a periodic
        plane across its sides. They change no particle and no result of a step. The first query after a step or an edit
        builds a tree, which takes as long as a `Quadtree` of the same discs; later ones use it. For `pairs`,
        `contacts`, `neighbors` and `nodes` it has all particles; for the other queries only those that are awake,
        because sleeping islands have trees that stay."""
    def contacts(self, *, sort: bool = False, max_pairs: SupportsIndex = 134217728, mask: _Mask = None) -> Contacts:
        """Find every pair of particles that overlap now, and how each overlaps.

        Parameters
        ----------
        sort : bool, default False
            Whether to sort the contacts by the first, then by the second id of the pair. If False, they come in the
            order of :meth:`pairs`.
        max_pairs : int, default 134217728
            Maximum number of pairs to return.
        mask : int, optional
            Find only pairs whose particles both have a category in this set of bits.

        Returns
        -------
        Contacts
            The pairs with their normals, depths, points and categories, as from :meth:`Space.contacts`, in float32.

        Raises
        ------
        ValueError
            If more than `max_pairs` pairs overlap."""
    def nodes(self) -> Nodes:
        """Return the boxes of the tree of all particles.

        Returns
        -------
        Nodes
            As from :meth:`Quadtree.nodes`."""
    @property
    def last_step(self) -> LastStep:
        """What the last step found: a `LastStep` of `contacts`, the pairs that touched, a `WorldContacts`;
        `wall_contacts`, the particles to which walls or the container gave an impulse, a `WallContacts`; and the
        numbers `substeps`, `unresolved` and `collapsed`.

        The contacts are listed when it is read. Those of sleeping particles are those of the last step in which they
        were awake. If `on_touch` is not "bounce", the pairs are those that overlap now, without impulses. The numbers
        are 0 before the first step, and after `restore` and `load`. Impulses are those of one step: divided by its
        length they are mean forces. A sum over many steps is in `last_call`."""
    @property
    def last_call(self) -> LastCall:
        """Sums over the last call of `step`, with all its steps: a `LastCall` of `duration`, `steps`, `collisions`,
        `wall_collisions`, `collision_virial`, `wall_impulses` and `side_impulses`.

        Particles that sleep add nothing; ``World(..., sleeping=False)`` keeps all awake."""
    @property
    def wall_events(self) -> WallEvents:
        """The particles and walls that began and ceased to touch in the last call of `step`: a `WallEvents` of
        `entered`, `stayed` and `exited`, each an ndarray of int64, shape (m, 2), of the id of a particle and that of a
        wall, or the `Side` of a container, sorted. They need ``track_events=True``, as `events` do.

        The steps and sub-steps of the call count as for `events`. A particle touches a wall that is a sensor if they
        overlap at any time of the call, also on its way through within one step: then the pair is in `entered` and in
        `exited`. It touches any other wall, or a side, if it gets an impulse from it, or if the gap at the end of the
        call is at most the rounding of float32. Walls that were removed touch nothing.

        Raises
        ------
        RuntimeError
            If `track_events` is False."""
    @property
    def events(self) -> WorldEvents:
        """The pairs that began and ceased to touch in the last call of `step`: a `WorldEvents` of `entered`, `stayed`
        and `exited`, each an ndarray of int64, shape (m, 2), of ids ``i < j``, sorted. They need
        ``World(..., track_events=True)`` or ``world.track_events = True``.

        All steps and sub-steps of the call count: a pair that began and ceased to touch is in `entered` and in
        `exited`. A pair in `entered` did not touch at the end of the call before, and a pair in `exited` does not touch
        at the end of this one, also because a particle was removed or merged. In the first call all pairs that touch
        have entered. So a pair that has entered does not enter again before it has exited.

        Particles touch if they collide, if the gap between them is at most the rounding of float32, or if a resting
        contact presses them together. Particles that pass through each other, sensors among them, touch if they overlap
        at any time of the call. Two immovable particles touch only if exactly one of them is a sensor.

        Raises
        ------
        RuntimeError
            If `track_events` is False."""
    @property
    def track_events(self) -> bool:
        """Whether `events` are tracked. The motion does not depend on it. If it is turned on, no pair counts as
        touching before the next step."""
    @track_events.setter
    def track_events(self, value: bool) -> None: ...
    def angular_momentum(self, about: _Vectors = (0.0, 0.0)) -> float:
        """Return the sum of m (r - a) × v + I ω of the movable particles, with the moment of inertia I = m r²/2.

        Parameters
        ----------
        about : array_like, shape (2,), default (0.0, 0.0)
            The point a.

        Returns
        -------
        float
            Positive for a rotation from +x to +y."""
    def temperature(self) -> float:
        """Return the temperature of the movable particles with k = 1: the sum of m (v - u)² over 2 (n - 1), where u is
        their mean velocity, weighted by mass.

        Rotation is left out. In two dimensions a gas that is at rest as a whole has n - 1 times this energy of
        translation.

        Returns
        -------
        float
            In units of mass times length squared per second squared; NaN for fewer than two particles."""
    def total_energy(self) -> float:
        """Return the sum of `kinetic_energy` and `potential_energy`."""
    def momentum(self) -> NDArray[np.float64]:
        """Return the sum of mass times velocity of the movable particles.

        Returns
        -------
        ndarray of float64, shape (2,)
            In units of mass times length per second."""
    def kinetic_energy(self) -> float:
        """Return the sum of ½ m v² + ½ I ω² of the movable particles, with the moment of inertia I = m r²/2."""
    def potential_energy(self) -> float:
        """Return the energy of all movable particles in the fields of gravity (0 at the origin) and of attractors
        (harmonic: 0 at the point, inverse square: 0 at infinity), of unbroken springs (½ stiffness times stretch
        squared), of gravitation (0 at infinity, by Barnes and Hut's method if there are many particles), and of each
        `PairForce` whose forces are equal and opposite (0 at its cutoff)."""
    @property
    def time(self) -> float:
        """Simulated time in seconds."""
    @property
    def profile(self) -> dict[str, float]:
        """Milliseconds of each stage of the last step: a dict of "forces", if there are forces, "bounds", "build",
        "pairs", "contacts", "resting", "events", "correction" and "store"."""
    @property
    def stats(self) -> Stats:
        """The size of the tree of the last step: a `Stats` of `nodes`, `leaves`, `depth` and `tests`, the number of
        pairs that were tested. All are 0 before the first step, and after `restore` and `load`."""
    def state_hash(self) -> int:
        """Return a 64-bit hash of all particles.

        Returns
        -------
        int
            The same for the same particles, on every machine."""
    def snapshot(self) -> bytes:
        """Return the whole state of the world in bytes.

        Returns
        -------
        bytes
            Particles, settings, forces, the time, the resting contacts, and the `attachment`, the same bytes on every
            machine. A world that `restore` makes from them continues with the same bits."""
    @classmethod
    def restore(cls, data: bytes | bytearray | memoryview) -> World:
        """Make a world from the bytes of `snapshot`.

        Parameters
        ----------
        data : bytes, bytearray or memoryview
            The bytes.

        Returns
        -------
        World
            A world that continues with the same bits.

        Raises
        ------
        TypeError
            If `data` is not bytes.
        ValueError
            If they are not from `snapshot`, or are truncated or damaged."""
    @property
    def attachment(self) -> str | None:
        """A text that the world keeps and does not read: str, or None, the default. It may be assigned.

        Programs keep their own settings there, as JSON. Snapshots, files, copies and pickles contain it; the motion and
        `state_hash` do not depend on it.

        Raises
        ------
        TypeError
            If an assigned value is neither str nor None."""
    @attachment.setter
    def attachment(self, value: str | None) -> None: ...
    def save(self, path: str | bytes | os.PathLike[str]) -> None:
        """Write the world into a file.

        Parameters
        ----------
        path : str, bytes or os.PathLike
            An existing file is replaced when the new one is complete; it keeps its permissions. If the path is a
            symbolic link, its target is replaced.

        Raises
        ------
        OSError
            If the file cannot be written; then an existing one is unchanged."""
    @classmethod
    def load(cls, path: str | bytes | os.PathLike[str]) -> World:
        """Read a world from a file that `save` has written.

        Parameters
        ----------
        path : str, bytes or os.PathLike
            The file.

        Returns
        -------
        World
            A world that continues with the same bits.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If it does not contain a world, or is truncated or damaged; the message names the file."""
    def __reduce__(self) -> tuple[Callable[[bytes], World], tuple[bytes]]: ...
    def __contains__(self, id: object, /) -> bool: ...

@final
class Walls(_Queries):
    """The walls of a world: line segments with ids, which discs do not cross.

    It is made by `World.walls` and shows the walls that the world has at any time. Each wall has an id, which never
    changes and is never used again: 0, 1, 2, ... in the order of adding. The columns are in the order of `ids`, and
    `rows` gives the rows of ids. Columns are read-only copies: assign them as a whole, or change some walls with `set`.
    A change wakes all particles. It costs as much as all walls, so change many at once.

    A wall stops particles from both sides and at its ends. A wall that is `one_way` stops them only from its left, and
    a sensor stops none. A wall moves with its velocity in each step, and pushes particles as a kinematic particle does.
    Walls that are moved by a change transfer no momentum: particles that overlap a wall are pushed out in several
    steps, to the side on which their centre is.

    Queries find walls by id, where they are now in float32, in a periodic world across its sides. Rays and moving
    shapes hit the same walls as casts of the `World`: no sensors, and one-way walls only from their left. The first
    query after walls have moved or changed builds a tree of all walls; later ones use it."""

    def add(self, segments: ArrayLike, *, velocities: ArrayLike = (0.0, 0.0), friction: ArrayLike | None = None,
            restitution: ArrayLike | None = None, sensors: ArrayLike = False, one_way: ArrayLike = False,
            categories: ArrayLike = 1, masks: ArrayLike = 4294967295) -> int | _Ids | Any:
        """Add one wall or many, after the others.

        Parameters
        ----------
        segments : array_like, shape (k, 2, 2), or (2, 2) for one wall
            From one end to the other, in units of length.
        velocities : array_like, shape (2,) or (k, 2), default (0.0, 0.0)
            In units of length per second. Walls that share an end should have the same velocity. Nothing falls asleep
            while a wall moves.
        friction, restitution : array_like, a number or shape (k,), optional
            Coefficients. A contact has the square root of the product with that of the particle. None, and NaN for one
            wall, is the coefficient of the particle.
        sensors : array_like of bool, one or shape (k,), default False
            Whether the wall is a sensor: it stops no particle. `World.wall_events` has the particles that touch it,
            also those that cross it within one step.
        one_way : array_like of bool, one or shape (k,), default False
            Whether the wall stops only what comes from the left of start → end: from the side of (-dy, dx), where (dx,
            dy) is ``end - start``. A particle comes from there if all of it is there, up to an overlap of 1/64 of its
            radius. Anything else passes.
        categories, masks : array_like of int, a number or shape (k,), default 1 and all bits
            Bit sets of 32 bits: a particle i and a wall w touch only if ``categories[i] & masks[w]`` and
            ``categories[w] & masks[i]``.

        Returns
        -------
        ndarray of int64, shape (k,), or int
            Their ids, above all ids before; one id for one segment.

        Raises
        ------
        TypeError, ValueError
            If a shape is wrong, a coordinate is not finite or above 1e18, the ends of a wall are equal, or a wall is
            longer than a side of the period; then nothing is added."""
    def remove(self, ids: ArrayLike) -> None:
        """Remove walls. Their ids are never used again.

        In the columns, the rows after a removed one move up. A `Motor` no longer drives them, and `ThermalWalls` leave
        them out.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The walls, each at most once.

        Raises
        ------
        IdError
            If an id does not exist; then none is removed.
        ValueError
            If an id is given twice; then none is removed."""
    def set(self, ids: ArrayLike, *, segments: ArrayLike | None = None, velocities: ArrayLike | None = None,
            friction: ArrayLike | None = None, restitution: ArrayLike | None = None, sensors: ArrayLike | None = None,
            one_way: ArrayLike | None = None, categories: ArrayLike | None = None,
            masks: ArrayLike | None = None) -> None:
        """Change some columns of some walls.

        Columns that are omitted stay the same.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The walls, each at most once.
        segments : array_like, shape (k, 2, 2), or (2, 2) for one id, optional
            In units of length.
        velocities : array_like, shape (2,) or (k, 2), optional
            In units of length per second.
        friction, restitution : array_like, a number or shape (k,), or None, optional
            Coefficients. None, and NaN for one wall, is the coefficient of the particle.
        sensors : array_like of bool, one or shape (k,), optional
            Whether the wall is a sensor.
        one_way : array_like of bool, one or shape (k,), optional
            Whether the wall stops only what comes from its left.
        categories, masks : array_like of int, a number or shape (k,), optional
            Bit sets of 32 bits.

        Raises
        ------
        IdError
            If an id does not exist; then nothing is changed.
        TypeError, ValueError
            As by `add`, or if an id is given twice; then nothing is changed."""
    @overload
    def get(self, ids: _Id) -> Wall:
        """Read all columns of one wall or some.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The walls; one may be given more than once.

        Returns
        -------
        WallColumns or Wall
            Copies of the columns by the names of the arguments of `add`, with a row for each id; single values for one
            id. NaN in `friction` and `restitution` stands for that of the particle.

        Raises
        ------
        TypeError
            If `ids` does not hold integers.
        IdError
            If no wall has an id."""
    @overload
    def get(self, ids: _IdList) -> WallColumns: ...
    @overload
    def get(self, ids: _Undecided) -> Wall | WallColumns | Any: ...
    @overload
    def rows(self, ids: _Id) -> int:
        """Return the rows that walls have in the columns.

        Parameters
        ----------
        ids : int or array_like of int, of any shape
            The walls.

        Returns
        -------
        ndarray of int64 of the same shape, or int
            Their rows, until a wall before them is removed; one row for one id.

        Raises
        ------
        TypeError
            If `ids` does not hold integers.
        IdError
            If no wall has an id."""
    @overload
    def rows(self, ids: _IdList | Sequence[_IdList]) -> _Ids: ...
    @overload
    def rows(self, ids: _Undecided) -> int | _Ids | Any: ...
    @property
    def ids(self) -> _Ids:
        """The ids of all walls, ascending: ndarray of int64, shape (m,), a read-only copy.

        The wall in row k of every column has the id ``ids[k]``. ``id in world.walls`` is True if a wall has the id."""
    @property
    def segments(self) -> NDArray[np.float32]:
        """The ends of the walls: ndarray of float32, shape (m, 2, 2), a read-only copy in units of length.

        To move all walls, assign an array of this shape. A segment that is the present one in float32 keeps what
        rounding removed while the wall moved."""
    @segments.setter
    def segments(self, value: ArrayLike) -> None: ...
    @property
    def velocities(self) -> NDArray[np.float32]:
        """Velocities: ndarray of float32, shape (m, 2), a read-only copy in units of length per second.

        A wall moves with its velocity in each step, so that `segments` has its new ends: pistons, paddles, lifts. To
        change all, assign an array or one vector; to change some, use `set`."""
    @velocities.setter
    def velocities(self, value: ArrayLike) -> None: ...
    @property
    def friction(self) -> NDArray[np.float32]:
        """Coefficients of friction: ndarray of float32, shape (m,), a read-only copy.

        NaN stands for the coefficient of the particle. To change all, assign an array, one number, or None for NaN."""
    @friction.setter
    def friction(self, value: ArrayLike | None) -> None: ...
    @property
    def restitution(self) -> NDArray[np.float32]:
        """Coefficients of restitution, 0 to 1: ndarray of float32, shape (m,), a read-only copy.

        NaN stands for the coefficient of the particle. To change all, assign an array, one number, or None for NaN."""
    @restitution.setter
    def restitution(self, value: ArrayLike | None) -> None: ...
    @property
    def sensors(self) -> NDArray[np.bool_]:
        """Which walls are sensors, which stop no particle: ndarray of bool, shape (m,), a read-only copy.

        `World.wall_events` has the particles that touch them. To change all, assign an array or one bool."""
    @sensors.setter
    def sensors(self, value: ArrayLike) -> None: ...
    @property
    def one_way(self) -> NDArray[np.bool_]:
        """Which walls stop only what comes from the left of start → end: ndarray of bool, shape (m,), a read-only copy.

        To change all, assign an array or one bool."""
    @one_way.setter
    def one_way(self, value: ArrayLike) -> None: ...
    @property
    def categories(self) -> NDArray[np.uint32]:
        """Categories: ndarray of uint32, shape (m,), a read-only copy of bit sets.

        To change all, assign an array or one number."""
    @categories.setter
    def categories(self, value: ArrayLike) -> None: ...
    @property
    def masks(self) -> NDArray[np.uint32]:
        """Masks: ndarray of uint32, shape (m,), a read-only copy of bit sets of the categories that each wall may
        touch.

        To change all, assign an array or one number."""
    @masks.setter
    def masks(self, value: ArrayLike) -> None: ...
    def __contains__(self, id: object, /) -> bool: ...

@type_check_only
class _Value:
    """What all containers and forces have: values that are compared by what they contain."""

    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs_ex__(self) -> tuple[tuple[Any, ...], dict[str, Any]]: ...

@type_check_only
class _Region(_Value):
    """What both containers have."""

    @property
    def area(self) -> float:
        """Its area."""
    @property
    def restitution(self) -> _Coefficient:
        """Coefficient of restitution of its sides: a number, four numbers if they differ, or None for that of the
        particle."""
    @property
    def friction(self) -> _Coefficient:
        """Coefficient of friction of its sides: a number, four numbers if they differ, or None for that of the
        particle."""
    @overload
    def contains(self, points: _Point) -> bool:
        """Whether points lie inside or on the sides.

        Parameters
        ----------
        points : array_like, shape (k, 2), or (2,) for one point
            In units of length.

        Returns
        -------
        ndarray of bool, shape (k,), or bool
            For each point, or for the only one."""
    @overload
    def contains(self, points: ArrayLike) -> NDArray[np.bool_]: ...
    def clip(self, points: ArrayLike, margin: _Number = 0.0) -> NDArray[np.float64]:
        """Return the nearest places inside.

        Parameters
        ----------
        points : array_like, shape (k, 2), or (2,) for one point
            In units of length.
        margin : float, default 0.0
            The distance from the sides that is kept, as the radius of discs. If there is not so much room, the place is
            in the middle.

        Returns
        -------
        ndarray of float64, shape (k, 2), or (2,) for one point
            The points that are inside already are as they were."""

@final
class Box(_Region):
    """Four walls around a rectangle: a container of a `World`.

    It is not a shape. Rectangles for `find_pairs`, `Quadtree` and `Space` are given by arrays.

    Parameters
    ----------
    min_x, min_y, max_x, max_y : float
        Its sides, in units of length; min below max. Stored as float32.
    restitution, friction : array_like, a number or shape (4,), optional
        Coefficients of the sides at min x, max x, min y and max y. A contact has the square root of the product with
        that of the particle; None, for all or for one side, is that of the particle.

    Raises
    ------
    TypeError
        If an argument is not a number.
    ValueError
        If a side is not finite or min is not below max."""

    __match_args__: Final = ("min_x", "min_y", "max_x", "max_y")
    def __new__(cls, min_x: _Number, min_y: _Number, max_x: _Number, max_y: _Number, *,
            restitution: ArrayLike | Sequence[float | None] | None = None,
            friction: ArrayLike | Sequence[float | None] | None = None) -> Self: ...
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
    @property
    def bounds(self) -> NDArray[np.float64]:
        """Left, top, right and bottom where y grows downwards: ndarray of float64, shape (4,), in the order min x, min
        y, max x, max y, as the rows of `Space.bounds`."""

@final
class Circle(_Region):
    """A circular wall: a container of a `World`.

    It is not a shape. Circles for `find_pairs`, `Quadtree` and `Space` are given by arrays.

    Parameters
    ----------
    center : array_like, shape (2,)
        Its centre, in units of length. Stored as float32.
    radius : float
        Its radius, above 0. Stored as float32.
    restitution, friction : float, optional
        Coefficients of its side. A contact has the square root of the product with that of the particle; None is that
        of the particle.

    Raises
    ------
    TypeError
        If an argument does not hold numbers.
    ValueError
        If a number is not finite or the radius not above 0."""

    __match_args__: Final = ("center", "radius")
    def __new__(cls, center: _Vectors, radius: _Number, *, restitution: _Number | None = None,
            friction: _Number | None = None) -> Self: ...
    @property
    def center(self) -> NDArray[np.float64]:
        """Its centre: ndarray of float64, shape (2,)."""
    @property
    def radius(self) -> float:
        """Its radius."""
    @property
    def bounds(self) -> NDArray[np.float64]:
        """The rectangle around it: ndarray of float64, shape (4,), in the order min x, min y, max x, max y."""

@final
class Attractor(_Value):
    """A force towards a point or a particle.

    An attracting particle is not accelerated by those that it attracts. On a torus the force is towards the nearest
    image of the point.

    Parameters
    ----------
    point : array_like, shape (2,), optional
        The point, in units of length; or give `particle`.
    strength : float
        Acceleration per unit of distance ("harmonic"), or G times the attracting mass ("inverse_square"). If negative,
        the force is repulsive.
    law : {"harmonic", "inverse_square"}, default "harmonic"
        Acceleration is strength times distance, as in the article, or strength over distance squared. In the second
        case the force within a particle's own radius is that inside a homogeneous ball of that radius.
    particle : int, optional
        Id of the attracting particle; if it is removed, the attractor is removed.

    Raises
    ------
    TypeError
        If not exactly one of `point` and `particle` is given, or it does not hold numbers.
    ValueError
        If a number is not finite, or there is no such law.
    IdError
        When it is assigned to `World.forces`, if no particle has the id."""

    __match_args__: Final = ("point", "strength", "law")
    def __new__(cls, point: ArrayLike | _Vector | None = None, strength: _Number | None = None,
            law: Literal["harmonic", "inverse_square"] = "harmonic", *,
            particle: SupportsIndex | None = None) -> Self: ...
    @property
    def point(self) -> tuple[float, float] | None:
        """The attracting point, (x, y); None if it is a particle."""
    @property
    def strength(self) -> float:
        """Acceleration per unit of distance, or G times the attracting mass."""
    @property
    def law(self) -> Literal["harmonic", "inverse_square"]:
        """"harmonic" or "inverse_square"."""
    @property
    def particle(self) -> int | None:
        """Id of the attracting particle, or None."""

@final
class Gravitation(_Value):
    """Gravitation between all particles.

    The acceleration of each is the sum of G m d / (d² + softening²)^(3/2) over all others; on a torus with minimum
    images. Many particles are summed by the Barnes-Hut method on a quadtree, with an error of about half a percent for
    the default `theta`; few are summed directly. Momentum is conserved.

    Parameters
    ----------
    G : float
        The gravitational constant.
    softening : float, default 0.0
        Distance below which the force is reduced, in units of length.
    theta : float, default 0.5
        A box is treated as one body if its diagonal divided by its distance is less; 0 to 1. With 0 every pair is
        summed.

    Raises
    ------
    TypeError
        If an argument is not a number.
    ValueError
        If a number is out of range."""

    __match_args__: Final = ("G", "softening", "theta")
    def __new__(cls, G: _Number, softening: _Number = 0.0, theta: _Number = 0.5) -> Self: ...
    @property
    def G(self) -> float:
        """The gravitational constant."""
    @property
    def softening(self) -> float:
        """Distance below which the force is reduced, in units of length."""
    @property
    def theta(self) -> float:
        """Diagonal divided by distance below which a box is treated as one body."""

@final
class Springs(_Value):
    """Springs between pairs of particles.

    The force of each spring is stiffness times stretch plus damping times the rate of lengthening. Stiff springs are
    integrated in parts of a sub-step, whose number is limited; the stiffness is reduced if more would be necessary.
    Where discs with stiff springs touch anything, the springs are solved together with the contacts: then bodies rest
    at any stiffness, but their oscillations lose energy. Springs are stiff for a disc if their stiffness in all,
    divided by its mass and times the square of the sub-step, is more than 1.45. If one of its ends is removed, a spring
    is removed too.

    Parameters
    ----------
    pairs : array_like of int, shape (m, 2)
        Ids of the two ends of each spring.
    lengths : array_like, a number or shape (m,)
        Lengths at rest, in units of length.
    stiffness : array_like, a number or shape (m,)
        Force per unit of stretch.
    damping : array_like, a number or shape (m,), default 0.0
        Force per unit of speed.
    max_stretch : array_like, a number or shape (m,), optional
        Stretch beyond which a spring breaks at the end of a step, in units of length. If omitted, none breaks.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If a shape is wrong or a number is out of range; the message says which.
    IdError
        When it is assigned to `World.forces`, if no particle has an id."""

    __match_args__: Final = ("pairs", "lengths", "stiffness")
    def __new__(cls, pairs: ArrayLike, lengths: ArrayLike, stiffness: ArrayLike, *, damping: ArrayLike = 0.0,
            max_stretch: ArrayLike | None = None) -> Self: ...
    @property
    def pairs(self) -> _Pairs:
        """Ids of the ends: read-only ndarray of int64, shape (m, 2)."""
    @property
    def lengths(self) -> NDArray[np.float32]:
        """Lengths at rest: read-only ndarray of float32, shape (m,)."""
    @property
    def stiffness(self) -> NDArray[np.float32]:
        """Force per unit of stretch: read-only ndarray of float32, shape (m,)."""
    @property
    def damping(self) -> NDArray[np.float32]:
        """Force per unit of speed: read-only ndarray of float32, shape (m,)."""
    @property
    def max_stretch(self) -> NDArray[np.float32]:
        """Stretch beyond which each breaks: read-only ndarray of float32, shape (m,); infinite if it never breaks."""
    def __len__(self) -> int: ...
    __hash__: None  # type: ignore[assignment]

@final
class PairForce(_Value):
    """Forces between kinds of particles within a cutoff.

    The force on a particle of kind a by one of kind b is a function of their distance. It is given at m equally spaced
    distances from 0 to `cutoff`, and linear between. The forces on each other need not be equal and opposite. The
    constructors `particle_life`, `lennard_jones` and `soft_discs` make well-known tables.

    Parameters
    ----------
    table : array_like, shape (K, K, m)
        ``table[a, b, k]`` is the force on kind a by kind b at the distance ``k * cutoff / (m - 1)``. It is positive if
        kind a is repelled. K is at most 64, m at least 2.
    cutoff : float
        Distance from which there is no force, in units of length. On a torus at most half of each side.
    damping : float, default 0.0
        Force that resists a relative speed of 1 along the line between two particles, at distance 0; at the distance d
        it is ``damping * (1 - d / cutoff)**2``.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If a shape is wrong or a number is out of range. When it is assigned to `World.forces`, also if the table does
        not have the kind of a particle, or the cutoff is too large for the torus.

    Notes
    -----
    Kinds belong to the particles: `World.kinds` has them, and they are the same for all `PairForce` of a world. Merged
    particles have the kind of the heaviest. The forces act at the positions in the middle of a sub-step (leapfrog), the
    damping with the velocities at its beginning. If no other force acts and nothing rests, a step has one sub-step;
    choose the length of a step for the steepest force, or more `World.substeps`. `World.potential_energy` includes
    forces that are equal and opposite for all kinds."""

    __match_args__: Final = ("table", "cutoff")
    def __new__(cls, table: ArrayLike, cutoff: _Number, *, damping: _Number = 0.0) -> Self: ...
    @staticmethod
    def particle_life(matrix: ArrayLike, cutoff: _Number, core: _Number = 0.3, *, strength: _Number = 1.0) -> PairForce:
        """Particle life: kinds attract and repel each other, not always mutually.

        Within ``core * cutoff`` all particles repel each other, with the force `strength` at distance 0. From there to
        the cutoff, kind a is attracted by kind b with the force ``matrix[a, b] * strength`` in the middle, which
        decreases to 0 on both sides.

        Parameters
        ----------
        matrix : array_like, shape (K, K)
            Attraction of kind a (row) by kind b (column), usually -1 to 1; negative values repel.
        cutoff : float
            Distance from which there is no force, in units of length.
        core : float, default 0.3
            Share of the cutoff within which all repel each other, between 0 and 1.
        strength : float, default 1.0
            Factor of all forces.

        Returns
        -------
        PairForce
            The force with this table.

        Raises
        ------
        TypeError, ValueError
            As for `PairForce`.

        Notes
        -----
        The forces are not conservative, so the world needs a `drag`."""
    @staticmethod
    def lennard_jones(epsilon: ArrayLike, sigma: ArrayLike, cutoff: _Number) -> PairForce:
        """The Lennard-Jones force, truncated at the cutoff.

        The potential energy is ``4 * epsilon * ((sigma / d)**12 - (sigma / d)**6)``, shifted to 0 at the cutoff. Below
        ``sigma / 2`` the force is that at ``sigma / 2``.

        Parameters
        ----------
        epsilon : array_like, a number or shape (K, K)
            Depth of the potential, in units of energy, at least 0.
        sigma : array_like, a number or shape (K, K)
            Distance at which it is 0, in units of length. The minimum is at ``2**(1/6) * sigma``.
        cutoff : float
            Distance from which there is no force, usually 2.5 times the largest sigma.

        Returns
        -------
        PairForce
            The force with this table.

        Raises
        ------
        TypeError, ValueError
            As for `PairForce`.

        Notes
        -----
        With sub-steps of ``0.002 * sigma * sqrt(m / epsilon)`` seconds the energy of a fluid varies by less than 0.1 %
        of its kinetic energy. Use ``on_touch="ignore"``, so that the particles do not also collide as discs."""
    @staticmethod
    def soft_discs(stiffness: ArrayLike, diameters: ArrayLike, *, damping: _Number = 0.0) -> PairForce:
        """Soft discs, which repel each other with a force proportional to their overlap.

        Parameters
        ----------
        stiffness : array_like, a number or shape (K, K)
            Force per unit of overlap, at least 0.
        diameters : array_like, a number or shape (K, K)
            Distance below which two kinds overlap, in units of length. The largest is the cutoff.
        damping : float, default 0.0
            As for `PairForce`.

        Returns
        -------
        PairForce
            The force with this table.

        Raises
        ------
        TypeError, ValueError
            As for `PairForce`."""
    @property
    def table(self) -> NDArray[np.float32]:
        """The forces: read-only ndarray of float32, shape (K, K, m)."""
    @property
    def cutoff(self) -> float:
        """Distance from which there is no force, in units of length."""
    @property
    def damping(self) -> float:
        """Force that resists a relative speed of 1 at distance 0."""
    @property
    def reciprocal(self) -> bool:
        """Whether all kinds act on each other with equal and opposite forces, so that momentum is conserved: bool."""
    __hash__: None  # type: ignore[assignment]

@final
class Flocking(_Value):
    """Flocking: separation, alignment and cohesion.

    The neighbours of a particle are those nearer than `cutoff`. Its acceleration is the mean over these of
    ``separation * (1 - d / cutoff)`` away from each, ``alignment`` times the difference of velocities, and ``cohesion``
    times the offset. Forces keep the speed within limits.

    Parameters
    ----------
    cutoff : float
        Distance below which particles are neighbours, in units of length. On a torus at most half of each side.
    separation : float
        Acceleration away from a neighbour at distance 0, at least 0.
    alignment : float
        Rate at which velocities become equal, per second, at least 0.
    cohesion : float
        Acceleration towards a neighbour per unit of distance, at least 0.
    max_speed : float
        Limit of the speed, in units of length per second; may be infinite.
    min_speed : float, default 0.0
        Lower limit of the speed of particles that move.

    Raises
    ------
    TypeError
        If an argument is not a number.
    ValueError
        If a number is out of range. When it is assigned to `World.forces`, also if the cutoff is too large for the
        torus.

    Notes
    -----
    The limits of the speed hold for the sum of all accelerations but gravity. Momentum and energy are not conserved."""

    __match_args__: Final = ("cutoff", "separation", "alignment", "cohesion", "max_speed", "min_speed")
    def __new__(cls, cutoff: _Number, separation: _Number, alignment: _Number, cohesion: _Number, max_speed: _Number,
            min_speed: _Number = 0.0) -> Self: ...
    @property
    def cutoff(self) -> float:
        """Distance below which particles are neighbours, in units of length."""
    @property
    def separation(self) -> float:
        """Acceleration away from a neighbour at distance 0."""
    @property
    def alignment(self) -> float:
        """Rate at which velocities become equal, per second."""
    @property
    def cohesion(self) -> float:
        """Acceleration towards a neighbour per unit of distance."""
    @property
    def max_speed(self) -> float:
        """Limit of the speed."""
    @property
    def min_speed(self) -> float:
        """Lower limit of the speed of particles that move."""

@final
class Grab(_Value):
    """A force that pulls a particle to a point, for instance to the mouse.

    It is a critically damped spring from the centre of the particle to the point. A particle at rest does not move
    beyond the point, at any length of a step. One that has a velocity, or whose force is limited by `max_force`, may.
    The particle collides as others do; `max_force` limits what it can push or lift. In a periodic world the force is
    towards the nearest image of the point.

    Parameters
    ----------
    id : int
        Id of the particle. It stays awake; if it is removed, so is the force.
    point : array_like, shape (2,)
        Where the particle is pulled to, in units of length.
    rate : float
        Speed of the approach, per second, at least 0. For short sub-steps a particle that starts at rest at the
        distance d is at the distance ``d * (1 + rate * t) * exp(-rate * t)`` after t seconds.
    max_force : float, default inf
        Limit of the force, at least 0, in units of mass times length per second squared.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If a number is out of range.
    IdError
        When it is assigned to `World.forces`, if no particle has the id.

    Notes
    -----
    Assign a new `Grab` to `World.forces` in each frame. If only grabs change, only the islands of the grabbed particles
    wake, and resting contacts keep their impulses. Under gravity g the particle rests below the point by
    ``g * (1 + rate * h)**2 / rate**2``, where h is the length of a sub-step. Immovable particles do not move."""

    __match_args__: Final = ("id", "point")
    def __new__(cls, id: SupportsIndex, point: _Point | _Array, *, rate: _Number,
            max_force: _Number = math.inf) -> Self: ...
    @property
    def id(self) -> int:
        """Id of the particle."""
    @property
    def point(self) -> tuple[float, float]:
        """Where it is brought, (x, y)."""
    @property
    def rate(self) -> float:
        """How fast, per second."""
    @property
    def max_force(self) -> float:
        """Limit of the force."""

@final
class Motor(_Value):
    """A prescribed motion of immovable particles and walls.

    They rotate about a pivot and move with a velocity, for example as the paddles of a mill, the flippers of a pinball
    table or a piston. With a `cycle` the motion is reversed in its second half. They push other particles and are not
    pushed. A motor is one of the `World.forces`.

    Parameters
    ----------
    ids : array_like of int, shape (k,), optional
        Ids of the immovable particles; if one is removed, the motor drives the others.
    walls : array_like of int, shape (m,), optional
        Ids of the walls. Walls do not rotate.
    pivot : array_like, shape (2,), optional
        The centre of the rotation, in units of length. It moves with `velocity`. A motor that only moves needs none.
    angular_velocity : float, default 0.0
        In radians per second, positive from +x to +y.
    velocity : array_like, shape (2,), default (0.0, 0.0)
        In units of length per second.
    cycle : float, optional
        Seconds of the motion there and back, above 0. If omitted, the motion is not reversed.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If a number is out of range, a particle or a wall is given twice, or `angular_velocity` is not 0 for walls or
        without a `pivot`. When it is assigned to `World.forces`, also if a particle is movable, or another motor drives
        the same particle or wall.
    IdError
        When it is assigned to `World.forces`, if a particle or a wall does not exist.

    Notes
    -----
    The motion is a function of `World.time`. At the beginning of each step the motor sets the velocities that lead to
    the position at its end. On a circle a step is a chord, so the angle per step should be small. Particles and walls
    that are moved between calls continue from their new position.

    The time is that of the world, not that since the motor was assigned: with a `cycle` one that is assigned at the
    time t begins in the phase ``t % cycle``. Particles and walls keep the velocity of the last step when their motor is
    taken out of `World.forces`; set their velocities to 0 to stop them."""

    __match_args__: Final = ("ids",)
    def __new__(cls, ids: ArrayLike | None = None, *, walls: ArrayLike | None = None, pivot: _Point | None = None,
            angular_velocity: float = 0.0, velocity: _Point = (0.0, 0.0), cycle: float | None = None) -> Self: ...
    @property
    def ids(self) -> _Ids:
        """Ids of the particles that it drives: read-only ndarray of int64, shape (k,)."""
    @property
    def walls(self) -> NDArray[np.int64]:
        """Ids of the walls that it drives: read-only ndarray of int64, shape (m,)."""
    @property
    def pivot(self) -> tuple[float, float]:
        """The centre of the rotation at time 0, (x, y)."""
    @property
    def angular_velocity(self) -> float:
        """In radians per second."""
    @property
    def velocity(self) -> tuple[float, float]:
        """In units of length per second, (x, y)."""
    @property
    def cycle(self) -> float | None:
        """Seconds of the motion there and back; None if it is not reversed."""
    __hash__: None  # type: ignore[assignment]

@final
class Thermostat(_Value):
    """Walls that heat or cool the particles that bounce off them.

    Every bounce off a wall changes a particle's speed s to s + rate (speed - s), as in the article's lesson about
    gases. A world has at most one `Thermostat`. The speeds do not reach the Maxwell distribution, see `ThermalWalls`.

    Parameters
    ----------
    speed : float
        Target speed in units of length per second, at least 0.
    rate : float
        Relative change by one bounce, 0 to 1; with 1 particles leave the walls with `speed`.

    Raises
    ------
    TypeError
        If an argument is not a number.
    ValueError
        If a number is out of range."""

    __match_args__: Final = ("speed", "rate")
    def __new__(cls, speed: _Number, rate: _Number) -> Self: ...
    @property
    def speed(self) -> float:
        """The target speed."""
    @property
    def rate(self) -> float:
        """Relative change by one bounce, 0 to 1."""

@final
class ThermalWalls(_Value):
    """Sides of the container, and walls, with a temperature.

    A particle that hits such a wall leaves it with the velocity of a particle that enters through it from a gas in
    equilibrium: the speed along the normal has the density ∝ v exp(-m v²/2kT), the velocity along the wall is normally
    distributed with the variance kT/m. A gas between such walls reaches their temperature and the Maxwell distribution;
    between different temperatures there is a heat flow. The random numbers are functions of `seed`, the particle's
    state at the impact and the time, so results have the same bits for every number of threads and every order of
    adding.

    Parameters
    ----------
    temperature : float
        Boltzmann's constant times the temperature, kT, above 0: the mean kinetic energy of a particle, in units of mass
        times length² per second².
    sides : Side or array_like of Side, shape (k,), optional
        Sides of the container. If omitted, or all of `Side`, those that it has; if omitted and `walls` is given, none.
    walls : int or array_like of int, shape (m,), optional
        Ids of line segments of `World.walls`, which have the temperature on both sides. At a wall that moves, the
        velocities are relative to it.
    seed : int, default 0
        Seed of the random numbers, below 2³².

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If a number is out of range, or a side or a wall is given twice. When it is assigned to `World.forces`, also if
        a wall has a temperature already, or the container does not have a side. A change of `World.container` to one
        without it is refused, too.
    IdError
        When it is assigned to `World.forces`, if a wall does not exist.

    Notes
    -----
    Several of them may have different sides and walls. Angular velocities, and particles that rest on a wall, are not
    heated: use coefficients of restitution of 1. `World.last_step` includes the change along the normal."""

    __match_args__: Final = ("temperature",)
    def __new__(cls, temperature: _Number, *, sides: ArrayLike | None = None, walls: ArrayLike | None = None,
            seed: SupportsIndex = 0) -> Self: ...
    @property
    def temperature(self) -> float:
        """Boltzmann's constant times the temperature."""
    @property
    def sides(self) -> tuple[Side, ...]:
        """The sides of the container that have it: a tuple of `Side`. All of them stand for those that the container
        has."""
    @property
    def seed(self) -> int:
        """The seed of the random numbers."""
    @property
    def walls(self) -> tuple[int, ...]:
        """The ids of the walls that have it: a tuple of int."""

@final
class AndersenThermostat(_Value):
    """A heat bath that gives each particle a new velocity at random times.

    At the end of each step a particle gets a new velocity with the probability 1 - exp(-rate dt). Each component of it
    is normally distributed with the variance kT/m. So the particles reach the Maxwell distribution at this temperature
    (canonical ensemble); momentum and energy are not conserved. The random numbers are functions of `seed`, the
    particle's state and the time, so results have the same bits for every number of threads and every order of adding.

    Parameters
    ----------
    temperature : float
        Boltzmann's constant times the temperature, kT, above 0: the mean kinetic energy of a particle, in units of mass
        times length² per second².
    rate : float
        Mean number of new velocities of a particle per second, at least 0.
    seed : int, default 0
        Seed of the random numbers, below 2³².

    Raises
    ------
    TypeError
        If an argument is not a number.
    ValueError
        If a number is out of range.

    Notes
    -----
    A world has at most one. Angular velocities and immovable particles are not changed."""

    __match_args__: Final = ("temperature", "rate", "seed")
    def __new__(cls, temperature: _Number, rate: _Number, seed: SupportsIndex = 0) -> Self: ...
    @property
    def temperature(self) -> float:
        """Boltzmann's constant times the temperature."""
    @property
    def rate(self) -> float:
        """Mean number of new velocities of a particle per second."""
    @property
    def seed(self) -> int:
        """The seed of the random numbers."""

@final
class Pump(_Value):
    """A drain and a nozzle, as of a fountain: what is in the drain starts again from the nozzle.

    At the beginning of each step a movable particle whose centre is in the drain is taken with the probability 1 -
    exp(-rate dt). It keeps its id and all columns but position and velocity. It starts somewhere along the width of the
    nozzle, and from there it has already flown for a random part of the step, so a jet is as even with long steps as
    with short ones. The random numbers are functions of `seed`, the particle's state and the time, so results have the
    same bits for every number of threads and every order of adding.

    Parameters
    ----------
    drain : array_like, shape (4,), or Box
        Sides min_x, min_y, max_x, max_y of the drain, in units of length.
    position : array_like, shape (2,)
        Centre of the nozzle, in units of length.
    velocity : array_like, shape (2,)
        Mean velocity of what leaves it, in units of length per second.
    rate : float
        Mean number of times per second at which a particle in the drain is taken, at least 0. The number of particles
        in the drain times this leaves the nozzle per second.
    width : float, default 0.0
        Length of the line on which particles start, perpendicular to the velocity.
    spread : float, default 0.0
        Maximum random addition to the velocity, in any direction, in units of length per second.
    seed : int, default 0
        Seed of the random numbers, below 2³².

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If a number is out of range, or a min of the drain is not below its max.

    Notes
    -----
    A pump adds energy and momentum. The nozzle does not look for room: particles that overlap there are pushed apart,
    without a change of their velocities, as everywhere. A world with pumps does not sleep. Of several pumps whose
    drains have a particle in common, the first one that takes it counts."""

    __match_args__: Final = ("drain", "position", "velocity")
    def __new__(cls, drain: ArrayLike | Box, position: ArrayLike, velocity: ArrayLike, *, rate: _Number,
            width: _Number = 0.0, spread: _Number = 0.0, seed: SupportsIndex = 0) -> Self: ...
    @property
    def drain(self) -> tuple[float, float, float, float]:
        """Sides of the drain, (min_x, min_y, max_x, max_y)."""
    @property
    def position(self) -> tuple[float, float]:
        """Centre of the nozzle, (x, y)."""
    @property
    def velocity(self) -> tuple[float, float]:
        """Mean velocity of what leaves it, (x, y)."""
    @property
    def rate(self) -> float:
        """How often a particle in the drain is taken, per second."""
    @property
    def width(self) -> float:
        """Length of the line on which particles start."""
    @property
    def spread(self) -> float:
        """Maximum random addition to the velocity."""
    @property
    def seed(self) -> int:
        """The seed of the random numbers."""

def scene_names() -> list[str]:
    """List the scenes.

    Returns
    -------
    list of str
        Their names."""

def describe_scene(name: str) -> str:
    """Describe a scene.

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
        If there is no such scene."""

def create_scene(name: str, n: SupportsIndex | None = None, seed: SupportsIndex = 0) -> World:
    """Make the world of a scene.

    Parameters
    ----------
    name : str
        One of `names()`.
    n : int, optional
        Number of particles; by default a suitable number for the scene. Sizes depend on it. The discs of walls and the
        pegs of `galton` come in addition, and first.
    seed : int, default 0
        The same seed gives the same world on every machine.

    Returns
    -------
    World
        In pixels and seconds, y grows downwards, for steps of 1/60 s.

    Raises
    ------
    ValueError
        If there is no such scene, or `n` or `seed` is out of range."""

def create_scene_part(name: str, n: SupportsIndex | None, seed: SupportsIndex, rank: int, size: int) -> World:
    """Make the particles of one of several ranks. For `jostle.mpi`."""

def scene_view(name: str, n: SupportsIndex | None = None) -> tuple[float, float, float, float]:
    """Return the part of a scene's world to display.

    Parameters
    ----------
    name : str
        One of `names()`.
    n : int, optional
        Number of particles, as for `create`.

    Returns
    -------
    tuple of float
        Sides min_x, min_y, max_x, max_y, in pixels.

    Raises
    ------
    ValueError
        If there is no such scene or `n` is out of range."""

def scene_default_count(name: str) -> int:
    """Return the default number of particles of a scene.

    Parameters
    ----------
    name : str
        One of `names()`.

    Returns
    -------
    int
        What `create` uses if `n` is omitted.

    Raises
    ------
    ValueError
        If there is no such scene."""

def scene_galton_board(n: SupportsIndex | None = None) -> GaltonBoard:
    """Return the geometry of the board in the scene `galton`.

    Parameters
    ----------
    n : int, optional
        Number of balls, as for `create`.

    Returns
    -------
    GaltonBoard
        With rows, bin_edges, bin_top, floor and ball_radius.

    Raises
    ------
    ValueError
        If `n` is out of range."""
