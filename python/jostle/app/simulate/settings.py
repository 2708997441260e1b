"""What to simulate: the settings that the command, a file and the sliders have in common."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from jostle.app.simulate.rules import Rule, check, one_of, pair, range_of, real, whole

METHODS = ("quadtree", "brute", "article-quadtree", "article-brute")
RENDERERS = ("auto", "opengl", "software")
CONTAINERS = ("box", "circle", "torus", "none")
ON_TOUCH = ("bounce", "merge", "ignore")
MOST_PARTICLES = 100_000_000

OnTouch = Literal["bounce", "merge", "ignore"]
Range = tuple[float, float]


@dataclass(frozen=True)
class Group:
    """Particles that a file adds to a scene, scattered by chance over a region."""

    count: int = 1
    region: tuple[float, float, float, float] | None = None  # the whole view, if None
    radius: Range = (5.0, 5.0)
    density: Range = (1.0, 1.0)
    velocity: tuple[float, float] = (0.0, 0.0)  # world units a second
    speed: Range = (0.0, 0.0)  # in any direction, added to the velocity
    movable: bool = True


@dataclass
class Settings:
    """A scene and how it runs; None leaves a choice to the scene or the library."""

    scene: str = "mixed"
    n: int | None = None
    seed: int = 0
    method: str = "quadtree"
    leaf_capacity: int | None = None
    max_depth: int | None = None
    world_size: float = 1.0  # the container's sides, as a multiple of the scene's own
    container: Literal["box", "circle", "torus", "none"] | None = None
    gravity: tuple[float, float] | None = None  # world units a second squared
    drag: float | None = None  # 1/s
    restitution: float | None = None
    substeps: int | None = None
    threads: int | None = None
    on_touch: OnTouch | None = None
    time_scale: float = 1.0  # simulated seconds a second
    particles: tuple[Group, ...] = ()  # beside those of the scene

    @property
    def by_article(self) -> bool:
        """Whether the article's rules hold."""
        return self.method.startswith("article-")


TEXT = Rule("a text", lambda value: isinstance(value, str))
TRUTH = Rule("true or false", lambda value: isinstance(value, bool))

RULES: dict[str, Rule] = {
    "scene": TEXT,
    "n": whole(0, MOST_PARTICLES),
    "seed": whole(0, 2**63 - 1),
    "method": one_of(*METHODS),
    "leaf_capacity": whole(1, 2**31 - 1),
    "max_depth": whole(0, 2**31 - 1),
    "world_size": real(0.01, 100),
    "container": one_of(*CONTAINERS),
    "gravity": pair("x, y"),
    "drag": real(0),
    "restitution": real(0, 1),
    "substeps": whole(1, 1_000),
    "threads": whole(1, 1_024),
    "on_touch": one_of(*ON_TOUCH),
    "time_scale": real(0.001, 100),
}

GROUP_RULES: dict[str, Rule] = {
    "count": whole(0, MOST_PARTICLES),
    "region": Rule(
        "four finite numbers [min_x, min_y, max_x, max_y], the smaller ones first",
        lambda value: (
            isinstance(value, list | tuple)
            and len(value) == 4
            and all(real().fits(v) for v in value)
            and value[0] <= value[2]
            and value[1] <= value[3]
        ),
    ),
    "radius": range_of(1e-6),
    "density": range_of(1e-6),
    "velocity": pair("x, y"),
    "speed": range_of(0.0),
    "movable": TRUTH,
}


def settings_of(facts: Mapping[str, Any]) -> Settings:
    """Return settings from their fields, as JSON and TOML give them; a ValueError says why not."""
    given = dict(facts)
    groups = given.pop("particles", ())
    plain = _checked(given, RULES, "a setting")
    return Settings(**plain, particles=tuple(group_of(group) for group in groups))


def group_of(facts: Mapping[str, Any]) -> Group:
    """Return a group from its fields; one number for a range stands for both of its ends."""
    plain = _checked(facts, GROUP_RULES, "a property of particles")
    for name in ("radius", "density", "speed"):
        if isinstance(plain.get(name), int | float):
            plain[name] = (plain[name], plain[name])
    return Group(**plain)


def _checked(facts: Mapping[str, Any], rules: Mapping[str, Rule], what: str) -> dict[str, Any]:
    """Return the values as the fields want them; a ValueError says which cannot be."""
    for name, value in facts.items():
        if name not in rules:
            raise ValueError(f"{name} is not {what}")
        if value is not None and (refusal := check(name, value, rules[name])):
            raise ValueError(refusal)
    return {name: tidy(value) for name, value in facts.items()}


def tidy(value: Any) -> Any:
    """Return lists as tuples of real numbers, and everything else as it is."""
    return tuple(map(float, value)) if isinstance(value, list | tuple) else value
