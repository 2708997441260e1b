"""The settings of a simulation: each is declared here, once.

Title, unit, limits, help and slider of a setting follow from its field: the panel, the options of
the command, TOML files, sweeps, the page docs/settings.md and the messages of errors use them.
"""

import dataclasses
import difflib
from collections.abc import Iterable, Iterator
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Strict,
    Tag,
    TypeAdapter,
    ValidationError,
    model_validator,
)
from pydantic.dataclasses import dataclass
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

import jostle
from jostle import life

T = TypeVar("T")

FARTHEST = 1e18  # the largest coordinate, velocity and force of the library
EVERY_CATEGORY = 2**32 - 1  # a mask with all bits
MAX_PARTICLES = 100_000_000
MOST_BRUTE = 30_000  # particles with which a running scene takes brute force
MOST_KINDS = 16  # of particle life
SHORTEST = 1e-6  # side of a rectangle, as a share of its coordinates
FORBID = ConfigDict(extra="forbid", arbitrary_types_allowed=True)

# Names of the choices in the user interface.
METHODS = {"quadtree": "quadtree", "brute": "brute force"}
CONTAINERS = {"box": "box", "circle": "circle", "torus": "periodic", "none": "no walls"}
ON_TOUCH = {"bounce": "bounce", "merge": "merge", "ignore": "off"}
SLEEPING = {True: "on", False: "off"}


# ---- Types ---------------------------------------------------------------------------------------


def fault(rule: str) -> PydanticCustomError:
    """Return the error of a value that breaks a rule, such as "it must be in order"."""
    return PydanticCustomError("fault", "{rule}", {"rule": rule})


def fault_at(field: str, why: str) -> PydanticCustomError:
    """Return the error of a field, found by comparing it with others."""
    return PydanticCustomError("fault at", "{field} {why}", {"field": field, "why": why})


def _kind(value: object) -> str:
    return "~list" if isinstance(value, list | tuple) else "~one"  # names of alternatives


def _as_range(value: object) -> object:
    return value if isinstance(value, list | tuple) else (value, value)


def _as_vector(value: object) -> object:
    return value if isinstance(value, list | tuple) else (0.0, value)


def _in_order(values: tuple[float, float]) -> tuple[float, float]:
    if values[0] > values[1]:
        raise fault("it must be [smallest, largest]")
    return values


