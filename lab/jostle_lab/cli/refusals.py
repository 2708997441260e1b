"""Checks of arguments, each of which ends the command with one sentence."""

import os
import sys
import tempfile
from pathlib import Path
from typing import NoReturn

import typer
from rich.console import Console

from jostle_lab.launcher import speaks
from jostle_lab.schema import unknown_scene

console = Console()


def check_scene(scene: str) -> None:
    if why := unknown_scene(scene):
        refuse(why)


def check_folder(out: Path) -> None:
    """Make a folder, and check that a file can be written in it, before long work."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
    except OSError as error:
        refuse(f"--out is {str(out)!r}, where no file can be written: {error.strerror}")


def check_file(name: str, path: Path) -> None:
    """Check that a file can probably be written."""
    if path.is_dir():
        refuse(f"{name}: {str(path)!r} is a folder, and no file can be written in its place")
    if path.is_fifo():
        refuse(f"{name}: {str(path)!r} is a pipe, and no file can be written in its place")
    if path.exists() and not os.access(path, os.W_OK):
        refuse(f"{name}: {str(path)!r} is there already and cannot be written")


def refuse(sentence: str) -> NoReturn:
    tell(f"jostle: {sentence}")
    raise typer.Exit(2)


def tell(message: str) -> None:
    """Print a message, once for all processes that MPI has started."""
    if speaks():
        print(message, file=sys.stderr)
