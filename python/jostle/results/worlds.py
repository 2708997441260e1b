"""What a world says about its last step, and copies of its particles."""

from __future__ import annotations

from typing import SupportsIndex

import numpy as np
from numpy.typing import NDArray

from jostle.results.base import Result
from jostle.results.categories import Choice


class WorldContacts(Result):
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
    categories : ndarray of uint32, shape (m, 2)
        The present categories of both particles, sets of bits.

    See Also
    --------
    jostle.World.last_step : Has it.
    WallContacts : Contacts with walls.

    Examples
    --------
    >>> world = jostle.World([(0, 0), (3, 0)], 1.0, velocities=[(1, 0), (0, 0)])
    >>> world.step(2.0)  # the left disc stops and the right one takes its velocity
    >>> contacts = world.last_step.contacts
    >>> contacts.pairs, contacts.normal_impulses
    (array([[0, 1]]), array([1.], dtype=float32))
    """

    __slots__ = (
        "pairs",
        "normals",
        "depths",
        "normal_impulses",
        "friction_impulses",
        "categories",
    )

    pairs: NDArray[np.int64]
    normals: NDArray[np.float32]
    depths: NDArray[np.float32]
    normal_impulses: NDArray[np.float32]
    friction_impulses: NDArray[np.float32]
    categories: NDArray[np.uint32]

    def between(self, a: SupportsIndex, b: SupportsIndex) -> WorldContacts:
        """Return the contacts between particles of some categories and particles of others.

        A contact is kept if one particle has a category in `a` and the other one has a category in
        `b`. The particle in the first column of `pairs` then has one in `a`, and that in the second
        has one in `b`; where this turns a pair, it turns the normal, too. The impulses stay as they
        are: both the tangent and the particle on which they act are the other one. A pair that fits
        in both orders is kept once, as it is.

        Parameters
        ----------
        a, b : int
            Categories, sets of 32 bits, which may be the same or have some in common.

        Returns
        -------
        WorldContacts
            The contacts that are kept, in the same order.

        Raises
        ------
        TypeError
            If `a` or `b` is no integer.
        ValueError
            If `a` or `b` has more than 32 bits.

        See Also
        --------
        jostle.Contacts.between : The same for shapes.
        WorldEvents.between : The same for events.

        Examples
        --------
        >>> ROCK, SHOT = 2, 4
        >>> world = jostle.World(
        ...     [(0, 0), (3, 0)], 1.0, velocities=[(0, 0), (-1, 0)], categories=[ROCK, SHOT]
        ... )
        >>> world.step(2.0)
        >>> hits = world.last_step.contacts.between(SHOT, ROCK)
        >>> hits.pairs, hits.normals  # from the shot to the rock
        (array([[1, 0]]), array([[-1.,  0.]], dtype=float32))
        """
        chosen = Choice(self.categories, a, b)
        return WorldContacts(
            chosen.pairs(self.pairs),
            chosen.normals(self.normals),
            chosen.of(self.depths),
            chosen.of(self.normal_impulses),
            chosen.of(self.friction_impulses),
            chosen.pairs(self.categories),
        )


class WallContacts(Result):
    """Particles to which walls gave an impulse during the last step of a `World`.

    The impulses leave out what a `Thermostat` adds, and what `ThermalWalls` add along the wall.

    Attributes
    ----------
    ids : ndarray of int64, shape (m,)
        Ids of the particles, ascending.
    walls : ndarray of int64, shape (m,)
        The id of the wall in `World.walls`, at a shared end the first of those that have it; for
        a side of the container its `Side`, which is negative.
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
    categories : ndarray of uint32, shape (m, 2)
        The present categories of the particle and of the wall, sets of bits. A side of the
        container stops every particle; it has category 1, as for casts.

    See Also
    --------
    jostle.World.last_step : Has it.
    WorldContacts : Contacts of two particles.
    Side : The sides of a container.

    Examples
    --------
    A disc of mass 1 that lies on the floor, y = 0:

    >>> box = jostle.Box(-9, 0, 9, 9)
    >>> world = jostle.World([(0, 1)], 1.0, gravity=(0, -10), restitution=0.5, container=box)
    >>> world.step(0.01)
    >>> float((world.last_step.wall_contacts.normal_impulses / 0.01).round(3)[0])  # the mean force
    10.0
    >>> jostle.Side(world.last_step.wall_contacts.walls[0])
    <Side.MIN_Y: -4>
    """

    __slots__ = (
        "ids",
        "walls",
        "normals",
        "depths",
        "normal_impulses",
        "friction_impulses",
        "categories",
    )

    ids: NDArray[np.int64]
    walls: NDArray[np.int64]
    normals: NDArray[np.float32]
    depths: NDArray[np.float32]
    normal_impulses: NDArray[np.float32]
    friction_impulses: NDArray[np.float32]
    categories: NDArray[np.uint32]

    def between(self, a: SupportsIndex, b: SupportsIndex) -> WallContacts:
        """Return the contacts between particles of some categories and walls of others.

        A contact is kept if the particle has a category in `a` and the wall has one in `b`.

        Parameters
        ----------
        a, b : int
            Categories, sets of 32 bits, which may be the same or have some in common.

        Returns
        -------
        WallContacts
            The contacts that are kept, in the same order.

        Raises
        ------
        TypeError
            If `a` or `b` is no integer.
        ValueError
            If `a` or `b` has more than 32 bits.

        See Also
        --------
        WorldContacts.between : The same for two particles.
        WallEvents.between : The same for events.

        Examples
        --------
        >>> LAVA = 8
        >>> world = jostle.World([(0, 1), (9, 1)], 1.0, velocities=(0, -1))
        >>> ids = world.walls.add([((-3, 0), (3, 0)), ((6, 0), (12, 0))], categories=[1, LAVA])
        >>> world.step(0.1)
        >>> world.last_step.wall_contacts.between(1, LAVA).ids
        array([1])
        """
        chosen = Choice(self.categories, a, b, directed=True)
        return WallContacts(*(chosen.of(getattr(self, name)) for name in self.__slots__))


class WorldEvents(Result):
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
    entered_categories, stayed_categories, exited_categories : ndarray of uint32, shape (m, 2)
        The categories of both when they touched last, sets of bits, for `between`.

    See Also
    --------
    jostle.World.events : Returns it.
    WallEvents : The same of particles and walls.
    jostle.Events : The same for the shapes of a `Space`.
    """

    __slots__ = (
        "entered",
        "stayed",
        "exited",
        "entered_categories",
        "stayed_categories",
        "exited_categories",
    )

    entered: NDArray[np.int64]
    stayed: NDArray[np.int64]
    exited: NDArray[np.int64]
    entered_categories: NDArray[np.uint32]
    stayed_categories: NDArray[np.uint32]
    exited_categories: NDArray[np.uint32]

    def between(self, a: SupportsIndex, b: SupportsIndex) -> WorldEvents:
        """Return the events between particles of some categories and particles of others.

        A pair is kept if one particle has a category in `a` and the other one has a category in
        `b`. The particle in the first column then has one in `a`, and that in the second has one in
        `b`, so the smaller id may be the second. A pair that fits in both orders is kept once, as
        it is.

        Parameters
        ----------
        a, b : int
            Categories, sets of 32 bits, which may be the same or have some in common.

        Returns
        -------
        WorldEvents
            The pairs that are kept, in the same order.

        Raises
        ------
        TypeError
            If `a` or `b` is no integer.
        ValueError
            If `a` or `b` has more than 32 bits.

        See Also
        --------
        jostle.Events.between : The same for a `Space`.
        WorldContacts.between : The same for contacts.

        Examples
        --------
        >>> COIN, PLAYER = 2, 4
        >>> world = jostle.World(
        ...     [(0, 0), (3, 0)], 1.0, velocities=[(0, 0), (-1, 0)], categories=[COIN, PLAYER],
        ...     sensors=[True, False], track_events=True,
        ... )
        >>> world.step(1.5)
        >>> world.remove(0)  # the events stay those of the call
        >>> world.events.between(PLAYER, COIN).entered
        array([[1, 0]])
        """
        categories = (self.entered_categories, self.stayed_categories, self.exited_categories)
        chosen = [Choice(of, a, b) for of in categories]
        return WorldEvents(
            chosen[0].pairs(self.entered),
            chosen[1].pairs(self.stayed),
            chosen[2].pairs(self.exited),
            chosen[0].pairs(self.entered_categories),
            chosen[1].pairs(self.stayed_categories),
            chosen[2].pairs(self.exited_categories),
        )


