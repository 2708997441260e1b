"""Results that consist of several arrays or numbers."""

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
    "RayHitLists",
    "RayHits",
    "Separated",
    "Slide",
    "Slides",
    "Stats",
    "WallContacts",
    "WorldCollisions",
    "WorldContacts",
    "WorldEvents",
    "WorldParticle",
    "WorldParticles",
]


class Contacts(NamedTuple):
    """Pairs that overlap, with normals and depths.

    Attributes
    ----------
    pairs : ndarray of int64, shape (m, 2)
        Row numbers i < j of a tree, or ids of a space; between two trees a row of each.
    normals : ndarray of float32 or float64, shape (m, 2)
        Unit vectors from i to j.
    depths : ndarray of float32 or float64, shape (m,)
        Penetration along the normal, in units of length.

    See Also
    --------
    jostle.Quadtree.contacts : Returns it.
    WorldContacts : The contacts of particles, with impulses.
    """

    pairs: NDArray[np.int64]
    normals: NDArray[np.floating[Any]]
    depths: NDArray[np.floating[Any]]


class Hits(NamedTuple):
    """Ids for each of many queries, concatenated.

    The ids of query q are ``ids[offsets[q]:offsets[q + 1]]``, ascending;
    ``np.diff(offsets)`` counts them, `lists` splits them.

    Attributes
    ----------
    offsets : ndarray of int64, shape (k + 1,)
        Index of the first id of each query; the last is the total number of ids.
    ids : ndarray of int64, shape (m,)
        Ids of shapes.

    See Also
    --------
    jostle.Quadtree.query_rect : Returns it for many rectangles.
    """

    offsets: NDArray[np.int64]
    ids: NDArray[np.int64]

    def lists(self) -> list[NDArray[np.int64]]:
        """Split the ids by query.

        Returns
        -------
        list of ndarray of int64
            The ids of each query, ascending; views of `ids`.

        Examples
        --------
        >>> import jostle
        >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
        >>> tree.query_circle([(0, 0), (3.5, 0), (9, 9)], 1.0).lists()
        [array([0]), array([1, 2]), array([], dtype=int64)]
        """
        return np.split(self.ids, self.offsets[1:])[:-1]


class Neighbors(NamedTuple):
    """The shapes nearest to a point, or to each of many.

    It unpacks as ``distances, ids``, like the result of SciPy's `cKDTree.query`. A `RayHit` has
    the id first.

    Attributes
    ----------
    distances : ndarray of float32 or float64, shape (k,) or (points, k)
        Distance to each shape, nearest first; 0 inside, infinity if fewer than k are
        found.
    ids : ndarray of int64, shape (k,) or (points, k)
        Ids of the shapes; -1 if fewer than k are found.

    See Also
    --------
    jostle.Quadtree.nearest : Returns it.
    """

    distances: NDArray[np.floating[Any]]
    ids: NDArray[np.int64]


class _RayHit(NamedTuple):
    id: int
    distance: float


class RayHit(_RayHit):
    """The first shape that a ray hits.

    It unpacks as ``id, distance``. `Neighbors` have the distances first.

    Attributes
    ----------
    id : int
        Id of the shape; -1 if nothing is hit.
    distance : float
        Distance to its surface, in units of length; infinity if nothing is hit.
    normal : tuple of float
        Unit vector that points away from the shape where it is hit, not part of the tuple;
        (0, 0) if nothing is hit or the ray starts in the shape.

    See Also
    --------
    jostle.Quadtree.raycast : Returns it for one ray.
    RayHits : The result for many rays.

    Examples
    --------
    >>> import jostle
    >>> tree = jostle.Quadtree(boxes=[(0, 0, 1, 1)])
    >>> hit = tree.raycast((-2, 0.5), (1, 0))
    >>> hit, hit.normal
    (RayHit(id=0, distance=2.0), (-1.0, 0.0))
    """

    normal: tuple[float, float] = (0.0, 0.0)

    def __new__(cls, id: int, distance: float, normal: tuple[float, float] = (0.0, 0.0)) -> RayHit:
        """Make a hit with its normal."""
        hit = super().__new__(cls, id, distance)
        hit.normal = normal
        return hit


