"""What all ranks compute from the particles of all."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import state
from ..exchange import together
from ..interrupts import collective
from .part import Part


class Totals(Part):
    """A world with sums over the particles of all ranks."""

    __slots__ = ()

    @collective
    def kinetic_energy(self) -> float:
        """Sum of ½ m v² + ½ I ω² of the movable particles of all ranks, with I = m r²/2.

        The exact sum, rounded once, so it is the same for every number of ranks. That of
        `jostle.World` is rounded after each addition and may differ in the last digits.

        Returns
        -------
        float
            In units of mass times length squared per second squared.

        See Also
        --------
        potential_energy : Of gravity and forces.
        """
        return state.kinetic_energy(self._comm, self._core)

    @collective
    def potential_energy(self) -> float:
        """Energy of the movable particles of all ranks in gravity and forces between kinds.

        It counts each `PairForce` that has a potential, and may differ from
        `jostle.World.potential_energy` in the last digits.

        Returns
        -------
        float
            In units of mass times length squared per second squared.

        See Also
        --------
        kinetic_energy : Of motion.
        """
        return state.potential_energy(self._comm, self._core, self._messages)

    @collective
    def momentum(self) -> NDArray[np.float64]:
        """Sum of mass times velocity of all movable particles, rounded once.

        Returns
        -------
        ndarray of float64, shape (2,)
            In units of mass times length per second.

        See Also
        --------
        kinetic_energy : The energy of this motion, among others.
        """
        return state.momentum(self._comm, self._core)

    @collective
    def total_energy(self) -> float:
        """Kinetic and potential energy of the movable particles of all ranks.

        Returns
        -------
        float
            In units of mass times length squared per second squared.

        See Also
        --------
        kinetic_energy, potential_energy : The terms.
        """
        kinetic = state.kinetic_energy(self._comm, self._core)
        return kinetic + state.potential_energy(self._comm, self._core, self._messages)

    @collective
    def angular_momentum(self, about: ArrayLike = (0.0, 0.0)) -> float:
        """Sum of m (r − about) × v + I ω of the movable particles of all ranks, rounded once.

        Parameters
        ----------
        about : array_like, shape (2,), default (0.0, 0.0)
            The point, the same on all ranks.

        Returns
        -------
        float
            In units of mass times length squared per second, see `jostle.World.angular_momentum`.

        Raises
        ------
        TypeError, ValueError
            If `about` is no point, or not the same on all ranks.
        RankError
            If another rank raises one of these.

        See Also
        --------
        momentum : Of translation.
        """
        with together(self._comm):
            self._core.angular_momentum(about)
            point = np.array(about, np.float32).astype(np.float64)
        self._check_same(about=point)
        return state.angular_momentum(self._comm, self._core, point)

    @collective
    def temperature(self) -> float:
        """Mean kinetic energy of translation of the movable particles of all ranks, with k = 1.

        The mean velocity is removed, see `jostle.World.temperature`. Each sum is rounded once, so
        the result is the same for every number of ranks.

        Returns
        -------
        float
            In units of mass times length squared per second squared; NaN for fewer than two movable
            particles.

        See Also
        --------
        kinetic_energy : The sum, with rotation and the mean velocity.
        """
        return state.temperature(self._comm, self._core)

    @collective
    def net_forces(self) -> NDArray[np.float64]:
        """Sum of the forces on each particle of this rank, at the present state.

        See `jostle.World.net_forces`, whose bits it has.

        Returns
        -------
        ndarray of float64, shape (n, 2)
            In the order of `ids`, in units of mass times length per second squared.

        See Also
        --------
        potential_energy : Of these forces.
        """
        return state.net_forces(self._comm, self._core, self._messages)

    @collective
    def state_hash(self) -> int:
        """Return the hash of all particles, the same on all ranks.

        Returns
        -------
        int
            That of `jostle.World.state_hash` with the same particles in the order of ids.
        """
        return state.state_hash(self._comm, self._core)
