"""A continuous space for Mesa's agents, in which neighbours come from a quadtree.

`ContinuousSpace` has the names, arguments and results of
`mesa.experimental.continuous_space.ContinuousSpace`, from which it is derived, so Mesa's
`ContinuousSpaceAgent` and the models written for it use it unchanged. Mesa computes the distances
to all agents for each query; this class queries a `jostle.Space` for the agents nearby, and then
computes and compares distances as Mesa does. The answers are the same agents in the same order,
with the same bits, with one exception: `get_k_nearest_agents` returns the nearest first, at equal
distances the agent that was added first, whereas Mesa's order of these k agents is not specified.

Positions may be assigned (``agent.position = p``), changed in place (``agent.position += v``,
``agent.position[0] = x``), or written for many agents at once
(``space.agent_positions[rows] = p``), also in views of them. Call `refresh` after other writes,
which are not detected: those of NumPy's functions (``np.add(p, v, out=agent.position)``,
``np.copyto``) and those through ``.flat``.

Spaces that are not of two dimensions, and queries from points outside of a torus, use Mesa's own
code.

Examples
--------
>>> import random
>>> import mesa
>>> from mesa.experimental.continuous_space import ContinuousSpaceAgent
>>> from jostle.mesa import ContinuousSpace
>>> model = mesa.Model(seed=1)
>>> space = ContinuousSpace([[0, 10], [0, 10]], torus=True, random=random.Random(1))
>>> agents = [ContinuousSpaceAgent(space, model) for _ in range(3)]
>>> for agent, x in zip(agents, (0.5, 9.5, 5.0)):
...     agent.position = (x, 5.0)
>>> near, distances = agents[0].get_neighbors_in_radius(1.0)
>>> near == [agents[1]], distances
(True, array([1.]))
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from mesa.experimental.continuous_space import ContinuousSpace as _MesaSpace
from numpy.typing import ArrayLike, NDArray

import jostle

__all__ = ["ContinuousSpace"]

#: Candidates are searched in a circle that is larger by this share of the largest number that the
#: distances are computed from, which is more than their rounding errors.
_MARGIN = 1e-9


_item = np.ndarray.__getitem__


class _Positions(np.ndarray):
    """An array of positions that reports writes to its space.

    `row` is the row of the space that a view may change, or None if it may change all.
    """

    space: ContinuousSpace | None = None
    row: int | None = None

    def __array_finalize__(self, source: Any) -> None:
        """Let views report writes as their source does; copies and results do not."""
        if type(source) is not _Positions or self.base is None:
            return
        if self.base is source or self.base is source.base:
            self.space, self.row = source.space, source.row

    def __getitem__(self, key: Any) -> Any:
        """Return a view, which reports writes too."""
        part = _item(self, key)
        if type(part) is _Positions:
            part.space, part.row = self.space, self._row_of(key)
        return part

    def __setitem__(self, key: Any, value: Any) -> None:
        """Write, and report the row or all rows."""
        super().__setitem__(key, value)
        self._report(self._row_of(key))

    def _row_of(self, key: Any) -> int | None:
        """Return the row that a key selects, None for several or unknown ones."""
        if self.row is None and type(key) is int and self.space is not None:
            return key if self is self.space._positions else None
        return self.row

    def fill(self, value: Any) -> None:
        """Fill, and report the rows."""
        super().fill(value)
        self._report(self.row)

    def put(self, *arguments: Any, **options: Any) -> None:
        """Write some numbers, and report the rows."""
        super().put(*arguments, **options)
        self._report(self.row)

    def _report(self, row: int | None) -> None:
        if self.space is not None:
            self.space._note_moved(row)


def _reporting(name: str) -> Any:
    """Return an operation in place that reports the rows that it writes."""
    operation = getattr(np.ndarray, name)

    def operate(self: _Positions, other: Any) -> Any:
        result = operation(self, other)
        self._report(self.row)
        return result

    return operate


for _name in ("add", "sub", "mul", "truediv", "floordiv", "mod", "pow", "matmul"):
    setattr(_Positions, f"__i{_name}__", _reporting(f"__i{_name}__"))


class ContinuousSpace(_MesaSpace):
    """Continuous space where each agent can have an arbitrary position.

    Parameters
    ----------
    dimensions : array_like, shape (d, 2)
        Minimum and maximum of each dimension. With two dimensions the quadtree is used.
    torus : bool, default False
        Whether the space wraps around.
    random : random.Random, optional
        A seeded generator of random numbers.
    n_agents : int, default 100
        The expected number of agents.

    See Also
    --------
    jostle.Space : Has the shapes and answers the queries.
    """

    def __init__(
        self,
        dimensions: ArrayLike,
        torus: bool = False,
        random: Any = None,
        n_agents: int = 100,
    ) -> None:
        """Make a space without agents."""
        super().__init__(dimensions, torus=torus, random=random, n_agents=n_agents)
        #: The shapes of jostle, whose ids are the rows of the agents; None before they are added.
        self._shapes: jostle.Space | None = None
        self._added = 0
        self._moved: set[int] = set()
        self._all_moved = False
        #: Rows whose position is outside of a torus or not finite.
        self._outside: set[int] = set()
        # As plain numbers: for one agent, arithmetic on these is faster than on arrays.
        self._low: list[float] = self.dimensions[:, 0].astype(float).tolist()
        self._high: list[float] = self.dimensions[:, 1].astype(float).tolist()
        self._largest = float(np.abs(self.dimensions).max())

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Restore a copy, or what was pickled: its positions are views of one array again."""
        self.__dict__.update(state)
        self._shapes = None
        self.agent_positions = self._agent_positions[: self._n_agents]

    @property
    def agent_positions(self) -> Any:
        """Positions of the agents: ndarray of float64, shape (n, d), a view."""
        return self._positions

    @agent_positions.setter
    def agent_positions(self, positions: NDArray[np.float64]) -> None:
        if positions is getattr(self, "_positions", None):
            return
        view = positions.view(_Positions)
        view.space, view.row = self, None
        self._positions = view

    def refresh(self) -> None:
        """Read all positions again before the next query.

        Only needed after the positions were the output of a function of NumPy.
        """
        self._note_moved(None)

    def _note_moved(self, row: int | None) -> None:
        if row is None or row < 0:
            self._all_moved = True
        else:
            self._moved.add(row)

    def _remove_agent(self, agent: Any) -> None:
        super()._remove_agent(agent)
        # The rows behind it have changed.
        self._shapes = None

    def _synchronized(self) -> jostle.Space | None:
        """Return the shapes at the present positions; None if Mesa's own code must be used."""
        if self.ndims != 2:
            return None
        if self._shapes is None:
            period = tuple(float(side) for side in self.size) if self.torus else None
            self._shapes, self._added = jostle.Space(period=period), 0
            self._outside.clear()
        if self._all_moved:
            self._moved.update(range(self._added))
            self._all_moved = False
        if self._moved:
            rows = [row for row in self._moved if row < self._added]
            self._moved.clear()
            if len(rows) == 1 and not self._outside and self._contains(self._numbers(rows[0])):
                x, y = self._numbers(rows[0])
                self._shapes.set(rows[0], positions=(x - self._low[0], y - self._low[1]))
            elif rows:
                self._shapes.set(rows, positions=self._inside(rows))
        if self._added < self._n_agents:
            new = range(self._added, self._n_agents)
            self._shapes.add(self._inside(list(new)))
            self._added = self._n_agents
        return None if self._outside else self._shapes

    def in_bounds(self, point: ArrayLike) -> bool:
        """Return whether a point is within the dimensions, its sides included.

        Parameters
        ----------
        point : array_like, shape (d,)
            The point.

        Returns
        -------
        bool
            False if a coordinate is outside or NaN.
        """
        if self.ndims == 2 and isinstance(point, np.ndarray) and point.shape == (2,):
            return self._contains(point.tolist())
        return bool(super().in_bounds(point))

    def calculate_difference_vector(
        self, point: NDArray[np.float64], agents: Any = None
    ) -> NDArray[np.float64]:
        """Return the vectors from a point to agents; on a torus the shorter ones.

        Parameters
        ----------
        point : array_like, shape (d,)
            The point.
        agents : iterable of agents, optional
            The agents; all of them by default.

        Returns
        -------
        ndarray of float64, shape (m, d)
            One row for each agent.
        """
        rows: Any = slice(self._n_agents)
        if agents is not None:
            rows = [self._agent_to_index[agent] for agent in agents]
        delta = self._agent_positions[rows] - np.asarray(point)
        if self.torus:
            around = delta - np.sign(delta) * self.size
            delta = np.where(np.abs(delta) < np.abs(around), delta, around)
        return delta

    def _numbers(self, row: int) -> list[float]:
        return self._agent_positions[row].tolist()

    def _contains(self, point: list[float]) -> bool:
        """Return whether a point is within the bounds; False for NaN."""
        (x, y), low, high = point, self._low, self._high
        return low[0] <= x <= high[0] and low[1] <= y <= high[1]

    def _inside(self, rows: list[int]) -> NDArray[np.float64]:
        """Return positions relative to the lower corner; note those that jostle cannot store."""
        low, high = self.dimensions[:, 0], self.dimensions[:, 1]
        positions = self._agent_positions[rows]
        good = np.isfinite(positions).all(axis=1)
        if self.torus:
            good &= ((positions >= low) & (positions <= high)).all(axis=1)
        if self._outside:
            self._outside.difference_update(rows)
        if not good.all():
            self._outside.update(row for row, fine in zip(rows, good, strict=True) if not fine)
        return np.where(good[:, None], positions - low, 0.0)

    def _rows_near(self, point: NDArray[np.float64], radius: float) -> NDArray[np.int64] | None:
        """Return rows with all agents within a radius; None if Mesa's own code must be used."""
        if point.shape != (2,) or not math.isfinite(radius):
            return None
        numbers = point.tolist()
        if not self._contains(numbers) and (self.torus or not np.isfinite(point).all()):
            return None
        shapes = self._synchronized()
        if shapes is None:
            return None
        x, y = numbers
        largest, radius = max(self._largest, abs(x), abs(y)), max(float(radius), 0.0)
        center = (x - self._low[0], y - self._low[1])
        return shapes.query_circle(center, radius + _MARGIN * (largest + radius))

    def _distances(
        self, point: NDArray[np.float64], rows: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Return distances as `calculate_distances` computes them."""
        if not self.torus:
            agents = [self.active_agents[row] for row in rows.tolist()]
            return np.asarray(self.calculate_distances(point, agents)[0])
        delta = np.abs(point - self._agent_positions[rows])
        delta = np.minimum(delta, self.size - delta, out=delta)
        return np.sqrt(delta[:, 0] ** 2 + delta[:, 1] ** 2)

    def get_agents_in_radius(
        self, point: ArrayLike, radius: float = 1
    ) -> tuple[list[Any], NDArray[np.float64]]:
        """Return the agents within a radius of a point, and their distances.

        Parameters
        ----------
        point : array_like, shape (d,)
            The centre.
        radius : float, default 1
            Agents at exactly this distance are included.

        Returns
        -------
        agents : list
            In the order in which they were added.
        distances : ndarray of float64, shape (m,)
            The distance of each.
        """
        center = np.array(point, dtype=np.float64)
        rows = self._rows_near(center, radius)
        if rows is None:
            return super().get_agents_in_radius(point, radius)
        distances = self._distances(center, rows)
        near = distances <= radius
        all_agents = self.active_agents
        return [all_agents[row] for row in rows[near].tolist()], distances[near]

    def get_k_nearest_agents(
        self, point: ArrayLike, k: int = 1
    ) -> tuple[list[Any], NDArray[np.float64]]:
        """Return the k agents nearest to a point, and their distances.

        Parameters
        ----------
        point : array_like, shape (d,)
            The point.
        k : int, default 1
            Number of agents, below that of all agents.

        Returns
        -------
        agents : list
            Nearest first; at equal distances the one that was added first.
        distances : ndarray of float64, shape (k,)
            The distance of each.
        """
        center = np.array(point, dtype=np.float64)
        shapes = self._synchronized()
        usable = shapes is not None and 0 < k < self._n_agents and np.isfinite(center).all()
        if not usable or (self.torus and not self.in_bounds(center)):
            return super().get_k_nearest_agents(point, k)
        assert shapes is not None
        found = shapes.nearest(tuple((center - self.dimensions[:, 0]).tolist()), k)
        rows = self._rows_near(center, float(found.distances[-1]))
        if rows is None:
            return super().get_k_nearest_agents(point, k)
        distances = self._distances(center, rows)
        order = np.argsort(distances, kind="stable")[:k]
        agents = [self.active_agents[row] for row in rows[order].tolist()]
        return agents, distances[order]
