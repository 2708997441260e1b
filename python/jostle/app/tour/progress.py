"""The output of the command `jostle tour`: a progress bar, and a table at its end."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from jostle.app.tour.tour import RATE, Visit, names, tour

LONGEST_NAME = max(map(len, names()))


def show_tour(out: Path, chosen: Sequence[str], *, films: bool, console: Console) -> None:
    """Run the tour, and print the results."""
    visits: list[Visit] = []
    with _progress(console) as progress:
        task = progress.add_task("", total=len(set(chosen) or names()))

        def say(name: str) -> None:
            progress.update(task, description=name.ljust(LONGEST_NAME))

        for visit in tour(out, chosen, films=films, coming=lambda stop: say(stop.name)):
            visits.append(visit)
            progress.advance(task)
        say("")
    console.print(_table(visits))
    console.print(f"in {out}", highlight=False, soft_wrap=True)


def _progress(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
    )


def _table(visits: Sequence[Visit]) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column("stop", style="cyan", no_wrap=True)
    table.add_column("description")
    for name in ("picture", "video", "time"):
        table.add_column(name, justify="right", no_wrap=True)
    for visit in visits:
        film = visit.film and f"{visit.pictures / RATE:.1f} s, {_size(visit.film)}"
        table.add_row(
            *(visit.stop.name, visit.stop.sentence),
            *(_size(visit.still), film or "\u2013", f"{visit.seconds:.1f} s"),
        )
    return table


def _size(path: Path) -> str:
    size = path.stat().st_size
    return f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{size / 1e3:.0f} KB"
