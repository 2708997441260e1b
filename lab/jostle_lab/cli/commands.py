"""The commands, their options, and the rules of these."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

import jostle
from jostle_lab import interrupt
from jostle_lab.launcher import is_started_by_mpi
from jostle_lab.simulate.settings import METHODS, RULES, STEPS, Settings
from jostle_lab.simulate.validation import one_of, whole

from .refusals import check_file, check_folder, check_option, check_scene, console, refuse
from .runs import has_display, read_settings, record, show

DEFAULT_SCENE = "mixed"
TUNED = whole(1, 2_000_000)  # particles
PICTURES = ".png", ".pdf", ".svg"
SEEDS = whole(1, 1_000_000)
SWEPT = whole(1, 1_000_000_000)
WARM_UP = whole(0, 1_000_000_000)
WORKERS = whole(1, 10_000)

# Arguments of several commands.
_SCENE = typer.Argument(help="A scene, as `jostle scenes` lists them.")
Count = Annotated[
    int | None,
    typer.Option("-n", help="Number of particles; the default of the scene if not given."),
]

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
        typer.Argument(help=f"A scene, as `jostle scenes` lists them. (default: {DEFAULT_SCENE})"),
    ] = None,
    n: Count = None,
    method: Annotated[
        str | None, typer.Option(help=f"One of {', '.join(METHODS)}. (default: {Settings.method})")
    ] = None,
    leaf_capacity: Annotated[
        int | None, typer.Option(help="Maximum number of particles in a leaf of the tree.")
    ] = None,
    max_depth: Annotated[int | None, typer.Option(help="Maximum depth of the tree.")] = None,
    seed: Annotated[
        int | None, typer.Option(help="The same seed gives the same run. (default: 0)")
    ] = None,
    config_file: Annotated[
        Path | None,
        typer.Option("--config", help="A TOML file with settings; options override them."),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(help="Number of steps; without a window, 10 s of video if not given."),
    ] = None,
    headless: Annotated[
        bool, typer.Option("--headless", help="Record a video instead of opening a window.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Folder for the video and the picture.")] = Path("out"),
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
    if is_started_by_mpi():
        refuse("a scene runs in one process; examples/film_over_ranks.py runs one on many ranks")
    config = read_settings(config_file)
    settings = replace(config.settings, **given)
    why_no_window = None
    if not headless:
        why_no_window = show(settings, steps, config) if has_display() else "there is no display"
        if why_no_window is None:
            return
    check_folder(out)
    if why_no_window is not None:
        console.print(f"No window ({why_no_window}); recording a video instead.")
    record(settings, steps, out, config)


@app.command()
def tune(
    scene: Annotated[str, _SCENE] = DEFAULT_SCENE,
    n: Annotated[int, typer.Option("-n", help="Number of particles.")] = 10_000,
    out: Annotated[
        Path | None,
        typer.Option(
            help=f"The picture, {', '.join(PICTURES)}. (default: out/tune-SCENE.png)",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Draw a map of the time to find all pairs, over the leaf capacity and depth of the tree."""
    check_scene(scene)
    check_option("n", n, TUNED)
    path = out or Path("out") / f"tune-{scene}.png"
    if path.suffix.lower() not in PICTURES:
        refuse(f"--out is {str(path)!r}; the picture's name must end with {' or '.join(PICTURES)}")
    check_folder(path.parent)
    check_file("--out", path)
    from jostle_lab.tune import command

    try:
        with interrupt.raised():
            command.tune(scene, n, path, console)
    except KeyboardInterrupt:
        console.print("Stopped; no picture was written.")
        raise
    except OSError as error:
        refuse(f"the picture could not be written: {str(error).splitlines()[0]}")


@app.command()
def sweep(
    scene: Annotated[str, _SCENE],
    out: Annotated[
        Path, typer.Option(help="CSV file with one row a run; an existing one is continued.")
    ],
    n: Count = None,
    given: Annotated[
        list[str] | None,
        typer.Option("--set", help="NAME=FIRST:LAST:COUNT or NAME=VALUE,VALUE; repeatedly."),
    ] = None,
    seeds: Annotated[int, typer.Option(help="Number of seeds of each combination.")] = 1,
    steps: Annotated[int, typer.Option(help="Steps of each run that are measured.")] = 600,
    warm_up: Annotated[int, typer.Option(help="Steps before these.")] = 0,
    measure: Annotated[
        list[str] | None,
        typer.Option(help="What to measure; repeatedly. (default: energy and pressure)"),
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
