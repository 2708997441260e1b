"""The frames that a simulation returns: one state of a world each, with its numbers.

A particle's tag is its id in the world. Rows change when particles are removed or merge; tags do
not.
"""

from dataclasses import dataclass, field
from typing import Annotated, Any, NamedTuple

import numpy as np
import pydantic.dataclasses
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, Strict

import jostle
from jostle import life
from jostle_lab.schema import FORBID, Id, Truth, Vector
from jostle_lab.schema import Rect as Rect
from jostle_lab.simulate.region import Container, container_of

Point = tuple[float, float]
Tags = NDArray[np.int64]

STRONGEST = 1e6  # 1/s², of an attractor; the user interface allows at most 40


def find(tags: Tags, wanted: ArrayLike) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Return the rows of those wanted that are among ascending tags, and which they are."""
    wanted = np.atleast_1d(np.asarray(wanted, np.int64))
    at = np.searchsorted(tags, wanted)
    there = at < len(tags)
    there[there] = tags[at[there]] == wanted[there]
    return at[there], there


@dataclass(frozen=True)
class FrameRequest:
    """The optional parts of a frame, each of which takes time."""

    tree: bool = False
    contacts: bool = False
    energies: bool = False


class FrameContacts(NamedTuple):
    """The contacts after a step: (m, 2) rows of the frame, unit normals, depths, impulses.

    Those with walls have a row of the frame, a unit normal towards the particle and an impulse.
    """

    pairs: NDArray[np.int64]
    normals: NDArray[np.float32]
    depths: NDArray[np.float32]
    impulses: NDArray[np.float32]
    at_walls: NDArray[np.int64]
    wall_normals: NDArray[np.float32]
    wall_impulses: NDArray[np.float32]


@dataclass(frozen=True)
class Energies:
    """Sums over all particles."""

    kinetic: float
    potential: float
    momentum: Point

    @property
    def total(self) -> float:
        return self.kinetic + self.potential


@dataclass(frozen=True)
class StepStats:
    """The numbers of the last step."""

    time: float = 0.0  # seconds since the scene began
    pairs_tested: int = 0
    touching: int = 0
    asleep: int = 0
    substeps: int = 1  # more than the setting, if contacts needed them
    nodes: int = 0
    depth: int = 0
    kinetic_energy: float = 0.0
    stage_times: dict[str, float] = field(default_factory=dict)  # milliseconds, in order


@pydantic.dataclasses.dataclass(frozen=True, config=FORBID)
class Attractor:
    """An attractor of the user, at a point or a particle: acceleration = strength × distance."""

    strength: Annotated[float, Strict(), Field(ge=-STRONGEST, le=STRONGEST)]  # 1/s²
    point: Vector | None = None
    tag: Id | None = None
    passing: Truth = False  # whether it ends when a key is released


@dataclass(frozen=True)
class Frame:
    """One state, as copies that cannot be changed: threads share them."""

    positions: NDArray[np.float32]  # (n, 2), world units
    velocities: NDArray[np.float32]  # (n, 2), world units per second
    radii: NDArray[np.float32]  # (n,)
    densities: NDArray[np.float32]  # (n,), mass over radius squared
    movable: NDArray[np.bool_]  # (n,)
    tags: Tags  # (n,), ascending
    born: NDArray[np.float64]  # (n,), the time each was added
    container: Container = None
    stats: StepStats = field(default_factory=StepStats)
    energies: Energies | None = None
    tree: jostle.Nodes | None = None
    contacts: FrameContacts | None = None
    springs: NDArray[np.int64] | None = None  # (s, 2) rows
    attractors: tuple[Attractor, ...] = ()
    angles: NDArray[np.float32] | None = None  # (n,), radians; None if no particle rotates
    scene: str = ""
    begun_with: int | None = None  # initial number of particles
    # (m, 2, 2), line segments: first those of the scene, then those of the user
    walls: NDArray[np.float32] = field(default_factory=lambda: np.empty((0, 2, 2), np.float32))
    own_walls: int = 0  # the number of those of the scene
    # (n,), the collision filter
    categories: NDArray[np.uint32] = field(default_factory=lambda: np.empty(0, np.uint32))
    masks: NDArray[np.uint32] = field(default_factory=lambda: np.empty(0, np.uint32))
    sensors: NDArray[np.int8] | None = None  # (n,): 1 for a sensor, 2 if something touches it
    kinds: NDArray[np.uint8] | None = None  # (n,); None if forces do not depend on kinds
    matrix: NDArray[np.float64] | None = None  # (K, K), of particle life

    def __post_init__(self) -> None:
        nodes = self.tree
        parts = (nodes.boxes, nodes.levels, nodes.counts, nodes.is_leaf) if nodes else ()
        for value in (*vars(self).values(), *parts, *(self.contacts or ())):
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def __len__(self) -> int:
        return len(self.radii)

    @property
    def masses(self) -> NDArray[np.float32]:
        return self.densities * self.radii**2

    def rows(self, tags: ArrayLike) -> NDArray[np.intp]:
        """Return the rows of the tags that exist."""
        return find(self.tags, tags)[0]


Forces = tuple[Any, ...]


class ParticleTable:
    """The times of birth, and copies of columns that only edits change, so that frames share them.

    All particles were born at time 0, unless `born` has other times.
    """

    def __init__(self, world: jostle.World, born: NDArray[np.float64] | None = None) -> None:
        self.tags: Tags = world.ids  # ascending
        self.born = np.zeros(len(world)) if born is None else born
        self.update(world)

    def update(self, world: jostle.World) -> None:
        """Read all columns; particles that were added since are born now."""
        before, born = self.tags, self.born
        self.tags = world.ids
        rows, known = find(before, self.tags)
        self.born = np.full(len(self.tags), world.time)
        self.born[known] = born[rows]
        self.radii: NDArray[np.float32] = world.radii
        self.movable: NDArray[np.bool_] = world.movable
        self.sensors: NDArray[np.bool_] = world.sensors
        self.categories: NDArray[np.uint32] = world.categories
        self.masks: NDArray[np.uint32] = world.masks
        self.friction = float(world.friction.max(initial=0.0))  # the largest coefficient
        # That of the first movable particle, or else of the first: new ones have it, too.
        bounces = world.restitution
        self.restitution = float(bounces[self.movable.argmax()]) if len(bounces) else 1.0
        self.turns = self.friction > 0 or bool(world.angular_velocities.any())
        self._usual_mass: float | None = None
        masses, areas = world.masses, self.radii**2
        self.densities: NDArray[np.float32] = np.divide(
            masses, areas, out=np.zeros_like(masses), where=areas > 0
        )

    def rows(self, tags: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the rows of existing tags."""
        if not len(self.tags) or self.tags[-1] == len(self.tags) - 1:
            return tags  # each is its row
        return np.searchsorted(self.tags, tags).astype(np.int64)

    def find(self, tags: ArrayLike) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        return find(self.tags, tags)

    def usual_mass(self, world: jostle.World) -> float:
        """Return the median mass of the movable particles, computed on demand."""
        if self._usual_mass is None:
            self._usual_mass = float(np.median(world.masses[self.movable]))
        return self._usual_mass


