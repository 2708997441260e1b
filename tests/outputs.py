"""Films and tables that programs write, read again."""

import csv
from pathlib import Path

import imageio_ffmpeg
import numpy as np


def frames_of(film: Path) -> list[np.ndarray]:
    """The frames of a film, each of shape (height, width, 3)."""
    reader = imageio_ffmpeg.read_frames(str(film))
    width, height = next(reader)["size"]
    return [np.frombuffer(frame, np.uint8).reshape(height, width, 3) for frame in reader]


def table(path: Path) -> list[dict[str, str]]:
    """The rows of a table."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def rows(path: Path) -> list[dict[str, str]]:
    """The rows of a sweep's table without the time, sorted."""
    found = table(path)
    for row in found:
        del row["seconds"]
    return sorted(found, key=str)
