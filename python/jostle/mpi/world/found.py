"""What the last step and the last call of `step` have found."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import jostle

from ..events import events_of, new_ids
from ..exchange import from_all, joined, together, totals
from ..interrupts import collective
from .part import Part


class Found(Part):
    """A world with records of its last step and its last call of `step`."""

    __slots__ = ()

    @property
    def last_step(self) -> jostle.LastStep:
        """What the last step found on this rank, see `jostle.World.last_step`.

        Not collective. Each pair that touched is on one rank, and particles at walls are those of
        this rank.
        """
        found = self._core.last_step
        fields = found.to_dict()
        fields["contacts"] = self._contacts(found.contacts)
        fields["wall_contacts"] = self._wall_contacts(found.wall_contacts)
        return jostle.LastStep(**fields)

    @property
    @collective
    def last_call(self) -> jostle.LastCall:
        """Sums over the last call of `step` and the particles of all ranks.

        See `jostle.World.last_call`. Impulses and the virial may differ in the last digits from
        those of one process, because each rank rounds its part.
        """
        found = self._core.last_call
        fields = found.to_dict()
        for name in ("collision_virial", "wall_impulses", "side_impulses"):
            fields[name] = from_all(self._comm, fields[name]).sum(axis=0)
        counts = np.array([found.collisions, found.wall_collisions], np.int64)
        pairs, walls = map(int, totals(self._comm, counts))
        return jostle.LastCall(**fields | {"collisions": pairs, "wall_collisions": walls})

    def _contacts(self, found: jostle.WorldContacts) -> jostle.WorldContacts:
        """Return those that belong to this rank, with ids among all particles."""
        count, ids, _ = self._own()
        movable, pairs = self._core.movable[found.pairs], ids[found.pairs]
        is_reversed = pairs[:, 0] > pairs[:, 1]
        # A pair belongs to the rank of the movable particle, of two to that of the smaller id.
        are_alike = movable[:, 0] == movable[:, 1]
        is_second = np.where(are_alike, is_reversed, movable[:, 1])
        owner = np.where(is_second, found.pairs[:, 1], found.pairs[:, 0])
        pairs = np.sort(pairs, axis=1)
        is_own = owner < count
        normals = np.where(is_reversed[:, None], -found.normals, found.normals)
        turned = found.categories[:, ::-1]
        categories = np.where(is_reversed[:, None], turned, found.categories)
        awake = found.to_dict() | {"pairs": pairs, "normals": normals, "categories": categories}
        asleep = self._core._own_touches_asleep().to_dict()
        columns = {name: np.concatenate([awake[name][is_own], asleep[name]]) for name in awake}
        order = np.lexsort(columns["pairs"].T[::-1])
        return jostle.WorldContacts(**{name: column[order] for name, column in columns.items()})

    def _wall_contacts(self, found: jostle.WallContacts) -> jostle.WallContacts:
        """Return those of particles of this rank, with ids among all particles."""
        count, ids, *_ = self._own()
        own = np.flatnonzero(found.ids < count)
        own = own[np.lexsort((found.walls[own], ids[found.ids[own]]))]
        columns = {name: column[own] for name, column in found.to_dict().items()}
        return jostle.WallContacts(**columns | {"ids": ids[columns["ids"]]})

    @property
    @collective
    def events(self) -> jostle.WorldEvents:
        """The pairs that began and ceased to touch in the last call of `step`, each on one rank.

        The pairs are of ids, sorted; see `jostle.World.events`. After `load` no pair touches before
        the first step.
        """
        return jostle.WorldEvents(**self._events(at_walls=False))

    @property
    @collective
    def wall_events(self) -> jostle.WallEvents:
        """The particles and walls that began and ceased to touch in the last call of `step`.

        Each pair is on one rank; see `jostle.World.wall_events`. After `load` nothing touches
        before the first step.
        """
        return jostle.WallEvents(**self._events(at_walls=True))

    def _events(self, *, at_walls: bool) -> dict[str, NDArray[Any]]:
        with together(self._comm):
            if not self._core.track_events:
                raise RuntimeError("events are not tracked; make the world with track_events=True")
        return events_of(self._comm, self._core._own_touches(at_walls))

    @property
    @collective
    def renumbered(self) -> NDArray[np.int64] | None:
        """The new id of each id after the last call of `step`, the same on all ranks.

        None if no particles merged; see `jostle.World.renumbered`. Each rank gets the whole array,
        with a number for each id that was ever given.
        """
        pairs = joined(self._comm, self._core._own_renumbering().reshape(-1)).reshape(-1, 2)
        return new_ids(self._comm, pairs, *self._core._own_ids()) if len(pairs) else None
