"""Queries of the particles of all ranks, by their ids."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, overload

from ..attributes import Attribute
from ..queries import query_all
from .part import Part


class Query(Attribute):
    """A query of `jostle.World`. To call it is a collective call."""

    @overload
    def __get__(self, world: None, owner: type) -> Query: ...
    @overload
    def __get__(self, world: Any, owner: type) -> Callable[..., Any]: ...
    def __get__(self, world: Any, owner: type) -> Query | Callable[..., Any]:
        if world is None:
            return self

        def query(*arguments: Any, **options: Any) -> Any:
            return query_all(world, self._name, *arguments, **options)

        query.__doc__ = self.__doc__
        return query


class Querying(Part):
    """A world with queries of the particles of all ranks."""

    __slots__ = ()

    query_point = Query("The ids of particles that contain points, see `jostle.World.query_point`.")
    query_rect = Query("The ids of particles that overlap rectangles, see `jostle.World`.")
    query_circle = Query("The ids of particles that overlap discs, see `jostle.World`.")
    query_polygon = Query("The ids of particles that overlap a polygon, see `jostle.World`.")
    nearest = Query("The particles nearest to points, see `jostle.World.nearest`.")
    raycast = Query("The first particle, wall or side on each ray, see `jostle.World.raycast`.")
    raycast_all = Query("All that each ray hits, see `jostle.World.raycast_all`.")
    shape_cast = Query("The first that each moving shape touches, see `jostle.World.shape_cast`.")
