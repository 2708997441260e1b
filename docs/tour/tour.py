"""The run of a stop in a window without a display, as a picture and a video."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pygame

from jostle.record import Film, write_png
from jostle_lab.draw.camera import Size
from jostle_lab.simulate.start import start
from jostle_lab.storage.recording import pixels
from jostle_lab.window import SIZE, Window
from tour.scripted_user import FILMED, FRAME, ScriptedUser
from tour.stops import Stop

DRIVERS = ("offscreen", "dummy")  # of SDL, without a display
RATE = round(1 / (FILMED * FRAME))


@dataclass(frozen=True)
class Visit:
    """The result of a stop."""

    still: Path
    film: Path | None
    frames: int  # of the video


def visit(stop: Stop, out: Path, size: Size = SIZE, *, film: bool) -> Visit:
    """Run one stop: a picture of its end, and a video."""
    still, path = out / f"{stop.name}.png", out / f"{stop.name}.mp4"
    window = Window(start(stop.settings), size, synchronous=True)
    session = window.session
    session.files.folder = out
    session.view_options.panels = True
    session.shows_times = False  # those of a window without a graphics card
    window.frame(0.0)  # which moves the camera aside
    session.view_options.tree, session.view_options.colour_by = stop.tree, stop.colour_by
    video = Film(path, size, RATE) if film else contextlib.nullcontext()
    with contextlib.closing(window), video as recorder:
        show = (lambda canvas: recorder.add(pixels(canvas))) if recorder else None
        user = ScriptedUser(window, show)
        stop.script(user)
        write_png(still, pixels(user.picture()))
    return Visit(still, path if film else None, recorder.frames if recorder else 0)


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
