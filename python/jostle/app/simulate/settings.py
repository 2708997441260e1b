"""The settings of a simulation, for the command line, files and sliders."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

import jostle
from jostle.app.simulate.validation import (
    AnyRule,
    Fields,
    Key,
    Many,
    Rule,
    dotted,
    each,
    one_of,
    or_none,
    range_of,
    real,
    rect,
    require,
    shown,
    unknown,
    whole,
)

METHODS = ("quadtree", "brute", "article-quadtree", "article-brute")
RENDERERS = ("auto", "opengl", "software")
CONTAINERS = ("box", "circle", "torus", "none")
ON_TOUCH = ("bounce", "merge", "ignore")
MAX_PARTICLES = 100_000_000
MOST_GROUPS = 1_000  # of particles that a file adds
MOST_LINES = 10_000  # of walls that a file adds, and points of one of them

OnTouch = Literal["bounce", "merge", "ignore"]
Range = tuple[float, float]


@dataclass(frozen=True)
class Group:
    """Particles that a file adds to a scene, at random positions in a region."""

    count: int = 1
    region: tuple[float, float, float, float] | None = None  # the whole view, if None
    radius: Range = (5.0, 5.0)
    density: Range = (1.0, 1.0)
    velocity: tuple[float, float] = (0.0, 0.0)  # world units per second
    speed: Range = (0.0, 0.0)  # in any direction, added to the velocity
    movable: bool = True
    sensor: bool = False  # whether they only report what touches them


@dataclass(frozen=True)
class Polyline:
    """Walls from point to point."""

    points: tuple[tuple[float, float], ...]
    closed: bool = False  # whether there is a wall from the last point to the first
    restitution: float = 1.0  # multiplied by those of the world and the particle
    friction: float | None = None  # that of the particle, if None
    velocity: tuple[float, float] = (0.0, 0.0)  # world units per second
    period: float | None = None  # of the motion back and forth, in seconds; without it if None
    temperature: float | None = None  # kT of thermal walls; others, if None


@dataclass
class Settings:
    """A scene and its settings; None means the default of the scene or of the library."""

    scene: str = "mixed"
    n: int | None = None
    seed: int = 0
    method: str = "quadtree"
    leaf_capacity: int | None = None
    max_depth: int | None = None
    world_size: float = 1.0  # the container's sides, as a multiple of the scene's own
    container: Literal["box", "circle", "torus", "none"] | None = None
    gravity: tuple[float, float] | None = None  # world units per second squared
    drag: float | None = None  # 1/s
    restitution: float | None = None
    substeps: int | None = None
    threads: int | None = None
    on_touch: OnTouch | None = None
    time_scale: float = 1.0  # simulated seconds per second
    particles: tuple[Group, ...] = ()  # in addition to those of the scene
    friction: float | None = None  # of every particle
    sleeping: bool | None = None  # whether particles that rest may fall asleep
    walls: tuple[Polyline, ...] = ()  # in addition to those of the scene
    # Of the sides of the container: of all, or at min x, max x, min y and max y.
    container_restitution: float | tuple[float, float, float, float] | None = None
    wall_friction: float | None = None  # of walls that a user draws; that of the particle, if None

    @property
    def by_article(self) -> bool:
        """Whether the article's rules apply."""
        return self.method.startswith("article-")


TEXT = Rule("a text", lambda value: isinstance(value, str))
TRUTH = Rule("true or false", lambda value: isinstance(value, bool))

PARTICLES = whole(0, MAX_PARTICLES)
SEED = whole(0, 2**63 - 1)
STEPS = whole(1, 2**31 - 1)
THREADS = whole(1, 1_024)

_SHARE, _SHARES = real(0, 1), each(real(0, 1), "min x", "max x", "min y", "max y")
SIDES = Rule(
    f"{_SHARE.words}, or {_SHARES.words}",
    lambda value: _SHARE.fits(value) or _SHARES.fits(value),
)

# Rules for the settings of a scene, for files, the command and the sliders.
RULES: dict[str, Rule] = {
    "scene": TEXT,
    "n": or_none(PARTICLES),
    "seed": SEED,
    "method": one_of(*METHODS),
    "leaf_capacity": or_none(whole(1, 2**31 - 1)),
    "max_depth": or_none(whole(0, 2**31 - 1)),
    "world_size": real(0.01, 100),
    "container": or_none(one_of(*CONTAINERS)),
    "gravity": or_none(each(real(), "x", "y")),
    "drag": or_none(real(0)),
    "restitution": or_none(real(0, 1)),
    "container_restitution": or_none(SIDES),
    "friction": or_none(real(0)),
    "wall_friction": or_none(real(0)),
    "substeps": or_none(whole(1, 1_000)),
    "threads": or_none(THREADS),
    "on_touch": or_none(one_of(*ON_TOUCH)),
    "sleeping": or_none(TRUTH),
    "time_scale": real(0.001, 100),
}

