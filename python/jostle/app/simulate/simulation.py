"""The interface of simulations of either rules, and the frames that they return."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle.app.simulate.settings import Polyline, Settings

Point = tuple[float, float]
Rect = tuple[float, float, float, float]
Container = jostle.Box | jostle.Circle | jostle.Torus | None
Tags = NDArray[np.int64]


@dataclass(frozen=True)
class Wants:
    """What a frame shall hold beside the columns; each costs time, so it is asked for."""

    tree: bool = False
    contacts: bool = False
    energies: bool = False


@dataclass(frozen=True)
class TreeBoxes:
    """The boxes of the tree: (k, 4) as min_x, min_y, max_x, max_y; levels, counts, leaves."""

    boxes: NDArray[np.float64]
    levels: NDArray[np.intp]
    counts: NDArray[np.intp]
    is_leaf: NDArray[np.bool_]

    @classmethod
    def none(cls) -> TreeBoxes:
        """Return no boxes at all."""
        return cls(np.empty((0, 4)), np.empty(0, np.intp), np.empty(0, np.intp), np.empty(0, bool))


@dataclass(frozen=True)
class Touching:
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

    @classmethod
    def of_pairs(cls, contacts: jostle.Contacts) -> Touching:
        """Return contacts without impulses and without walls."""
        nothing = np.empty(0, np.float32)
        return cls(
            contacts.pairs, contacts.normals, contacts.depths, np.zeros_like(contacts.depths),
            np.empty(0, np.int64), nothing.reshape(0, 2), nothing,
        )  # fmt: skip


@dataclass(frozen=True)
class Energies:
    """Sums over all particles."""

    kinetic: float
    potential: float
    momentum: Point


@dataclass(frozen=True)
class Facts:
    """The numbers of the last step."""

    time: float = 0.0  # seconds since the scene began
    pairs_tested: int = 0
    touching: int = 0
    asleep: int = 0
    nodes: int = 0
    depth: int = 0
    kinetic_energy: float = 0.0
    stage_times: dict[str, float] = field(default_factory=dict)  # milliseconds, in order


@dataclass(frozen=True)
class Frame:
    """One state, for the picture and for the panels: copies, so looking cannot disturb it.

    A particle's *tag* is its number in the order of adding over the whole run. Rows move up when
    others are removed, tags stay: whoever remembers a particle remembers its tag.
    """

    positions: NDArray[np.float32]  # (n, 2), world units
    velocities: NDArray[np.float32]  # (n, 2), world units a second
    radii: NDArray[np.float32]  # (n,)
    densities: NDArray[np.float32]  # (n,), mass over radius squared
    movable: NDArray[np.bool_]  # (n,)
    tags: Tags  # (n,), ascending
    born: NDArray[np.float64]  # (n,), the time each was added
    container: Container = None
    facts: Facts = field(default_factory=Facts)
    energies: Energies | None = None
    tree: TreeBoxes | None = None
    touching: Touching | None = None
    springs: NDArray[np.int64] | None = None  # (s, 2) rows
    attractors: tuple[Pull, ...] = ()
    angles: NDArray[np.float32] | None = None  # (n,), radians; None if nothing turns
    scene: str = ""  # whose extras are shown
    begun_with: int | None = None  # the number of particles that the scene was made for
    # (m, 2, 2), line segments: first those of the scene, then those that were drawn
    walls: NDArray[np.float32] = field(default_factory=lambda: np.empty((0, 2, 2), np.float32))
    own_walls: int = 0  # the number of those of the scene
    sensors: NDArray[np.int8] | None = None  # (n,): 1 for a sensor, 2 if something touches it

    def __len__(self) -> int:
        return len(self.radii)

    @property
    def masses(self) -> NDArray[np.float32]:
        """Return the mass of each particle."""
        return self.densities * self.radii**2

    def rows(self, tags: ArrayLike) -> NDArray[np.intp]:
        """Return where the tags are now; those that are gone are left out."""
        wanted = np.atleast_1d(np.asarray(tags, np.int64))
        at = np.searchsorted(self.tags, wanted)
        there = at < len(self.tags)
        there[there] = self.tags[at[there]] == wanted[there]
        found: NDArray[np.intp] = at[there]
        return found


@dataclass(frozen=True)
class Pull:
    """An attraction that a person has placed: by distance × strength, to a point or a particle."""

    strength: float  # 1/s²
    point: Point | None = None
    tag: int | None = None
    passing: bool = False  # it lasts as long as a key is down

    @classmethod
    def of(cls, facts: Mapping[str, Any]) -> Pull:
        """Return a pull from its fields, as JSON gives them back."""
        x_y = facts["point"]
        point = None if x_y is None else (float(x_y[0]), float(x_y[1]))
        return cls(facts["strength"], point, facts["tag"], facts["passing"])


class Simulation(Protocol):
    """A scene in motion. A step lasts `time_step` seconds; y grows downwards.

    One thread at a time uses it. `Engine` sees to that, so only what the engine calls may act.
    """

    settings: Settings
    scene: str
    time_step: float
    view: Rect

    def __len__(self) -> int: ...

    @property
    def method(self) -> str:
        """One of `settings.METHODS`."""

    @property
    def adjustable(self) -> frozenset[str]:
        """The fields of `Settings` that `adjust` can change while it runs."""

    @property
    def rules(self) -> Settings:
        """The settings with the rules that hold where they leave a choice open."""

    def step(self) -> None:
        """Go on by one time step."""

    def frame(self, wants: Wants = ...) -> Frame:
        """Return the present state."""

    def adjust(self, name: str, value: object) -> str | None:
        """Change one of `adjustable`; a sentence says why where that is refused."""

    def add(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        densities: ArrayLike = ...,
        movable: ArrayLike = ...,
        sensors: ArrayLike = ...,
    ) -> Tags:
        """Add particles; return their tags."""

    def remove(self, tags: ArrayLike) -> None:
        """Remove particles; tags that are gone are no mistake."""

    def change(
        self,
        tags: ArrayLike,
        *,
        positions: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
        densities: ArrayLike | None = None,
        movable: ArrayLike | None = None,
    ) -> None:
        """Set columns of particles; tags that are gone are no mistake, their rows are left out."""

    def add_wall(self, line: Polyline) -> None:
        """Add line segments that a user draws."""

    def remove_walls(self, rows: ArrayLike) -> None:
        """Remove line segments by their rows in the frame."""

    def attract(self, pulls: tuple[Pull, ...]) -> None:
        """Replace the attractions that a person has placed."""

    def drag(self, tag: int, point: Point, velocity: Point) -> None:
        """Before a step: draw a held particle to the hand, which is at a point and moves.

        A particle that is gone is no mistake.
        """

    def save(self) -> bytes:
        """Return the state, so that `load` goes on from it bit for bit."""

    def load(self, state: bytes) -> None:
        """Go back to a state of this simulation."""
