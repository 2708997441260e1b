"""Results of queries, and the boxes and size of a quadtree."""

from __future__ import annotations

from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from jostle.results.base import Lists, Result
from jostle.results.categories import Choice


class Contacts(Result):
    """Pairs that overlap, with normals, depths, points and categories.

    Attributes
    ----------
    pairs : ndarray of int64, shape (m, 2)
        Row numbers i < j of a tree, or ids of a space; between two trees a row of each.
    normals : ndarray of float32 or float64, shape (m, 2)
        Unit vectors from i to j.
    depths : ndarray of float32 or float64, shape (m,)
        Penetration along the normal, in units of length.
    points : ndarray of float32 or float64, shape (m, 2, 2)
        Points in the middle of the overlap, half of the depth below both surfaces. Where two sides
        overlap they are the ends of the common part, the lower one first; elsewhere, as of a
        circle, there is one, and the second is NaN. With a period they are next to shape i.
    categories : ndarray of uint32, shape (m, 2)
        The categories of both shapes, sets of bits.

    See Also
    --------
    jostle.Quadtree.contacts, jostle.Space.contacts : Return it.
    WorldContacts : The contacts of particles, with impulses.

    Examples
    --------
    Two boxes whose sides overlap from x = 1 to x = 2:

    >>> import jostle
    >>> tree = jostle.Quadtree(boxes=[(0, 0, 2, 2), (1, 1.5, 4, 4)])
    >>> tree.contacts().points
    array([[[1.  , 1.75],
            [2.  , 1.75]]])
    """

    __slots__ = ("pairs", "normals", "depths", "points", "categories")

    pairs: NDArray[np.int64]
    normals: NDArray[np.floating[Any]]
    depths: NDArray[np.floating[Any]]
    points: NDArray[np.floating[Any]]
    categories: NDArray[np.uint32]

    def between(self, a: SupportsIndex, b: SupportsIndex) -> Contacts:
        """Return the contacts between shapes of some categories and shapes of others.

        A contact is kept if one shape has a category in `a` and the other one has a category in
        `b`. The shape in the first column of `pairs` then has one in `a`, and that in the second
        has one in `b`; where this turns a pair, it turns the normal, too. A pair that fits in both
        orders is kept once, as it is. A turned pair of two trees has the row of the other tree
        first.

        Parameters
        ----------
        a, b : int
            Categories, sets of 32 bits, which may be the same or have some in common.

        Returns
        -------
        Contacts
            The contacts that are kept, in the same order.

        Raises
        ------
        TypeError
            If `a` or `b` is no integer.
        ValueError
            If `a` or `b` has more than 32 bits.

        See Also
        --------
        jostle.Events.between : The same for events.
        jostle.WorldContacts.between : The same for particles.

        Examples
        --------
        >>> import jostle
        >>> ROCK, SHOT = 2, 4
        >>> space = jostle.Space()
        >>> rocks = space.add([(0, 0), (0, 1)], radii=1.0, categories=ROCK)
        >>> shot = space.add((0, 2), radii=0.5, categories=SHOT)
        >>> hits = space.contacts().between(SHOT, ROCK)
        >>> hits.pairs, hits.normals
        (array([[2, 1]]), array([[ 0., -1.]]))
        """
        chosen = Choice(self.categories, a, b)
        return Contacts(
            chosen.pairs(self.pairs),
            chosen.normals(self.normals),
            chosen.of(self.depths),
            chosen.of(self.points),
            chosen.pairs(self.categories),
        )


class IdLists(Result, Lists[NDArray[np.int64]]):
    """A list of ids for each of many queries, or for each shape.

    It is a sequence: ``lists[q]`` is the array of ids of query q, and a loop visits these arrays in
    order.

    Attributes
    ----------
    ids : ndarray of int64, shape (m,)
        The ids of all queries, one list after the other.
    offsets : ndarray of int64, shape (k + 1,)
        Those of query q are ``ids[offsets[q]:offsets[q + 1]]``.

    See Also
    --------
    jostle.Quadtree.query_rect : Returns it for many rectangles.
    jostle.Quadtree.neighbors : Returns it for all shapes.

    Examples
    --------
    >>> import jostle
    >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
    >>> lists = tree.query_circle([(0, 0), (3.5, 0), (9, 9)], 1.0)
    >>> lists[1], len(lists), lists.counts
    (array([1, 2]), 3, array([1, 2, 0]))

    The sum of a value over the ids of each query:

    >>> masses, total = np.array([1.0, 5.0, 7.0]), np.zeros(len(lists))
    >>> np.add.at(total, lists.queries, masses[lists.ids])
    >>> total
    array([ 1., 12.,  0.])
    """

    __slots__ = ("ids", "offsets")

    ids: NDArray[np.int64]
    offsets: NDArray[np.int64]

    def _elements(self, at: slice) -> NDArray[np.int64]:
        """Return the ids in a slice."""
        return self.ids[at]


class Neighbors(Result):
    """The shapes nearest to a point, or to each of many.

    Attributes
    ----------
    ids : ndarray of int64, shape (k,) or (points, k)
        Ids of the shapes, nearest first; -1 if fewer than k are found.
    distances : ndarray of float32 or float64, shape (k,) or (points, k)
        Distance to each shape; 0 inside, infinity if fewer than k are found.

    See Also
    --------
    jostle.Quadtree.nearest : Returns it.
    """

    __slots__ = ("ids", "distances")

    ids: NDArray[np.int64]
    distances: NDArray[np.floating[Any]]