class WallEvents(Result):
    """Particles and walls that began and ceased to touch in the last call of `World.step`.

    Each array has pairs of the id of a particle and that of a wall, or the `Side` of a container,
    sorted.

    Attributes
    ----------
    entered : ndarray of int64, shape (m, 2)
        Pairs that did not touch at the end of the call before, and touched in this one.
    stayed : ndarray of int64, shape (m, 2)
        Pairs that touched at the ends of both calls.
    exited : ndarray of int64, shape (m, 2)
        Pairs that touched at the end of the call before or in this one, and not at its end.
    entered_categories, stayed_categories, exited_categories : ndarray of uint32, shape (m, 2)
        The categories of both when they touched last, sets of bits, for `between`. A side of the
        container has category 1.

    See Also
    --------
    jostle.World.wall_events : Returns it.
    WorldEvents : The same of two particles.
    """

    __slots__ = (
        "entered",
        "stayed",
        "exited",
        "entered_categories",
        "stayed_categories",
        "exited_categories",
    )

    entered: NDArray[np.int64]
    stayed: NDArray[np.int64]
    exited: NDArray[np.int64]
    entered_categories: NDArray[np.uint32]
    stayed_categories: NDArray[np.uint32]
    exited_categories: NDArray[np.uint32]

    def between(self, a: SupportsIndex, b: SupportsIndex) -> WallEvents:
        """Return the events between particles of some categories and walls of others.

        A pair is kept if the particle has a category in `a` and the wall has one in `b`.

        Parameters
        ----------
        a, b : int
            Categories, sets of 32 bits, which may be the same or have some in common.

        Returns
        -------
        WallEvents
            The pairs that are kept, in the same order.

        Raises
        ------
        TypeError
            If `a` or `b` is no integer.
        ValueError
            If `a` or `b` has more than 32 bits.

        See Also
        --------
        WorldEvents.between : The same for two particles.
        WallContacts.between : The same for contacts.

        Examples
        --------
        >>> BALL, GOAL = 2, 4
        >>> world = jostle.World(
        ...     [(0, 0), (0, 2)], 0.5, velocities=[(9, 0), (0, 0)], categories=[BALL, 1],
        ...     track_events=True,
        ... )
        >>> goal = world.walls.add(((4, -1), (4, 1)), sensors=True, categories=GOAL)
        >>> world.step(1.0)
        >>> world.wall_events.between(BALL, GOAL).entered
        array([[0, 0]])
        """
        categories = (self.entered_categories, self.stayed_categories, self.exited_categories)
        chosen = [Choice(of, a, b, directed=True) for of in categories]
        return WallEvents(
            chosen[0].pairs(self.entered),
            chosen[1].pairs(self.stayed),
            chosen[2].pairs(self.exited),
            chosen[0].pairs(self.entered_categories),
            chosen[1].pairs(self.stayed_categories),
            chosen[2].pairs(self.exited_categories),
        )


