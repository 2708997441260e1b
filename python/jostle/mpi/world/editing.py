"""Changes of particles of any rank between steps."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import edits
from ..interrupts import collective
from .columns import Columns


class Editing(Columns):
    """A world whose particles can be changed."""

    __slots__ = ()

    @collective
    def add(
        self,
        /,
        positions: ArrayLike,
        radii: ArrayLike,
        **columns: Any,
    ) -> NDArray[np.int64]:
        """Add particles.

        Parameters
        ----------
        positions : array_like, shape (k, 2)
            Those that this rank adds, at any positions; k may be 0.
        radii : array_like, a number or shape (k,)
            In units of length.
        **columns
            The other arguments of `jostle.World.add`.

        Returns
        -------
        ndarray of int64, shape (k,)
            Their ids, above all ids before; those of rank 0 first, then those of rank 1, and so on.

        Raises
        ------
        TypeError, ValueError
            As by `jostle.World.add`; then no rank adds any.
        RankError
            If another rank raises one of these.

        See Also
        --------
        remove : Remove particles.
        set : Change particles.
        """
        self._own_world = None
        places = edits.rows_of(positions)
        return edits.add(self._comm, self._core, places, radii, **columns)

    @collective
    def remove(self, ids: ArrayLike) -> None:
        """Remove particles of any rank. Their ids are never used again.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Those that this rank gives, of particles of any rank; k may be 0. Each particle is
            given at most once by all ranks together.

        Raises
        ------
        IdError, TypeError, ValueError
            As by `jostle.World.remove`; then none is removed on any rank.
        RankError
            If another rank raises one of these.

        See Also
        --------
        add : Add particles.
        """
        self._own_world = None
        edits.remove(self._comm, self._core, ids)

    @collective
    def set(self, /, ids: ArrayLike, **columns: Any) -> None:
        """Change some columns of some particles of any rank.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Those that this rank gives, of particles of any rank; k may be 0. Each particle is
            given at most once by all ranks together.
        **columns
            The columns of `jostle.World.set`, the same ones on all ranks.

        Raises
        ------
        IdError, TypeError, ValueError
            As by `jostle.World.set`, or if the columns are not the same on all ranks; then nothing
            changes on any rank.
        RankError
            If another rank raises one of these.

        See Also
        --------
        add : Add particles.
        """
        self._own_world = None
        edits.change(self._comm, self._core, ids, **columns)

    @collective
    def apply_force(
        self, /, ids: ArrayLike, forces: ArrayLike, points: ArrayLike | None = None
    ) -> None:
        """Add given forces on some particles of any rank, for the next call of `step`.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Those that this rank gives, of particles of any rank; k may be 0. A call equals one of
            `jostle.World.apply_force` with the ids of rank 0, then those of rank 1, and so on.
        forces : array_like, shape (k, 2), or (2,) for one id or as one for all
            In units of mass times length per second², see `jostle.World.apply_force`.
        points : array_like, shape (k, 2), or (2,) for one id or as one for all, optional
            Where each acts. All ranks that give ids give points, or none does.

        Raises
        ------
        IdError, TypeError, ValueError
            As by `jostle.World.apply_force`, or if only some ranks give points; then nothing
            changes on any rank.
        RankError
            If another rank raises one of these.

        See Also
        --------
        accelerations : Those of all particles.
        """
        edits.push(self._comm, self._core, ids, forces, points)

    @collective
    def apply_impulse(
        self, /, ids: ArrayLike, impulses: ArrayLike, points: ArrayLike | None = None
    ) -> None:
        """Give impulses to some particles of any rank, at once.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Those that this rank gives, of particles of any rank; k may be 0. A call equals one of
            `jostle.World.apply_impulse` with the ids of rank 0, then those of rank 1, and so on.
        impulses : array_like, shape (k, 2), or (2,) for one id or as one for all
            In units of mass times length per second, see `jostle.World.apply_impulse`.
        points : array_like, shape (k, 2), or (2,) for one id or as one for all, optional
            Where each acts. All ranks that give ids give points, or none does.

        Raises
        ------
        IdError, TypeError, ValueError
            As by `jostle.World.apply_impulse`, or if only some ranks give points; then nothing
            changes on any rank.
        RankError
            If another rank raises one of these.

        See Also
        --------
        apply_force : Forces during the next call of `step`.
        """
        edits.hit(self._comm, self._core, ids, impulses, points)

    @property
    def accelerations(self) -> NDArray[np.float32]:
        """Given accelerations in the next call of `step`: ndarray of float32, shape (n, 2).

        They are in the order of `ids`. Assign an array of this shape, one vector for all of this
        rank, or None for zeros. The assignment is a collective call, which replaces what was given
        before; see `jostle.World.accelerations`.
        """
        given: NDArray[np.float32] = self._core.accelerations
        return given[: len(self)]

    @accelerations.setter
    def accelerations(self, value: ArrayLike | None) -> None:
        self._accelerate(value)

    @collective
    def _accelerate(self, accelerations: ArrayLike | None) -> None:
        edits.accelerate(self._comm, self._core, accelerations)