GROUP_RULES: dict[str, Rule] = {
    "count": PARTICLES,
    "region": or_none(rect(least=0.0)),
    "radius": range_of(1e-6),
    "density": range_of(1e-6),
    "velocity": each(real(), "x", "y"),
    "speed": range_of(0.0),
    "movable": TRUTH,
    "sensor": TRUTH,
}

GROUPS = Many(
    Fields(GROUP_RULES, "a property of particles", complete=False),
    "written as [[particles]], once for each group",
    MOST_GROUPS,
)
LINE_RULES: dict[str, AnyRule] = {
    "points": Many(each(real(), "x", "y"), "a list of points, each [x, y]", MOST_LINES),
    "closed": TRUTH,
    "restitution": real(0, 1),
    "friction": or_none(real(0)),
    "velocity": each(real(), "x", "y"),
    "period": or_none(real(0.001)),
    "temperature": or_none(real(1e-6)),
}
LINES = Many(
    Fields(LINE_RULES, "a property of walls", complete=False),
    "written as [[walls]], once for each polyline",
    MOST_LINES,
)
SETTINGS = Fields({**RULES, "particles": GROUPS, "walls": LINES}, "a setting", complete=False)


def settings_of(facts: Mapping[str, Any]) -> Settings:
    """Return settings from fields of JSON or TOML; raise a ValueError if one is wrong."""
    require(facts, SETTINGS)
    for key, why in degenerate_walls(facts):
        raise ValueError(f"{dotted(key)} {why}")
    groups = tuple(map(_group_of, facts.get("particles", ())))
    lines = tuple(map(_line_of, facts.get("walls", ())))
    return Settings(**{**_tidy(facts), "particles": groups, "walls": lines})


def degenerate_walls(facts: Mapping[str, Any]) -> Iterator[tuple[Key, str]]:
    """Yield the key and the message of each polyline without length, after a check of its types.

    Coordinates are compared in float32, as the library stores them.
    """
    for number, line in enumerate(facts.get("walls", ())):
        if "points" not in line:
            yield ("walls", number, "points"), "is missing"
            continue
        key: Key = ("walls", number, "points")
        points = np.array(line["points"], np.float32).reshape(-1, 2)
        closed = bool(line.get("closed", False))
        least = 3 if closed else 2
        if len(points) < least:
            what = "closed polyline" if closed else "polyline"
            yield key, f"has {len(points)} entries; a {what} needs at least {least}"
        after = np.roll(points, -1, axis=0) if closed else points[1:]
        for row in np.flatnonzero((points[: len(after)] == after).all(axis=1))[:1].tolist():
            other = (row + 1) % len(points)
            why = (
                f"is {shown(list(line['points'][other]))}, like points[{row}]; a wall needs length"
            )
            yield (*key, other), why


def unknown_scene(name: str) -> str | None:
    """Return why a scene is refused, or None."""
    names = jostle.scenes.names()
    return None if name in names else unknown(name, "a scene", names)


def _group_of(facts: Mapping[str, Any]) -> Group:
    """Return a group from its fields; one number for a range is both of its ends."""
    plain = _tidy(facts)
    for name in ("radius", "density", "speed"):
        if isinstance(plain.get(name), int | float):
            plain[name] = (plain[name], plain[name])
    return Group(**plain)


def _line_of(facts: Mapping[str, Any]) -> Polyline:
    """Return a polyline from its fields."""
    points = tuple((float(x), float(y)) for x, y in facts["points"])
    x, y = facts.get("velocity", (0.0, 0.0))
    return Polyline(**{**facts, "points": points, "velocity": (float(x), float(y))})


def _tidy(facts: Mapping[str, Any]) -> dict[str, Any]:
    """Return lists as tuples of real numbers, and other values unchanged."""
    return {
        name: tuple(map(float, value)) if isinstance(value, list | tuple) else value
        for name, value in facts.items()
        if name not in ("particles", "walls")
    }