class _RayHits(NamedTuple):
    ids: NDArray[np.int64]
    distances: NDArray[np.floating[Any]]


class RayHits(_RayHits):
    """The first shape that each of many rays hits, or all that one ray hits.

    It unpacks as ``ids, distances``. `Neighbors` have the distances first.

    Attributes
    ----------
    ids : ndarray of int64, shape (k,)
        Ids of the shapes; -1 where nothing is hit.
    distances : ndarray of float32 or float64, shape (k,)
        Distances to their surfaces; infinity where nothing is hit.
    normals : ndarray of float32 or float64, shape (k, 2)
        Unit vectors that point away from the shapes where they are hit, not part of the tuple;
        (0, 0) where nothing is hit or a ray starts in the shape.

    See Also
    --------
    jostle.Quadtree.raycast : Returns it for many rays.
    RayHit : The result for one ray.
    """

    normals: NDArray[np.floating[Any]]

    def __new__(
        cls,
        ids: NDArray[np.int64],
        distances: NDArray[np.floating[Any]],
        normals: NDArray[np.floating[Any]] | None = None,
    ) -> RayHits:
        """Make hits with their normals."""
        hits = super().__new__(cls, ids, distances)
        hits.normals = np.zeros((len(ids), 2)) if normals is None else normals
        return hits


class RayHitLists(NamedTuple):
    """All shapes that each of many rays hits, concatenated.

    The hits of ray r are ``ids[offsets[r]:offsets[r + 1]]``, nearest first, and so are their
    distances and normals.

    Attributes
    ----------
    offsets : ndarray of int64, shape (k + 1,)
        Index of the first hit of each ray; the last is the total number of hits.
    ids : ndarray of int64, shape (m,)
        Ids of the shapes.
    distances : ndarray of float32 or float64, shape (m,)
        Distances to their surfaces.
    normals : ndarray of float32 or float64, shape (m, 2)
        Unit vectors that point away from the shapes; (0, 0) where a ray starts in the shape.

    See Also
    --------
    jostle.Quadtree.raycast_all, jostle.Space.raycast_all : Return it for many rays.
    """

    offsets: NDArray[np.int64]
    ids: NDArray[np.int64]
    distances: NDArray[np.floating[Any]]
    normals: NDArray[np.floating[Any]]


class Separated(NamedTuple):
    """Centres of shapes that have been moved apart.

    Attributes
    ----------
    centers : ndarray of float32 or float64, shape (n, 2)
        The new centres.
    rounds : int
        Number of rounds; placing along an axis counts as one.
    overlaps : int
        Number of pairs that still overlap; 0 if the shapes are separated.

    See Also
    --------
    jostle.separate : Returns it.
    """

    centers: NDArray[np.floating[Any]]
    rounds: int
    overlaps: int


class Slide(NamedTuple):
    """How one shape moved and slid along others.

    Attributes
    ----------
    displacement : ndarray of float32 or float64, shape (2,)
        How far it has moved, in units of length.
    remaining : ndarray of float32 or float64, shape (2,)
        The displacement that was given, without its components into the obstacles; divided by
        the duration of the step it is the velocity for the next step.
    normals : ndarray of float32 or float64, shape (m, 2)
        Unit normal of each obstacle, towards the shape.
    on_floor, on_wall, on_ceiling : bool
        Whether it met a surface that faces up, sideways or down.
    hits : ndarray of int64, shape (m,)
        Ids of the obstacles, in the order in which it met them; -2 - k is the wall with the
        index k.
    floor : int
        Id of the last floor that it met; -1 if there is none, a wall as in `hits`.

    See Also
    --------
    jostle.Space.move_and_slide : Returns it for one shape.
    Slides : The result for many shapes.
    """

    displacement: NDArray[np.floating[Any]]
    remaining: NDArray[np.floating[Any]]
    normals: NDArray[np.floating[Any]]
    on_floor: bool
    on_wall: bool
    on_ceiling: bool
    hits: NDArray[np.int64]
    floor: int