class RayHit(Result):
    """The first shape that a ray hits.

    Attributes
    ----------
    id : int
        Id of the shape; -1 if nothing is hit.
    distance : float
        Distance to its surface, in units of length; infinity if nothing is hit.
    point : ndarray of float32 or float64, shape (2,)
        Where the shape is hit; NaN if nothing is hit. With a period it lies on the ray, so it may
        be outside of the first period.
    normal : ndarray of float32 or float64, shape (2,)
        Unit vector that points away from the shape where it is hit; (0, 0) if nothing is hit or
        the ray starts in the shape.
    wall : int
        In a :class:`jostle.World`, what is hit if it is no particle: the id of a wall, or a
        :class:`jostle.Side` of the container, which is negative; then `id` is -1. In the queries of
        :class:`jostle.Walls` it is `id`. Otherwise -1.

    See Also
    --------
    jostle.Quadtree.raycast, jostle.World.raycast : Return it for one ray.
    RayHits : The result for many rays.

    Examples
    --------
    >>> import jostle
    >>> tree = jostle.Quadtree(boxes=[(0, 0, 1, 1)])
    >>> hit = tree.raycast((-2, 0.5), (1, 0))
    >>> hit.id, hit.point, hit.normal
    (0, array([0. , 0.5]), array([-1.,  0.]))
    """

    __slots__ = ("id", "distance", "point", "normal", "wall")

    id: int
    distance: float
    point: NDArray[np.floating[Any]]
    normal: NDArray[np.floating[Any]]
    wall: int


class RayHits(Result):
    """The first shape that each of many rays hits, or all that one ray hits.

    Attributes
    ----------
    ids : ndarray of int64, shape (k,)
        Ids of the shapes; -1 where nothing is hit.
    distances : ndarray of float32 or float64, shape (k,)
        Distances to their surfaces; infinity where nothing is hit.
    points : ndarray of float32 or float64, shape (k, 2)
        Where the shapes are hit; NaN where nothing is hit. With a period they lie on the rays.
    normals : ndarray of float32 or float64, shape (k, 2)
        Unit vectors that point away from the shapes where they are hit; (0, 0) where nothing is
        hit or a ray starts in the shape.
    walls : ndarray of int64, shape (k,)
        In a :class:`jostle.World`, ids of the walls, or sides of the container as of
        :class:`jostle.Side`, that are hit; -1 where none is. In the queries of
        :class:`jostle.Walls` they are `ids`.

    See Also
    --------
    jostle.Quadtree.raycast, jostle.World.raycast : Return it for many rays.
    RayHit : The result for one ray.
    """

    __slots__ = ("ids", "distances", "points", "normals", "walls")

    ids: NDArray[np.int64]
    distances: NDArray[np.floating[Any]]
    points: NDArray[np.floating[Any]]
    normals: NDArray[np.floating[Any]]
    walls: NDArray[np.int64]


class RayHitLists(Result, Lists[RayHits]):
    """All shapes that each of many rays hits.

    It is a sequence: ``lists[r]`` are the `RayHits` of ray r, nearest first.

    Attributes
    ----------
    ids : ndarray of int64, shape (m,)
        Ids of the shapes, one list after the other.
    distances : ndarray of float32 or float64, shape (m,)
        Distances to their surfaces.
    points : ndarray of float32 or float64, shape (m, 2)
        Where the shapes are hit. With a period they lie on the rays.
    normals : ndarray of float32 or float64, shape (m, 2)
        Unit vectors that point away from the shapes; (0, 0) where a ray starts in the shape.
    walls : ndarray of int64, shape (m,)
        As of `RayHits`.
    offsets : ndarray of int64, shape (k + 1,)
        The hits of ray r are those from ``offsets[r]`` to ``offsets[r + 1]``.

    See Also
    --------
    jostle.Quadtree.raycast_all, jostle.Space.raycast_all, jostle.World.raycast_all : Return it
        for many rays.
    """

    __slots__ = ("ids", "distances", "points", "normals", "walls", "offsets")

    ids: NDArray[np.int64]
    distances: NDArray[np.floating[Any]]
    points: NDArray[np.floating[Any]]
    normals: NDArray[np.floating[Any]]
    walls: NDArray[np.int64]
    offsets: NDArray[np.int64]

    def _elements(self, at: slice) -> RayHits:
        """Return the hits in a slice."""
        return RayHits(
            self.ids[at], self.distances[at], self.points[at], self.normals[at], self.walls[at]
        )


class Nodes(Result):
    """The boxes of a quadtree, parents before their children.

    Attributes
    ----------
    boxes : ndarray of float64, shape (k, 4)
        Sides min_x, min_y, max_x, max_y.
    levels : ndarray of int64, shape (k,)
        Subdivisions above each box.
    counts : ndarray of int64, shape (k,)
        Shapes in each box and its descendants.
    is_leaf : ndarray of bool, shape (k,)
        Whether the box did not split.

    See Also
    --------
    jostle.Quadtree.nodes, jostle.World.nodes : Return it.
    """

    __slots__ = ("boxes", "levels", "counts", "is_leaf")

    boxes: NDArray[np.float64]
    levels: NDArray[np.int64]
    counts: NDArray[np.int64]
    is_leaf: NDArray[np.bool_]


class Stats(Result):
    """Size of a quadtree and number of tests of its last query.

    Attributes
    ----------
    nodes : int
        Boxes.
    leaves : int
        Boxes that did not split.
    depth : int
        Subdivisions above the deepest box.
    tests : int
        Shapes or pairs of shapes that were tested.

    See Also
    --------
    jostle.Quadtree.stats : Returns it.
    jostle.World.stats : Returns it, too.
    """

    __slots__ = ("nodes", "leaves", "depth", "tests")

    nodes: int
    leaves: int
    depth: int
    tests: int
