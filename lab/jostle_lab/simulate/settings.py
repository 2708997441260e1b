"""The settings of a simulation, each declared with its limits.

The same declarations check the command line, TOML files, scene files and panels.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

import jostle
from jostle import life
from jostle_lab.simulate.validation import (
    Many,
    Refusals,
    Rule,
    each,
    either,
    fields_of,
    limited,
    one_of,
    or_none,
    range_of,
    real,
    rect,
    refusals,
    shorten,
    shown,
    unknown,
    whole,
)

# Names of the methods in the user interface.
METHODS = {"quadtree": "quadtree", "brute": "brute force"}
MOST_BRUTE = 30_000  # particles with which a running scene takes brute force
MAX_PARTICLES = 100_000_000
MOST_GROUPS = 1_000  # of particles that a file adds
MOST_KINDS = 16  # of particle life
EVERY_CATEGORY = 2**32 - 1  # a mask with all bits
MOST_LINES = 10_000  # of walls that a file adds, and points of one of them

OnTouch = Literal["bounce", "merge", "ignore"]
ContainerKind = Literal["box", "circle", "torus", "none"]
ON_TOUCH, CONTAINERS = get_args(OnTouch), get_args(ContainerKind)
Range = tuple[float, float]
Vector = tuple[float, float]
Rect = tuple[float, float, float, float]
Matrix = tuple[tuple[float, ...], ...]

TEXT = Rule("a text", lambda value: isinstance(value, str))
TRUTH = Rule("true or false", lambda value: isinstance(value, bool))
VECTOR = each(real(), "x", "y")
PARTICLES = whole(0, MAX_PARTICLES)
SEED = whole(0, 2**63 - 1)
STEPS = whole(1, 2**31 - 1)
THREADS = whole(1, 1_024)

SIDES = either(real(0, 1), each(real(0, 1), "min x", "max x", "min y", "max y"))


def _is_matrix(value: Any) -> bool:
    rows = value if isinstance(value, list | tuple) else ()
    line = each(real(-1, 1), *map(str, range(len(rows))))
    return 1 <= len(rows) <= MOST_KINDS and all(map(line.fits, rows))


_ROWS = Rule(
    f"up to {MOST_KINDS} rows of as many numbers from -1 to 1",
    _is_matrix,
    lambda rows: tuple(tuple(map(float, row)) for row in rows),
)
MATRIX = either(one_of(*life.MATRICES), _ROWS)


# Of a whole group, or of each particle; `_wrong_filters` checks the entries of a list.
_BITS = whole(0, EVERY_CATEGORY)
_EACH_BITS = Rule(
    "a list of such numbers, one for each particle",
    lambda value: isinstance(value, list | tuple),
    tuple,
)
FILTER = either(_BITS, _EACH_BITS)


@dataclass(frozen=True)
class Group:
    """Particles that a file adds to a scene, at random positions in a region."""

    count: int = limited(PARTICLES, 1)
    region: Rect | None = limited(or_none(rect(least=0.0)), None)  # the whole view, if None
    radius: Range = limited(range_of(1e-6), (5.0, 5.0))
    density: Range = limited(range_of(1e-6), (1.0, 1.0))
    velocity: Vector = limited(VECTOR, (0.0, 0.0))  # world units per second
    speed: Range = limited(range_of(0.0), (0.0, 0.0))  # in any direction, added to the velocity
    movable: bool = limited(TRUTH, True)
    sensor: bool = limited(TRUTH, False)  # whether they only report what touches them
    categories: int | tuple[int, ...] = limited(FILTER, 1)  # bit sets, as those of `jostle.World`
    masks: int | tuple[int, ...] = limited(FILTER, EVERY_CATEGORY)


@dataclass(frozen=True)
class Polyline:
    """Walls from point to point."""

    points: tuple[Vector, ...] = limited(Many(VECTOR, "a list of points, each [x, y]", MOST_LINES))
    closed: bool = limited(TRUTH, False)  # whether there is a wall from the last point to the first
    # A contact has the square root of the product with that of the particle; this alone, if None.
    restitution: float | None = limited(or_none(real(0, 1)), None)
    friction: float | None = limited(or_none(real(0)), None)  # that of the particle, if None
    velocity: Vector = limited(VECTOR, (0.0, 0.0))  # world units per second
    # Seconds of the motion there and back; without it if None.
    cycle: float | None = limited(or_none(real(0.001)), None)
    temperature: float | None = limited(or_none(real(1e-6)), None)  # kT of thermal walls
    one_way: bool = limited(TRUTH, False)  # solid for what comes from the left of start → end
    categories: int = limited(_BITS, 1)  # bit sets, as those of `jostle.World.walls`
    masks: int = limited(_BITS, EVERY_CATEGORY)


def _degenerate(line: Mapping[str, Any]) -> Refusals:
    """Yield the key and the message of a wall without length.

    Coordinates are compared in float32, as the library stores them.
    """
    points = np.array(line["points"], np.float32).reshape(-1, 2)
    closed = line.get("closed", False)
    least = 3 if closed else 2
    if len(points) < least:
        what = "closed polyline" if closed else "polyline"
        yield ("points",), f"has {len(points)} entries; a {what} needs at least {least}"
    after = np.roll(points, -1, axis=0) if closed else points[1:]
    for row in np.flatnonzero((points[: len(after)] == after).all(axis=1))[:1].tolist():
        other = (row + 1) % len(points)
        why = f"is {shown(list(line['points'][other]))}, like points[{row}]; a wall needs length"
        yield ("points", other), why


def _wrong_filters(group: Mapping[str, Any]) -> Refusals:
    """Yield the key and the message of a list of bit sets with a wrong number or length."""
    count = group.get("count", 1)
    for name in ("categories", "masks"):
        bits = group.get(name, 0)
        if not isinstance(bits, list | tuple):
            continue
        for (row,), why in refusals(bits, Many(_BITS, most=MAX_PARTICLES)):
            yield (name, row), why
        if len(bits) != count:
            yield (name,), f"has {len(bits):,} entries; the group has {count:,} particles"


GROUPS = Many(
    fields_of(Group, "a property of particles", also=_wrong_filters),
    "written as [[particles]], once for each group",
    MOST_GROUPS,
)
LINES = Many(
    fields_of(Polyline, "a property of walls", also=_degenerate),
    "written as [[walls]], once for each polyline",
    MOST_LINES,
)


@dataclass
class Settings:
    """A scene and its settings; None means the default of the scene or of the library."""

    scene: str = limited(TEXT, "mixed")
    n: int | None = limited(or_none(PARTICLES), None)
    seed: int = limited(SEED, 0)
    method: str = limited(one_of(*METHODS), "quadtree")
    leaf_capacity: int | None = limited(or_none(whole(1, 2**31 - 1)), None)
    max_depth: int | None = limited(or_none(whole(0, 2**31 - 1)), None)
    # The container's sides, as a multiple of the scene's own.
    world_size: float = limited(real(0.01, 100), 1.0)
    container: ContainerKind | None = limited(or_none(one_of(*CONTAINERS)), None)
    gravity: Vector | None = limited(or_none(VECTOR), None)  # world units per second squared
    drag: float | None = limited(or_none(real(0)), None)  # 1/s
    restitution: float | None = limited(or_none(real(0, 1)), None)  # of every particle
    substeps: int | None = limited(or_none(whole(1, 1_000)), None)
    threads: int | None = limited(or_none(THREADS), None)
    on_touch: OnTouch | None = limited(or_none(one_of(*ON_TOUCH)), None)
    time_scale: float = limited(real(0.001, 100), 1.0)  # simulated seconds per second
    particles: tuple[Group, ...] = limited(GROUPS, ())  # in addition to those of the scene
    friction: float | None = limited(or_none(real(0)), None)  # of every particle
    sleeping: bool | None = limited(or_none(TRUTH), None)  # whether resting particles may sleep
    walls: tuple[Polyline, ...] = limited(LINES, ())  # in addition to those of the scene
    # Of the sides of the container: of all, or at min x, max x, min y and max y; that of the
    # particle, if None.
    container_restitution: float | Rect | None = limited(or_none(SIDES), None)
    # Of walls that a user draws; that of the particle, if None.
    wall_friction: float | None = limited(or_none(real(0)), None)
    # Of particle life: a name of `life.MATRICES`, or numbers.
    matrix: str | Matrix | None = limited(or_none(MATRIX), None)


SETTINGS = fields_of(Settings, "a setting")
RULES = SETTINGS.rules


def too_slow(method: str, n: int) -> str | None:
    """Return why a running scene of n particles cannot have a method, or None."""
    if method != "brute" or n <= MOST_BRUTE:
        return None
    return (
        f"More than {MOST_BRUTE:,} particles are too slow with brute force: a step takes seconds."
    )


def unknown_scene(name: str) -> str | None:
    """Return why a scene is refused, or None."""
    names = jostle.scenes.names()
    return None if name in names else f"{shorten(name)} {unknown(name, 'a scene', names)}"
