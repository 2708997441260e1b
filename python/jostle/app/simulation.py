"""What the app asks of a simulation, whichever rules it follows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

import jostle

Point = tuple[float, float]
Rect = tuple[float, float, float, float]
Container = jostle.Box | jostle.Circle | jostle.Torus | None

METHODS = ("quadtree", "brute", "article-quadtree", "article-brute")


@dataclass(frozen=True)
class Frame:
    """The arrays that one picture is drawn from: copies, so drawing cannot disturb the world."""

    positions: NDArray[np.float32]  # (n, 2), world units
    velocities: NDArray[np.float32]  # (n, 2), world units a second
    radii: NDArray[np.float32]  # (n,)
    densities: NDArray[np.float32]  # (n,)
    movable: NDArray[np.bool_]  # (n,)


@dataclass(frozen=True)
class TreeBoxes:
    """The boxes of the tree: (k, 4) as min_x, min_y, max_x, max_y; levels; which are leaves."""

    boxes: NDArray[np.float64]
    levels: NDArray[np.intp]
    is_leaf: NDArray[np.bool_]

    @classmethod
    def none(cls) -> TreeBoxes:
        """Return no boxes at all."""
        return cls(np.empty((0, 4)), np.empty(0, np.intp), np.empty(0, np.bool_))


@dataclass(frozen=True)
class Facts:
    """The numbers of the last step that the readout shows."""

    pairs_tested: int
    touching: int
    kinetic_energy: float


class Simulation(Protocol):
    """A scene in motion. A step lasts `time_step` seconds; y grows downwards."""

    scene: str
    time_step: float
    view: Rect

    @property
    def method(self) -> str:
        """One of `METHODS`."""

    @property
    def container(self) -> Container:
        """The walls, drawn as a calm outline."""

    @property
    def stage_times(self) -> dict[str, float]:
        """Milliseconds for each stage of the last step, in the order of the stages."""

    def __len__(self) -> int: ...

    def step(self) -> None:
        """Go on by one time step."""

    def restart(self) -> None:
        """Go back to the first state; the method stays as it is."""

    def switch_method(self) -> str | None:
        """Swap brute force and tree; a sentence says why where that is refused."""

    def frame(self) -> Frame:
        """Return copies of the columns a picture needs."""

    def facts(self) -> Facts:
        """Return the numbers of the last step."""

    def tree_boxes(self) -> TreeBoxes:
        """Return the boxes of the tree over the present positions."""

    def pick(self, point: Point, reach: float) -> int | None:
        """Return the particle under the point, or the nearest one within `reach` of it."""

    def pull(self, particle: int, point: Point) -> None:
        """Before a step: send a held particle towards the hand."""

    def release(self, particle: int, velocity: Point) -> None:
        """Let go of a held particle, with the hand's velocity."""
