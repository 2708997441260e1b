"""The command `jostle tune`: sweeps with a progress bar, then tables, CSV and pictures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from jostle_lab.tables import print_whole
from jostle_lab.tune import records
from jostle_lab.tune.candidates import Work
from jostle_lab.tune.report import report, title
from jostle_lab.tune.sweep import QUICK, THOROUGH, Tuner, Tuning

SWEEPS = ("leaf capacity × depth", "final", "world size", "number of particles")
NOTHING = "Stopped before anything was measured; no file was written."


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
    """Run all sweeps, and show the results; Ctrl-C ends the sweeps and shows the rest.

    Parameters
    ----------
    scene, n, seed
        The particles.
    out
        A folder, made when there are results; the files are named after the scene.
    console
        Output of progress, tables and names of the files.
    work, threads
        The timed call, the search for pairs or a step, and its threads, None for all cores.
    rounds, quick
        Number of rounds, and whether to use the smaller effort.

    Returns
    -------
    bool
        Whether it was completed.
    """
    effort = QUICK if quick else THOROUGH
    if rounds is not None:
        effort = replace(effort, rounds=rounds)
    try:
        tuner = Tuner(scene, n, work=work, threads=threads, effort=effort, seed=seed)
    except KeyboardInterrupt:
        console.print(NOTHING)
        return False
    tuning = tuner.tuning
    console.print(f"[bold]{title(tuning)}[/]", highlight=False)
    finished = _sweep(tuner, console)
    if not finished and not _measured(tuning):
        console.print(NOTHING)
        return False
    if not finished:
        console.print("Stopped. Results so far:")
    *parts, last = [*report(tuning)] or [""]
    for part in parts:
        if isinstance(part, str):
            console.print(part, highlight=False)
        else:
            print_whole(part, console)
        console.print()
    try:
        for name, path in _write(tuning, out):
            console.print(f"{name:10}{path}", highlight=False, soft_wrap=True)
    finally:
        console.print("", last, sep="\n", highlight=False, soft_wrap=True)
    return finished


def files(scene: str, work: Work, out: Path) -> list[Path]:
    """Return the files of a tuning: the CSV, the map and the curves."""
    stem = scene if work == "pairs" else f"{scene}-step"
    return [out / f"tune-{stem}{end}" for end in (".csv", "-settings.png", "-particles.png")]


def _measured(tuning: Tuning) -> bool:
    return any(o.rounds for _, outcomes in tuning.sweeps() for o in outcomes.values())


def _sweep(tuner: Tuner, console: Console) -> bool:
    steps = (tuner.settings, tuner.final, tuner.sizes, tuner.counts)
    sweeps = dict(zip(SWEEPS, steps, strict=True))
    with _progress(console) as progress:
        tasks: dict[str, TaskID] = {
            name: progress.add_task(name, total=None, start=False)
            for name in (SWEEPS[-1:] if tuner.tuning.one_leaf() else SWEEPS)
        }

        def watch(name: str, done: int, total: int) -> None:
            if done == 0:
                progress.start_task(tasks[name])
            progress.update(tasks[name], completed=done, total=total)

        try:
            for name, sweep in sweeps.items():
                if name in tasks:
                    sweep(watch)
        except KeyboardInterrupt:
            return False
    return True


def _write(tuning: Tuning, out: Path) -> list[tuple[str, Path]]:
    """Write the CSV and the pictures that have data."""
    from jostle_lab.tune import pictures

    table, *images = files(tuning.scene, tuning.work, out)
    out.mkdir(parents=True, exist_ok=True)
    records.write(tuning, table)
    written = [("csv", table)]
    for picture, draw in zip(images, (pictures.settings, pictures.curves), strict=True):
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
