"""The compiled part of jostle; `help` on each name tells more."""

import math
import os
from collections.abc import Callable, Iterable, Iterator
from typing import (
    Any,
    Final,
    Literal,
    Protocol,
    SupportsFloat,
    SupportsIndex,
    TypeAlias,
    final,
    overload,
)

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray
from typing_extensions import Self

from jostle.results import Contacts, GaltonBoard, Neighbors, Nodes, Nozzle, RayHit, Stats

__all__ = [
    "Attractor",
    "Box",
    "Circle",
    "Events",
    "Gravitation",
    "Quadtree",
    "Space",
    "Springs",
    "Thermostat",
    "Torus",
    "World",
    "__version__",
    "abandon_threads",
    "create_scene",
    "describe_scene",
    "find_pairs",
    "scene_default_count",
    "scene_fountains",
    "scene_galton_board",
    "scene_names",
    "scene_view",
    "scene_wall",
    "sprite_dict",
    "sprite_pairs",
    "sprite_sides",
]

__version__: Final[str]

_Number: TypeAlias = SupportsFloat | SupportsIndex

class _Vector(Protocol):
    """Two numbers with names, such as a vector of pygame."""

    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...

_Point: TypeAlias = tuple[_Number, _Number] | _Vector
_Four: TypeAlias = tuple[_Number, _Number, _Number, _Number]
_Ids: TypeAlias = NDArray[np.int64]
_Pairs: TypeAlias = NDArray[np.int64]
_Container: TypeAlias = Box | Circle | Torus
_Force: TypeAlias = Attractor | Gravitation | Springs | Thermostat

def abandon_threads() -> None: ...
def find_pairs(
    centers: ArrayLike,
    radii: ArrayLike = 0.0,
    half_sizes: ArrayLike | None = None,
    *,
    method: Literal["auto", "brute", "quadtree"] = "auto",
    sort: bool = False,
    max_pairs: SupportsIndex = 134217728,
    threads: SupportsIndex | None = None,
) -> NDArray[np.uint32]: ...
def sprite_pairs(
    left: list[Any],
    right: list[Any] | None,
    rule: Literal["rect", "rects", "circle", "mask"],
    ratio: float,
    types: tuple[type, type],
    radius_of: Callable[[Any], float] | None = None,
) -> tuple[NDArray[np.uint32], NDArray[np.bool_] | None] | None: ...
def sprite_sides(sprites: list[Any], types: tuple[type, type]) -> NDArray[np.float64] | None: ...
def sprite_dict(
    pairs: NDArray[np.uint32], keys: list[Any], values: list[Any]
) -> dict[Any, list[Any]]: ...

