"""The interface of simulations of either rules, and the frames that they return."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle.app.simulate.settings import EVERY_CATEGORY, TRUTH, VECTOR, Polyline, Settings
from jostle.app.simulate.settings import Rect as Rect
from jostle.app.simulate.validation import limited, or_none, real, whole

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
    sensors: NDArray[np.int8] | None = None  # (n,): 1 for a sensor, 2 if something touches it
    kinds: NDArray[np.uint8] | None = None  # (n,); None if forces do not depend on kinds
    matrix: NDArray[np.float64] | None = None  # (K, K), of particle life
    # (n,), the collision filter; None under the article's rules
    categories: NDArray[np.uint32] | None = None
    masks: NDArray[np.uint32] | None = None

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


# Columns of particles that `Simulation.add` is given beside their densities.
PLAIN: dict[str, Any] = {
    "movable": True, "sensors": False, "kinds": None, "categories": 1, "masks": EVERY_CATEGORY
}  # fmt: skip
# The shape of one value of each column that `Simulation.change` sets.
WIDTHS: dict[str, tuple[int, ...]] = {
    "positions": (2,), "velocities": (2,), "densities": (), "movable": (), "categories": (),
    "masks": (),
}  # fmt: skip


class Simulation(Protocol):
    """A simulation of a scene. A step lasts `time_step` seconds; y points down.

    It is used by one thread at a time, which `Engine` ensures.
    """

    settings: Settings
    time_step: float
    view: Rect
    adjustable: frozenset[str]  # the fields of `Settings` that `adjust` can change while it runs

    @property
    def attractors(self) -> tuple[Attractor, ...]:
        """The attractors of the user."""

    def __len__(self) -> int: ...

    @property
    def effective_settings(self) -> Settings:
        """The settings, with the values that apply in place of None."""

    def step(self) -> None:
        """Advance by one time step."""

    def frame(self, request: FrameRequest = ...) -> Frame:
        """Return the present state."""

    def adjust(self, name: str, value: object) -> str | None:
        """Change one of `adjustable`; return a message if it is refused."""

    def add(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        densities: ArrayLike = ...,
        **columns: ArrayLike | None,
    ) -> Tags:
        """Add particles, with other columns than those of `PLAIN`; return their tags."""

    def remove(self, tags: ArrayLike) -> None:
        """Remove particles; tags that do not exist are ignored."""

    def change(self, tags: ArrayLike, **columns: ArrayLike | None) -> None:
        """Set columns of particles, which `WIDTHS` names; None leaves one as it is.

        Rows of tags that do not exist are ignored.
        """

    def add_wall(self, line: Polyline) -> None:
        """Add line segments that a user draws."""

    def remove_walls(self, rows: ArrayLike) -> None:
        """Remove line segments by their rows in the frame."""

    def attract(self, attractors: tuple[Attractor, ...]) -> None:
        """Replace the attractors of the user."""

    def drag(self, tag: int, point: Point, velocity: Point) -> None:
        """Accelerate a held particle towards the cursor, before a step.

        A tag that does not exist is ignored.
        """

    def save(self) -> bytes:
        """Return the state; after `load` the simulation continues with the same bits."""

    def load(self, state: bytes) -> None:
        """Restore a state of this simulation."""