class LastStep(Result):
    """What the last step of a `World` found.

    Attributes
    ----------
    contacts : WorldContacts
        The pairs of particles that touched.
    wall_contacts : WallContacts
        The particles to which walls or the container gave an impulse.
    substeps : int
        Sub-steps of the step; 0 before the first step and where all particles sleep.
    unresolved : int
        Particles with so many collisions in a part of the step that their contacts were solved
        together, without restitution, until its end.
    collapsed : int
        Times that the collisions of a particle became elastic for the rest of a part of the step,
        because it had 64 collisions in it (inelastic collapse).

    See Also
    --------
    jostle.World.last_step : Returns it.
    LastCall : Sums over many steps.
    """

    __slots__ = ("contacts", "wall_contacts", "substeps", "unresolved", "collapsed")

    contacts: WorldContacts
    wall_contacts: WallContacts
    substeps: int
    unresolved: int
    collapsed: int


class LastCall(Result):
    """Sums over all steps of the last call of `World.step`.

    Impulses are those on particles. Particles that sleep add nothing.

    Attributes
    ----------
    duration : float
        Simulated time of the call, in seconds.
    steps : int
        Number of steps.
    collisions : int
        Impacts of two particles. Several impacts of one pair count each; resting contacts do not.
    wall_collisions : int
        Impacts of a particle and a wall or the container.
    collision_virial : ndarray of float64, shape (2, 2)
        Sum of the outer products r J over the contacts of two particles, in units of mass times
        length squared per second: r leads from one centre to the other at the impact, and J is the
        impulse on the other, friction and resting contacts included. Half its trace, divided by
        area and duration, is the part of the pressure that collisions cause. In a container the
        area is that of the centres, which stay a radius away from each side.
    wall_impulses : ndarray of float64, shape (m, 2)
        Sum of the impulses of each wall on particles, in the rows of `World.walls`;
        ``world.walls.rows(ids)`` are those of ids. Walls that were removed since have none.
    side_impulses : ndarray of float64, shape (5, 2)
        Of the sides of the container in the order of `Side`, min_x, max_x, min_y, max_y and rim:
        the sum of the impulses along the normal into the container, at least 0, and that of
        friction along the tangent (-normal_y, normal_x). Sides that it does not have are 0. The row
        of a side is ``-2 - side``: a `Side` is negative, so as an index it counts from the end.

    See Also
    --------
    jostle.World.last_call : Returns it.
    LastStep : The contacts of the last step.

    References
    ----------
    J. J. Erpenbeck, W. W. Wood, *Molecular dynamics techniques for hard-core systems*, in: Modern
    Theoretical Chemistry 6 (1977), for the virial of collisions.

    Examples
    --------
    The force on the floor of a box, and on its left side:

    >>> box = jostle.Box(0, 0, 9, 9)
    >>> world = jostle.World([(4, 1)], 1.0, gravity=(0, -10), restitution=0.0, container=box)
    >>> world.step(1 / 60, steps=30)
    >>> normal = world.last_call.side_impulses[:, 0] / world.last_call.duration
    >>> Side = jostle.Side
    >>> normal[-2 - Side.MIN_Y].round(2).item(), normal[-2 - Side.MIN_X].item()
    (10.0, 0.0)
    """

    __slots__ = (
        "duration",
        "steps",
        "collisions",
        "wall_collisions",
        "collision_virial",
        "wall_impulses",
        "side_impulses",
    )

    duration: float
    steps: int
    collisions: int
    wall_collisions: int
    collision_virial: NDArray[np.float64]
    wall_impulses: NDArray[np.float64]
    side_impulses: NDArray[np.float64]


