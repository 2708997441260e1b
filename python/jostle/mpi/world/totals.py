"""What all ranks compute from the particles of all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import state
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
    def state_hash(self) -> int:
        """Return the hash of all particles, the same on all ranks.

        Returns
        -------
        int
            That of `jostle.World.state_hash` with the same particles in the order of ids.
        """
        return state.state_hash(self._comm, self._core)
