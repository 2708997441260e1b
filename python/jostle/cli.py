"""The command: `jostle run`, `tour`, `tune`, `scenes`, `bench` and `sweep`."""

from __future__ import annotations

import importlib.util
import io
import os
import sys
import tempfile
import traceback
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NoReturn

_INSTALL = 'the command needs {}, which is not installed; pip install "jostle[app]" brings it'

try:
    import typer
    from rich.console import Console
    from rich.table import Table
except ImportError as missing:
    raise SystemExit("jostle: " + _INSTALL.format(missing.name)) from None

import jostle
from jostle import interrupt
from jostle.app.simulate.settings import (
    FIXED_BY_ARTICLE,
    METHODS,
    RENDERERS,
    RULES,
    SEED,
    STEPS,
    THREADS,
    Settings,
)
from jostle.app.simulate.simulation import Simulation
from jostle.app.simulate.start import start
from jostle.app.simulate.validation import AnyRule, check, one_of, similar, whole
from jostle.launcher import is_started_by_mpi, speaks

if TYPE_CHECKING:
    from jostle.app.storage.config import Config

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
console = Console()


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
        _check_scene(scene)
    options: dict[str, Any] = {
        **{"scene": scene, "n": n, "seed": seed, "method": method},
        **{"leaf_capacity": leaf_capacity, "max_depth": max_depth},
    }
    given = {name: value for name, value in options.items() if value is not None}
    for name, value in given.items():
        _check(name, value, RULES[name])
    _check("steps", steps, STEPS)
    _check("renderer", renderer, one_of(*RENDERERS))
    _check_extra()
    config = _read_config(config_file)
    settings = replace(config.settings, **given)
    for name in FIXED_BY_ARTICLE if settings.by_article else ():
        if name in given or name in config.given:
            _refuse(f"{_option(name)} cannot be set here: the article's are fixed")
    if mpi or is_started_by_mpi():
        _check("checkpoint", checkpoint, STEPS)
        _run_on_ranks(settings, config, steps, out, checkpoint, resume)
        return
    for option, value in (("--checkpoint", checkpoint), ("--resume", resume)):
        if value is not None:
            _refuse(f"{option} is for runs over ranks; add --mpi, or start the command with mpirun")
    why_no_window = None
    if not headless:
        why_no_window = (
            _show(settings, steps, renderer or config.renderer or RENDERERS[0], config)
            if has_display()
            else "there is no display"
        )
        if why_no_window is None:
            return
    if renderer == "opengl":
        _refuse("--renderer is 'opengl', but a video is drawn in software")
    _check_folder(out)
    if why_no_window is not None:
        console.print(f"No window ({why_no_window}); recording a video instead.")
    _film(settings, steps, out, config)


@app.command()
def tour(
    out: Annotated[Path, typer.Option(help="Folder for the pictures and videos.")] = Path("out"),
    only: Annotated[
        list[str] | None, typer.Option(help="A single stop; may be given repeatedly.")
    ] = None,
    stills: Annotated[bool, typer.Option("--stills", help="Make no videos.")] = False,
) -> None:
    """Make pictures and short videos of the simulator, without a display."""
    _check_extra("imgui_bundle")
    from jostle.app.tour.tour import names, show_tour

    for name in only or []:
        if name not in names():
            _refuse(f"there is no stop {name!r}; the stops are {', '.join(names())}")
    _check_folder(out)
    try:
        with interrupt.raised():
            show_tour(out, only or [], films=not stills, console=console)
    except OSError as error:
        _refuse(f"the tour could not be written: {str(error).splitlines()[0]}")


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
    _check_scene(scene)
    _check("n", n, TUNED)
    _check("rounds", rounds, ROUNDS)
    _check("threads", threads, THREADS)
    _check("seed", seed, SEED)
    if importlib.util.find_spec("matplotlib") is None:
        _refuse(_INSTALL.format("matplotlib"))
    from jostle.tune import command

    work: Literal["step", "pairs"] = "step" if step else "pairs"
    _check_folder(out, make=False)
    for path in command.files(scene, work, out):
        _check_file("--out", path)
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
        _refuse(f"the tuning could not be written: {str(error).splitlines()[0]}")
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
    from jostle.bench import command

    _check("n", n, SHAPES)
    _check("rounds", rounds, ROUNDS)
    _check("threads", threads, THREADS)
    if csv is not None:
        _check_new_file("--csv", csv)
    try:
        with interrupt.raised():
            finished = command.bench(n, rounds, sorted({1, threads}), csv, console)
    except OSError as error:
        _refuse(f"the results could not be written: {str(error).splitlines()[0]}")
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
    from jostle.sweep import command
    from jostle.sweep.measures import MEASURES
    from jostle.sweep.plan import PlanError, plan
    from jostle.sweep.table import TableError

    _check_scene(scene)
    _check("n", n, RULES["n"])
    for name, count, rule in (
        ("seeds", seeds, SEEDS),
        ("steps", steps, SWEPT),
        ("warm_up", warm_up, WARM_UP),
        ("workers", workers, WORKERS),
    ):
        _check(name, count, rule)
    measures = list(dict.fromkeys(measure or ["energy", "pressure"]))
    for name in measures:
        _check("measure", name, one_of(*MEASURES))
    try:
        runs = plan(scene, n, given or [], seeds, steps, warm_up, measures)
        _check_file("--out", out)
        finished = command.sweep(runs, out, workers, console)
    except (PlanError, TableError) as error:
        _refuse(str(error))
    except OSError as error:
        _refuse(f"--out is {str(out)!r}, where no file can be written: {error.strerror}")
    except (ValueError, MemoryError) as error:
        _refuse(f"a run failed: {error}")
    if not finished:
        raise typer.Exit(interrupt.CODE)


