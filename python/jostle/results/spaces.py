"""Copies of the shapes of a space, and how shapes moved."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from jostle.results.base import Result
from jostle.results.queries import IdLists


class Shapes(Result):
    """Some shapes of a `Space`, by the names of the arguments of `Space.add` and `Space.set`.

    Attributes
    ----------
    positions : ndarray of float32 or float64, shape (k, 2)
        Centres; ``(min + max) / 2`` for shapes given as boxes.
    radii : ndarray of float32 or float64, shape (k,)
        Radii.
    half_sizes : ndarray of float32 or float64, shape (k, 2)
        Half widths and half heights; 0 for circles, ``(max - min) / 2`` for shapes given as boxes.
    boxes : ndarray of float32 or float64, shape (k, 4)
        Sides min_x, min_y, max_x, max_y without the radii, as given or ``center ± half_size``.
    segments : ndarray of float32 or float64, shape (k, 2, 2)
        Start and end of segments; NaN for other shapes.
    categories, masks : ndarray of uint32, shape (k,)
        Bit sets of 32 bits.

    See Also
    --------
    jostle.Space.get : Returns it.
    Shape : The same of one shape.
    """

    __slots__ = ("positions", "radii", "half_sizes", "boxes", "segments", "categories", "masks")

    positions: NDArray[np.floating[Any]]
    radii: NDArray[np.floating[Any]]
    half_sizes: NDArray[np.floating[Any]]
    boxes: NDArray[np.floating[Any]]
    segments: NDArray[np.floating[Any]]
    categories: NDArray[np.uint32]
    masks: NDArray[np.uint32]


class Shape(Result):
    """One shape of a `Space`, by the names of the arguments of `Space.add` and `Space.set`.

    Attributes
    ----------
    positions : ndarray of float32 or float64, shape (2,)
        The centre; ``(min + max) / 2`` for a shape given as a box.
    radii : float
        The radius.
    half_sizes : ndarray of float32 or float64, shape (2,)
        Half width and half height; 0 for a circle.
    boxes : ndarray of float32 or float64, shape (4,)
        Sides min_x, min_y, max_x, max_y without the radius, as given or ``center ± half_size``.
    segments : ndarray of float32 or float64, shape (2, 2)
        Start and end of a segment; NaN for another shape.
    categories, masks : int
        Bit sets of 32 bits.

    See Also
    --------
    jostle.Space.get : Returns it.
    Shapes : The same of many shapes.
    """

    __slots__ = Shapes.__slots__

    positions: NDArray[np.floating[Any]]
    radii: float
    half_sizes: NDArray[np.floating[Any]]
    boxes: NDArray[np.floating[Any]]
    segments: NDArray[np.floating[Any]]
    categories: int
    masks: int


class Separated(Result):
    """Centres of shapes that have been moved apart.

    Attributes
    ----------
    positions : ndarray of float32 or float64, shape (n, 2)
        The new centres.
    rounds : int
        Number of rounds; placing along an axis counts as one.
    overlaps : int
        Number of pairs that still overlap; 0 if the shapes are separated.

    See Also
    --------
    jostle.separate : Returns it.
    """

    __slots__ = ("positions", "rounds", "overlaps")

    positions: NDArray[np.floating[Any]]
    rounds: int
    overlaps: int


class Slide(Result):
    """How one shape moved and slid along others.

    Attributes
    ----------
    displacement : ndarray of float32 or float64, shape (2,)
        How far it has moved, in units of length.
    remaining : ndarray of float32 or float64, shape (2,)
        The displacement that was given, without its components into the obstacles; divided by
        the duration of the step it is the velocity for the next step.
    hits : ndarray of int64, shape (m,)
        Ids of the obstacles, each once, in the order in which it met them.
    normals : ndarray of float32 or float64, shape (m, 2)
        Unit normal of each obstacle where it was met first, towards the shape.
    floor : int
        Id of the last floor that it met; -1 if there is none.
    platform_velocity : ndarray of float32 or float64, shape (2,)
        The displacement, since the last call for the shape, of that floor, or else of the floor on
        which it stood before; (0, 0) without one.
    on_floor, on_wall, on_ceiling : bool
        Whether it met a surface that faces up, sideways or down.
    crushed : bool
        Whether obstacles leave it no room, so that it overlaps one.

    See Also
    --------
    jostle.Space.move_and_slide : Returns it for one shape.
    Slides : The result for many shapes.
    """

    __slots__ = (
        "displacement",
        "remaining",
        "hits",
        "normals",
        "floor",
        "platform_velocity",
        "on_floor",
        "on_wall",
        "on_ceiling",
        "crushed",
    )

    displacement: NDArray[np.floating[Any]]
    remaining: NDArray[np.floating[Any]]
    hits: NDArray[np.int64]
    normals: NDArray[np.floating[Any]]
    floor: int
    platform_velocity: NDArray[np.floating[Any]]
    on_floor: bool
    on_wall: bool
    on_ceiling: bool
    crushed: bool


class Slides(Result):
    """How many shapes moved and slid along others.

    Attributes
    ----------
    displacement : ndarray of float32 or float64, shape (k, 2)
        How far each has moved, in units of length.
    remaining : ndarray of float32 or float64, shape (k, 2)
        The displacements that were given, without their components into the obstacles; divided
        by the duration of the step they are the velocities for the next step.
    hits : IdLists
        Ids of the obstacles of each, each once, in the order in which it met them.
    normals : ndarray of float32 or float64, shape (m, 2)
        Unit normal of each obstacle where it was met first, towards the shape that met it; in the
        order of ``hits.ids``.
    floor : ndarray of int64, shape (k,)
        Id of the last floor that each met; -1 if there is none.
    platform_velocity : ndarray of float32 or float64, shape (k, 2)
        The displacement, since the last call for the shape, of that floor, or else of the floor on
        which it stood before; (0, 0) without one.
    on_floor, on_wall, on_ceiling : ndarray of bool, shape (k,)
        Whether each met a surface that faces up, sideways or down.
    crushed : ndarray of bool, shape (k,)
        Whether obstacles leave it no room, so that it overlaps one.

    See Also
    --------
    jostle.Space.move_and_slide : Returns it for many shapes.
    Slide : The result for one shape.
    """

    __slots__ = Slide.__slots__

    displacement: NDArray[np.floating[Any]]
    remaining: NDArray[np.floating[Any]]
    hits: IdLists
    normals: NDArray[np.floating[Any]]
    floor: NDArray[np.int64]
    platform_velocity: NDArray[np.floating[Any]]
    on_floor: NDArray[np.bool_]
    on_wall: NDArray[np.bool_]
    on_ceiling: NDArray[np.bool_]
    crushed: NDArray[np.bool_]
