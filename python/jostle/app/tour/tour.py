"""A tour of the simulator: its stops one by one, in a window without a display, as pictures."""

from __future__ import annotations

import contextlib
import math
import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pygame

from jostle.app.draw.camera import Size
from jostle.app.keep.recorder import Recorder, save_png
from jostle.app.simulate.start import start
from jostle.app.tour.stops import STOPS, Stop
from jostle.app.tour.visitor import FILMED, FRAME, Visitor
from jostle.app.window import SIZE, Window

DRIVERS = ("offscreen", "dummy")  # of SDL: windows that nobody sees
RATE = round(1 / (FILMED * FRAME))


@dataclass(frozen=True)
class Visit:
    """What a stop leaves behind."""

    stop: Stop
    still: Path
    film: Path | None
    pictures: int  # in the film
    seconds: float  # that it took


def names() -> list[str]:
    """Return the names of all stops."""
    return [stop.name for stop in STOPS]


def tour(
    out: Path,
    chosen: Sequence[str] = (),
    *,
    films: bool = True,
    size: Size = SIZE,
    coming: Callable[[Stop], object] = lambda stop: None,
) -> Iterator[Visit]:
    """Visit the stops one after the other.

    Parameters
    ----------
    out
        A folder that exists; files are named for the stops, and replace those of a tour before.
    chosen
        Names of stops; all, if there are none.
    films
        Whether to make films too.
    size
        Of the window in pixels.
    coming
        Called with each stop before it is visited.

    Yields
    ------
    Visit
    """
    with _no_display():
        for stop in STOPS:
            if not chosen or stop.name in chosen:
                coming(stop)
                yield visit(stop, out, size, film=films and stop.filmed)


def visit(stop: Stop, out: Path, size: Size = SIZE, *, film: bool) -> Visit:
    """Visit one stop: a still of its end, and a film."""
    began, pictures = time.perf_counter(), 0
    still, path = out / f"{stop.name}.png", out / f"{stop.name}.mp4"
    window = Window(start(stop.settings), size, renderer="software")
    window.session.files.folder = out
    window.session.engine.short = math.inf  # all steps are made in the window: none comes late
    with contextlib.ExitStack() as ending:
        ending.callback(window.close)
        recorder = ending.enter_context(Recorder(path, size, RATE)) if film else None

        def add(canvas: pygame.Surface) -> None:
            nonlocal pictures
            pictures += 1
            if recorder is not None:
                recorder.add(canvas)

        visitor = Visitor(window, add if film else None)
        stop.visit(visitor)
        save_png(visitor.picture(), still)
    return Visit(stop, still, path if film else None, pictures, time.perf_counter() - began)


@contextlib.contextmanager
def _no_display() -> Iterator[None]:
    """Let windows be opened where nobody sees them."""
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
