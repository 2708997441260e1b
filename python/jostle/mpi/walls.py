"""The walls of a distributed world, which are the same on all ranks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle

from .attributes import Attribute


class WallColumn(Attribute):
    """A column of the walls. To assign it is a collective call."""

    @overload
    def __get__(self, walls: None, owner: type) -> WallColumn: ...
    @overload
    def __get__(self, walls: Any, owner: type) -> NDArray[Any]: ...
    def __get__(self, walls: Any, owner: type) -> WallColumn | NDArray[Any]:
        if walls is None:
            return self
        column: NDArray[Any] = getattr(walls._world._core.walls, self._name)
        return column

    def __set__(self, walls: Any, value: object) -> None:
        walls._world._edit_walls(lambda all_walls: setattr(all_walls, self._name, value))


class WallQuery(Attribute):
    """A query of the walls by their ids. It is not collective, because each rank has all walls."""

    @overload
    def __get__(self, walls: None, owner: type) -> WallQuery: ...
    @overload
    def __get__(self, walls: Any, owner: type) -> Callable[..., Any]: ...
    def __get__(self, walls: Any, owner: type) -> WallQuery | Callable[..., Any]:
        if walls is None:
            return self
        query: Callable[..., Any] = getattr(walls._world._core.walls, self._name)
        return query


class Walls:
    """The walls of a `jostle.mpi.World`, the same on all ranks.

    `add`, `set`, `remove` and the assignment of a column are collective calls, with the same
    arguments on all ranks. All that reads, queries included, is not collective.

    Parameters
    ----------
    world : World
        The world; `World.walls` gives it.

    See Also
    --------
    World.walls : Returns it.
    jostle.Walls : The same in one process.

    Examples
    --------
    >>> from mpi4py import MPI
    >>> import jostle.mpi
    >>> world = jostle.mpi.World(MPI.COMM_SELF, [(0, 2)], 1.0)
    >>> world.walls.add(((-3, 0), (3, 0)), friction=0.5)
    0
    >>> world.walls.friction
    array([0.5], dtype=float32)
    >>> world.walls.raycast((1, 5), (0, -1)).id
    0
    """

    __slots__ = ("_world",)

    def __init__(self, world: Any) -> None:
        self._world = world

    def add(self, segments: ArrayLike, **columns: Any) -> NDArray[np.int64] | int:
        """Add one wall or many to all ranks.

        Parameters
        ----------
        segments : array_like, shape (k, 2, 2), or (2, 2) for one wall
            In units of length.
        **columns
            The other arguments of `jostle.Walls.add`.

        Returns
        -------
        ndarray of int64, shape (k,), or int
            Their ids, above all ids before.

        Raises
        ------
        TypeError, ValueError
            As by `jostle.Walls.add`, or if the walls would differ between ranks; then nothing is
            added.
        RankError
            If another rank raises one of these.

        See Also
        --------
        set : Change walls.
        remove : Remove walls.
        """
        ids: NDArray[np.int64] | int = self._world._edit_walls(
            lambda walls: walls.add(segments, **columns)
        )
        return ids

    def set(self, ids: ArrayLike, **columns: Any) -> None:
        """Change some columns of some walls on all ranks.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The walls, each at most once.
        **columns
            The columns of `jostle.Walls.set`.

        Raises
        ------
        TypeError, ValueError
            As by `jostle.Walls.set`, or if the walls would differ between ranks; then nothing
            changes.
        RankError
            If another rank raises one of these.

        See Also
        --------
        get : Read walls.
        """
        self._world._edit_walls(lambda walls: walls.set(ids, **columns))

    def remove(self, ids: ArrayLike) -> None:
        """Remove walls from all ranks. Their ids are never used again.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The walls, each at most once.

        Raises
        ------
        TypeError, ValueError
            As by `jostle.Walls.remove`, or if the walls would differ between ranks; then none is
            removed.
        RankError
            If another rank raises one of these.

        See Also
        --------
        add : Add walls.
        """
        self._world._edit_walls(lambda walls: walls.remove(ids))

    def get(self, ids: ArrayLike) -> jostle.Wall | jostle.WallColumns:
        """Read all columns of one wall or some. Not collective.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            The walls.

        Returns
        -------
        WallColumns or Wall
            As by `jostle.Walls.get`.

        Raises
        ------
        TypeError, ValueError
            As by `jostle.Walls.get`.

        See Also
        --------
        set : Change walls.
        """
        found: jostle.Wall | jostle.WallColumns = self._world._core.walls.get(ids)
        return found

    def rows(self, ids: ArrayLike) -> Any:
        """Return the rows that walls have in the columns. Not collective.

        Parameters
        ----------
        ids : int or array_like of int, of any shape
            The walls.

        Returns
        -------
        ndarray of int64 of the same shape, or int
            Their rows.

        Raises
        ------
        TypeError, ValueError
            As by `jostle.Walls.rows`.

        See Also
        --------
        get : Read walls.
        """
        return self._world._core.walls.rows(ids)

    @property
    def ids(self) -> NDArray[np.int64]:
        """The ids of all walls, ascending: ndarray of int64, shape (m,)."""
        ids: NDArray[np.int64] = self._world._core.walls.ids
        return ids

    segments = WallColumn("The ends: ndarray of float32, shape (m, 2, 2), in units of length.")
    velocities = WallColumn("Velocities: ndarray of float32, shape (m, 2).")
    friction = WallColumn(
        "Coefficients of friction: ndarray of float32, shape (m,); NaN is that of the particle."
    )
    restitution = WallColumn(
        "Coefficients of restitution: ndarray of float32, shape (m,); NaN is that of the particle."
    )
    sensors = WallColumn("Which walls are sensors: ndarray of bool, shape (m,).")
    one_way = WallColumn(
        "Which walls stop only what comes from the left: ndarray of bool, shape (m,)."
    )
    categories = WallColumn("Categories: ndarray of uint32, shape (m,).")
    masks = WallColumn("Masks: ndarray of uint32, shape (m,).")

    query_rect = WallQuery("The ids of walls that overlap rectangles; see `jostle.Walls`.")
    query_circle = WallQuery("The ids of walls that overlap circles; see `jostle.Walls`.")
    query_point = WallQuery("The ids of walls at points; see `jostle.Walls`.")
    query_polygon = WallQuery("The ids of walls that overlap a polygon; see `jostle.Walls`.")
    nearest = WallQuery("The walls nearest to points; see `jostle.Walls`.")
    raycast = WallQuery("The first wall on each ray; see `jostle.Walls`.")
    raycast_all = WallQuery("All walls on each ray; see `jostle.Walls`.")
    shape_cast = WallQuery("The first wall that each moving shape touches; see `jostle.Walls`.")

    def __len__(self) -> int:
        return len(self._world._core.walls)

    def __contains__(self, wall: object) -> bool:
        return wall in self._world._core.walls

    def __repr__(self) -> str:
        return f"<jostle.mpi.Walls with {len(self)} walls>"