def _read_config(path: Path | None) -> Config:
    """Return the contents of a file; no entries without a file."""
    from jostle.app.storage.config import Config, ConfigError, read_config

    if path is None:
        return Config()
    if sys.version_info < (3, 11) and importlib.util.find_spec("tomli") is None:
        _refuse(_INSTALL.format("tomli"))
    try:
        return read_config(path)
    except ConfigError as error:
        _refuse(str(error))
    except OSError as error:
        _refuse(f"--config is {str(path)!r}, which cannot be read: {error.strerror}")


def _show(settings: Settings, steps: int | None, renderer: str, config: Config) -> str | None:
    """Run in a window; return the reason if none can be opened."""
    _check_extra("imgui_bundle")
    import pygame

    from jostle.app.draw.screen import NoRendererError
    from jostle.app.window import SIZE, Window

    simulation = _start(settings, config)
    try:
        window = Window(simulation, config.size or SIZE, steps=steps, renderer=renderer)
    except NoRendererError as error:
        _refuse(f"--renderer is 'opengl', but {error}")
    except pygame.error as error:
        return str(error)
    window.session.view_options.update(config.view_options)
    with interrupt.raised():
        window.run()
    return None


def _film(settings: Settings, steps: int | None, out: Path, config: Config) -> None:
    """Record a video, and print the table."""
    from jostle.app.draw.view_options import ViewOptions
    from jostle.app.film_report import film_report
    from jostle.app.headless import SIZE, default_steps, make_film

    options = ViewOptions(**config.view_options) if config.view_options else None
    simulation = _start(settings, config)
    try:
        with interrupt.raised():
            film = make_film(
                *(simulation, steps or default_steps(simulation), out, console),
                size=config.size or SIZE,
                options=options,
            )
    except OSError as error:
        _refuse(f"the video could not be written: {str(error).splitlines()[0]}")
    except KeyboardInterrupt:
        console.print(f"Stopped. The video so far, if any, is in {out}.")
        raise
    console.print(film_report(simulation, film, settings))
    console.print(f"video    {film.video}\npicture  {film.still}", highlight=False, soft_wrap=True)


def _run_on_ranks(
    settings: Settings,
    config: Config,
    steps: int | None,
    out: Path,
    checkpoint: int | None,
    resume: Path | None,
) -> None:
    """Record a video of a scene whose particles are distributed over the ranks of MPI."""
    if importlib.util.find_spec("mpi4py") is None:
        _refuse('a run over ranks needs mpi4py, which is not installed; pip install "jostle[mpi]"')
    from mpi4py import MPI

    from jostle.app.headless import SIZE
    from jostle.app.ranks.run import DEFAULT_STEPS, Plan, Stopped, leave_together, refusal, run
    from jostle.mpi import RankError

    if why := refusal(settings):
        _refuse(why)
    size = config.size or SIZE
    plan = Plan(settings, steps or DEFAULT_STEPS, out, checkpoint, resume, size)
    try:
        run(MPI.COMM_WORLD, plan, console)
        return
    except Stopped as stopped:
        _tell(str(stopped))
        code = interrupt.CODE
    except (RankError, ValueError, MemoryError, OSError) as error:
        _tell(f"jostle: the run over ranks has ended: {error}")
        code = 2
    except BaseException:
        # The other ranks do not know of this one's error.
        traceback.print_exc()
        MPI.COMM_WORLD.Abort(1)
    leave_together(MPI.COMM_WORLD)
    raise typer.Exit(code)


