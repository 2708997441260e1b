"""The way through a tuning: sweeps under a progress bar, then tables, CSV and pictures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from jostle.tune import records
from jostle.tune.contenders import Work
from jostle.tune.report import report, title
from jostle.tune.sweep import QUICK, THOROUGH, Tuner, Tuning

SWEEPS = ("leaf capacity × depth", "final", "world size", "number of particles")


def tune(
    scene: str,
    n: int,
    out: Path,
    console: Console,
    *,
    work: Work = "pairs",
    threads: int | None = None,
    rounds: int | None = None,
    quick: bool = False,
    seed: int = 0,
) -> bool:
    """Run all sweeps, and show what came of it; Ctrl-C ends the sweeps and shows the rest.

    Parameters
    ----------
    scene, n, seed
        Which particles.
    out
        A folder that exists; the files are named for the scene.
    console
        Where progress, tables and the names of the files go.
    work, threads
        What is timed: finding pairs or a whole step; on how many threads, None for all cores.
    rounds, quick
        How much effort is made.

    Returns
    -------
    bool
        Whether it came to its end.
    """
    effort = QUICK if quick else THOROUGH
    if rounds is not None:
        effort = replace(effort, rounds=rounds)
    tuner = Tuner(scene, n, work=work, threads=threads, effort=effort, seed=seed)
    console.print(f"[bold]{title(tuner.tuning)}[/]", highlight=False)
    finished = _sweep(tuner, console)
    if not finished:
        console.print("Stopped. What was measured until then:")
    for part in report(tuner.tuning):
        console.print(part, "", sep="\n", highlight=False)
    for name, path in _write(tuner.tuning, out):
        console.print(f"{name:10}{path}", highlight=False, soft_wrap=True)
    return finished


def _sweep(tuner: Tuner, console: Console) -> bool:
    with _progress(console) as progress:
        tasks: dict[str, TaskID] = {
            name: progress.add_task(name, total=None, start=False) for name in SWEEPS
        }

        def watch(name: str, done: int, total: int) -> None:
            if done == 0:
                progress.start_task(tasks[name])
            progress.update(tasks[name], completed=done, total=total)

        try:
            for sweep in (tuner.settings, tuner.final, tuner.sizes, tuner.counts):
                sweep(watch)
        except KeyboardInterrupt:
            return False
    return True


def _write(tuning: Tuning, out: Path) -> list[tuple[str, Path]]:
    """Write the CSV and the pictures that there is something to show in."""
    from jostle.tune import pictures

    stem = tuning.scene if tuning.work == "pairs" else f"{tuning.scene}-step"
    table = out / f"tune-{stem}.csv"
    records.write(tuning, table)
    written = [("csv", table)]
    for name, draw in (("settings", pictures.settings), ("particles", pictures.curves)):
        picture = out / f"tune-{stem}-{name}.png"
        if draw(tuning, picture):
            written.append(("picture", picture))
    return written


def _progress(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description:22}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        console=console,
    )
