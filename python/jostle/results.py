"""Results that consist of several arrays or numbers."""

from __future__ import annotations

import operator
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NoReturn, SupportsIndex

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from typing_extensions import Self, dataclass_transform
else:

    def dataclass_transform(**_):
        """Return a decorator that does nothing: only type checkers read it."""
        return lambda kind: kind


__all__ = [
    "Contacts",
    "GaltonBoard",
    "IdLists",
    "Neighbors",
    "Nodes",
    "Nozzle",
    "Particle",
    "Particles",
    "RayHit",
    "RayHitLists",
    "RayHits",
    "Separated",
    "Shape",
    "Shapes",
    "Slide",
    "Slides",
    "Stats",
    "WallContacts",
    "WorldCollisions",
    "WorldContacts",
    "WorldEvents",
]


_set = object.__setattr__


@dataclass_transform(frozen_default=True)
class _Result:
    """Base of the results: the fields of `__slots__`, in this order, which cannot be changed."""

    # `dataclasses` would do the same, but it takes a third of the time of `import jostle`.
    __slots__: tuple[str, ...] = ()

    if not TYPE_CHECKING:  # a type checker derives the arguments from the fields

        def __init__(self, *args, **kwargs):
            names = self.__slots__
            if kwargs:
                args += tuple(kwargs.pop(name) for name in names[len(args) :] if name in kwargs)
            if kwargs or len(args) != len(names):
                raise TypeError(f"{type(self).__name__} has the fields {', '.join(names)}")
            for name, value in zip(names, args, strict=True):
                _set(self, name, value)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        """Refuse to change a field."""
        raise AttributeError(f"a field of {type(self).__name__} cannot be changed: {name}")

    def __delattr__(self, name: str) -> NoReturn:
        """Refuse to delete a field."""
        raise AttributeError(f"a field of {type(self).__name__} cannot be deleted: {name}")

    def __eq__(self, other: object) -> bool:
        """Whether the other is of the same class and has equal fields."""
        if type(other) is not type(self):
            return NotImplemented
        return all(_same(getattr(self, name), getattr(other, name)) for name in self.__slots__)

    __hash__ = None  # type: ignore[assignment]

    def to_dict(self) -> dict[str, Any]:
        """Return the fields by their names, for instance as arguments of `add` or `set`.

        Returns
        -------
        dict
            A new one, with the values that the fields have.
        """
        return {name: getattr(self, name) for name in self.__slots__}

    def __reduce__(self) -> tuple[type[Self], tuple[Any, ...]]:
        """Return the class and the values of the fields, for pickle and copy."""
        return type(self), tuple(getattr(self, name) for name in self.__slots__)

    def __repr__(self) -> str:
        """Return the class with its fields."""
        fields = ", ".join(f"{name}={getattr(self, name)!r}" for name in self.__slots__)
        return f"{type(self).__name__}({fields})"


def _same(one: Any, other: Any) -> bool:
    """Whether two fields are equal; NaN, which stands for no value, equals itself."""
    return np.array_equal(one, other, equal_nan=np.asarray(one).dtype.kind == "f")


def _span(offsets: NDArray[np.int64], index: SupportsIndex) -> slice:
    """Return where the list with an index begins and ends."""
    nth, count = operator.index(index), len(offsets) - 1
    if not -count <= nth < count:
        raise IndexError(f"list {nth} of {count} lists")
    return slice(int(offsets[nth % count]), int(offsets[nth % count + 1]))


class Contacts(_Result):
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

    __slots__ = ("pairs", "normals", "depths")

    pairs: NDArray[np.int64]
    normals: NDArray[np.floating[Any]]
    depths: NDArray[np.floating[Any]]


class IdLists(_Result):
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

    def __len__(self) -> int:
        """Return the number of queries."""
        return len(self.offsets) - 1

    def __getitem__(self, query: SupportsIndex) -> NDArray[np.int64]:
        """Return the ids of a query; a negative index counts from the end."""
        return self.ids[_span(self.offsets, query)]

    def __iter__(self) -> Iterator[NDArray[np.int64]]:
        """Yield the ids of each query."""
        return map(self.__getitem__, range(len(self)))

    @property
    def counts(self) -> NDArray[np.int64]:
        """The number of ids of each query, an array of int64 of shape (k,)."""
        return np.diff(self.offsets)

    @property
    def queries(self) -> NDArray[np.int64]:
        """The query of each id, an array of int64 of shape (m,)."""
        return np.repeat(np.arange(len(self)), self.counts)


