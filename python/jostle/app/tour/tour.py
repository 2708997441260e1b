"""The run over all stops, in a window without a display, as pictures and videos."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pygame
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from jostle.app.draw.camera import Size
from jostle.app.simulate.start import start
from jostle.app.storage.encoder import Encoder
from jostle.app.tour.scripted_user import FILMED, FRAME, ScriptedUser
from jostle.app.tour.stops import STOPS, Stop
from jostle.app.window import SIZE, Window

DRIVERS = ("offscreen", "dummy")  # of SDL, without a display
RATE = round(1 / (FILMED * FRAME))


@dataclass(frozen=True)
class Visit:
    """The result of a stop."""

    stop: Stop
    still: Path
    film: Path | None
    pictures: int  # in the video
    seconds: float


def names() -> list[str]:
    return [stop.name for stop in STOPS]


def visit(stop: Stop, out: Path, size: Size = SIZE, *, film: bool) -> Visit:
    """Run one stop: a picture of its end, and a video."""
    began = time.perf_counter()
    still, path = out / f"{stop.name}.png", out / f"{stop.name}.mp4"
    window = Window(start(stop.settings), size, renderer="software", synchronous=True)
    session = window.session
    session.files.folder = out
    session.view_options.tree, session.view_options.colour_by = stop.tree, stop.colour_by
    video = Encoder(path, size, RATE) if film else contextlib.nullcontext()
    with contextlib.closing(window), video as recorder:
        user = ScriptedUser(window, recorder.draw if recorder else None)
        stop.script(user)
        pygame.image.save(user.picture(), still)
    pictures = recorder.frames if recorder else 0
    return Visit(stop, still, path if film else None, pictures, time.perf_counter() - began)


@contextlib.contextmanager
def no_display() -> Iterator[None]:
    """Open windows without a display."""
    before = os.environ.get("SDL_VIDEODRIVER")
    try:
        for driver in DRIVERS:
            os.environ["SDL_VIDEODRIVER"] = driver
            with contextlib.suppress(pygame.error):
                pygame.display.init()
                break
        yield
    finally:
        pygame.display.quit()
        if before is None:
            del os.environ["SDL_VIDEODRIVER"]
        else:
            os.environ["SDL_VIDEODRIVER"] = before


def show_tour(out: Path, chosen: Sequence[str], *, films: bool, console: Console) -> None:
    """Run the chosen stops, or all, and print the results.

    The files in `out`, an existing folder, are named after the stops, and replace those of an
    earlier tour.
    """
    stops = [stop for stop in STOPS if not chosen or stop.name in chosen]
    longest = max(map(len, names()))
    visits: list[Visit] = []
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()
    with no_display(), Progress(*columns, TimeElapsedColumn(), console=console) as progress:
        task = progress.add_task("", total=len(stops))
        for stop in stops:
            progress.update(task, description=stop.name.ljust(longest))
            visits.append(visit(stop, out, film=films and stop.filmed))
            progress.advance(task)
        progress.update(task, description=" " * longest)
    console.print(_table(visits))
    console.print(f"in {out}", highlight=False, soft_wrap=True)


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
