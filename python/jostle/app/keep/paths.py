"""Names of new files, and files that are written whole or not at all."""

from __future__ import annotations

import itertools
import os
import re
import tempfile
import time
from pathlib import Path


def new_path(folder: Path, stem: str, suffix: str) -> Path:
    """Return the path of a file that is not there yet, named for a scene and the time of day.

    The folder is made if need be.
    """
    folder.mkdir(parents=True, exist_ok=True)
    stem = re.sub(r"[^\w-]+", "-", stem) + time.strftime("-%Y%m%d-%H%M%S")
    return folder / (free_name(folder, stem, suffix) + suffix)


def free_name(folder: Path, name: str, *suffixes: str) -> str:
    """Return the first of name, name-2, name-3, … that no file has with one of the suffixes."""
    names = itertools.chain([name], (f"{name}-{number}" for number in itertools.count(2)))
    return next(
        new for new in names if not any((folder / (new + suffix)).exists() for suffix in suffixes)
    )


def write_whole(path: Path, data: bytes) -> None:
    """Write a file such that there is either all of it or what was there before."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def why_not(error: OSError, path: Path) -> str:
    """Return a sentence on a file that could not be read or written."""
    return f"{path.name}: {error.strerror or error}"