class Neighbors(_Result):
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


class RayHit(_Result):
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

    See Also
    --------
    jostle.Quadtree.raycast : Returns it for one ray.
    RayHits : The result for many rays.

    Examples
    --------
    >>> import jostle
    >>> tree = jostle.Quadtree(boxes=[(0, 0, 1, 1)])
    >>> hit = tree.raycast((-2, 0.5), (1, 0))
    >>> hit.id, hit.point, hit.normal
    (0, array([0. , 0.5]), array([-1.,  0.]))
    """

    __slots__ = ("id", "distance", "point", "normal")

    id: int
    distance: float
    point: NDArray[np.floating[Any]]
    normal: NDArray[np.floating[Any]]


class RayHits(_Result):
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

    See Also
    --------
    jostle.Quadtree.raycast : Returns it for many rays.
    RayHit : The result for one ray.
    """

    __slots__ = ("ids", "distances", "points", "normals")

    ids: NDArray[np.int64]
    distances: NDArray[np.floating[Any]]
    points: NDArray[np.floating[Any]]
    normals: NDArray[np.floating[Any]]


class RayHitLists(_Result):
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
    offsets : ndarray of int64, shape (k + 1,)
        The hits of ray r are those from ``offsets[r]`` to ``offsets[r + 1]``.

    See Also
    --------
    jostle.Quadtree.raycast_all, jostle.Space.raycast_all : Return it for many rays.
    """

    __slots__ = ("ids", "distances", "points", "normals", "offsets")

    ids: NDArray[np.int64]
    distances: NDArray[np.floating[Any]]
    points: NDArray[np.floating[Any]]
    normals: NDArray[np.floating[Any]]
    offsets: NDArray[np.int64]

    def __len__(self) -> int:
        """Return the number of rays."""
        return len(self.offsets) - 1

    def __getitem__(self, ray: SupportsIndex) -> RayHits:
        """Return the hits of a ray; a negative index counts from the end."""
        at = _span(self.offsets, ray)
        return RayHits(self.ids[at], self.distances[at], self.points[at], self.normals[at])

    def __iter__(self) -> Iterator[RayHits]:
        """Yield the hits of each ray."""
        return map(self.__getitem__, range(len(self)))

    @property
    def counts(self) -> NDArray[np.int64]:
        """The number of hits of each ray, an array of int64 of shape (k,)."""
        return np.diff(self.offsets)

    @property
    def queries(self) -> NDArray[np.int64]:
        """The ray of each hit, an array of int64 of shape (m,)."""
        return np.repeat(np.arange(len(self)), self.counts)


class Shapes(_Result):
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
    categories, masks : ndarray of uint32, shape (k,)
        Bit sets of 32 bits.

    See Also
    --------
    jostle.Space.get : Returns it.
    Shape : The same of one shape.
    """

    __slots__ = ("positions", "radii", "half_sizes", "boxes", "categories", "masks")

    positions: NDArray[np.floating[Any]]
    radii: NDArray[np.floating[Any]]
    half_sizes: NDArray[np.floating[Any]]
    boxes: NDArray[np.floating[Any]]
    categories: NDArray[np.uint32]
    masks: NDArray[np.uint32]


class Shape(_Result):
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
    categories, masks : int
        Bit sets of 32 bits.

    See Also
    --------
    jostle.Space.get : Returns it.
    Shapes : The same of many shapes.
    """

    __slots__ = ("positions", "radii", "half_sizes", "boxes", "categories", "masks")

    positions: NDArray[np.floating[Any]]
    radii: float
    half_sizes: NDArray[np.floating[Any]]
    boxes: NDArray[np.floating[Any]]
    categories: int
    masks: int


class Separated(_Result):
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


class Slide(_Result):
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

    __slots__ = (
        "displacement",
        "remaining",
        "normals",
        "on_floor",
        "on_wall",
        "on_ceiling",
        "hits",
        "floor",
    )

    displacement: NDArray[np.floating[Any]]
    remaining: NDArray[np.floating[Any]]
    normals: NDArray[np.floating[Any]]
    on_floor: bool
    on_wall: bool
    on_ceiling: bool
    hits: NDArray[np.int64]
    floor: int


class Slides(_Result):
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
    hits : IdLists
        Ids of the obstacles of each, in the order in which it met them; -2 - k is the wall with
        the index k.
    floors : ndarray of int64, shape (k,)
        Id of the last floor that each met; -1 if there is none, a wall as in `hits`.

    See Also
    --------
    jostle.Space.move_and_slide : Returns it for many shapes.
    Slide : The result for one shape.
    """

    __slots__ = (
        "displacements",
        "remaining",
        "normals",
        "on_floor",
        "on_wall",
        "on_ceiling",
        "hits",
        "floors",
    )

    displacements: NDArray[np.floating[Any]]
    remaining: NDArray[np.floating[Any]]
    normals: NDArray[np.floating[Any]]
    on_floor: NDArray[np.bool_]
    on_wall: NDArray[np.bool_]
    on_ceiling: NDArray[np.bool_]
    hits: IdLists
    floors: NDArray[np.int64]


