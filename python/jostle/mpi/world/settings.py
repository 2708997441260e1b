"""What holds for all particles, the same on all ranks but the number of threads."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import jostle

from ..attributes import Setting
from ..walls import Walls
from .part import Part


class Settings(Part):
    """A world with settings."""

    __slots__ = ()

    gravity = Setting[NDArray[np.float64]]("Acceleration of gravity: ndarray, shape (2,).")
    drag = Setting[float]("Linear damping per second, see `jostle.World.drag`.")
    container = Setting[jostle.Box | jostle.Circle | None](
        "The region of the particles, see `jostle.World.container`."
    )
    period = Setting[Any]("Width and height of a periodic plane, see `jostle.World.period`.")

    @property
    def walls(self) -> Walls:
        """The walls: a `jostle.mpi.Walls`, which shows and changes those of all ranks."""
        return Walls(self)

    forces = Setting[list[Any]]("The forces, see `jostle.World.forces`.")
    on_touch = Setting[str]("What happens to particles that touch, see `jostle.World.on_touch`.")
    substeps = Setting[int | None](
        "Sub-steps of a step, see `jostle.World.substeps`. The automatic number is that of the "
        "particles of all ranks."
    )
    sleeping = Setting[bool]("Whether islands that rest may fall asleep.")
    track_events = Setting[bool]("Whether `events` are tracked, see `jostle.World.track_events`.")
    method = Setting[str]('How pairs are found: "quadtree" or "brute".')
    leaf_capacity = Setting[int]("Maximum number of particles of a leaf of the tree.")
    max_depth = Setting[int]("Maximum depth of the tree.")

    @property
    def threads(self) -> int | None:
        """Number of threads of this rank; None for all cores. Not collective."""
        threads: int | None = self._core.threads
        return threads

    @threads.setter
    def threads(self, value: int | None) -> None:
        self._core.threads = value
