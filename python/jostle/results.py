"""Answers made of several arrays or numbers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Contacts",
    "GaltonBoard",
    "Hits",
    "Neighbors",
    "Nodes",
    "Nozzle",
    "RayHit",
    "RayHits",
    "Stats",
]


class Contacts(NamedTuple):
    """Pairs that overlap, and how.

    Attributes
    ----------
    pairs : ndarray of int64, shape (m, 2)
        Row numbers i < j.
    normals : ndarray of float32 or float64, shape (m, 2)
        Unit vectors from i to j.
    depths : ndarray of float32 or float64, shape (m,)
        How far the two overlap along the normal, in units of length.
    """

    pairs: NDArray[np.int64]
    normals: NDArray[np.floating[Any]]
    depths: NDArray[np.floating[Any]]


class Hits(NamedTuple):
    """Ids for each of many questions, one list behind the other.

    The ids of question q are ``ids[offsets[q]:offsets[q + 1]]``, ascending;
    ``np.diff(offsets)`` counts them, `lists` parts them.

    Attributes
    ----------
    offsets : ndarray of int64, shape (k + 1,)
        Where the ids of each question begin; the last is the number of all.
    ids : ndarray of int64, shape (m,)
        Ids of shapes.
    """

    offsets: NDArray[np.int64]
    ids: NDArray[np.int64]

    def lists(self) -> list[NDArray[np.int64]]:
        """Part the ids by question.

        Returns
        -------
        list of ndarray of int64
            The ids of each question, ascending; views of `ids`.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> tree.query_circle([(0, 0), (3.5, 0), (9, 9)], 1.0).lists()
        [array([0]), array([1, 2]), array([], dtype=int64)]
        """
        return np.split(self.ids, self.offsets[1:-1])


class Neighbors(NamedTuple):
    """The shapes nearest to a point, or to each of many.

    It unpacks as ``distances, ids``, as what `cKDTree.query` of SciPy returns. A `RayHit` has the
    id first.

    Attributes
    ----------
    distances : ndarray of float32 or float64, shape (k,) or (points, k)
        How far it is to each shape, nearest first; 0 inside, infinity where there are
        fewer than k.
    ids : ndarray of int64, shape (k,) or (points, k)
        Ids of the shapes; -1 where there are fewer than k.
    """

    distances: NDArray[np.floating[Any]]
    ids: NDArray[np.int64]


class RayHit(NamedTuple):
    """What a ray hits first.

    It unpacks as ``id, distance``. `Neighbors` have the distances first.

    Attributes
    ----------
    id : int
        Id of the shape; -1 if nothing is hit.
    distance : float
        How far it is to its surface, in units of length; infinity if nothing is hit.
    """

    id: int
    distance: float


class RayHits(NamedTuple):
    """What each of many rays hits first.

    It unpacks as ``ids, distances``. `Neighbors` have the distances first.

    Attributes
    ----------
    ids : ndarray of int64, shape (k,)
        Ids of the shapes; -1 where nothing is hit.
    distances : ndarray of float32 or float64, shape (k,)
        How far it is to their surfaces; infinity where nothing is hit.
    """

    ids: NDArray[np.int64]
    distances: NDArray[np.floating[Any]]


class Nodes(NamedTuple):
    """The boxes of a quadtree, parents before their children.

    Attributes
    ----------
    boxes : ndarray of float64, shape (k, 4)
        min_x, min_y, max_x, max_y.
    depths : ndarray of int64, shape (k,)
        Subdivisions above each box.
    counts : ndarray of int64, shape (k,)
        Shapes in each box and all below it.
    is_leaf : ndarray of bool, shape (k,)
        Whether the box did not split.
    """

    boxes: NDArray[np.float64]
    depths: NDArray[np.int64]
    counts: NDArray[np.int64]
    is_leaf: NDArray[np.bool_]


class Stats(NamedTuple):
    """What a quadtree looks like and how much work its last answer was.

    Attributes
    ----------
    nodes : int
        Boxes.
    leaves : int
        Boxes that did not split.
    depth : int
        Subdivisions above the deepest box.
    tests : int
        Pairs of shapes that were tested.
    """

    nodes: int
    leaves: int
    depth: int
    tests: int


class GaltonBoard(NamedTuple):
    """Where things are on the board of the scene `galton`. y grows downwards.

    Attributes
    ----------
    rows : int
        Rows of pegs. A ball that turns right at k of them ends in bin k, counted from 0 on the
        left; k is binomial: `rows` throws of a fair coin.
    bin_edges : ndarray of float32, shape (rows + 2,)
        Edges of the bins along x, ascending.
    bin_top : float
        Where the bins are open.
    floor : float
        Where they end.
    ball_radius : float
        Radius of the balls.
    """

    rows: int
    bin_edges: NDArray[np.float32]
    bin_top: float
    floor: float
    ball_radius: float


class Nozzle(NamedTuple):
    """Where drops come from in the scene `emitters`.

    Attributes
    ----------
    position : tuple of float
        Their centre as they come out, x and y.
    velocity : tuple of float
        Their velocity, in pixels a second.
    width : float
        They come out anywhere on a line of this length across the velocity.
    spread : float
        Most that is added to it by chance, in any direction, in pixels a second.
    radii : tuple of float
        The smallest radius and the largest.
    density : float
        Mass over the radius squared.
    drops_per_second : float
        How many come out in a second.
    """

    position: tuple[float, float]
    velocity: tuple[float, float]
    width: float
    spread: float
    radii: tuple[float, float]
    density: float
    drops_per_second: float
