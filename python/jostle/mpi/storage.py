"""Files of distributed worlds: one file, which all ranks write and read in parts.

The file has a head, the settings as a snapshot of a world without particles, a table of chunks, and
the chunks. A chunk has the particles of a range of ids: the numbers of rows of all `PARTS`, then
their rows. The core reads such a file, too: `ranks/parts.rs`.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from jostle._core import checksum
from jostle.writing import NewFile

from .exchange import raise_together, send, together
from .records import PAIRS, PARTS

_MAGIC = b"jostle ranks\x1a\n\0\0"
_VERSION = 5

#: Ids of a chunk. Each rank has whole chunks, so that the file does not depend on the ranks.
_CHUNK = 1 << 14

_HEAD = np.dtype(
    [
        ("magic", "S16"),
        ("version", "<u8"),
        ("particles", "<u8"),
        ("next", "<u8"),
        ("settings", "<u8"),
    ]
)

#: Fields by which rows are sorted, the last one first.
_ORDER = ("wall", "other", "id")

#: Bytes of a chunk, and their checksum.
_ENTRY = np.dtype([("size", "<u8"), ("checksum", "<u8")])


def by_ids(comm: MPI.Intracomm, rows: NDArray[Any], end: int, unit: int = 1) -> NDArray[Any]:
    """Send rows to ranks so that each has a range of the ids below an end, in units of so many."""
    rows = send(comm, rows, _ranks_of(rows["id"], comm.size, end, unit))
    names = [name for name in _ORDER if name in (rows.dtype.names or ())]
    return rows[np.lexsort([rows[name] for name in names])]


def _starts(size: int, end: int, unit: int) -> NDArray[np.int64]:
    """The first id of each rank."""
    units = -(-end // unit)
    return np.minimum(np.arange(size) * units // size * unit, end)


def _ranks_of(ids: NDArray[np.int64], size: int, end: int, unit: int) -> NDArray[np.intp]:
    return np.searchsorted(_starts(size, end, unit)[1:], ids, side="right")


def _chunks_of(rank: int, size: int, end: int) -> tuple[int, int]:
    """The chunks of a rank: the first one, and the one after the last."""
    count = -(-end // _CHUNK)
    return rank * count // size, (rank + 1) * count // size


def write(
    comm: MPI.Intracomm, path: Path, settings: bytes, end: int, parts: list[NDArray[Any]]
) -> None:
    """Write a file, which replaces `path` when it is complete; `settings` of rank 0 count.

    All ids are below `end`.
    """
    total = int(comm.allreduce(len(parts[0])))
    parts = [by_ids(comm, rows, end, _CHUNK) for rows in parts]
    first, last = _chunks_of(comm.rank, comm.size, end)
    chunks = [_chunk(parts, number) for number in range(first, last)]
    table = np.array([(len(chunk), checksum(chunk)) for chunk in chunks], _ENTRY)
    settings = comm.bcast(settings)
    head = np.array([(_MAGIC, _VERSION, total, end, len(settings))], _HEAD).tobytes() + settings
    table_at = len(head)
    size = int(table["size"].sum())
    chunks_at = table_at + _ENTRY.itemsize * -(-end // _CHUNK)
    own_at = chunks_at + int(comm.exscan(size) or 0)
    new = None
    with together(comm):
        if comm.rank == 0:
            new = NewFile(path)
    with _removed_after_errors(new):
        place = comm.bcast(new and new.path)
        with _opened(comm, place, path, chunks_at + int(comm.allreduce(size))) as file:
            if comm.rank == 0:
                file.Write_at(0, head)
            file.Write_at(table_at + _ENTRY.itemsize * first, table.tobytes())
            file.Write_at(own_at, b"".join(chunks))
        with together(comm):
            if new is not None:
                new.commit()


def _chunk(parts: list[NDArray[Any]], number: int) -> bytes:
    """The rows of a chunk, from rows that are sorted by ids."""
    ends = [number * _CHUNK, (number + 1) * _CHUNK]
    limits = [np.searchsorted(rows["id"], ends) for rows in parts]
    rows = [rows[first:last] for rows, (first, last) in zip(parts, limits, strict=True)]
    return b"".join([np.array(list(map(len, rows)), "<u8").tobytes(), *(r.tobytes() for r in rows)])


@contextmanager
def _opened(comm: MPI.Intracomm, place: Path, path: Path, size: int) -> Iterator[MPI.File]:
    """Open a file of all ranks for a block without calls of all ranks; errors name `path`.

    All ranks make all calls, even if one fails; then all raise.
    """
    error: BaseException | None = None

    @contextmanager
    def kept() -> Iterator[None]:
        """Keep the first error."""
        nonlocal error
        try:
            yield
        except MPI.Exception as raised:
            error = error or OSError(f"{path}: {_sentence(raised.Get_error_string())}")
        except BaseException as raised:
            error = error or raised

    with kept():
        file = MPI.File.Open(comm, os.fspath(place), MPI.MODE_CREATE | MPI.MODE_WRONLY)
    raise_together(comm, error)
    with kept():
        file.Set_size(size)
    with kept():
        yield file
    with kept():
        file.Sync()
    with kept():
        file.Close()
    raise_together(comm, error)


def _sentence(text: str) -> str:
    """The last of several lines of an error of MPI, without the name of a function."""
    last = text.strip().rpartition("\n")[2]
    return last.partition(": ")[2] or last


@contextmanager
def _removed_after_errors(new: NewFile | None) -> Iterator[None]:
    try:
        yield
    except BaseException:
        if new is not None:
            new.discard()
        raise


def read(comm: MPI.Intracomm, path: Path) -> tuple[bytes, int, list[NDArray[Any]]]:
    """Return the settings, the end of the ids, and the `PARTS` of this rank's range of ids.

    A rank gets the contacts of its particles with those of others, too.
    """
    with together(comm):
        if path.exists() and not path.is_file() and not path.is_dir():
            raise ValueError(f"{path} is a pipe or a device, not a file")
        with path.open("rb") as file:
            settings, end, chunks = _read_chunks(file, path, comm.rank, comm.size)
        parts = [
            np.concatenate([np.zeros(0, kind), *(rows[part] for rows in chunks)])
            for part, kind in enumerate(PARTS)
        ]
    for number in PAIRS:
        rows = parts[number]
        homes = [_ranks_of(rows[name], comm.size, end, _CHUNK) for name in ("id", "other")]
        is_shared = homes[0] != homes[1]
        parts[number] = np.concatenate([rows, send(comm, rows[is_shared], homes[1][is_shared])])
    return settings, end, parts


def _read_chunks(
    file: Any, path: Path, rank: int, size: int
) -> tuple[bytes, int, list[list[NDArray[Any]]]]:
    """Return the settings, the end of the ids, and the rows of each of this rank's chunks."""
    head = np.frombuffer(file.read(_HEAD.itemsize).ljust(_HEAD.itemsize, b"\0"), _HEAD)[0]
    if head["magic"] != _MAGIC.rstrip(b"\0"):
        raise ValueError(f"{path} is not a file of jostle.mpi.World.save")
    if head["version"] != _VERSION:
        raise ValueError(
            f"{path} has format {head['version']}; this version of jostle reads {_VERSION}"
        )
    end, length = int(head["next"]), int(head["settings"])
    count = -(-end // _CHUNK)
    found = os.fstat(file.fileno()).st_size
    chunks_at = _HEAD.itemsize + length + count * _ENTRY.itemsize
    settings, table = (file.read(size) if chunks_at <= found else b""
                       for size in (length, count * _ENTRY.itemsize))  # fmt: skip
    entries = np.frombuffer(table, _ENTRY)
    if chunks_at + int(entries["size"].sum()) != found:
        raise ValueError(f"{path} is cut off, or has something after its end")
    first, last = _chunks_of(rank, size, end)
    file.seek(int(entries["size"][:first].sum()), os.SEEK_CUR)
    chunks = []
    for number in range(first, last):
        chunk = file.read(int(entries[number]["size"]))
        rows = _rows_of(chunk) if checksum(chunk) == entries[number]["checksum"] else None
        if rows is None or not _are_ids(rows[0]["id"], number):
            raise ValueError(
                f"{path} is damaged: the particles from {number * _CHUNK} on are not as written"
            )
        chunks.append(rows)
    return settings, end, chunks


def _are_ids(ids: NDArray[np.int64], number: int) -> bool:
    """Whether ids may be those of a chunk: ascending, in its range."""
    before, after = number * _CHUNK - 1, (number + 1) * _CHUNK
    return bool((np.diff(ids, prepend=before, append=after) > 0).all())


def _rows_of(chunk: bytes) -> list[NDArray[Any]]:
    """The rows of all parts in a chunk."""
    counts = np.frombuffer(chunk[: 8 * len(PARTS)], "<u8").tolist()
    sizes = [count * kind.itemsize for count, kind in zip(counts, PARTS, strict=True)]
    ends = np.cumsum([8 * len(PARTS), *sizes]).tolist()
    return [
        np.frombuffer(chunk[start:end], kind)
        for start, end, kind in zip(ends, ends[1:], PARTS, strict=False)
    ]