class Particles(Result):
    """Some particles of a `World`, by the names of the arguments of `World.add` and `World.set`.

    Attributes
    ----------
    positions, velocities : ndarray of float32, shape (k, 2)
        Centres in units of length, and velocities in units of length per second.
    radii, masses, restitution : ndarray of float32, shape (k,)
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
    jostle.World.get : Returns it.
    Particle : The same of one particle.
    """

    __slots__ = (
        "positions",
        "velocities",
        "radii",
        "masses",
        "restitution",
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
    restitution: NDArray[np.float32]
    movable: NDArray[np.bool_]
    friction: NDArray[np.float32]
    angles: NDArray[np.float32]
    angular_velocities: NDArray[np.float32]
    categories: NDArray[np.uint32]
    masks: NDArray[np.uint32]
    sensors: NDArray[np.bool_]
    kinds: NDArray[np.uint8]


class Particle(Result):
    """One particle of a `World`, by the names of the arguments of `World.add` and `World.set`.

    Attributes
    ----------
    positions, velocities : ndarray of float32, shape (2,)
        Centres in units of length, and velocities in units of length per second.
    radii, masses, restitution : float
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
    jostle.World.get : Returns it.
    Particles : The same of many particles.
    """

    __slots__ = Particles.__slots__

    positions: NDArray[np.float32]
    velocities: NDArray[np.float32]
    radii: float
    masses: float
    restitution: float
    movable: bool
    friction: float
    angles: float
    angular_velocities: float
    categories: int
    masks: int
    sensors: bool
    kinds: int


class WallColumns(Result):
    """Some walls of a `World`, by the names of the arguments of `World.walls.add` and `set`.

    Attributes
    ----------
    segments : ndarray of float32, shape (k, 2, 2)
        Their ends, in units of length.
    velocities : ndarray of float32, shape (k, 2)
        In units of length per second.
    friction, restitution : ndarray of float32, shape (k,)
        Coefficients; NaN stands for that of the particle.
    sensors : ndarray of bool, shape (k,)
        Whether the wall is a sensor.
    one_way : ndarray of bool, shape (k,)
        Whether the wall stops only what comes from its left.
    categories, masks : ndarray of uint32, shape (k,)
        Bit sets of 32 bits.

    See Also
    --------
    jostle.Walls.get : Returns it.
    Wall : The same of one wall.
    """

    __slots__ = (
        "segments",
        "velocities",
        "friction",
        "restitution",
        "sensors",
        "one_way",
        "categories",
        "masks",
    )

    segments: NDArray[np.float32]
    velocities: NDArray[np.float32]
    friction: NDArray[np.float32]
    restitution: NDArray[np.float32]
    sensors: NDArray[np.bool_]
    one_way: NDArray[np.bool_]
    categories: NDArray[np.uint32]
    masks: NDArray[np.uint32]


class Wall(Result):
    """One wall of a `World`, by the names of the arguments of `World.walls.add` and `set`.

    Attributes
    ----------
    segments : ndarray of float32, shape (2, 2)
        Its ends, in units of length.
    velocities : ndarray of float32, shape (2,)
        In units of length per second.
    friction, restitution : float
        Coefficients; NaN stands for that of the particle.
    sensors : bool
        Whether the wall is a sensor.
    one_way : bool
        Whether the wall stops only what comes from its left.
    categories, masks : int
        Bit sets of 32 bits.

    See Also
    --------
    jostle.Walls.get : Returns it.
    WallColumns : The same of many walls.
    """

    __slots__ = WallColumns.__slots__

    segments: NDArray[np.float32]
    velocities: NDArray[np.float32]
    friction: float
    restitution: float
    sensors: bool
    one_way: bool
    categories: int
    masks: int
