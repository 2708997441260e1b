"""What the figures were measured on, and where they are kept."""

from __future__ import annotations

import csv
import os
import platform
import re
from pathlib import Path

RESULTS = Path(__file__).parent / "results"


def cpu() -> str:
    """The processor's own name for itself, as far as it gives one."""
    info = Path("/proc/cpuinfo")
    if info.exists() and (match := re.search(r"model name\s*:\s*(.+)", info.read_text())):
        return match.group(1).strip()
    return platform.processor() or platform.machine()


def describe() -> str:
    """One line: processor, cores, system, Python."""
    system = f"{platform.system()} {platform.machine()}"
    return f"{cpu()}, {os.cpu_count()} cores, {system}, Python {platform.python_version()}"


def slug() -> str:
    """A file name for the results of this kind of machine."""
    words = re.sub(r"[^A-Za-z0-9]+", "-", f"{cpu()} {os.cpu_count()} cores").strip("-")
    return words.lower()


def write(kind: str, rows: list[dict[str, object]]) -> None:
    """Keep the rows of one benchmark, in place of this machine's earlier ones."""
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / f"{kind}-{slug()}.csv"
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(f"\nwritten to benchmarks/results/{path.name}")
