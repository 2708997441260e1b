"""The description of the machine, and the file of results."""

from __future__ import annotations

import csv
import io
import os
import platform
import re
from importlib import metadata
from pathlib import Path

import numpy as np

import jostle
from jostle import _core
from jostle.writing import append, write

__all__ = ["Results", "Row", "cpu", "describe", "slug", "version_of"]

Row = dict[str, object]


def cpu() -> str:
    """Return the name of the processor."""
    info = Path("/proc/cpuinfo")
    if info.exists() and (match := re.search(r"model name\s*:\s*(.+)", info.read_text())):
        return match[1].strip()
    return platform.processor() or platform.machine()


def cores() -> int:
    """Return the number of cores available to this process."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def describe() -> str:
    """Return processor, vector instructions, cores, system, Python and NumPy in one line."""
    system = f"{platform.system()} {platform.machine()}"
    python = f"Python {platform.python_version()}, NumPy {np.__version__}"
    return f"{cpu()}, {_core.instructions()}, {cores()} cores, {system}, {python}"


def slug() -> str:
    """Return a file name for this machine."""
    name = f"{cpu()} {_core.instructions()} {cores()} cores"
    return re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-").lower()


def version_of(package: str) -> str | None:
    """Return the installed version of a package, or None."""
    if package == "jostle":
        return jostle.__version__
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


class Results:
    """A CSV file written row by row, so that an interrupted run keeps its results."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.count = 0
        self._columns: list[str] = []

    def add(self, rows: list[Row]) -> None:
        """Append rows; the first begins the file with a header."""
        for row in rows:
            whole = {**row, "machine": describe()}
            begins = not self._columns
            self._columns = self._columns or list(whole)
            if begins:
                self.path.parent.mkdir(parents=True, exist_ok=True)
            lines = io.StringIO()
            writer = csv.DictWriter(lines, self._columns, lineterminator="\n")
            if begins:
                writer.writeheader()
            writer.writerow(whole)
            put = write if begins else append
            put(self.path, lines.getvalue().encode("utf-8"))
            self.count += 1
