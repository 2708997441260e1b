"""The frames that a simulation returns: one state each, with its numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle_lab.simulate.settings import TRUTH, VECTOR
from jostle_lab.simulate.settings import Rect as Rect
from jostle_lab.simulate.validation import limited, or_none, real, whole

Point = tuple[float, float]
Container = jostle.Box | jostle.Circle | jostle.Torus | None
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


@dataclass(frozen=True)
class Frame:
    """One state, as copies that cannot be changed: threads share them.

    A particle's *tag* is its number in the order of adding over the whole run. Rows change when
    others are removed; tags do not.
    """

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
        for value in (*vars(self).values(), *(self.tree or ()), *(self.contacts or ())):
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


@dataclass(frozen=True)
class Attractor:
    """An attractor of the user, at a point or a particle: acceleration = strength × distance."""

    strength: float = limited(real(-STRONGEST, STRONGEST))  # 1/s²
    point: Point | None = limited(or_none(VECTOR), None)
    tag: int | None = limited(or_none(whole(0, 2**62)), None)
    passing: bool = limited(TRUTH, False)  # whether it ends when a key is released
