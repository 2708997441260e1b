"""The command `jostle sweep`: a progress bar, and a file of results."""

from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from jostle_lab import interrupt

from .plan import Run
from .table import Table
from .workers import executor, results

__all__ = ["sweep"]


def sweep(runs: list[Run], out: Path, workers: int | None, console: Console) -> bool:
    """Do the runs that are not in the file yet. After Ctrl-C the file has the runs so far.

    Returns
    -------
    bool
        Whether all runs are in the file.
    """
    with executor(workers) as pool:
        if pool is None:
            return True
        table = Table(out, runs)
        before = len(runs) - len(table.left)
        if before:
            console.print(f"{before} of {len(runs)} runs are in {out} already.", highlight=False)
        try:
            with Progress(console=console) as bar, interrupt.raised():
                task = bar.add_task(f"{len(runs):,} runs", total=len(runs), completed=before)
                for row in results(*pool, table.left):
                    table.add(row)
                    bar.advance(task)
        except KeyboardInterrupt:
            console.print(f"Stopped. The same command continues the table in {out}.")
            return False
    console.print(f"table    {out}", highlight=False, soft_wrap=True)
    return True
