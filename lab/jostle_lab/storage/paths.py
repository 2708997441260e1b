"""Names of new files."""

from __future__ import annotations

import itertools
import re
import time
from pathlib import Path


def new_path(folder: Path, stem: str, suffix: str) -> Path:
    """Return the path of a new file, named after a scene and the time.

    The folder is made if it does not exist.
    """
    folder.mkdir(parents=True, exist_ok=True)
    stem = re.sub(r"[^\w-]+", "-", stem) + time.strftime("-%Y%m%d-%H%M%S")
    return folder / (free_name(folder, stem, suffix) + suffix)


def free_name(folder: Path, name: str, *suffixes: str) -> str:
    """Return the first of name, name-2, name-3, … without a file with one of the suffixes."""
    names = itertools.chain([name], (f"{name}-{number}" for number in itertools.count(2)))
    return next(
        new for new in names if not any((folder / (new + suffix)).exists() for suffix in suffixes)
    )


def reason_of(error: OSError, path: Path) -> str:
    """Return a message about a file that could not be read or written."""
    return f"{path.name}: {error.strerror or error}"
