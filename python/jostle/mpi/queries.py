"""Queries of all ranks: each rank computes all with its particles, and the results are joined."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import jostle

from .exchange import together
from .interrupts import collective

#: The shape of no queries, by the arguments that are a row for each query.
_NOTHING = {
    "rect": (0, 4),
    "vertices": (0, 3, 2),
    **dict.fromkeys(("point", "center", "origin", "direction"), (0, 2)),
}

#: The first arguments of each query.
_FIRST = {
    "query_point": ("point",),
    "query_rect": ("rect",),
    "query_circle": ("center",),
    "query_polygon": ("vertices",),
    "nearest": ("point",),
    **dict.fromkeys(("raycast", "raycast_all", "shape_cast"), ("origin", "direction")),
}


@collective
def query_all(world: Any, query: str, *arguments: Any, **options: Any) -> Any:
    """Return the result of a query of this rank among all particles, as by one `jostle.World`."""
    comm = world._comm
    with together(comm):
        names = _FIRST[query]
        arguments = (*map(_many, names, arguments), *arguments[len(names) :])
        options = {name: _many(name, value) for name, value in options.items()}
        own = getattr(world._queried(), query)(*arguments, **options)
    everything = comm.allgather((arguments, options))
    with together(comm):
        results = [
            own if rank == comm.rank else getattr(world._queried(), query)(*given, **others)
            for rank, (given, others) in enumerate(everything)
        ]
    return _JOIN[query](comm.alltoall(results))


def _many(name: str, value: Any) -> Any:
    """An argument, of which an empty list stands for no queries."""
    is_empty = isinstance(value, list | tuple | np.ndarray) and np.size(value) == 0
    return np.zeros(_NOTHING[name]) if is_empty and name in _NOTHING else value


def _found(parts: Sequence[Any]) -> Any:
    """All ids, ascending."""
    ids = np.concatenate([getattr(part, "ids", part) for part in parts])
    if not isinstance(parts[0], jostle.IdLists):
        return np.sort(ids)
    queries = np.concatenate([part.queries for part in parts])
    offsets = np.sum([part.offsets for part in parts], axis=0)
    return jostle.IdLists(ids[np.lexsort((ids, queries))], offsets)


def _nearest(parts: Sequence[jostle.Neighbors]) -> jostle.Neighbors:
    """As many as each rank has found, nearest first, at equal distances the smaller id."""
    ids, distances = (
        np.concatenate([getattr(part, name) for part in parts], axis=-1)
        for name in ("ids", "distances")
    )
    order = np.lexsort((ids, distances))[..., : parts[0].ids.shape[-1]]
    return jostle.Neighbors(*(np.take_along_axis(of, order, axis=-1) for of in (ids, distances)))


def _first(parts: Sequence[Any]) -> Any:
    """The nearest hit of each ray; of equal ones a particle, whose id is the smallest."""
    if isinstance(parts[0], jostle.RayHit):
        return min(parts, key=lambda hit: (hit.distance, hit.id < 0, hit.id))
    columns = {
        name: np.stack([getattr(part, name) for part in parts]) for name in jostle.RayHits.__slots__
    }
    nearest = np.lexsort((*_keys(columns),), axis=0)[0]
    chosen = (nearest, np.arange(len(nearest)))
    return jostle.RayHits(**{name: column[chosen] for name, column in columns.items()})


def _all(parts: Sequence[Any]) -> Any:
    """All hits of each ray, nearest first. Walls and sides are those that one rank has found."""
    columns = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in jostle.RayHits.__slots__
    }
    are_lists = isinstance(parts[0], jostle.RayHitLists)
    rays = np.concatenate([part.queries if are_lists else 0 * part.ids for part in parts])
    # Each rank has the same walls, in the order in which they follow each other.
    kept = np.flatnonzero((columns["ids"] >= 0) | (np.arange(len(rays)) < len(parts[0].ids)))
    columns = {name: column[kept] for name, column in columns.items()}
    order = np.lexsort((*_keys(columns), rays[kept]))
    columns = {name: column[order] for name, column in columns.items()}
    if not are_lists:
        return jostle.RayHits(**columns)
    counts = np.bincount(rays[kept], minlength=len(parts[0]))
    return jostle.RayHitLists(**columns, offsets=np.concatenate([[0], np.cumsum(counts)]))


def _keys(columns: dict[str, NDArray[Any]]) -> tuple[NDArray[Any], ...]:
    """By what hits are sorted, the last one first: at equal distances particles come first."""
    return columns["ids"], columns["ids"] < 0, columns["distances"]


#: How the results of all ranks are joined.
_JOIN: dict[str, Callable[[Sequence[Any]], Any]] = {
    **dict.fromkeys(("query_point", "query_rect", "query_circle", "query_polygon"), _found),
    "nearest": _nearest,
    **dict.fromkeys(("raycast", "shape_cast"), _first),
    "raycast_all": _all,
}
