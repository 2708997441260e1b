"""Checks of arguments, each of which ends the command with one sentence."""

from __future__ import annotations

import importlib.util
import os
import sys
import tempfile
from pathlib import Path
from typing import NoReturn

import typer
from rich.console import Console

import jostle
from jostle_lab.launcher import speaks
from jostle_lab.simulate.validation import AnyRule, check, similar

INSTALL = "the command needs {}, which is not installed; pip install ./lab brings it"

console = Console()


def check_scene(scene: str) -> None:
    names = jostle.scenes.names()
    if scene not in names:
        alike = similar(scene, names)
        hint = f"did you mean {alike}? " if alike else ""
        refuse(f"there is no scene {scene!r}; {hint}the scenes are {', '.join(names)}")


def check_option(name: str, value: object, rule: AnyRule) -> None:
    """Exit with a message if an option breaks its rule."""
    if value is not None and (refusal := check(option_of(name), value, rule)):
        refuse(refusal)


def option_of(name: str) -> str:
    return f"-{name}" if len(name) == 1 else "--" + name.replace("_", "-")


def check_folder(out: Path, *, make: bool = True) -> None:
    """Check that a file can be written in a folder, before long work.

    The folder is made; if it is to be made later, its nearest existing parent is tried.
    """
    try:
        if make:
            out.mkdir(parents=True, exist_ok=True)
        _try_folder(next(folder for folder in (out, *out.absolute().parents) if folder.exists()))
    except OSError as error:
        refuse(f"--out is {str(out)!r}, where no file can be written: {error.strerror}")


def _try_folder(folder: Path) -> None:
    with tempfile.TemporaryFile(dir=folder):
        pass


def check_file(name: str, path: Path) -> None:
    """Check that a file can probably be written."""
    if path.is_dir():
        refuse(f"{name}: {str(path)!r} is a folder, and no file can be written in its place")
    if path.is_fifo():
        refuse(f"{name}: {str(path)!r} is a pipe, and no file can be written in its place")
    if path.exists() and not os.access(path, os.W_OK):
        refuse(f"{name}: {str(path)!r} is there already and cannot be written")


def check_new_file(name: str, path: Path) -> None:
    """Check that a file can be written, and does not replace results."""
    try:
        if not path.parent.exists():
            refuse(f"{name} is {str(path)!r}, but there is no folder {str(path.parent)!r}")
        check_file(name, path)
        if path.is_file() and path.stat().st_size:
            refuse(f"{name} is {str(path)!r}, which is there already; name a new file")
        if not path.exists():
            _try_folder(path.parent)
    except OSError as error:
        refuse(f"{name} is {str(path)!r}, where no file can be written: {error.strerror}")


def check_extra(*modules: str) -> None:
    """Exit with a message if a package is missing, as ImGui is on Python 3.10."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    for module in ("pygame", "imageio_ffmpeg", *modules):
        if importlib.util.find_spec(module) is None:
            if module == "imgui_bundle" and sys.version_info < (3, 11):
                refuse("the window needs Python 3.11 or newer; --headless records a video")
            refuse(INSTALL.format(module.replace("_", "-")))


def refuse(sentence: str) -> NoReturn:
    tell(f"jostle: {sentence}")
    raise typer.Exit(2)


def tell(message: str) -> None:
    """Print a message, once for all processes that MPI has started."""
    if speaks():
        print(message, file=sys.stderr)