def _is_ordered(corners: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    x0, y0, x1, y1 = corners
    if x1 < x0 or y1 < y0:
        raise fault("it must be [min_x, min_y, max_x, max_y], the smaller ones first")
    return corners


def _has_sides(corners: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    x0, y0, x1, y1 = _is_ordered(corners)
    shortest = SHORTEST * max(1.0, *map(abs, corners))
    if x1 - x0 < shortest or y1 - y0 < shortest:
        raise fault(f"its sides must be at least {shortest:g}")
    return corners


def _is_square(rows: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    if any(len(row) != len(rows) for row in rows):
        raise fault("it must have as many columns as rows")
    return rows


Truth = Annotated[bool, Strict()]
Real = Annotated[float, Strict(), Field(ge=-FARTHEST, le=FARTHEST)]
Coefficient = Annotated[float, Strict(), Field(ge=0, le=FARTHEST)]
Share = Annotated[float, Strict(), Field(ge=0, le=1)]
Size = Annotated[float, Strict(), Field(ge=1e-6, le=FARTHEST)]
Count = Annotated[int, Strict(), Field(ge=0, le=MAX_PARTICLES)]
Natural = Annotated[int, Strict(), Field(ge=1, le=2**31 - 1)]
Seed = Annotated[int, Strict(), Field(ge=0, le=2**63 - 1)]
Id = Annotated[int, Strict(), Field(ge=0, le=2**62)]
Bits = Annotated[int, Strict(), Field(ge=0, le=EVERY_CATEGORY)]
Pixels = Annotated[int, Strict(), Field(ge=64, le=16_384)]
Vector = tuple[Real, Real]
Gravity = Annotated[Vector, BeforeValidator(_as_vector)]  # a number points downwards
Rect = tuple[Real, Real, Real, Real]
Corners = Annotated[Rect, AfterValidator(_is_ordered)]
Region = Annotated[Rect, AfterValidator(_has_sides)]
SizeRange = Annotated[tuple[Size, Size], BeforeValidator(_as_range), AfterValidator(_in_order)]
SpeedRange = Annotated[
    tuple[Coefficient, Coefficient], BeforeValidator(_as_range), AfterValidator(_in_order)
]
Row = tuple[Annotated[float, Strict(), Field(ge=-1, le=1)], ...]
Matrix = Annotated[
    tuple[Row, ...], Field(min_length=1, max_length=MOST_KINDS), AfterValidator(_is_square)
]
Sides = Annotated[
    Annotated[Share, Tag("~one")] | Annotated[tuple[Share, Share, Share, Share], Tag("~list")],
    Discriminator(_kind),
]
Filter = Annotated[
    Annotated[Bits, Tag("~one")] | Annotated[tuple[Bits, ...], Tag("~list")], Discriminator(_kind)
]
Method = Literal["quadtree", "brute"]
ContainerKind = Literal["box", "circle", "torus", "none"]
OnTouch = Literal["bounce", "merge", "ignore"]


# ---- Declarations --------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Slider:
    """The range of a slider; `form` formats its values."""

    low: float
    high: float
    log: bool = False
    form: str = "%.2f"


def setting(default: Any, title: str, about: str, **more: Any) -> Any:
    """Return a field of the settings.

    `more` may have a `unit`, a `slider` or `labels` of the values, the `panel` that shows it, and
    what it `sets` in a running simulation: an attribute of the "world", a column of its
    "particles", or something "else".
    """
    return Field(default, title=title, description=about, json_schema_extra=more)


@dataclass(frozen=True, config=FORBID)
class Group:
    """Particles that a file adds to a scene, at random free positions of a region."""

    count: Count = setting(1, "count", "number of particles")
    region: Corners | None = setting(
        None, "region", "[min_x, min_y, max_x, max_y]; the whole view unless given"
    )
    radius: SizeRange = setting((5.0, 5.0), "radius", "a number, or [smallest, largest]")
    density: SizeRange = setting((1.0, 1.0), "density", "mass over radius²; a number or a range")
    velocity: Vector = setting(
        (0.0, 0.0), "velocity", "[x, y], of every particle", unit="world units/s"
    )
    speed: SpeedRange = setting(
        (0.0, 0.0), "speed", "in any direction, added to the velocity", unit="world units/s"
    )
    movable: Truth = setting(
        True, "movable", "others keep their velocity, and push without being pushed"
    )
    sensor: Truth = setting(
        False, "sensor", "drawn as a ring, bright while something touches it, and pushes nothing"
    )
    categories: Filter = setting(
        1, "categories", "bit set of the collision filter, or one for each particle"
    )
    masks: Filter = setting(
        EVERY_CATEGORY, "masks", "bit set of the collision filter, or one for each particle"
    )

    @model_validator(mode="after")
    def _one_for_each(self) -> "Group":
        for name in ("categories", "masks"):
            bits = getattr(self, name)
            if isinstance(bits, tuple) and len(bits) != self.count:
                why = f"has {len(bits):,} entries; the group has {self.count:,} particles"
                raise fault_at(name, why)
        return self


@dataclass(frozen=True, config=FORBID)
class Polyline:
    """Walls from point to point."""

    points: Annotated[tuple[Vector, ...], Field(max_length=10_000)] = Field(
        title="points", description="at least 2; consecutive points must differ"
    )
    closed: Truth = setting(False, "closed", "with a wall from the last point to the first")
    restitution: Share | None = setting(None, "restitution", "that of the particle unless given")
    friction: Coefficient | None = setting(None, "friction", "that of the particle unless given")
    velocity: Vector = setting((0.0, 0.0), "velocity", "[x, y]")
    cycle: Annotated[float, Strict(), Field(ge=0.001, le=FARTHEST)] | None = setting(
        None,
        "cycle",
        "duration of the motion there and back; unless given they never go back",
        unit="s",
    )
    temperature: Size | None = setting(
        None,
        "temperature",
        "kT: particles leave the walls as from a gas of this mean kinetic energy",
    )
    one_way: Truth = setting(
        False,
        "one way",
        "solid only for what comes from the left of the way: from the side of (−dy, dx)",
    )
    categories: Bits = setting(1, "categories", "bit set of the collision filter")
    masks: Bits = setting(EVERY_CATEGORY, "masks", "bit set of the collision filter")

    @model_validator(mode="after")
    def _has_lengths(self) -> "Polyline":
        """Refuse walls without length; coordinates are compared as the library stores them."""
        least = 3 if self.closed else 2
        if len(self.points) < least:
            what = "closed polyline" if self.closed else "polyline"
            why = f"has {len(self.points)} entries; a {what} needs at least {least}"
            raise fault_at("points", why)
        with np.errstate(over="ignore"):  # the library refuses what is out of range
            points = np.array(self.points, np.float32)
        after = np.roll(points, -1, axis=0) if self.closed else points[1:]
        for row in np.flatnonzero((points[: len(after)] == after).all(axis=1))[:1].tolist():
            other = (row + 1) % len(points)
            x, y = self.points[other]
            why = f"is [{x:g}, {y:g}], like points[{row}]; a wall needs length"
            raise fault_at(f"points[{other}]", why)
        return self


@dataclass(frozen=True, config=FORBID)
class Settings:
    """A scene and its settings; None means the default of the scene or of the library."""

    scene: str = setting("mixed", "scene", "as `jostle scenes` lists them")
    n: Count | None = setting(
        None, "particles", "number of particles of the scene",
        slider=Slider(0, 1_000_000, log=True), sets="else",
    )  # fmt: skip
    seed: Seed = setting(0, "seed", "the same seed gives the same run")
    method: Method = setting("quadtree", "method", "how pairs are found", sets="world")
    leaf_capacity: Natural | None = setting(
        None, "leaf capacity", "maximum number of particles in a leaf of the tree",
        slider=Slider(1, 1024, log=True), panel="tree", sets="world",
    )  # fmt: skip
    max_depth: Annotated[int, Strict(), Field(ge=0, le=2**31 - 1)] | None = setting(
        None, "max. depth", "maximum depth of the tree", slider=Slider(1, 4096, log=True),
        panel="tree", sets="world",
    )  # fmt: skip
    world_size: Annotated[float, Strict(), Field(ge=0.01, le=100)] = setting(
        1.0, "world size", "the container's sides, as a multiple of the scene's own",
        slider=Slider(0.25, 4.0, log=True, form="%.2f ×"), panel="world", sets="else",
    )  # fmt: skip
    container: ContainerKind | None = setting(
        None, "container", "what encloses the particles; a torus is periodic", labels=CONTAINERS,
        panel="world", sets="else",
    )  # fmt: skip
    gravity: Gravity | None = setting(
        None, "gravity", "[x, y], or a number, which points downwards", unit="world units/s²",
        slider=Slider(0.0, 2000.0, form="%.0f"), panel="world", sets="world",
    )  # fmt: skip
    drag: Coefficient | None = setting(
        None, "drag", "rate at which velocities decrease", unit="1/s", slider=Slider(0.0, 5.0),
        panel="world", sets="world",
    )  # fmt: skip
    restitution: Share | None = setting(
        None, "restitution", "of every particle; contacts have the square root of both multiplied",
        slider=Slider(0.0, 1.0), panel="world", sets="particles",
    )  # fmt: skip
    substeps: Annotated[int, Strict(), Field(ge=1, le=1_000)] | None = setting(
        None, "sub-steps", "of each step; as many as it needs unless given",
        slider=Slider(1, 32, log=True), panel="time", sets="world",
    )  # fmt: skip
    threads: Annotated[int, Strict(), Field(ge=1, le=1_024)] | None = setting(
        None, "threads", "all cores unless given", slider=Slider(1, 16), panel="tree", sets="world"
    )
    on_touch: OnTouch | None = setting(
        None, "collisions", "what touching particles do", labels=ON_TOUCH, panel="world",
        sets="world",
    )  # fmt: skip
    time_scale: Annotated[float, Strict(), Field(ge=0.001, le=100)] = setting(
        1.0, "speed", "simulated seconds per real second",
        slider=Slider(0.05, 8.0, log=True, form="%.2f ×"), panel="time", sets="else",
    )  # fmt: skip
    particles: Annotated[tuple[Group, ...], Field(max_length=1_000)] = setting(
        (), "particles", "groups in addition to the particles of the scene"
    )
    friction: Coefficient | None = setting(
        None, "friction", "of every particle; contacts have the square root of both multiplied",
        slider=Slider(0.0, 2.0), panel="world", sets="particles",
    )  # fmt: skip
    sleeping: Truth | None = setting(
        None, "sleeping", "whether resting particles may fall asleep", labels=SLEEPING,
        panel="world", sets="world",
    )  # fmt: skip
    walls: Annotated[tuple[Polyline, ...], Field(max_length=10_000)] = setting(
        (), "walls", "polylines in addition to the walls of the scene"
    )
    container_restitution: Sides | None = setting(
        None,
        "restitution of the container",
        "of all sides, or at min x, max x, min y and max y; that of the particle unless given",
    )
    wall_friction: Coefficient | None = setting(
        None, "wall friction", "of walls drawn in the window; that of the particles unless given",
        slider=Slider(0.0, 2.0), panel="walls", sets="else",
    )  # fmt: skip
    matrix: (
        Annotated[
            Annotated[str, Tag("~one")] | Annotated[Matrix, Tag("~list")], Discriminator(_kind)
        ]
        | None
    ) = setting(
        None, "matrix",
        "of particle life: a name such as dragons, or rows such as [[1, -0.5], [0.5, 1]]",
        sets="else",
    )  # fmt: skip

    @model_validator(mode="after")
    def _known_matrix(self) -> "Settings":
        if isinstance(self.matrix, str) and self.matrix not in life.MATRICES:
            why = unknown(self.matrix, "a matrix", life.MATRICES)
            raise fault_at("matrix", f"is {shown(self.matrix)}, which {why}")
        return self


def fields_of(kind: Any) -> dict[str, FieldInfo]:
    """Return the declarations of all fields of a class of this module."""
    fields: dict[str, FieldInfo] = kind.__pydantic_fields__
    return fields


# Settings of one value, which a panel or an option of the command can have.
SCALARS = tuple(name for name in fields_of(Settings) if name not in ("scene", "particles", "walls"))


def field_of(name: str) -> FieldInfo:
    """Return the declaration of a setting."""
    return fields_of(Settings)[name]


def title_of(name: str) -> str:
    return field_of(name).title or name


def about(name: str) -> str:
    """Return the help of a setting: a sentence with its unit."""
    words, unit = field_of(name).description or "", extra(name, "unit")
    return f"{words[:1].upper()}{words[1:]}{f', in {unit}' if unit else ''}."


def extra(name: str, what: str) -> Any:
    """Return what a setting declares beside title and help, or None; see `setting`."""
    more = field_of(name).json_schema_extra
    return more.get(what) if isinstance(more, dict) else None


def settings_with(what: str, value: str) -> tuple[str, ...]:
    """Return the settings that declare a value, such as all with `panel` "tree"."""
    return tuple(name for name in fields_of(Settings) if extra(name, what) == value)


def kind_of(name: str) -> str:
    """Return the values of a setting in words: its choices, or "whole number" and the like."""
    parts = list(_parts(field_of(name).annotation))
    for part in parts:
        if get_origin(part) is Literal:
            return "|".join(get_args(part))
    if any(get_origin(part) is tuple for part in parts):
        return "text or list" if str in parts else "number or list"
    words = {bool: "true|false", int: "whole number", float: "number", str: "text"}
    return next(words[part] for part in parts if part in words)


def _parts(annotation: Any) -> Iterator[Any]:
    """Yield an annotation and everything inside it."""
    yield annotation
    for part in get_args(annotation):
        yield from _parts(part)


# ---- Reading -------------------------------------------------------------------------------------


def read(kind: type[T], values: object, *, within: str = "", known: Iterable[str] = ()) -> T:
    """Return an object from nested tables and lists; raise a ValueError in a sentence.

    `within` is the key of the values, and `known` has names that are no fields of `kind`.
    """
    try:
        return TypeAdapter(kind).validate_python(values)
    except ValidationError as error:
        raise ValueError(sentence(error, kind, within, known)) from None


def wrong(name: str, value: object) -> str | None:
    """Return why a setting cannot have a value, or None."""
    try:
        read(Settings, {name: value})
    except ValueError as error:
        return str(error)
    return None


# Messages of pydantic that are of Python more than of the values.
RULES = {
    "dataclass_type": "it must be a table",
    "tuple_type": "it must be a list",
    "too_long": "it may have at most {max_length} entries",
    "too_short": "it must have at least {min_length} entries",
    "greater_than_equal": "it must be at least {ge}",
    "less_than_equal": "it must be at most {le}",
    "bool_type": "it must be true or false",
    "int_type": "it must be a whole number",
    "float_type": "it must be a number",
    "string_type": "it must be a text",
}


def sentence(error: ValidationError, kind: Any, within: str = "", known: Iterable[str] = ()) -> str:
    """Return the first error of a validation as a sentence: the key, the value and the rule."""
    first = error.errors(include_url=False)[0]
    parts = [part for part in first["loc"] if not str(part).startswith("~")]
    key = dotted(([within] if within else []) + parts)
    if first["type"] == "unexpected_keyword_argument":
        names = [*_fields_at(kind, parts[:-1]), *known]
        return f"{key} {unknown(str(parts[-1]), 'a setting', names)}"
    if first["type"] == "missing":
        return f"{key} is missing"
    if first["type"] == "fault at":
        return f"{key}.{first['msg']}".lstrip(".")
    rule = first["msg"].replace("Input should be", "it must be")
    if first["type"] in RULES:
        limits = {name: _number(limit) for name, limit in first.get("ctx", {}).items()}
        rule = RULES[first["type"]].format(**limits)
    return f"{key} is {shown(first['input'])}; {rule}"


def _number(limit: object) -> str:
    """Return a limit in the form 1e+18 or 1,000."""
    form = "," if isinstance(limit, int) else "g" if isinstance(limit, float) else ""
    return format(limit, form)


def _fields_at(kind: Any, path: Iterable[str | int]) -> list[str]:
    """Return the names of the fields of a dataclass inside `kind`, at the end of a path."""
    for part in path:
        if isinstance(part, str):
            annotation = kind.__pydantic_fields__[part].annotation
            tables = (each for each in _parts(annotation) if hasattr(each, "__pydantic_fields__"))
            kind = next(tables, None)
    return list(getattr(kind, "__pydantic_fields__", {}))


def unknown(name: str, what: str, known: Iterable[str]) -> str:
    """Return why a name is refused, with the most similar known name; the name comes before it."""
    known = list(known)
    alike = difflib.get_close_matches(shorten(name), known, 1, 0.5)
    hint = f"did you mean {alike[0]}?" if alike else f"there are {', '.join(known)}"
    return f"is not {what}; {hint}"


def shown(value: object) -> str:
    """Return a value for a message: one line of limited length."""
    if isinstance(value, bool):
        return str(value).lower()
    try:
        return shorten(repr(value))
    except (ValueError, RecursionError):  # thousands of digits, or of brackets
        return "too large to be shown"


def shorten(text: str) -> str:
    """Return a text without line breaks, truncated if it is long."""
    text = text if text.isprintable() else repr(text)
    return text if len(text) <= 60 else f"{text[:59]}…"


def dotted(key: Iterable[str | int]) -> str:
    """Return a key in the form particles[0].count."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{shorten(part)}" for part in key)
    return "".join(parts).removeprefix(".")


def unknown_scene(name: str) -> str | None:
    """Return why a scene is refused, or None."""
    names = jostle.scenes.names()
    return None if name in names else f"{shorten(name)} {unknown(name, 'a scene', names)}"


def too_slow(method: str, n: int) -> str | None:
    """Return why a running scene of n particles cannot have a method, or None."""
    if method != "brute" or n <= MOST_BRUTE:
        return None
    return (
        f"More than {MOST_BRUTE:,} particles are too slow with brute force: a step takes seconds."
    )
