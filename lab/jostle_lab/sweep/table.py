"""The table of results: a CSV file with one row for each run, which a later sweep continues."""

import csv
import io
import os
from collections.abc import Sequence
from pathlib import Path

from jostle.writing import append

from .plan import Run


class TableError(ValueError):
    """A file that does not belong to the sweep."""


class Table:
    """The rows of a file, and those that are added to it."""

    def __init__(self, path: Path, runs: Sequence[Run]) -> None:
        keys = list(runs[0].key)
        self._path = path
        self._columns = [*keys, *runs[0].measures, "hash", "seconds"]
        self._done = {self._key(row, keys) for row in self._read()}
        self.left = [run for run in runs if tuple(run.key.values()) not in self._done]

    @staticmethod
    def _key(row: dict[str, str], keys: Sequence[str]) -> tuple[str, ...]:
        return tuple(row[name] for name in keys)

    def _read(self) -> list[dict[str, str]]:
        """The complete rows of the file, which is begun if there is none."""
        if not self._path.exists() or self._path.stat().st_size == 0:
            self._write(self._columns)
            return []
        text = self._path.read_bytes().decode("utf-8", errors="replace")
        whole = text[: text.rfind("\n") + 1]
        rows = list(csv.reader(io.StringIO(whole)))
        if not rows or rows[0] != self._columns:
            raise TableError(
                f"--out is {str(self._path)!r}, which has other columns than this sweep: "
                "name a new file, or repeat the options with which it was begun"
            )
        if whole != text:
            # A sweep was killed while it wrote this row.
            os.truncate(self._path, len(whole.encode("utf-8")))
        columns = rows[0]
        return [
            dict(zip(columns, row, strict=True)) for row in rows[1:] if len(row) == len(columns)
        ]

    def add(self, row: dict[str, str]) -> None:
        """Append the row of a run; it is on disk before the next one."""
        self._write([row[name] for name in self._columns])

    def _write(self, cells: Sequence[str]) -> None:
        row = io.StringIO()
        csv.writer(row, lineterminator="\n").writerow(cells)
        append(self._path, row.getvalue().encode("utf-8"))