class Slides(NamedTuple):
    """How many shapes moved and slid along others.

    Attributes
    ----------
    displacements : ndarray of float32 or float64, shape (k, 2)
        How far each has moved, in units of length.
    remaining : ndarray of float32 or float64, shape (k, 2)
        The displacements that were given, without their components into the obstacles; divided
        by the duration of the step they are the velocities for the next step.
    normals : ndarray of float32 or float64, shape (m, 2)
        Unit normal of each obstacle, towards the shape that met it; in the order of ``hits.ids``.
    on_floor, on_wall, on_ceiling : ndarray of bool, shape (k,)
        Whether each met a surface that faces up, sideways or down.
    hits : Hits
        Ids of the obstacles of each, in the order in which it met them; -2 - k is the wall with
        the index k.
    floors : ndarray of int64, shape (k,)
        Id of the last floor that each met; -1 if there is none, a wall as in `hits`.

    See Also
    --------
    jostle.Space.move_and_slide : Returns it for many shapes.
    Slide : The result for one shape.
    """

    displacements: NDArray[np.floating[Any]]
    remaining: NDArray[np.floating[Any]]
    normals: NDArray[np.floating[Any]]
    on_floor: NDArray[np.bool_]
    on_wall: NDArray[np.bool_]
    on_ceiling: NDArray[np.bool_]
    hits: Hits
    floors: NDArray[np.int64]


class Nodes(NamedTuple):
    """The boxes of a quadtree, parents before their children.

    Attributes
    ----------
    boxes : ndarray of float64, shape (k, 4)
        Sides min_x, min_y, max_x, max_y.
    depths : ndarray of int64, shape (k,)
        Subdivisions above each box.
    counts : ndarray of int64, shape (k,)
        Shapes in each box and its descendants.
    is_leaf : ndarray of bool, shape (k,)
        Whether the box did not split.

    See Also
    --------
    jostle.Quadtree.nodes : Returns it.
    """

    boxes: NDArray[np.float64]
    depths: NDArray[np.int64]
    counts: NDArray[np.int64]
    is_leaf: NDArray[np.bool_]


