"""The ways to run a scene: in a window, or as a video."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from jostle_lab import interrupt
from jostle_lab.simulate.settings import Settings
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.simulate.start import start

from .refusals import console, refuse

if TYPE_CHECKING:
    from jostle_lab.storage.config import Config


def read_settings(path: Path | None) -> Config:
    """Return the contents of a file; no entries without a file."""
    from jostle_lab.storage.config import Config, ConfigError, read_config

    if path is None:
        return Config()
    try:
        return read_config(path)
    except ConfigError as error:
        refuse(str(error))
    except OSError as error:
        refuse(f"--config is {str(path)!r}, which cannot be read: {error.strerror}")


def show(settings: Settings, steps: int | None, config: Config) -> str | None:
    """Run in a window; return the reason if none can be opened."""
    if importlib.util.find_spec("imgui_bundle") is None:
        refuse("the window needs Python 3.11 or newer; --headless records a video")
    import pygame

    from jostle_lab.draw.screen import NoOpenGLError
    from jostle_lab.window import SIZE, Window

    simulation = _start(settings, config)
    try:
        window = Window(simulation, config.size or SIZE, steps=steps)
    except (NoOpenGLError, pygame.error) as error:
        return str(error)
    window.session.view_options.update(config.view_options)
    with interrupt.raised():
        window.run()
    return None


def record(settings: Settings, steps: int | None, out: Path, config: Config) -> None:
    """Record a video, and print the table."""
    from jostle_lab.draw.view_options import ViewOptions
    from jostle_lab.headless import SIZE, default_steps, film_report, make_film

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
        refuse(f"the video could not be written: {str(error).splitlines()[0]}")
    except KeyboardInterrupt:
        console.print(f"Stopped. The video so far, if any, is in {out}.")
        raise
    console.print(film_report(simulation, film))
    console.print(f"video    {film.video}\npicture  {film.still}", highlight=False, soft_wrap=True)


def _start(settings: Settings, config: Config) -> Simulation:
    """Return the simulation; an error of the library becomes a message of the command."""
    try:
        return start(settings)
    except (ValueError, OverflowError, MemoryError) as error:
        why = str(error) or f"there is not enough memory for {settings.n:,} particles"
        refuse(f"{config.name}: {why}" if config.name else why)


def has_display() -> bool:
    """Return whether there is a display; on Linux the environment says so."""
    if os.environ.get("SDL_VIDEODRIVER") in ("dummy", "offscreen"):
        return False
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
