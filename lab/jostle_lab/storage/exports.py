"""Names of new files; states as tables (CSV) and trajectories (GSD), for other programs."""

import itertools
import re
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from jostle.writing import NewFile
from jostle_lab.simulate.containers import bounds
from jostle_lab.simulate.frame import Frame, Rect

COLUMNS = ("tag", "x", "y", "vx", "vy", "radius", "mass")
_DIGITS = "%.9g"  # distinguishes any two numbers of single precision


def write_positions(path: Path, frame: Frame) -> None:
    """Write a row for each particle of a frame, in world units and seconds."""
    columns = [
        frame.tags, *frame.positions.T, *frame.velocities.T, frame.radii, frame.masses
    ]  # fmt: skip
    formats = ["%d", *[_DIGITS] * (len(columns) - 1)]
    _write_table(path, COLUMNS, columns, formats)


def write_series(path: Path, columns: Mapping[str, ArrayLike]) -> None:
    """Write columns of equal length, such as energies over time, in double precision."""
    _write_table(path, tuple(columns), list(columns.values()), ["%.17g"] * len(columns))


def _write_table(path: Path, names: Iterable[str], columns: list[Any], formats: list[str]) -> None:
    table = np.column_stack([np.asarray(column, np.float64) for column in columns])
    with NewFile(path) as new, new.path.open("w", encoding="ascii", newline="\n") as file:
        file.write(",".join(names) + "\n")
        np.savetxt(file, table, formats, delimiter=",")


def write_gsd(path: Path, frames: Iterable[Frame], view: Rect, time_step: float) -> int:
    """Write frames in the schema of HOOMD, for OVITO; return their number.

    The box is centred at the origin, and y points up. Particles are in the order of their tags,
    which are in `log/particles/tag`.
    """
    import gsd.hoomd

    count = 0
    with NewFile(path) as new, gsd.hoomd.open(str(new.path), "w") as file:
        for frame in frames:
            snapshot = gsd.hoomd.Frame()
            _fill(snapshot, frame, view)
            snapshot.configuration.step = round(frame.stats.time / time_step)
            file.append(snapshot)
            count += 1
    return count


def _fill(snapshot: Any, frame: Frame, view: Rect) -> None:
    min_x, min_y, max_x, max_y = _around(frame, view)
    middle = np.array([(min_x + max_x) / 2, (min_y + max_y) / 2])
    snapshot.configuration.dimensions = 2
    snapshot.configuration.box = [max_x - min_x, max_y - min_y, 0, 0, 0, 0]
    particles = snapshot.particles
    particles.N = len(frame)
    particles.types = ["movable", "fixed"]
    particles.typeid = np.where(frame.movable, 0, 1).astype(np.uint32)
    particles.position = _upwards(frame.positions - middle)
    particles.velocity = _upwards(frame.velocities)
    particles.diameter = 2 * frame.radii
    particles.mass = frame.masses
    snapshot.log["particles/tag"] = frame.tags
    snapshot.log["time"] = np.array([frame.stats.time])


def _around(frame: Frame, view: Rect) -> Rect:
    """Return the bounds of the container, or the view, extended to contain all centres."""
    min_x, min_y, max_x, max_y = bounds(frame.container) or view
    if len(frame):
        low, high = frame.positions.min(axis=0), frame.positions.max(axis=0)
        min_x, min_y = min(min_x, float(low[0])), min(min_y, float(low[1]))
        max_x, max_y = max(max_x, float(high[0])), max(max_y, float(high[1]))
    return min_x, min_y, max_x, max_y


def _upwards(vectors: NDArray[np.floating]) -> NDArray[np.float32]:
    """Return (n, 3) vectors from (n, 2), with y inverted."""
    flat = np.zeros((len(vectors), 3), np.float32)
    flat[:, 0], flat[:, 1] = vectors[:, 0], -vectors[:, 1]
    return flat


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
