"""The particles that a rank has now, and how many all ranks have."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle

from .. import ids as particle_ids
from ..attributes import Column
from ..interrupts import collective
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

    kinds = Column("Kinds: ndarray of uint8, shape (n,), in the order of `ids`.")

    def rows(self, ids: ArrayLike) -> Any:
        """Return the rows that particles of this rank have in the columns. Not collective.

        Parameters
        ----------
        ids : int or array_like of int, of any shape
            Particles of this rank.

        Returns
        -------
        ndarray of int64 of the same shape, or int
            Their rows, until the next step.

        Raises
        ------
        IdError, TypeError
            As by `jostle.World.rows`, also if a particle is on another rank.

        See Also
        --------
        get : Reads particles of any rank.
        """
        return particle_ids.rows(self._core, ids)

    @collective
    def get(self, ids: ArrayLike) -> jostle.Particle | jostle.Particles:
        """Read all columns of one particle or some, of any rank.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Those that this rank reads; k may be 0.

        Returns
        -------
        Particles or Particle
            As by `jostle.World.get`, for this rank's ids.

        Raises
        ------
        IdError, TypeError
            As by `jostle.World.get`; an id that no particle has is an error on all ranks.
        RankError
            If another rank raises a TypeError.

        See Also
        --------
        set : Changes particles.
        """
        return particle_ids.particles(self._comm, self._core, ids)

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

        A dict. It has `calls` in which all ranks take part, and `messages` and `bytes` with
        particles and hashes. `repeats` is the number of steps that were repeated, `rebalances` how
        often domains were chosen, and `seconds` the time of waiting and communication.
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