def _start(settings: Settings, config: Config) -> Simulation:
    """Return the simulation; an error of the library becomes a message of the command."""
    try:
        return start(settings)
    except (ValueError, OverflowError, MemoryError) as error:
        why = str(error) or f"there is not enough memory for {settings.n:,} particles"
        _refuse(f"{config.name}: {why}" if config.name else why)


def has_display() -> bool:
    """Return whether there is a display; on Linux the environment says so."""
    if os.environ.get("SDL_VIDEODRIVER") in ("dummy", "offscreen"):
        return False
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _check_scene(scene: str) -> None:
    names = jostle.scenes.names()
    if scene not in names:
        alike = similar(scene, names)
        hint = f"did you mean {alike}? " if alike else ""
        _refuse(f"there is no scene {scene!r}; {hint}the scenes are {', '.join(names)}")


def _check(name: str, value: object, rule: AnyRule) -> None:
    """Exit with a message if an option breaks its rule."""
    if value is not None and (refusal := check(_option(name), value, rule)):
        _refuse(refusal)


def _option(name: str) -> str:
    return f"-{name}" if len(name) == 1 else "--" + name.replace("_", "-")


def _check_folder(out: Path, *, make: bool = True) -> None:
    """Check that a file can be written in a folder, before long work.

    The folder is made; if it is to be made later, its nearest existing parent is tried.
    """
    try:
        if make:
            out.mkdir(parents=True, exist_ok=True)
        _try_folder(next(folder for folder in (out, *out.absolute().parents) if folder.exists()))
    except OSError as error:
        _refuse(f"--out is {str(out)!r}, where no file can be written: {error.strerror}")


def _try_folder(folder: Path) -> None:
    with tempfile.TemporaryFile(dir=folder):
        pass


def _check_file(name: str, path: Path) -> None:
    """Check that a file can probably be written."""
    if path.is_dir():
        _refuse(f"{name}: {str(path)!r} is a folder, and no file can be written in its place")
    if path.exists() and not os.access(path, os.W_OK):
        _refuse(f"{name}: {str(path)!r} is there already and cannot be written")


def _check_new_file(name: str, path: Path) -> None:
    """Check that a file can be written, and does not replace results."""
    try:
        if not path.parent.exists():
            _refuse(f"{name} is {str(path)!r}, but there is no folder {str(path.parent)!r}")
        _check_file(name, path)
        if path.is_file() and path.stat().st_size:
            _refuse(f"{name} is {str(path)!r}, which is there already; name a new file")
        if not path.exists():
            _try_folder(path.parent)
    except OSError as error:
        _refuse(f"{name} is {str(path)!r}, where no file can be written: {error.strerror}")


def _check_extra(*modules: str) -> None:
    """Exit with a message if a package of the extra `app` is missing."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    for module in ("pygame", "imageio_ffmpeg", *modules):
        if importlib.util.find_spec(module) is None:
            if module == "imgui_bundle" and sys.version_info < (3, 11):
                _refuse("the window needs Python 3.11 or newer; --headless records a video")
            _refuse(_INSTALL.format(module.replace("_", "-")))


def _refuse(sentence: str) -> NoReturn:
    _tell(f"jostle: {sentence}")
    raise typer.Exit(2)


def _tell(message: str) -> None:
    """Print a message, once for all processes that MPI has started."""
    if speaks():
        print(message, file=sys.stderr)


def main() -> None:
    """Run the command; an error in its arguments becomes a message and exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # characters that it cannot encode become "?"
            stream.reconfigure(errors="replace")
    with interrupt.handled():
        code = _exit_code()
    sys.exit(code)


def command() -> None:
    """Run `main` as a process; after Ctrl-C it ends without waiting for threads."""
    try:
        main()
    except SystemExit as end:
        if end.code == interrupt.CODE:
            interrupt.leave()
        raise


def _exit_code() -> int:
    # The base class of all errors of arguments; its package depends on typer's version.
    usage_error: type[Exception] = typer.BadParameter.__mro__[2]
    try:
        code = app(standalone_mode=False)
    except usage_error as error:
        if sentence := error.format_message():  # type: ignore[attr-defined]
            _tell(f"jostle: {sentence}")
        return 2
    except (typer.Abort, KeyboardInterrupt):
        return interrupt.CODE
    return code if isinstance(code, int) else 0


if __name__ == "__main__":
    command()
