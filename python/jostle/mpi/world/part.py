"""The part of a distributed world that one rank has, and what is the same on all ranks."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

import jostle

from .. import state
from ..exchange import duplicate_of, first_id, from_all, together
from ..interrupts import collective
from ..messages import Messages

#: Settings that must be the same on all ranks.
_SETTINGS = (
    *("gravity", "drag", "container", "period", "walls"),
    *("forces", "on_touch", "substeps", "sleeping", "track_events"),
)


def _bytes_of(setting: object) -> bytes:
    """All of a setting; the text of a long array would be shortened."""
    if isinstance(setting, np.ndarray):
        return repr((setting.shape, setting.dtype)).encode() + setting.tobytes()
    if isinstance(setting, list | tuple):
        return b"".join(map(_bytes_of, setting))
    if isinstance(setting, jostle.Walls):
        columns = setting.get(setting.ids).to_dict()
        return _bytes_of([setting.ids, *columns.values()])
    if isinstance(setting, jostle.PairForce):  # whose repr does not show the table
        return _bytes_of(setting.table) + _bytes_of((setting.cutoff, setting.damping))
    return repr(setting).encode() + b";"


class Part:
    """The core with this rank's particles, and the communicator."""

    # An attribute that does not exist, such as a misspelt setting, cannot be assigned.
    __slots__ = ("_comm", "_core", "_messages", "_own_world", "_work")

    def _begin(self, comm: MPI.Intracomm) -> None:
        self._comm = duplicate_of(comm)
        self._messages = Messages(self._comm)
        self._work: float | None = None
        self._own_world: Any = None

    @collective
    def _distribute(self, part: Callable[[int, int], Any]) -> None:
        """Make the worlds of all ranks one, with ids in the order of ranks."""
        with together(self._comm):
            core = part(self._comm.rank, self._comm.size)
            core._check_distributable()
        self._core: Any = core
        self._check_settings(core, _SETTINGS)
        ids = first_id(self._comm, len(core)) + np.arange(len(core))
        core._distribute(self._messages, ids)
        core._agree_on_losses()

    def _check_settings(self, core: Any, names: tuple[str, ...]) -> None:
        """Refuse settings that differ between ranks."""
        values = {name: getattr(core, name) for name in names}
        if "substeps" in values:
            # The automatic number depends on the particles of all ranks.
            values["substeps"] = core._given_substeps()
        self._check_same(**values)

    def _check_same(self, **values: object) -> None:
        """Refuse values that differ between ranks."""
        digests = [hashlib.sha256(_bytes_of(value)).digest() for value in values.values()]
        own = np.frombuffer(b"".join(digests), np.uint8).reshape(len(values), -1)
        everything = from_all(self._comm, own)
        differ = (everything != everything[0]).any(axis=(0, 2))
        for at, (name, value) in enumerate(values.items()):
            if differ[at]:
                raise ValueError(f"{name} is not the same on all ranks: here it is {value!r}")

    @collective
    def _assign(self, name: str, value: object) -> None:
        """Change a setting on all ranks. All islands wake."""
        with together(self._comm):
            trial: Any = self._core._of_records(self._core._own_records())
            setattr(trial, name, value)
            trial._check_distributable()
        self._check_settings(trial, (name,))
        self._core._drop_ghosts()
        self._own_world = None
        setattr(self._core, name, value)
        self._core._agree_on_losses()

    @collective
    def _edit_walls(self, edit: Callable[[jostle.Walls], Any]) -> Any:
        """Change the walls of all ranks alike. All islands wake."""
        with together(self._comm):
            trial: Any = self._core._of_records(b"")
            edit(trial.walls)
            trial._check_distributable()
        self._check_settings(trial, ("walls",))
        self._core._drop_ghosts()
        self._own_world = None
        found = edit(self._core.walls)
        self._core._agree_on_losses()
        return found

    def _queried(self) -> Any:
        """A `jostle.World` with the particles and ids of this rank, kept until they change."""
        if self._own_world is None:
            records = state.records_of(self._core)
            records = records[np.argsort(records["id"])]
            self._own_world = self._core._of_records(records.tobytes())
            self._own_world._set_ids(records["id"].copy(), self._core._own_ids()[1])
        return self._own_world

    def _own(self) -> tuple[int, NDArray[np.int64], list[int]]:
        own: tuple[int, NDArray[np.int64], list[int]] = self._core._own()
        return own
