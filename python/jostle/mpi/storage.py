"""Files of distributed worlds: one file, which all ranks write and read in parts.

The file has a head, the settings as a snapshot of a world without particles, a checksum for each
chunk of particles, and the particles as records in the order of ids.
"""

from __future__ import annotations

import os
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .exchange import send, together

_MAGIC = b"jostle ranks\x1a\n\0\0"
_VERSION = 1

#: Particles of a chunk. Each rank has whole chunks, so that checksums do not depend on the ranks.
_CHUNK = 1 << 14

_HEAD = np.dtype([("magic", "S16"), ("version", "<u8"), ("particles", "<u8"), ("settings", "<u8")])


def by_ids(comm: MPI.Intracomm, rows: NDArray[Any], total: int, unit: int = 1) -> NDArray[Any]:
    """Send particles to ranks so that each has a range of ids, in units of so many."""
    starts = _starts(comm.size, total, unit)
    rows = send(comm, rows, np.searchsorted(starts[1:], rows["id"], side="right"))
    return np.sort(rows, order="id")


def _starts(size: int, total: int, unit: int) -> NDArray[np.int64]:
    """The first id of each rank."""
    units = -(-total // unit)
    return np.minimum(np.arange(size) * units // size * unit, total)


def write(comm: MPI.Intracomm, path: Path, settings: bytes, rows: NDArray[Any]) -> None:
    """Write a file beside `path`, and rename it when it is complete; `settings` of rank 0 count."""
    total = int(comm.allreduce(len(rows)))
    rows = by_ids(comm, rows, total, _CHUNK)
    first = int(_starts(comm.size, total, _CHUNK)[comm.rank])
    sums = np.array(
        [zlib.crc32(rows[at : at + _CHUNK].tobytes()) for at in range(0, len(rows), _CHUNK)], "<u4"
    )
    settings = comm.bcast(settings)
    beside = path.with_name(f".{path.name}.partial")
    sums_at = _HEAD.itemsize + len(settings)
    rows_at = sums_at + 4 * -(-total // _CHUNK)
    with _all_or_none(comm, beside, MPI.MODE_CREATE | MPI.MODE_WRONLY) as file:
        file.Set_size(rows_at + total * rows.dtype.itemsize)
        head = np.array([(_MAGIC, _VERSION, total, len(settings))], _HEAD).tobytes() + settings
        file.Write_at_all(0, head if comm.rank == 0 else b"")
        file.Write_at_all(sums_at + 4 * (first // _CHUNK), sums.tobytes())
        file.Write_at_all(rows_at + first * rows.dtype.itemsize, rows.tobytes())
        file.Sync()
    with together(comm):
        if comm.rank == 0:
            os.replace(beside, path)


class _all_or_none:
    """A file of all ranks; the error of opening it is raised by all."""

    def __init__(self, comm: MPI.Intracomm, path: Path, mode: int) -> None:
        self._comm, self._path, self._mode = comm, path, mode

    def __enter__(self) -> MPI.File:
        error: Exception | None = None
        try:
            self._file = MPI.File.Open(self._comm, os.fspath(self._path), self._mode)
        except MPI.Exception as raised:
            error = OSError(f"{self._path}: {raised.Get_error_string()}")
        if error is not None:
            raise error
        return self._file

    def __exit__(self, *_: object) -> None:
        self._file.Close()


def read(comm: MPI.Intracomm, path: Path, record: np.dtype[np.void]) -> tuple[bytes, NDArray[Any]]:
    """Return the settings, and this rank's range of the particles."""
    with together(comm):
        with path.open("rb") as file:
            head = np.frombuffer(file.read(_HEAD.itemsize).ljust(_HEAD.itemsize, b"\0"), _HEAD)[0]
            size = os.fstat(file.fileno()).st_size
            if head["magic"] != _MAGIC.rstrip(b"\0"):
                raise ValueError(f"{path} is not a file of jostle.mpi.World.save")
            if head["version"] != _VERSION:
                raise ValueError(
                    f"{path} has format {head['version']}; this version of jostle reads {_VERSION}"
                )
            total = int(head["particles"])
            sums_at = _HEAD.itemsize + int(head["settings"])
            rows_at = sums_at + 4 * -(-total // _CHUNK)
            if size != rows_at + total * record.itemsize:
                raise ValueError(f"{path} is cut off, or has something after its end")
            settings = file.read(int(head["settings"]))
            starts = np.append(_starts(comm.size, total, _CHUNK), total)
            first, last = (int(at) for at in starts[comm.rank : comm.rank + 2])
            file.seek(sums_at + 4 * (first // _CHUNK))
            sums = np.frombuffer(file.read(4 * -(-(last - first) // _CHUNK)), "<u4")
            file.seek(rows_at + first * record.itemsize)
            rows = np.frombuffer(file.read((last - first) * record.itemsize), record)
        for number, expected in enumerate(sums):
            chunk = rows[number * _CHUNK : (number + 1) * _CHUNK]
            if zlib.crc32(chunk.tobytes()) != expected:
                at = first + number * _CHUNK
                raise ValueError(
                    f"{path} is damaged: the particles from {at} on are not as written"
                )
    return settings, rows