class Stats(NamedTuple):
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
    WorldStats : The same for a step of a `World`.
    """

    nodes: int
    leaves: int
    depth: int
    tests: int


class WorldContacts(NamedTuple):
    """Pairs of particles that touched during the last step of a `World`.

    Attributes
    ----------
    pairs : ndarray of int64, shape (m, 2)
        Ids i < j.
    normals : ndarray of float32, shape (m, 2)
        Unit vectors from i to j, at the end of the step.
    depths : ndarray of float32, shape (m,)
        Penetration along the normal at the end of the step, in units of length; negative for
        pairs that had separated.
    normal_impulses : ndarray of float32, shape (m,)
        Sum of the impulses of the step on j along the normal, at least 0; on i they have the
        opposite sign.
    friction_impulses : ndarray of float32, shape (m,)
        Sum of the impulses of friction on j along the tangent (-normal_y, normal_x).

    See Also
    --------
    jostle.World.contacts : Returns it.
    WallContacts : Contacts with walls.

    Examples
    --------
    >>> world = jostle.World([(0, 0), (3, 0)], [(1, 0), (0, 0)], radii=1.0)
    >>> world.step(2.0)  # the left disc stops and the right one takes its velocity
    >>> world.contacts.pairs, world.contacts.normal_impulses
    (array([[0, 1]]), array([1.], dtype=float32))
    """

    pairs: NDArray[np.int64]
    normals: NDArray[np.float32]
    depths: NDArray[np.float32]
    normal_impulses: NDArray[np.float32]
    friction_impulses: NDArray[np.float32]


class WorldParticles(NamedTuple):
    """Some particles of a `World`, by the names of the arguments of `World.add` and `World.set`.

    Attributes
    ----------
    positions, velocities : ndarray of float32, shape (k, 2)
        Centres in units of length, and velocities in units of length per second.
    radii, masses, restitutions : ndarray of float32, shape (k,)
        Radii in units of length, masses, and coefficients of restitution.
    movable : ndarray of bool, shape (k,)
        Whether contacts and forces can change the velocity.
    friction, angles, angular_velocities : ndarray of float32, shape (k,)
        Coefficients of friction; radians, -π to π without π, and radians per second.
    categories, masks : ndarray of uint32, shape (k,)
        Bit sets of 32 bits.
    sensors : ndarray of bool, shape (k,)
        Whether the particle is a sensor.
    kinds : ndarray of uint8, shape (k,)
        Kinds in each `PairForce` of the world.

    See Also
    --------
    jostle.World.read : Returns it.
    WorldParticle : The same of one particle.
    """

    positions: NDArray[np.float32]
    velocities: NDArray[np.float32]
    radii: NDArray[np.float32]
    masses: NDArray[np.float32]
    restitutions: NDArray[np.float32]
    movable: NDArray[np.bool_]
    friction: NDArray[np.float32]
    angles: NDArray[np.float32]
    angular_velocities: NDArray[np.float32]
    categories: NDArray[np.uint32]
    masks: NDArray[np.uint32]
    sensors: NDArray[np.bool_]
    kinds: NDArray[np.uint8]


class WorldParticle(NamedTuple):
    """One particle of a `World`, by the names of the arguments of `World.add` and `World.set`.

    Attributes
    ----------
    positions, velocities : ndarray of float32, shape (2,)
        Centres in units of length, and velocities in units of length per second.
    radii, masses, restitutions : float
        Radii in units of length, masses, and coefficients of restitution.
    movable : bool
        Whether contacts and forces can change the velocity.
    friction, angles, angular_velocities : float
        Coefficients of friction; radians, -π to π without π, and radians per second.
    categories, masks : int
        Bit sets of 32 bits.
    sensors : bool
        Whether the particle is a sensor.
    kinds : int
        Kind in each `PairForce` of the world.

    See Also
    --------
    jostle.World.read : Returns it.
    WorldParticles : The same of many particles.
    """

    positions: NDArray[np.float32]
    velocities: NDArray[np.float32]
    radii: float
    masses: float
    restitutions: float
    movable: bool
    friction: float
    angles: float
    angular_velocities: float
    categories: int
    masks: int
    sensors: bool
    kinds: int


class WallContacts(NamedTuple):
    """Particles to which walls gave an impulse during the last step of a `World`.

    The impulses leave out what a `Thermostat` adds, and what `ThermalWalls` add along the wall.

    Attributes
    ----------
    ids : ndarray of int64, shape (m,)
        Ids of the particles, ascending.
    walls : ndarray of int64, shape (m,)
        0 to 3: the walls of a `Box` at min_x, max_x, min_y and max_y; 0 for a `Circle`;
        4 + k: wall k of `World.walls`, at a shared end the first of those that have it.
    normals : ndarray of float32, shape (m, 2)
        Unit vectors from the wall to the particle, at the end of the step.
    depths : ndarray of float32, shape (m,)
        Penetration at the end of the step, in units of length; negative for particles that
        have left the wall.
    normal_impulses : ndarray of float32, shape (m,)
        Sum of the impulses of the step on the particle along the normal, above 0.
    friction_impulses : ndarray of float32, shape (m,)
        Sum of the impulses of friction on the particle along the tangent
        (-normal_y, normal_x).

    See Also
    --------
    jostle.World.wall_contacts : Returns it.
    WorldContacts : Contacts of two particles.

    Examples
    --------
    A disc of mass 1 that lies on the floor, y = 0:

    >>> box = jostle.Box(-9, 0, 9, 9)
    >>> world = jostle.World(
    ...     [(0, 1)], [(0, 0)], radii=1.0, gravity=(0, -10), restitution=0.5, container=box
    ... )
    >>> world.step(0.01)
    >>> float((world.wall_contacts.normal_impulses / 0.01).round(3)[0])  # the mean force
    10.0
    """

    ids: NDArray[np.int64]
    walls: NDArray[np.int64]
    normals: NDArray[np.float32]
    depths: NDArray[np.float32]
    normal_impulses: NDArray[np.float32]
    friction_impulses: NDArray[np.float32]


class WorldEvents(NamedTuple):
    """Pairs that began and ceased to touch in the last call of `World.step`.

    It unpacks as ``entered, stayed, left``. Each array has pairs of ids i < j, sorted.

    Attributes
    ----------
    entered : ndarray of int64, shape (m, 2)
        Pairs that did not touch at the end of the call before, and touched in this one.
    stayed : ndarray of int64, shape (m, 2)
        Pairs that touched at the ends of both calls.
    left : ndarray of int64, shape (m, 2)
        Pairs that touched at the end of the call before or in this one, and not at its end.

    See Also
    --------
    jostle.World.events : Returns it.
    jostle.Events : The same for the shapes of a `Space`.
    """

    entered: NDArray[np.int64]
    stayed: NDArray[np.int64]
    left: NDArray[np.int64]


class WorldCollisions(NamedTuple):
    """Numbers of collisions in the last call of `World.step`.

    Attributes
    ----------
    pairs : int
        Collisions of two particles.
    walls : int
        Collisions of a particle with a wall or the container.

    See Also
    --------
    jostle.World.collisions : Returns it.
    """

    pairs: int
    walls: int


class WorldStats(NamedTuple):
    """Size of the quadtree of the last step of a `World`, and what the step did.

    Attributes
    ----------
    nodes : int
        Boxes.
    leaves : int
        Boxes that did not split.
    depth : int
        Subdivisions above the deepest box.
    tests : int
        Pairs of particles that were tested.
    unresolved : int
        Particles that had so many collisions in a part of the step that they stayed with what
        pressed them until its end.
    substeps : int
        Sub-steps of the step; 0 before the first step and where all particles sleep.
    collapsed : int
        Times that the collisions of a particle became elastic for the rest of a part of the step,
        because it had 64 collisions in it (inelastic collapse).

    See Also
    --------
    jostle.World.stats : Returns it.
    """

    nodes: int
    leaves: int
    depth: int
    tests: int
    unresolved: int
    substeps: int
    collapsed: int


class GaltonBoard(NamedTuple):
    """Geometry of the board in the scene `galton`; y grows downwards.

    Attributes
    ----------
    rows : int
        Rows of pegs. A ball that turns right at k of them ends in bin k, counted from 0 on the
        left; k has a binomial distribution of `rows` trials with probability 1/2.
    bin_edges : ndarray of float32, shape (rows + 2,)
        Edges of the bins along x, ascending.
    bin_top : float
        The y of the open top of the bins.
    floor : float
        The y of the bottom of the bins.
    ball_radius : float
        Radius of the balls.

    See Also
    --------
    jostle.scenes.galton_board : Returns it.
    """

    rows: int
    bin_edges: NDArray[np.float32]
    bin_top: float
    floor: float
    ball_radius: float


class Nozzle(NamedTuple):
    """A source of drops in the scene `emitters`.

    Attributes
    ----------
    position : tuple of float
        Centre of the source, x and y.
    velocity : tuple of float
        Velocity of the drops, in pixels per second.
    width : float
        Drops start at random on a line of this length, perpendicular to the velocity.
    spread : float
        Maximum random addition to the velocity, in any direction, in pixels per second.
    radii : tuple of float
        The smallest and the largest radius.
    density : float
        Mass divided by the squared radius.
    drops_per_second : float
        Number of drops per second.

    See Also
    --------
    jostle.scenes.fountains : Returns a list of them.
    """

    position: tuple[float, float]
    velocity: tuple[float, float]
    width: float
    spread: float
    radii: tuple[float, float]
    density: float
    drops_per_second: float
