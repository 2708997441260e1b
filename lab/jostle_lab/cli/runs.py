"""The ways to run a scene: in a window, or as a video."""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jostle_lab import interrupt
from jostle_lab.schema import Settings
from jostle_lab.simulate.simulation import ADJUSTABLE, Simulation
from jostle_lab.simulate.start import start

from .refusals import check_scene, console, refuse

if TYPE_CHECKING:
    from jostle_lab.draw.camera import Camera, Size
    from jostle_lab.draw.view_options import ViewOptions
    from jostle_lab.storage.scene_file import SavedScene
    from jostle_lab.window import Window


NO_IMGUI = "the window needs Python 3.11 or newer"


@dataclass(frozen=True)
class Opened:
    """A scene or a file, ready to run."""

    simulation: Simulation
    size: Size | None = None  # of the window or the video
    view_options: Mapping[str, Any] = field(default_factory=dict)
    saved: SavedScene | None = None

    def show(self, camera: Camera, options: ViewOptions) -> None:
        """Set a camera and view options to those of the file."""
        options.update(self.view_options)
        if self.saved is not None:
            self.saved.show(camera, options)


def open_source(source: str, given: Mapping[str, Any]) -> Opened:
    """Return the simulation of a scene's name or a file, with the given settings."""
    path = Path(source)
    try:
        if path.suffix == ".toml":
            return _open_settings(path, given)
        if path.suffix == ".jostle" or path.exists():
            return _open_scene(path, given)
    except OSError as error:
        refuse(f"{source} cannot be read: {error.strerror}")
    check_scene(source)
    return Opened(_start(Settings(source, **given)))


def _open_settings(path: Path, given: Mapping[str, Any]) -> Opened:
    from jostle_lab.storage.config import ConfigError, read_config

    try:
        config = read_config(path)
    except ConfigError as error:
        refuse(str(error))
    simulation = _start(replace(config.settings, **given), path.name)
    return Opened(simulation, config.size, config.view_options)


def _open_scene(path: Path, given: Mapping[str, Any]) -> Opened:
    """Open a saved scene; only settings that can change in a running scene may be given."""
    from jostle_lab.storage.scene_file import read_scene

    try:
        saved = read_scene(path)
    except ValueError as error:
        refuse(str(error).rstrip("."))
    for name, value in given.items():
        if name not in ADJUSTABLE:
            refuse(f"{name} cannot be changed in a saved scene")
        if why := saved.simulation.adjust(name, value):
            refuse(why)
    return Opened(saved.simulation, saved=saved)


def show(opened: Opened, steps: int | None) -> str | None:
    """Run in a window; return the reason if none can be opened."""
    window = open_window(opened, steps)
    if window == NO_IMGUI:
        refuse(f"{window}; --headless records a video")
    if isinstance(window, str):
        return window
    with interrupt.raised():
        window.run()
    return None


def open_window(opened: Opened, steps: int | None) -> Window | str:
    """Return a window, or the reason if none can be opened."""
    if not has_display():
        return "there is no display"
    if importlib.util.find_spec("imgui_bundle") is None:
        return NO_IMGUI
    import pygame

    from jostle_lab.draw.screen import NoOpenGLError
    from jostle_lab.window import SIZE, Window

    try:
        window = Window(opened.simulation, opened.size or SIZE, steps=steps)
    except (NoOpenGLError, pygame.error) as error:
        return str(error)
    opened.show(window.session.camera, window.session.view_options)
    return window


def record(opened: Opened, steps: int | None, out: Path) -> None:
    """Record a video, and print the table."""
    from jostle_lab.draw.view_options import ViewOptions
    from jostle_lab.headless import SIZE, default_steps, film_report, make_film

    options = ViewOptions(**opened.view_options) if opened.view_options else None
    simulation = opened.simulation
    try:
        with interrupt.raised():
            film = make_film(
                *(simulation, steps or default_steps(simulation), out, console),
                size=opened.size or SIZE,
                options=options,
            )
    except OSError as error:
        refuse(f"the video could not be written: {str(error).splitlines()[0]}")
    except KeyboardInterrupt:
        console.print(f"Stopped. The video so far, if any, is in {out}.")
        raise
    console.print(film_report(simulation, film))
    console.print(f"video    {film.video}\npicture  {film.still}", highlight=False, soft_wrap=True)


def _start(settings: Settings, file: str = "") -> Simulation:
    """Return the simulation; an error of the library becomes a message of the command."""
    try:
        return start(settings)
    except (ValueError, OverflowError, MemoryError) as error:
        why = str(error) or f"there is not enough memory for {settings.n:,} particles"
        refuse(f"{file}: {why}" if file else why)


def has_display() -> bool:
    """Return whether there is a display; on Linux the environment says so."""
    if os.environ.get("SDL_VIDEODRIVER") in ("dummy", "offscreen"):
        return False
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