def frame_of(
    world: jostle.World, columns: ParticleTable, request: FrameRequest, **more: Any
) -> Frame:
    """Return the present state of a world; `more` are fields that the world does not have."""
    forces = world.forces
    pair = pair_force(forces)
    return Frame(
        positions=world.positions,
        velocities=world.velocities,
        radii=columns.radii,
        densities=columns.densities,
        movable=columns.movable,
        tags=columns.tags,
        born=columns.born,
        container=container_of(world),
        stats=_stats(world),
        energies=_energies(world) if request.energies else None,
        tree=world.nodes() if request.tree else None,
        contacts=_contacts(world, columns) if request.contacts else None,
        springs=_springs(forces, columns),
        angles=world.angles if columns.turns else None,
        walls=world.walls.segments,
        sensors=_sensors(world, columns) if columns.sensors.any() else None,
        kinds=None if pair is None else world.kinds,
        matrix=None if pair is None else life.matrix_of(pair),
        categories=columns.categories,
        masks=columns.masks,
        **more,
    )


def _energies(world: jostle.World) -> Energies:
    x, y = world.momentum().tolist()
    return Energies(world.kinetic_energy(), world.potential_energy(), (x, y))


def _sensors(world: jostle.World, columns: ParticleTable) -> NDArray[np.int8]:
    touched = np.zeros(len(columns.tags), np.bool_)
    touched[columns.rows(world.last_step.contacts.pairs)] = True
    return columns.sensors.astype(np.int8) * (1 + touched)


def _stats(world: jostle.World) -> StepStats:
    stats, step = world.stats, world.last_step
    return StepStats(
        time=world.time,
        pairs_tested=stats.tests,
        touching=len(step.contacts.pairs),
        asleep=int(np.count_nonzero(world.asleep)),
        substeps=step.substeps,
        nodes=stats.nodes,
        depth=stats.depth,
        kinetic_energy=world.kinetic_energy(),
        stage_times=dict(world.profile),
    )


def _contacts(world: jostle.World, columns: ParticleTable) -> FrameContacts:
    step = world.last_step
    contacts, walls = step.contacts, step.wall_contacts
    return FrameContacts(
        pairs=columns.rows(contacts.pairs),
        normals=contacts.normals,
        depths=contacts.depths,
        impulses=contacts.normal_impulses,
        at_walls=columns.rows(walls.ids),
        wall_normals=walls.normals,
        wall_impulses=walls.normal_impulses,
    )


def pair_force(forces: Forces) -> jostle.PairForce | None:
    """Return the first force between kinds that has several of them."""
    for force in forces:
        if isinstance(force, jostle.PairForce) and force.table.shape[0] > 1:
            return force
    return None


def _springs(forces: Forces, columns: ParticleTable) -> NDArray[np.int64] | None:
    pairs = [force.pairs for force in forces if isinstance(force, jostle.Springs)]
    return columns.rows(np.concatenate(pairs)) if pairs else None
