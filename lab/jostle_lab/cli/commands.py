"""The commands, their options, and the rules of these."""

import inspect
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

import jostle
from jostle_lab import interrupt
from jostle_lab.launcher import is_started_by_mpi
from jostle_lab.schema import MAX_PARTICLES, SCALARS, Settings, about, kind_of, unknown

from . import runs
from .refusals import check_file, check_folder, check_scene, console, refuse
from .runs import open_source, record, show
from .values import given_settings

DEFAULT_SCENE = Settings().scene
FIRST_SCENE = "springs"  # of a window: soft bodies fall, and can be thrown
PICTURES = ".png", ".pdf", ".svg"

# Arguments of several commands.
_SCENE = typer.Argument(help="A scene, as `jostle scenes` lists them.")
Count = Annotated[
    int | None,
    typer.Option(
        "-n", min=0, max=MAX_PARTICLES, help="Number of particles; that of the scene unless given."
    ),
]
Steps = Annotated[
    int | None,
    typer.Option(min=1, help="Number of steps; without a window, 10 s of video unless given."),
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


def _setting(name: str) -> inspect.Parameter:
    """Return the option of a setting, as the schema declares it."""
    option = "-n" if name == "n" else "--" + name.replace("_", "-")
    hint = typer.Option(option, help=escape(about(name)), metavar=kind_of(name), show_default=False)
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[str | None, hint]
    )


def run(
    source: Annotated[
        str | None,
        typer.Argument(
            help="A scene, as `jostle scenes` lists them, or a file: .jostle or .toml.",
            metavar="[SCENE|FILE]",
        ),
    ] = None,
    steps: Steps = None,
    headless: Annotated[
        bool, typer.Option("--headless", help="Record a video instead of opening a window.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Folder for the video and the picture.")] = Path("out"),
    **options: str | None,
) -> None:
    """Run a scene or a file in a window, or record a video if there is no display."""
    given = given_settings(options)
    if is_started_by_mpi():
        refuse("a scene runs in one process; examples/film_over_ranks.py runs one on many ranks")
    first = FIRST_SCENE if runs.has_display() and not headless else DEFAULT_SCENE
    opened = open_source(source or first, given)
    why_no_window = None
    if not headless:
        why_no_window = show(opened, steps)
        if why_no_window is None:
            return
    check_folder(out)
    if why_no_window is not None:
        console.print(f"No window ({why_no_window}); recording a video instead.")
    record(opened, steps, out)


def _with_settings(command: Any) -> None:
    """Replace the keywords of a command by one option for each setting."""
    signature = inspect.signature(command)
    own = [each for each in signature.parameters.values() if each.kind is not each.VAR_KEYWORD]
    settings = [_setting(name) for name in SCALARS]
    command.__signature__ = signature.replace(parameters=[*own, *settings])
    command.__annotations__ |= {each.name: each.annotation for each in settings}
    del command.__annotations__["options"]


_with_settings(run)
app.command()(run)


@app.command()
def tune(
    scene: Annotated[str, _SCENE] = DEFAULT_SCENE,
    n: Annotated[
        int, typer.Option("-n", min=1, max=2_000_000, help="Number of particles.")
    ] = 10_000,
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
    seeds: Annotated[int, typer.Option(min=1, help="Number of seeds of each combination.")] = 1,
    steps: Annotated[int, typer.Option(min=1, help="Steps of each run that are measured.")] = 600,
    warm_up: Annotated[int, typer.Option(min=0, help="Steps before these.")] = 0,
    measure: Annotated[
        list[str] | None,
        typer.Option(help="What to measure; repeatedly. (default: energy and pressure)"),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes; one for each core if not given.")
    ] = None,
) -> None:
    """Simulate a scene with all combinations of settings and seeds, in many processes."""
    from jostle_lab.sweep import command
    from jostle_lab.sweep.measures import MEASURES
    from jostle_lab.sweep.plan import PlanError, plan
    from jostle_lab.sweep.table import TableError

    check_scene(scene)
    measures = list(dict.fromkeys(measure or ["energy", "pressure"]))
    for name in measures:
        if name not in MEASURES:
            refuse(f"--measure {name} {unknown(name, 'a measure', MEASURES)}")
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