@final
class Quadtree:
    def __new__(
        cls,
        centers: ArrayLike,
        radii: ArrayLike = 0.0,
        half_sizes: ArrayLike | None = None,
        *,
        categories: ArrayLike | None = None,
        masks: ArrayLike | None = None,
        leaf_capacity: SupportsIndex = 96,
        max_depth: SupportsIndex = 4096,
        threads: SupportsIndex | None = None,
    ) -> Self: ...
    def pairs(
        self,
        other: Quadtree | None = None,
        *,
        sort: bool = False,
        max_pairs: SupportsIndex = 134217728,
        mask: SupportsIndex | None = None,
    ) -> NDArray[np.uint32]: ...
    def contacts(self, *, max_pairs: SupportsIndex = 134217728) -> Contacts: ...
    @overload
    def query_rect(self, rect: _Four, *, mask: SupportsIndex | None = None) -> _Ids: ...
    @overload
    def query_rect(self, rect: ArrayLike, *, mask: SupportsIndex | None = None) -> Any: ...
    @overload
    def query_circle(
        self, center: _Point, radius: _Number, *, mask: SupportsIndex | None = None
    ) -> _Ids: ...
    @overload
    def query_circle(
        self, center: ArrayLike, radius: ArrayLike, *, mask: SupportsIndex | None = None
    ) -> Any: ...
    @overload
    def query_point(self, point: _Point, *, mask: SupportsIndex | None = None) -> _Ids: ...
    @overload
    def query_point(self, point: ArrayLike, *, mask: SupportsIndex | None = None) -> Any: ...
    def query_polygon(self, vertices: ArrayLike, *, mask: SupportsIndex | None = None) -> Any: ...
    def nearest(
        self,
        point: ArrayLike | _Vector,
        k: SupportsIndex = 1,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> Neighbors: ...
    @overload
    def raycast(
        self,
        origin: _Point,
        direction: _Point,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit: ...
    @overload
    def raycast(
        self,
        origin: ArrayLike,
        direction: ArrayLike,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> Any: ...
    @overload
    def circle_cast(
        self,
        origin: _Point,
        direction: _Point,
        radius: _Number,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit: ...
    @overload
    def circle_cast(
        self,
        origin: ArrayLike,
        direction: ArrayLike,
        radius: ArrayLike,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> Any: ...
    def nodes(self) -> Nodes: ...
    @property
    def stats(self) -> Stats: ...
    def __len__(self) -> int: ...

@final
class Space:
    def __new__(
        cls,
        *,
        dtype: DTypeLike = "float64",
        leaf_capacity: SupportsIndex = 96,
        max_depth: SupportsIndex = 4096,
        threads: SupportsIndex | None = None,
    ) -> Self: ...
    @overload
    def add(
        self,
        centers: _Point,
        radii: ArrayLike = 0.0,
        half_sizes: ArrayLike | None = None,
        *,
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> int: ...
    @overload
    def add(
        self,
        centers: ArrayLike | _Vector,
        radii: ArrayLike = 0.0,
        half_sizes: ArrayLike | None = None,
        *,
        categories: ArrayLike = 1,
        masks: ArrayLike = 0xFFFFFFFF,
    ) -> Any: ...
    def move(self, ids: ArrayLike, centers: ArrayLike | _Vector) -> None: ...
    def resize(
        self,
        ids: ArrayLike,
        radii: ArrayLike | None = None,
        half_sizes: ArrayLike | None = None,
    ) -> None: ...
    def set_filter(
        self,
        ids: ArrayLike,
        categories: ArrayLike | None = None,
        masks: ArrayLike | None = None,
    ) -> None: ...
    def remove(self, ids: ArrayLike) -> None: ...
    def update(self, *, max_pairs: SupportsIndex = 134217728) -> Events: ...
    def pairs(
        self,
        *,
        sort: bool = False,
        max_pairs: SupportsIndex = 134217728,
        mask: SupportsIndex | None = None,
    ) -> _Pairs: ...
    @overload
    def query_rect(self, rect: _Four, *, mask: SupportsIndex | None = None) -> _Ids: ...
    @overload
    def query_rect(self, rect: ArrayLike, *, mask: SupportsIndex | None = None) -> Any: ...
    @overload
    def query_circle(
        self, center: _Point, radius: _Number, *, mask: SupportsIndex | None = None
    ) -> _Ids: ...
    @overload
    def query_circle(
        self, center: ArrayLike, radius: ArrayLike, *, mask: SupportsIndex | None = None
    ) -> Any: ...
    @overload
    def query_point(self, point: _Point, *, mask: SupportsIndex | None = None) -> _Ids: ...
    @overload
    def query_point(self, point: ArrayLike, *, mask: SupportsIndex | None = None) -> Any: ...
    def query_polygon(self, vertices: ArrayLike, *, mask: SupportsIndex | None = None) -> Any: ...
    def nearest(
        self,
        point: ArrayLike | _Vector,
        k: SupportsIndex = 1,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> Neighbors: ...
    @overload
    def raycast(
        self,
        origin: _Point,
        direction: _Point,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit: ...
    @overload
    def raycast(
        self,
        origin: ArrayLike,
        direction: ArrayLike,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> Any: ...
    @overload
    def circle_cast(
        self,
        origin: _Point,
        direction: _Point,
        radius: _Number,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> RayHit: ...
    @overload
    def circle_cast(
        self,
        origin: ArrayLike,
        direction: ArrayLike,
        radius: ArrayLike,
        *,
        max_distance: _Number = math.inf,
        mask: SupportsIndex | None = None,
    ) -> Any: ...
    def centers(self, ids: ArrayLike | None = None) -> NDArray[np.floating[Any]]: ...
    def half_sizes(self, ids: ArrayLike | None = None) -> NDArray[np.floating[Any]]: ...
    @overload
    def radii(self, ids: SupportsIndex) -> float: ...
    @overload
    def radii(self, ids: ArrayLike | None = None) -> Any: ...
    @overload
    def categories(self, ids: SupportsIndex) -> int: ...
    @overload
    def categories(self, ids: ArrayLike | None = None) -> Any: ...
    @overload
    def masks(self, ids: SupportsIndex) -> int: ...
    @overload
    def masks(self, ids: ArrayLike | None = None) -> Any: ...
    @property
    def ids(self) -> _Ids: ...
    @property
    def dtype(self) -> Literal["float32", "float64"]: ...
    def __contains__(self, id: object, /) -> bool: ...
    def __len__(self) -> int: ...

@final
class Events:
    @property
    def entered(self) -> _Pairs: ...
    @property
    def stayed(self) -> _Pairs: ...
    @property
    def left(self) -> _Pairs: ...
    def __iter__(self) -> Iterator[_Pairs]: ...

@final
class World:
    def __new__(
        cls,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        *,
        masses: ArrayLike | None = None,
        densities: ArrayLike = 1.0,
        movable: ArrayLike | None = None,
        gravity: ArrayLike = (0.0, 0.0),
        drag: _Number = 0.0,
        restitution: ArrayLike = 1.0,
        container: _Container | None = None,
        forces: Iterable[_Force] = (),
        on_touch: Literal["bounce", "merge", "ignore"] = "bounce",
        method: Literal["quadtree", "brute"] = "quadtree",
        threads: SupportsIndex | None = None,
        leaf_capacity: SupportsIndex = 96,
        max_depth: SupportsIndex = 4096,
        substeps: SupportsIndex = 4,
    ) -> Self: ...
    def step(self, dt: _Number, steps: SupportsIndex = 1) -> None: ...
    def add(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        *,
        masses: ArrayLike | None = None,
        densities: ArrayLike = 1.0,
        restitutions: ArrayLike = 1.0,
        movable: ArrayLike | None = None,
    ) -> NDArray[np.uint32]: ...
    def remove(self, ids: ArrayLike) -> None: ...
    def set(
        self,
        ids: ArrayLike,
        *,
        positions: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
        radii: ArrayLike | None = None,
        masses: ArrayLike | None = None,
        restitutions: ArrayLike | None = None,
        movable: ArrayLike | None = None,
    ) -> None: ...
    @property
    def positions(self) -> NDArray[np.float32]: ...
    @positions.setter
    def positions(self, value: ArrayLike) -> None: ...
    @property
    def velocities(self) -> NDArray[np.float32]: ...
    @velocities.setter
    def velocities(self, value: ArrayLike) -> None: ...
    @property
    def radii(self) -> NDArray[np.float32]: ...
    @radii.setter
    def radii(self, value: ArrayLike) -> None: ...
    @property
    def masses(self) -> NDArray[np.float32]: ...
    @masses.setter
    def masses(self, value: ArrayLike) -> None: ...
    @property
    def restitutions(self) -> NDArray[np.float32]: ...
    @restitutions.setter
    def restitutions(self, value: ArrayLike) -> None: ...
    @property
    def movable(self) -> NDArray[np.bool_]: ...
    @movable.setter
    def movable(self, value: ArrayLike) -> None: ...
    @property
    def gravity(self) -> tuple[float, float]: ...
    @gravity.setter
    def gravity(self, value: ArrayLike) -> None: ...
    @property
    def drag(self) -> float: ...
    @drag.setter
    def drag(self, value: _Number) -> None: ...
    @property
    def restitution(self) -> float: ...
    @restitution.setter
    def restitution(self, value: _Number) -> None: ...
    @property
    def container(self) -> _Container | None: ...
    @container.setter
    def container(self, value: _Container | None) -> None: ...
    @property
    def forces(self) -> tuple[_Force, ...]: ...
    @forces.setter
    def forces(self, value: Iterable[_Force]) -> None: ...
    @property
    def on_touch(self) -> Literal["bounce", "merge", "ignore"]: ...
    @on_touch.setter
    def on_touch(self, value: Literal["bounce", "merge", "ignore"]) -> None: ...
    @property
    def renumbered(self) -> NDArray[np.int64] | None: ...
    @property
    def method(self) -> Literal["quadtree", "brute"]: ...
    @method.setter
    def method(self, value: Literal["quadtree", "brute"]) -> None: ...
    @property
    def threads(self) -> int | None: ...
    @threads.setter
    def threads(self, value: SupportsIndex | None) -> None: ...
    @property
    def leaf_capacity(self) -> int: ...
    @leaf_capacity.setter
    def leaf_capacity(self, value: SupportsIndex) -> None: ...
    @property
    def max_depth(self) -> int: ...
    @max_depth.setter
    def max_depth(self, value: SupportsIndex) -> None: ...
    @property
    def substeps(self) -> int: ...
    @substeps.setter
    def substeps(self, value: SupportsIndex) -> None: ...
    @property
    def contacts(self) -> Contacts: ...
    @property
    def momentum(self) -> tuple[float, float]: ...
    @property
    def kinetic_energy(self) -> float: ...
    @property
    def potential_energy(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def profile(self) -> dict[str, float]: ...
    @property
    def stats(self) -> Stats: ...
    def state_hash(self) -> int: ...
    def snapshot(self) -> bytes: ...
    @classmethod
    def restore(cls, data: bytes | bytearray | memoryview) -> World: ...
    def save(self, path: str | os.PathLike[str]) -> None: ...
    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> World: ...
    def __reduce__(self) -> tuple[Callable[[bytes], World], tuple[bytes]]: ...
    def __len__(self) -> int: ...

@final
class Box:
    __match_args__: Final = ("min_x", "min_y", "max_x", "max_y")
    def __new__(cls, min_x: _Number, min_y: _Number, max_x: _Number, max_y: _Number) -> Self: ...
    @property
    def min_x(self) -> float: ...
    @property
    def min_y(self) -> float: ...
    @property
    def max_x(self) -> float: ...
    @property
    def max_y(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[float, float, float, float]: ...

@final
class Circle:
    __match_args__: Final = ("center", "radius")
    def __new__(cls, center: ArrayLike, radius: _Number) -> Self: ...
    @property
    def center(self) -> tuple[float, float]: ...
    @property
    def radius(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[tuple[float, float], float]: ...

@final
class Torus:
    __match_args__: Final = ("width", "height")
    def __new__(cls, width: _Number, height: _Number) -> Self: ...
    @property
    def width(self) -> float: ...
    @property
    def height(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[float, float]: ...

@final
class Attractor:
    def __new__(
        cls,
        point: ArrayLike | None = None,
        strength: _Number | None = None,
        law: Literal["harmonic", "inverse_square"] = "harmonic",
        *,
        particle: SupportsIndex | None = None,
    ) -> Self: ...
    @property
    def point(self) -> tuple[float, float] | None: ...
    @property
    def strength(self) -> float: ...
    @property
    def law(self) -> Literal["harmonic", "inverse_square"]: ...
    @property
    def particle(self) -> int | None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs_ex__(
        self,
    ) -> tuple[tuple[tuple[float, float] | None, float, str], dict[str, int | None]]: ...

@final
class Gravitation:
    __match_args__: Final = ("G", "softening", "theta")
    def __new__(cls, G: _Number, softening: _Number = 0.0, theta: _Number = 0.5) -> Self: ...
    @property
    def G(self) -> float: ...
    @property
    def softening(self) -> float: ...
    @property
    def theta(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[float, float, float]: ...

@final
class Springs:
    __match_args__: Final = ("pairs", "lengths", "stiffness", "damping", "max_stretch")
    def __new__(
        cls,
        pairs: ArrayLike,
        lengths: ArrayLike,
        stiffness: ArrayLike,
        damping: ArrayLike = 0.0,
        max_stretch: ArrayLike | None = None,
    ) -> Self: ...
    @property
    def pairs(self) -> NDArray[np.uint32]: ...
    @property
    def lengths(self) -> NDArray[np.float32]: ...
    @property
    def stiffness(self) -> NDArray[np.float32]: ...
    @property
    def damping(self) -> NDArray[np.float32]: ...
    @property
    def max_stretch(self) -> NDArray[np.float32]: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]
    def __getnewargs__(self) -> tuple[NDArray[Any], ...]: ...

@final
class Thermostat:
    __match_args__: Final = ("speed", "rate")
    def __new__(cls, speed: _Number, rate: _Number) -> Self: ...
    @property
    def speed(self) -> float: ...
    @property
    def rate(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __getnewargs__(self) -> tuple[float, float]: ...

def scene_names() -> list[str]: ...
def describe_scene(name: str) -> str: ...
def create_scene(name: str, n: SupportsIndex | None = None, seed: SupportsIndex = 0) -> World: ...
def scene_view(name: str, n: SupportsIndex | None = None) -> tuple[float, float, float, float]: ...
def scene_default_count(name: str) -> int: ...
def scene_fountains(n: SupportsIndex | None = None) -> list[Nozzle]: ...
def scene_galton_board(n: SupportsIndex | None = None) -> GaltonBoard: ...
def scene_wall(start: _Point, end: _Point, radius: _Number) -> NDArray[np.float32]: ...
