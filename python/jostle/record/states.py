"""States of worlds as films, trajectories and tables."""

from __future__ import annotations

import itertools
import operator
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jostle._core import World
from jostle.record.films import Film, extra, format_of
from jostle.record.picture import Camera, bounds_of
from jostle.writing import NewFile

LONGEST = {".mp4": 1280, ".gif": 640}  # pixels of the longer side
SLOWEST, FASTEST = 10.0, {".mp4": 60.0, ".gif": 50.0}  # pictures per second

_ARRAYS = ("ids", "positions", "velocities", "angles", "angular_velocities", "radii", "masses")


def record(
    world: World,
    path: str | os.PathLike[str],
    dt: float,
    steps: int,
    *,
    every: int = 1,
    progress: Callable[[int, int], object] | None = None,
) -> None:
    """Step a world, and write its states, the present one first.

    Parameters
    ----------
    world : World
        The world, which is `steps` steps further afterwards.
    path : path-like
        The file, whose suffix is the format; see `write_states`. A film shows units of time as
        seconds, as far as its rate allows.
    dt : float
        Time step, in units of time.
    steps : int
        Number of steps.
    every : int, default 1
        Steps from one written state to the next.
    progress : callable, optional
        Called with the number of steps done and `steps` after each written state.

    Raises
    ------
    ValueError
        If the suffix is another, or a number is out of range.
    ModuleNotFoundError
        If a package of the extra `record` is missing.
    OSError
        If the file cannot be written. Then an old file is as it was.

    See Also
    --------
    write_states : For a loop of your own.

    Examples
    --------
    >>> from jostle.record import record
    >>> world = jostle.scenes.create("heap", n=30)
    >>> record(world, "heap.gif", dt=1 / 60, steps=12, every=4)
    >>> round(world.time, 3)
    0.2
    """
    world.step(dt, 0)  # checks dt
    steps, every = operator.index(steps), operator.index(every)
    for name, value, least in (("steps", steps, 0), ("every", every, 1)):
        if value < least:
            raise ValueError(f"{name} is {value}; it must be at least {least}")

    def states() -> Iterator[World]:
        yield world
        for done in range(every, steps + 1, every):
            world.step(dt, every)
            yield world
            if progress is not None:
                progress(done, steps)
        world.step(dt, steps % every)

    write_states(path, states(), rate=1 / (dt * every))


def write_states(
    path: str | os.PathLike[str], states: Iterable[World], *, rate: float = 30.0
) -> None:
    """Write states of a world.

    Parameters
    ----------
    path : path-like
        The file, whose suffix is the format: .mp4, .gif, .gsd, .csv or .npz.
    states : iterable of World
        The states, of which each is written before the next is taken. They may be one world that a
        generator steps.
    rate : float, default 30.0
        Pictures per second of a film, from 10 to 60, or to 50 in .gif; the nearest of these is
        used.

    Raises
    ------
    ValueError
        If the suffix is another, or the rate is not above 0.
    ModuleNotFoundError
        If a package of the extra `record` is missing.
    OSError
        If the file cannot be written. Then an old file is as it was.

    Notes
    -----
    A film shows the container, the period, or the discs and walls of the first state. Colours are
    those of the speed, or of the kind if there are several. Its longer side has 1280 pixels, in
    .gif 640.

    A table .csv has the columns time, id, x, y, vx, vy, radius and mass, in world units. In .npz,
    `times` has a number for each state, and the particles of state k are the rows ``offsets[k]`` to
    ``offsets[k + 1]`` of `ids`, `positions`, `velocities`, `angles`, `angular_velocities`, `radii`
    and `masses`.

    In .gsd the origin is the middle of the box, and y grows upwards, so that particles fall in the
    same direction as in films. Types are movable and fixed; ids are in ``log/particles/id``, the
    time is in ``log/time``.

    Examples
    --------
    >>> from jostle.record import write_states
    >>> world = jostle.scenes.create("gas", n=20)
    >>> write_states("gas.csv", [world])
    >>> np.loadtxt("gas.csv", delimiter=",", skiprows=1).shape
    (20, 8)
    """
    suffix = format_of(path, (*LONGEST, *_WRITERS))
    if not 0 < rate < np.inf:
        raise ValueError(f"rate is {rate}; it must be finite and above 0")
    if suffix in LONGEST:
        _write_film(Path(path), states, min(max(rate, SLOWEST), FASTEST[suffix]), LONGEST[suffix])
    else:
        with NewFile(Path(path)) as new:
            _WRITERS[suffix](new.path, states)


def _write_film(path: Path, states: Iterable[World], rate: float, longest: int) -> None:
    """Write a film of the part of the plane that the first state is in."""
    rest = iter(states)
    for first in rest:
        camera = Camera(first, longest)
        with Film(path, camera.size, rate) as film:
            for world in itertools.chain([first], rest):
                film.add(camera.picture(world))


def _write_csv(path: Path, states: Iterable[World]) -> None:
    line = "%.17g,%d" + ",%.9g" * 6 + "\n"  # the digits that distinguish any two of their type
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("time,id,x,y,vx,vy,radius,mass\n")
        for world in states:
            motion = *world.positions.T, *world.velocities.T
            columns = (world.ids, *motion, world.radii, world.masses)
            rows = zip(*(column.tolist() for column in columns), strict=True)
            file.writelines(line % (world.time, *row) for row in rows)


def _write_npz(path: Path, states: Iterable[World]) -> None:
    times, columns = [], []
    for world in states:
        times.append(world.time)
        columns.append([getattr(world, name) for name in _ARRAYS])
    offsets = np.cumsum([0, *(len(state[0]) for state in columns)])
    arrays: dict[str, Any] = {"times": np.array(times), "offsets": offsets}
    for name, parts in zip(_ARRAYS, zip(*columns, strict=True), strict=False):
        arrays[name] = np.concatenate(parts)
    with path.open("wb") as file:
        np.savez(file, **arrays)


def _write_gsd(path: Path, states: Iterable[World]) -> None:
    with extra("a trajectory"):
        import gsd.hoomd
    with gsd.hoomd.open(str(path), "w") as file:
        for step, world in enumerate(states):
            frame = gsd.hoomd.Frame()
            frame.configuration.step, frame.configuration.dimensions = step, 2
            _fill(frame, world)
            file.append(frame)


def _fill(frame: Any, world: World) -> None:
    n, positions, particles = len(world), world.positions, frame.particles
    edges = np.array(bounds_of(world)).reshape(2, 2)
    low = np.minimum(edges[0], positions.min(axis=0, initial=np.inf))
    high = np.maximum(edges[1], positions.max(axis=0, initial=-np.inf))
    frame.configuration.box = [*(high - low), 0, 0, 0, 0]
    particles.N, particles.types = n, ["movable", "fixed"]
    particles.typeid = np.where(world.movable, 0, 1).astype(np.uint32)
    particles.position = _upwards(positions - (low + high) / 2)
    particles.velocity = _upwards(world.velocities)
    particles.diameter, particles.mass = 2 * world.radii, world.masses
    frame.log["particles/id"], frame.log["time"] = world.ids, np.array([world.time])


def _upwards(vectors: NDArray[np.floating]) -> NDArray[np.float32]:
    """Return (n, 3) vectors from (n, 2), with y inverted."""
    return np.pad(vectors * (1, -1), ((0, 0), (0, 1))).astype(np.float32)


_WRITERS = {".gsd": _write_gsd, ".csv": _write_csv, ".npz": _write_npz}
