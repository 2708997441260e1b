"""The forces and walls of a world.

Forces act between kinds of particles, on walls, and towards attractors of the user. Walls are line
segments inside the container, which a scene, a file or a user adds.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle import life
from jostle_lab.schema import Polyline
from jostle_lab.simulate.frame import Attractor, Forces, ParticleTable, Point, pair_force

Attractors = tuple[Attractor, ...]

# The arguments of a motor, and of a pump.
MOTOR = ("ids", "walls", "pivot", "angular_velocity", "velocity", "cycle")
PUMP = ("drain", "position", "velocity", "rate", "width", "spread", "seed")


def kind_count(world: jostle.World) -> int | None:
    """Return the number of kinds; None if the world has no force between kinds."""
    counts = [f.table.shape[0] for f in world.forces if isinstance(f, jostle.PairForce)]
    return min(counts, default=None)


def set_matrix(world: jostle.World, matrix: str | Sequence[Sequence[float]]) -> None:
    """Set the matrix of particle life, by name or as numbers.

    If the number of kinds changes, the particles get all kinds in turn.
    """
    old = pair_force(world.forces)
    if old is None or life.matrix_of(old) is None:
        raise ValueError("Only particle life has a matrix: choose the scene life.")
    values = np.asarray(life.MATRICES[matrix] if isinstance(matrix, str) else matrix)
    core, strength = life.core_of(old), float(old.table[0, 0, 0])
    new = jostle.PairForce.particle_life(values, old.cutoff, core, strength=strength)
    forces = tuple(new if force == old else force for force in world.forces)
    if len(values) != len(old.table):
        world.forces = ()  # so that no table refuses a kind
        world.kinds = np.arange(len(world)) % len(values)
    world.forces = forces


def shifted(forces: Forces, by: NDArray[np.floating]) -> Forces:
    """Return forces whose motors have shifted pivots, and whose pumps have shifted."""
    return tuple(_shifted(force, by) for force in forces)


def _shifted(force: Any, by: NDArray[np.floating]) -> Any:
    if isinstance(force, jostle.Motor):
        return _with(force, MOTOR, pivot=np.array(force.pivot) + by)
    if isinstance(force, jostle.Pump):
        drain = np.array(force.drain) + np.tile(by, 2)
        return _with(force, PUMP, drain=drain, position=np.array(force.position) + by)
    return force


def _with(force: Any, arguments: tuple[str, ...], **changes: Any) -> Any:
    """Return a force with some other arguments."""
    return type(force)(**{name: getattr(force, name) for name in arguments} | changes)


class AttractorForces:
    """The attractors of the user in one world, and the grab: forces after those of the world."""

    def __init__(
        self, world: jostle.World, columns: ParticleTable, own: int, attractors: Attractors = ()
    ) -> None:
        self._world, self._columns = world, columns
        self.own = own  # the number of forces of the world itself
        self.grab: jostle.Grab | None = None
        self.attractors = self._living(attractors)
        self.renew()  # a saved world may have a grab, which nobody holds any more

    def hold(self, grab: jostle.Grab | None) -> None:
        """Replace the grab; that of a particle that does not exist is left out."""
        if grab is not None and not len(self._columns.find(grab.id)[0]):
            grab = None
        if grab != self.grab:
            self.grab = grab
            self._bind(self.attractors)

    def place(self, attractors: Attractors) -> None:
        """Replace them; those of particles that do not exist are left out."""
        attractors = self._living(attractors)
        if attractors != self.attractors:
            self._bind(attractors)

    def renew(self) -> None:
        """Remove those of particles that no longer exist."""
        if self.grab is not None and not len(self._columns.find(self.grab.id)[0]):
            self.grab = None
        self._bind(self._living(self.attractors))

    def merge(self, renumbered: NDArray[np.int64]) -> None:
        """Give them the new tags of their particles after a merge."""
        self.attractors = tuple(
            one if one.tag is None else replace(one, tag=int(renumbered[one.tag]))
            for one in self.attractors
        )
        self.grab = None  # its id may have changed; the user grabs again before the next step
        self.renew()

    @contextmanager
    def detached(self) -> Iterator[None]:
        """Remove their forces meanwhile; forces of the world may end with particles or walls."""
        self._world.forces = self._world.forces[: self.own]
        yield
        self.own = len(self._world.forces)
        self._columns.update(self._world)
        self.renew()

    def _living(self, attractors: Attractors) -> Attractors:
        tags = [one.tag for one in attractors if one.tag is not None]
        living = {None, *self._columns.tags[self._columns.find(tags)[0]].tolist()}
        return tuple(one for one in attractors if one.tag in living)

    def _bind(self, attractors: Attractors) -> None:
        forces = [
            jostle.Attractor(strength=attractor.strength, particle=attractor.tag)
            if attractor.point is None
            else jostle.Attractor(attractor.point, attractor.strength)
            for attractor in attractors
            if attractor.point is not None or attractor.tag is not None
        ]
        grab = () if self.grab is None else (self.grab,)
        self._world.forces = (*self._world.forces[: self.own], *forces, *grab)
        self.attractors = attractors


Floats = NDArray[np.floating]
Ends = NDArray[np.float32]  # (m, 2, 2)


class WallSegments:
    """The walls of a world: first its `own`, of the scene and its file, then drawn ones."""

    def __init__(self, world: jostle.World, own: int) -> None:
        self._world, self.own = world, own

    def add(self, line: Polyline, *, own: bool) -> None:
        """Add the sides of a polyline; own walls must be added before drawn ones."""
        world = self._world
        new = jostle.polyline(np.asarray(line.points, np.float32), closed=line.closed)
        ids = world.walls.add(
            new, restitution=line.restitution, friction=line.friction,
            one_way=line.one_way, categories=line.categories, masks=line.masks,
        )  # fmt: skip
        if any(line.velocity) and len(new):
            motor = jostle.Motor(walls=ids, velocity=line.velocity, cycle=line.cycle)
            world.forces = (*world.forces, motor)
        if line.temperature is not None and len(new):
            world.forces = (*world.forces, jostle.ThermalWalls(line.temperature, walls=ids))
        self.own += len(new) if own else 0

    def remove(self, rows: ArrayLike) -> None:
        """Remove walls; rows that do not exist are ignored."""
        walls = self._world.walls
        wanted = np.unique(np.asarray(rows, np.int64))
        gone = wanted[(wanted >= 0) & (wanted < len(walls))]
        walls.remove(walls.ids[gone])
        self.own -= int(np.count_nonzero(gone < self.own))

    def set_friction(self, friction: float | None) -> None:
        """Set the friction of the drawn walls; that of the particles, if None."""
        walls = self._world.walls
        walls.set(walls.ids[self.own :], friction=friction)

    def shift(self, by: Floats) -> None:
        if by.any():
            self._world.forces = shifted(self._world.forces, by)
            self._world.walls.segments = self._world.walls.segments + by


def nearest(ends: Floats, point: Point) -> tuple[int, float]:
    """Return the row of the nearest wall and its distance; -1 and inf if there is none."""
    if len(ends) == 0:
        return -1, np.inf
    near = jostle.Quadtree(segments=ends.astype(np.float64)).nearest(point)
    return int(near.ids[0]), float(near.distances[0])


def clear_of(positions: Floats, radii: Floats, ends: Floats) -> NDArray[np.bool_]:
    """Return which discs overlap no wall."""
    clear = np.ones(len(positions), np.bool_)
    if len(ends) and len(positions):
        discs = jostle.Quadtree(positions.astype(np.float64), radii.astype(np.float64))
        walls = jostle.Quadtree(segments=ends.astype(np.float64))
        clear[discs.pairs(walls)[:, 0]] = False
    return clear
