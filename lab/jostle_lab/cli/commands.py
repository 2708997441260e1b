"""The commands, their options, and the rules of these."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from rich.table import Table

import jostle
from jostle_lab import interrupt
from jostle_lab.launcher import is_started_by_mpi
from jostle_lab.simulate.settings import (
    METHODS,
    RENDERERS,
    RULES,
    SEED,
    STEPS,
    THREADS,
    Settings,
)
from jostle_lab.simulate.validation import one_of, whole

from .refusals import (
    INSTALL,
    check_extra,
    check_file,
    check_folder,
    check_new_file,
    check_option,
    check_scene,
    console,
    refuse,
)
from .runs import has_display, read_settings, record, run_on_ranks, show

DEFAULT_SCENE = "mixed"
TUNED = whole(1, 2_000_000)  # particles
SHAPES = whole(10, 10_000_000)  # shapes
ROUNDS = whole(1, 1_000)
SEEDS = whole(1, 1_000_000)
SWEPT = whole(1, 1_000_000_000)
WARM_UP = whole(0, 1_000_000_000)
WORKERS = whole(1, 10_000)

app = typer.Typer(
    help="A quadtree that finds every touching pair, and a particle simulator.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        console.print(f"jostle {jostle.__version__}", highlight=False)
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    pass


@app.command()
def scenes() -> None:
    """List the scenes."""
    table = Table(show_header=True, header_style="bold", box=None, padding=(0, 2, 0, 0))
    table.add_column("scene", style="cyan", no_wrap=True)
    table.add_column("particles", justify="right")
    table.add_column("description")
    for name in jostle.scenes.names():
        count = jostle.scenes.default_count(name)
        table.add_row(name, f"{count:,}", jostle.scenes.describe(name))
    console.print(table)


@app.command()
def run(
    scene: Annotated[
        str | None,
        typer.Argument(help=f"A scene, as `jostle scenes` lists them.  [default: {DEFAULT_SCENE}]"),
    ] = None,
    n: Annotated[
        int | None,
        typer.Option("-n", help="Number of particles; the default of the scene if not given."),
    ] = None,
    method: Annotated[
        str | None, typer.Option(help=f"One of {', '.join(METHODS)}.  [default: {Settings.method}]")
    ] = None,
    leaf_capacity: Annotated[
        int | None, typer.Option(help="Maximum number of particles in a leaf of the tree.")
    ] = None,
    max_depth: Annotated[int | None, typer.Option(help="Maximum depth of the tree.")] = None,
    seed: Annotated[
        int | None, typer.Option(help="The same seed gives the same run.  [default: 0]")
    ] = None,
    config_file: Annotated[
        Path | None,
        typer.Option("--config", help="A TOML file with settings; options override them."),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(help="Number of steps; without a window, 10 s of video if not given."),
    ] = None,
    renderer: Annotated[
        str | None, typer.Option(help="Renderer of the window: auto, opengl or software.")
    ] = None,
    headless: Annotated[
        bool, typer.Option("--headless", help="Record a video instead of opening a window.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Folder for the video and the picture.")] = Path("out"),
    mpi: Annotated[
        bool, typer.Option("--mpi", help="Run over the ranks of MPI, as if mpirun starts several.")
    ] = False,
    checkpoint: Annotated[
        int | None, typer.Option(help="Steps between checkpoints of a run over ranks.")
    ] = None,
    resume: Annotated[
        Path | None, typer.Option(help="A checkpoint to continue, on any number of ranks.")
    ] = None,
) -> None:
    """Run a scene in a window, or record a video if there is no display."""
    if scene is not None:
        check_scene(scene)
    options: dict[str, Any] = {
        **{"scene": scene, "n": n, "seed": seed, "method": method},
        **{"leaf_capacity": leaf_capacity, "max_depth": max_depth},
    }
    given = {name: value for name, value in options.items() if value is not None}
    for name, value in given.items():
        check_option(name, value, RULES[name])
    check_option("steps", steps, STEPS)
    check_option("renderer", renderer, one_of(*RENDERERS))
    check_extra()
    config = read_settings(config_file)
    settings = replace(config.settings, **given)
    if mpi or is_started_by_mpi():
        check_option("checkpoint", checkpoint, STEPS)
        run_on_ranks(settings, config, steps, out, checkpoint, resume)
        return
    for option, value in (("--checkpoint", checkpoint), ("--resume", resume)):
        if value is not None:
            refuse(f"{option} is for runs over ranks; add --mpi, or start the command with mpirun")
    why_no_window = None
    if not headless:
        why_no_window = (
            show(settings, steps, renderer or config.renderer or RENDERERS[0], config)
            if has_display()
            else "there is no display"
        )
        if why_no_window is None:
            return
    if renderer == "opengl":
        refuse("--renderer is 'opengl', but a video is drawn in software")
    check_folder(out)
    if why_no_window is not None:
        console.print(f"No window ({why_no_window}); recording a video instead.")
    record(settings, steps, out, config)


@app.command()
def tour(
    out: Annotated[Path, typer.Option(help="Folder for the pictures and videos.")] = Path("out"),
    only: Annotated[
        list[str] | None, typer.Option(help="A single stop; may be given repeatedly.")
    ] = None,
    stills: Annotated[bool, typer.Option("--stills", help="Make no videos.")] = False,
) -> None:
    """Make pictures and short videos of the simulator, without a display."""
    check_extra("imgui_bundle")
    from tour.tour import names, show_tour

    for name in only or []:
        if name not in names():
            refuse(f"there is no stop {name!r}; the stops are {', '.join(names())}")
    check_folder(out)
    try:
        with interrupt.raised():
            show_tour(out, only or [], films=not stills, console=console)
    except OSError as error:
        refuse(f"the tour could not be written: {str(error).splitlines()[0]}")


@app.command()
def tune(
    scene: Annotated[str, typer.Argument(help="A scene, as `jostle scenes` lists them.")],
    n: Annotated[int, typer.Option("-n", "--n", help="Number of particles.")] = 10_000,
    rounds: Annotated[
        int | None, typer.Option(help="Maximum number of rounds of each sweep, as time allows.")
    ] = None,
    threads: Annotated[
        int | None, typer.Option(help="Threads of each call; all cores if not given.")
    ] = None,
    step: Annotated[
        bool,
        typer.Option("--step", help="Time steps of the world instead of the search for pairs."),
    ] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="About 15 s instead of up to two minutes.")
    ] = False,
    seed: Annotated[int, typer.Option(help="The same seed gives the same particles.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for the CSV and the pictures.")] = Path("out"),
) -> None:
    """Find the best settings for a scene: leaf capacity, depth, world size, particles."""
    check_scene(scene)
    check_option("n", n, TUNED)
    check_option("rounds", rounds, ROUNDS)
    check_option("threads", threads, THREADS)
    check_option("seed", seed, SEED)
    if importlib.util.find_spec("matplotlib") is None:
        refuse(INSTALL.format("matplotlib"))
    from jostle_lab.tune import command

    work: Literal["step", "pairs"] = "step" if step else "pairs"
    check_folder(out, make=False)
    for path in command.files(scene, work, out):
        check_file("--out", path)
    try:
        with interrupt.raised():
            finished = command.tune(
                *(scene, n, out, console),
                work=work,
                threads=threads,
                rounds=rounds,
                quick=quick,
                seed=seed,
            )
    except OSError as error:
        refuse(f"the tuning could not be written: {str(error).splitlines()[0]}")
    if not finished:
        raise typer.Exit(interrupt.CODE)


@app.command()
def bench(
    n: Annotated[
        int,
        typer.Option(
            "-n", help="Maximum number of shapes; for steps a fifth of it, at least 1,000."
        ),
    ] = 100_000,
    rounds: Annotated[int, typer.Option(help="Number of timings of each.")] = 9,
    threads: Annotated[
        int, typer.Option(help="Maximum number of threads, in addition to one.")
    ] = 2,
    csv: Annotated[Path | None, typer.Option(help="A new file for the results.")] = None,
) -> None:
    """Compare jostle with other installed libraries on this machine."""
    import command

    check_option("n", n, SHAPES)
    check_option("rounds", rounds, ROUNDS)
    check_option("threads", threads, THREADS)
    if csv is not None:
        check_new_file("--csv", csv)
    try:
        with interrupt.raised():
            finished = command.bench(n, rounds, sorted({1, threads}), csv, console)
    except OSError as error:
        refuse(f"the results could not be written: {str(error).splitlines()[0]}")
    if not finished:
        raise typer.Exit(interrupt.CODE)


@app.command()
def sweep(
    scene: Annotated[str, typer.Argument(help="A scene, as `jostle scenes` lists them.")],
    out: Annotated[
        Path, typer.Option(help="CSV file with one row a run; an existing one is continued.")
    ],
    n: Annotated[
        int | None,
        typer.Option("-n", help="Number of particles; the default of the scene if not given."),
    ] = None,
    given: Annotated[
        list[str] | None,
        typer.Option("--set", help="NAME=FIRST:LAST:COUNT or NAME=VALUE,VALUE; repeatedly."),
    ] = None,
    seeds: Annotated[int, typer.Option(help="Number of seeds of each combination.")] = 1,
    steps: Annotated[int, typer.Option(help="Steps of each run that are measured.")] = 600,
    warm_up: Annotated[int, typer.Option(help="Steps before these.")] = 0,
    measure: Annotated[
        list[str] | None,
        typer.Option(help="What to measure; repeatedly.  [default: energy and pressure]"),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help="Processes; one for each core if not given.")
    ] = None,
) -> None:
    """Simulate a scene with all combinations of settings and seeds, in many processes."""
    from jostle_lab.sweep import command
    from jostle_lab.sweep.measures import MEASURES
    from jostle_lab.sweep.plan import PlanError, plan
    from jostle_lab.sweep.table import TableError

    check_scene(scene)
    check_option("n", n, RULES["n"])
    for name, count, rule in (
        ("seeds", seeds, SEEDS),
        ("steps", steps, SWEPT),
        ("warm_up", warm_up, WARM_UP),
        ("workers", workers, WORKERS),
    ):
        check_option(name, count, rule)
    measures = list(dict.fromkeys(measure or ["energy", "pressure"]))
    for name in measures:
        check_option("measure", name, one_of(*MEASURES))
    try:
        runs = plan(scene, n, given or [], seeds, steps, warm_up, measures)
        check_file("--out", out)
        finished = command.sweep(runs, out, workers, console)
    except (PlanError, TableError) as error:
        refuse(str(error))
    except OSError as error:
        refuse(f"--out is {str(out)!r}, where no file can be written: {error.strerror}")
    except (ValueError, MemoryError) as error:
        refuse(f"a run failed: {error}")
    if not finished:
        raise typer.Exit(interrupt.CODE)
