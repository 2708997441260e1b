"""The particles that a rank has now, and how many all ranks have."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import jostle

from ..attributes import Column
from .part import Part


class Columns(Part):
    """A world with columns of this rank's particles."""

    __slots__ = ()

    def __len__(self) -> int:
        """Number of particles of this rank."""
        return int(self._core._counts()[0])

    positions = Column("Centres: ndarray of float32, shape (n, 2), in the order of `ids`.")
    velocities = Column("Velocities: ndarray of float32, shape (n, 2), in the order of `ids`.")
    radii = Column("Radii: ndarray of float32, shape (n,), in the order of `ids`.")
    masses = Column("Masses: ndarray of float32, shape (n,), in the order of `ids`.")
    restitution = Column(
        "Coefficients of restitution: ndarray of float32, shape (n,), in the order of `ids`."
    )
    movable = Column(
        "Which particles are movable: ndarray of bool, shape (n,), in the order of `ids`."
    )
    friction = Column(
        "Coefficients of friction: ndarray of float32, shape (n,), in the order of `ids`."
    )
    angles = Column("Angles in radians: ndarray of float32, shape (n,), in the order of `ids`.")
    angular_velocities = Column(
        "Angular velocities: ndarray of float32, shape (n,), in the order of `ids`."
    )
    categories = Column("Categories: ndarray of uint32, shape (n,), in the order of `ids`.")
    unwrapped_positions = Column(
        "Positions with the periods that were travelled: ndarray of float64, shape (n, 2), in the "
        "order of `ids`."
    )
    masks = Column("Masks: ndarray of uint32, shape (n,), in the order of `ids`.")
    sensors = Column(
        "Which particles are sensors: ndarray of bool, shape (n,), in the order of `ids`."
    )
    asleep = Column(
        "Which particles are asleep: ndarray of bool, shape (n,), in the order of `ids`."
    )

    @property
    def total(self) -> int:
        """Number of particles of all ranks."""
        return int(self._core._counts()[1])

    @property
    def ghosts(self) -> int:
        """Number of copies of particles of other ranks in the last step."""
        count, ids, *_ = self._own()
        return len(ids) - count

    @property
    def time(self) -> float:
        """Simulated time in seconds."""
        return float(self._core.time)

    @property
    def ids(self) -> NDArray[np.int64]:
        """Ids of this rank's particles: ndarray of int64, shape (n,), in the order of columns."""
        return self._own()[1][: len(self)]

    @property
    def traffic(self) -> dict[str, float]:
        """What this rank has sent so far.

        A dict of `calls` in which all ranks take part, `messages` and `bytes` with particles and
        hashes, `repeats`, the number of steps that were repeated, `rebalances`, how often domains
        were chosen, and `seconds` of waiting and communication.
        """
        names = ("calls", "messages", "bytes", "repeats", "rebalances")
        counts = dict(zip(names, self._own()[2], strict=True))
        return {**counts, "seconds": self._messages.seconds}

    @property
    def stats(self) -> jostle.Stats:
        """Size of the tree of this rank's particles and ghosts, and tests in the last step."""
        stats: jostle.Stats = self._core.stats
        return stats

    @property
    def profile(self) -> dict[str, float]:
        """Milliseconds of each stage of the last step on this rank, see `jostle.World.profile`."""
        return dict(self._core.profile)