class Nodes(_Result):
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
    jostle.Quadtree.nodes : Returns it.
    """

    __slots__ = ("boxes", "levels", "counts", "is_leaf")

    boxes: NDArray[np.float64]
    levels: NDArray[np.int64]
    counts: NDArray[np.int64]
    is_leaf: NDArray[np.bool_]


class Stats(_Result):
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

    __slots__ = ("nodes", "leaves", "depth", "tests")

    nodes: int
    leaves: int
    depth: int
    tests: int


class WorldContacts(_Result):
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

    __slots__ = ("pairs", "normals", "depths", "normal_impulses", "friction_impulses")

    pairs: NDArray[np.int64]
    normals: NDArray[np.float32]
    depths: NDArray[np.float32]
    normal_impulses: NDArray[np.float32]
    friction_impulses: NDArray[np.float32]


class Particles(_Result):
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
    Particle : The same of one particle.
    """

    __slots__ = (
        "positions",
        "velocities",
        "radii",
        "masses",
        "restitutions",
        "movable",
        "friction",
        "angles",
        "angular_velocities",
        "categories",
        "masks",
        "sensors",
        "kinds",
    )

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


class Particle(_Result):
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
    Particles : The same of many particles.
    """

    __slots__ = (
        "positions",
        "velocities",
        "radii",
        "masses",
        "restitutions",
        "movable",
        "friction",
        "angles",
        "angular_velocities",
        "categories",
        "masks",
        "sensors",
        "kinds",
    )

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


class WallContacts(_Result):
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

    __slots__ = ("ids", "walls", "normals", "depths", "normal_impulses", "friction_impulses")

    ids: NDArray[np.int64]
    walls: NDArray[np.int64]
    normals: NDArray[np.float32]
    depths: NDArray[np.float32]
    normal_impulses: NDArray[np.float32]
    friction_impulses: NDArray[np.float32]


class WorldEvents(_Result):
    """Pairs that began and ceased to touch in the last call of `World.step`.

    Each array has pairs of ids i < j, sorted.

    Attributes
    ----------
    entered : ndarray of int64, shape (m, 2)
        Pairs that did not touch at the end of the call before, and touched in this one.
    stayed : ndarray of int64, shape (m, 2)
        Pairs that touched at the ends of both calls.
    exited : ndarray of int64, shape (m, 2)
        Pairs that touched at the end of the call before or in this one, and not at its end.

    See Also
    --------
    jostle.World.events : Returns it.
    jostle.Events : The same for the shapes of a `Space`.
    """

    __slots__ = ("entered", "stayed", "exited")

    entered: NDArray[np.int64]
    stayed: NDArray[np.int64]
    exited: NDArray[np.int64]


class WorldCollisions(_Result):
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

    __slots__ = ("pairs", "walls")

    pairs: int
    walls: int


class WorldStats(_Result):
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

    __slots__ = ("nodes", "leaves", "depth", "tests", "unresolved", "substeps", "collapsed")

    nodes: int
    leaves: int
    depth: int
    tests: int
    unresolved: int
    substeps: int
    collapsed: int


class GaltonBoard(_Result):
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

    __slots__ = ("rows", "bin_edges", "bin_top", "floor", "ball_radius")

    rows: int
    bin_edges: NDArray[np.float32]
    bin_top: float
    floor: float
    ball_radius: float


class Nozzle(_Result):
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

    __slots__ = ("position", "velocity", "width", "spread", "radii", "density", "drops_per_second")

    position: tuple[float, float]
    velocity: tuple[float, float]
    width: float
    spread: float
    radii: tuple[float, float]
    density: float
    drops_per_second: float
