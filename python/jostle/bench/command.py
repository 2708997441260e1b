"""The command `jostle bench`: short comparisons, a progress bar, tables, and a file on request."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from jostle import interrupt
from jostle.bench import pairs, steps
from jostle.bench.machine import Results, Row, describe, version_of
from jostle.tables import print_whole

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
class Race:
    """What is raced on one scene."""

    kind: str
    scene: str
    counts: Sequence[int]

    def run(
        self, rounds: int, threads: Sequence[int], told: Callable[[str], None]
    ) -> Iterator[list[Row]]:
        """Yield the rows of each size."""
        race = pairs.race if self.kind == "pairs" else steps.race
        return race(self.scene, self.counts, rounds, PATIENCE[self.kind], threads, told=told)


def races(largest: int) -> list[Race]:
    """Return the races up to a number of shapes; steps are raced up to a fifth of it."""
    counts = [SMALLEST * 10**power for power in range(7) if SMALLEST * 10**power < largest]
    counts.append(largest)
    fewer = [count for count in counts if 5 * count <= largest] or counts[:1]
    return [Race("pairs", scene, counts) for scene in PAIR_SCENES] + [
        Race("step", scene, fewer) for scene in steps.SCENES
    ]


def bench(
    largest: int, rounds: int, threads: Sequence[int], csv: Path | None, console: Console
) -> bool:
    """Race whatever is installed; Ctrl-C ends the races and shows what was measured.

    Returns
    -------
    bool
        Whether it came to its end.

    Raises
    ------
    OSError
        Where the file cannot be written; the tables are shown before.
    """
    todo = races(largest)
    for line in (describe(), who_is_there(), sizes(todo)):
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
    todo: Sequence[Race],
    rounds: int,
    threads: Sequence[int],
    results: Results | None,
    console: Console,
) -> bool:
    columns = BarColumn(20), TextColumn("{task.description}"), TimeElapsedColumn()
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=sum(len(race.counts) for race in todo))
        for race in todo:
            rows: list[Row] = []
            try:
                for group in race.run(
                    rounds, threads, lambda text: bar.update(task, description=text)
                ):
                    rows += group
                    if results:
                        with interrupt.held():  # no row is written in part
                            results.add([_kept(race, row) for row in group])
                    bar.advance(task)
            except KeyboardInterrupt:
                return False
            finally:
                if rows:
                    console.print(title(race))
                    print_whole(table(race, rows), console)
    return True


def _kept(race: Race, row: Row) -> Row:
    """Return the columns of the file."""
    return {"kind": race.kind} | {column: row[column] for column in KEPT}


def sizes(todo: Sequence[Race]) -> str:
    """Say how many shapes are raced, and why steps stop earlier."""
    most, fewer = todo[0].counts[-1], todo[-1].counts[-1]
    if fewer == most:
        return f"pairs and steps of up to {most:,} shapes"
    words = "steps, which take longer, are run at up to a fifth of that and at 1,000 at least: here"
    return f"pairs of up to {most:,} shapes; {words} up to {fewer:,}"


def who_is_there() -> str:
    """Say which other libraries take part, and which would if they were installed."""
    versions = {package: version_of(package) for package in OTHERS}
    there = ", ".join(f"{package} {version}" for package, version in versions.items() if version)
    missing = ", ".join(package for package, version in versions.items() if not version)
    return f"beside {there or 'nothing'}" + (f"; not installed: {missing}" if missing else "")


def title(race: Race) -> str:
    """Say what a table shows."""
    what = "all pairs" if race.kind == "pairs" else "one step, positions read"
    return f"\n[bold]{race.scene}[/bold]: {what}; ns a shape (× jostle on one thread)"


def table(race: Race, rows: list[Row]) -> Table:
    """Show nanoseconds for each shape, and how many times as long as the first row they are."""
    shown = Table(box=None, padding=(0, 2, 0, 0))
    shown.add_column("", style="cyan", no_wrap=True)
    counts = [n for n in race.counts if any(row["count"] == n and row["rounds"] for row in rows)]
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
    """Return the name of a row, with its threads, and how positions were read where that tells."""
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
