"""The command `jostle bench`: short comparisons, a progress bar, tables, and a file on request."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pairs
import steps
from machine import Results, Row, describe, version_of
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from jostle_lab import interrupt
from jostle_lab.tables import print_whole

__all__ = ["bench"]

SMALLEST = 1_000
PAIR_SCENES = ("discs", "mixed", "clusters", "rectangles")
PATIENCE = {"pairs": 0.3, "step": 0.1}
"""Seconds that one answer, or one frame, may take; slower libraries are omitted."""

OTHERS = ("scipy", "shapely", "matscipy", "vesin", "fastquadtree", "pyqtree", "pymunk", "pyb2d3")
KEPT = (
    *("scene", "count", "name", "version", "threads", "manner", "setting"),
    *("rounds", "median_s", "low_s", "high_s", "note"),
)


@dataclass(frozen=True)
class Comparison:
    """A comparison on one scene."""

    kind: str
    scene: str
    counts: Sequence[int]

    def run(
        self, rounds: int, threads: Sequence[int], report: Callable[[str], None]
    ) -> Iterator[list[Row]]:
        """Yield the rows of each size."""
        compare = pairs.compare if self.kind == "pairs" else steps.compare
        return compare(self.scene, self.counts, rounds, PATIENCE[self.kind], threads, report=report)


def comparisons(largest: int) -> list[Comparison]:
    """Return the comparisons up to a number of shapes; of steps, up to a fifth of it."""
    counts = [SMALLEST * 10**power for power in range(7) if SMALLEST * 10**power < largest]
    counts.append(largest)
    fewer = [count for count in counts if 5 * count <= largest] or counts[:1]
    return [Comparison("pairs", scene, counts) for scene in PAIR_SCENES] + [
        Comparison("step", scene, fewer) for scene in steps.SCENES
    ]


def bench(
    largest: int, rounds: int, threads: Sequence[int], csv: Path | None, console: Console
) -> bool:
    """Compare the installed libraries; Ctrl-C ends the comparison and shows the results so far.

    Returns
    -------
    bool
        Whether it was completed.

    Raises
    ------
    OSError
        If the file cannot be written; the tables are shown before.
    """
    todo = comparisons(largest)
    for line in (describe(), libraries(), sizes(todo)):
        console.print(line, highlight=False, soft_wrap=True)
    results = Results(csv) if csv else None
    finished = _run(todo, rounds, threads, results, console)
    if not finished:
        console.print("Stopped.")
    if results and results.count:
        rows = f"{results.count} rows" if results.count > 1 else "1 row"
        console.print(f"{rows} written to {results.path}", highlight=False, soft_wrap=True)
    return finished


def _run(
    todo: Sequence[Comparison],
    rounds: int,
    threads: Sequence[int],
    results: Results | None,
    console: Console,
) -> bool:
    columns = BarColumn(20), TextColumn("{task.description}"), TimeElapsedColumn()
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=sum(len(comparison.counts) for comparison in todo))
        for comparison in todo:
            rows: list[Row] = []
            try:
                for group in comparison.run(
                    rounds, threads, lambda text: bar.update(task, description=text)
                ):
                    rows += group
                    if results:
                        with interrupt.held():  # no row is written in part
                            results.add([_kept(comparison, row) for row in group])
                    bar.advance(task)
            except KeyboardInterrupt:
                return False
            finally:
                if rows:
                    console.print(title(comparison))
                    print_whole(table(comparison, rows), console)
    return True


def _kept(comparison: Comparison, row: Row) -> Row:
    """Return the columns of the file."""
    return {"kind": comparison.kind} | {column: row[column] for column in KEPT}


def sizes(todo: Sequence[Comparison]) -> str:
    """Return the numbers of shapes."""
    most, fewer = todo[0].counts[-1], todo[-1].counts[-1]
    if fewer == most:
        return f"pairs and steps of up to {most:,} shapes"
    return f"pairs of up to {most:,} shapes; steps of up to {fewer:,} (a fifth, at least 1,000)"


def libraries() -> str:
    """Return the names of the compared libraries, and of those that are not installed."""
    versions = {package: version_of(package) for package in OTHERS}
    there = ", ".join(f"{package} {version}" for package, version in versions.items() if version)
    missing = ", ".join(package for package, version in versions.items() if not version)
    return f"compared with {there or 'nothing'}" + (
        f"; not installed: {missing}" if missing else ""
    )


def title(comparison: Comparison) -> str:
    """Return the title of a table."""
    what = "all pairs" if comparison.kind == "pairs" else "one step and reading the positions"
    return f"\n[bold]{comparison.scene}[/bold]: {what}; ns per shape (× jostle on one thread)"


def table(comparison: Comparison, rows: list[Row]) -> Table:
    """Return nanoseconds per shape, and the ratio to the first row."""
    shown = Table(box=None, padding=(0, 2, 0, 0))
    shown.add_column("", style="cyan", no_wrap=True)
    counts = [
        n for n in comparison.counts if any(row["count"] == n and row["rounds"] for row in rows)
    ]
    for count in counts:
        shown.add_column(f"{count:,}", justify="right", no_wrap=True)
    lines: dict[str, dict[object, Row]] = {}
    for row in rows:
        lines.setdefault(label(row), {})[row["count"]] = row
    first = next(iter(lines.values()), {})
    for name, cells in lines.items():
        if any(row["rounds"] for row in cells.values()):
            shown.add_row(name, *(cell(cells.get(n), first.get(n)) for n in counts))
    return shown


def label(row: Row) -> str:
    """Return the name of a row, with its threads and the way in which positions are read."""
    threads = "" if row["threads"] == 1 else f", {row['threads']} threads"
    manner = f", {row['manner']}" if row["manner"] in ("batch", "body by body") else ""
    return f"{row['name']}{manner}{threads}"


def cell(row: Row | None, first: Row | None) -> str:
    """Return a time and its ratio."""
    if row is None or not row["rounds"] or first is None:
        return "–"
    median, base = float(str(row["median_s"])), float(str(first["median_s"]))
    ratio = median / base
    times = f"{ratio:,.0f}" if ratio >= 10 else f"{ratio:.2g}"
    return f"{1e9 * median / int(str(row['count'])):,.0f} (×{times})"
