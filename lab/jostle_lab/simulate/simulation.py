"""A scene in a `jostle.World`, and the inputs of its user."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic.dataclasses import dataclass as validated

import jostle
from jostle_lab.schema import (
    EVERY_CATEGORY,
    FORBID,
    Id,
    Polyline,
    Real,
    Region,
    Settings,
    read,
    settings_with,
    too_slow,
    wrong,
)
from jostle_lab.simulate.containers import (
    InitialRegion,
    bounds,
    center_of,
    free_positions,
    kind_of,
    moved_inside,
)
from jostle_lab.simulate.forces import add_walls, force_of, kind_count, set_matrix, shifted
from jostle_lab.simulate.frame import (
    Attractor,
    Frame,
    FrameRequest,
    ParticleTable,
    Point,
    Rect,
    Tags,
    frame_of,
)
from jostle_lab.simulate.region import (
    Container,
    area_of,
    container_of,
    set_container,
    with_restitution,
)

Work = Callable[["Simulation"], object]

TIME_STEP = 1 / 60
GRAB_RATE = 40.0  # 1/s: rate of the spring that pulls a held particle to the cursor
LEAST_RESPONSE = 0.3  # times that rate, for the heaviest particles

WORLD_SETTINGS = settings_with("sets", "world")  # attributes of a world, by the same name
COLUMN_SETTINGS = settings_with("sets", "particles")  # columns: of every particle
# The settings that `Simulation.adjust` can change while it runs.
ADJUSTABLE = frozenset((*WORLD_SETTINGS, *COLUMN_SETTINGS, *settings_with("sets", "else")))
WIDTHS = {"positions": (2,), "velocities": (2,)}  # of one value of a column
MOST_AT_ONCE = 100_000  # particles that are added to a running scene at once

Born = tuple[tuple[Real, Id], ...]  # times of birth, and how many particles in a row have each


@validated(frozen=True, config=FORBID)
class State:
    """What a saved world keeps as its attachment."""

    settings: Settings
    view: Region
    own_forces: Id
    pulls: tuple[Attractor, ...]
    home: InitialRegion
    own_walls: Id
    born: Born
    window: Any = None


@dataclass(frozen=True)
class Held:
    """A particle held at a point that moves with a velocity."""

    tag: int
    point: Point
    velocity: Point
    drag: int = 0  # the number of the drag


@dataclass(frozen=True)
class Edit:
    """A change of the simulation between two steps; a text as its result is a message."""

    work: Work
    key: str = ""  # what it changes; edits with the same key are undone together
    changes: bool = True  # whether undo brings back the state before it
    result: Future[object] = field(default_factory=Future, compare=False)


@dataclass(frozen=True)
class Inputs:
    """What the user does during a job: edits before its steps, and what is held in each step."""

    grab: Held | None = None
    attract: Attractor | None = None  # towards the cursor
    edits: tuple[Edit, ...] = ()

    @property
    def holds(self) -> str:
        """Return what is held as a key of undo; an empty string if nothing is."""
        if self.grab is not None:
            return f"drag {self.grab.drag}"
        return "attract" if self.attract is not None else ""


class Simulation:
    """A world as a simulation. A step lasts `time_step` seconds; y points down.

    The settings override those of the world. `view` is the visible part of it: min_x, min_y,
    max_x, max_y. It is used by one thread at a time, which `Engine` ensures.
    """

    time_step = TIME_STEP

    def __init__(self, settings: Settings, view: Rect, world: jostle.World) -> None:
        self.settings, self.view, self.world = settings, view, world
        for name in (*WORLD_SETTINGS, *COLUMN_SETTINGS):
            value = getattr(settings, name)
            if value is not None:
                setattr(world, name, value)
        sides = settings.container_restitution
        if sides is not None:
            set_container(world, with_restitution(container_of(world), sides))
        if settings.matrix is not None:
            set_matrix(world, settings.matrix)
        self._columns = ParticleTable(world)
        self._begin(world, len(world.walls), len(world.forces))
        self._initial = InitialRegion.of(container_of(world), view, settings.n)
        if settings.world_size != 1.0 or settings.container is not None:
            self._fit_container()

    def _begin(
        self, world: jostle.World, own_walls: int, own_forces: int,
        attractors: tuple[Attractor, ...] = (),
    ) -> None:  # fmt: skip
        # Walls of the scene and its file have smaller ids than drawn ones. The forces of the scene
        # come first, then those of the user.
        self._drawn, self._own_forces = own_walls, own_forces
        self._held: jostle.Grab | None = None
        self._cursor: Attractor | None = None
        self.attractors: tuple[Attractor, ...] = ()
        self.attract(attractors)  # without a grab, which nobody holds any more

    @classmethod
    def of_scene(cls, settings: Settings) -> Simulation:
        scene, n, seed = settings.scene, settings.n, settings.seed
        world = jostle.scenes.create(scene, n=n, seed=seed)
        return cls(settings, jostle.scenes.view(scene, n), world)

    @classmethod
    def of_own(cls, world: jostle.World, name: str) -> Simulation:
        """Return the simulation of a world that no scene has made; `name` is shown for it."""
        view = bounds(container_of(world)) or _view_of(world)
        return cls(Settings(name, method=world.method), view, world)

    @classmethod
    def resume(cls, state: bytes) -> Simulation:
        """Return the simulation that continues from a state, as `save` returns it."""
        return cls.of_world(jostle.World.restore(state))

    @classmethod
    def of_world(cls, world: jostle.World) -> Simulation:
        """Return the simulation that continues from a world with the attachment of `save`."""
        simulation = cls.__new__(cls)
        simulation._take(world)
        return simulation

    def __len__(self) -> int:
        return len(self.world)

    @property
    def effective_settings(self) -> Settings:
        """Return the settings, with the values that apply in place of None."""
        world, of_walls = self.world, self.settings.wall_friction
        rules: dict[str, Any] = {name: getattr(world, name) for name in WORLD_SETTINGS}
        rules |= self._surface
        rules["container"] = kind_of(container_of(world))
        rules["gravity"] = tuple(world.gravity.tolist())
        rules["substeps"] = world.substeps or world.last_step.substeps or None
        rules["wall_friction"] = rules["friction"] if of_walls is None else of_walls
        return replace(self.settings, **rules)

    @property
    def _surface(self) -> dict[str, float]:
        """Return the coefficients of new particles: those of the settings, or of the others."""
        given = {name: getattr(self.settings, name) for name in COLUMN_SETTINGS}
        return {
            name: getattr(self._columns, name) if value is None else value
            for name, value in given.items()
        }

    def frame(self, request: FrameRequest = FrameRequest()) -> Frame:  # noqa: B008 (it is frozen)
        cursor = () if self._cursor is None else (self._cursor,)
        return frame_of(
            self.world, self._columns, request, scene=self.settings.scene,
            attractors=(*self.attractors, *cursor), own_walls=self._own_walls,
            begun_with=self._initial.n,
        )  # fmt: skip

    # Changing

    def step(self, inputs: Inputs = Inputs()) -> None:
        self.hold(inputs)
        self.world.step(self.time_step)
        renumbered = self.world.renumbered
        if renumbered is not None:
            self.attractors = tuple(
                one if one.tag is None else replace(one, tag=int(renumbered[one.tag]))
                for one in self.attractors
            )
            self._columns.update(self.world)
            self._held = None  # its id may have changed; the next step has a new grab
            self.attract(self.attractors)

    def adjust(self, name: str, value: Any) -> str | None:
        """Change a setting; return a message if it is refused, without any change."""
        if why := wrong(name, value):
            return why
        before = self.settings
        self.settings = replace(before, **{name: value})
        value = getattr(self.settings, name)  # as it is declared: a vector of gravity
        try:
            if name == "n":
                self._set_count(value)
            elif name in ("world_size", "container"):
                self._fit_container()
            elif name == "method" and (reason := too_slow(value, len(self))):
                raise ValueError(reason)
            elif name == "matrix":
                set_matrix(self.world, value)
            elif name == "wall_friction":
                self.world.walls.set(self._drawn_walls, friction=value)
            elif name in COLUMN_SETTINGS:
                setattr(self.world, name, value)
                self._columns.update(self.world)
            elif name in WORLD_SETTINGS:
                setattr(self.world, name, value)
        except (ValueError, TypeError, OverflowError) as error:
            self.settings = before
            return str(error)
        return None

    def _center(self) -> NDArray[np.float64]:
        return np.array(center_of(bounds(container_of(self.world)) or self._initial.rect))

    def _fit_container(self) -> None:
        """Set the container of the settings, and move particles inside."""
        world, settings, before = self.world, self.settings, self._center()
        container, view = self._initial.fitted(settings.container, settings.world_size)
        container = with_restitution(container, settings.container_restitution)
        self._require_room(container)
        set_container(world, container)
        self.view = view
        shift = self._center() - before
        if shift.any():
            world.forces = shifted(world.forces, shift)
            world.walls.segments = world.walls.segments + shift
        places = world.positions.astype(np.float64) + shift
        inside = moved_inside(places, self._columns.radii.astype(np.float64), container)
        world.positions = np.where(self._columns.movable[:, None], inside, places)

    def _require_room(self, container: Container) -> None:
        """Raise a ValueError if the particles need more area than a container has."""
        area = math.inf if container is None else area_of(container)
        needed = math.pi * float((self._columns.radii[self._columns.movable] ** 2).sum(dtype=float))
        if needed > area:
            what = f"the particles need an area of {needed:.3g}"
            raise ValueError(f"The container would have an area of {area:.3g}; {what}.")

    def _set_count(self, n: int) -> None:
        """Add copies of particles if there are enough free positions, or remove the last ones.

        `n` is the number of movable particles.
        """
        moving = np.flatnonzero(self._columns.movable)
        more = n - len(moving)
        if more <= 0:
            self.remove(self._columns.tags[moving[n:]])
            return
        if reason := too_slow(self.settings.method, len(self) + more):
            raise ValueError(reason)
        if more > MOST_AT_ONCE or not len(moving) or not self._add_copies(moving, more):
            raise ValueError(f"There is no room for {more:,} more particles.")

    def _add_copies(self, rows: NDArray[np.intp], count: int) -> bool:
        """Add copies of random rows at random free positions; return whether there are enough."""
        columns, world = self._columns, self.world
        rng = np.random.default_rng([self.settings.seed, int(columns.tags[-1])])
        rows = rng.choice(rows, count)
        radii = columns.radii[rows]
        places, found = free_positions(world, radii, self.view, int(rng.integers(2**31)))
        if len(found) == count:
            rows, radii = rows[found], radii[found]
            self.add(
                places, world.velocities[rows], radii, columns.densities[rows],
                sensors=columns.sensors[rows], categories=columns.categories[rows],
                masks=columns.masks[rows],
            )  # fmt: skip
        return len(found) == count

    def add(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        densities: ArrayLike = 1.0,
        *,
        movable: ArrayLike = True,
        sensors: ArrayLike = False,
        kinds: ArrayLike | None = None,
        categories: ArrayLike = 1,
        masks: ArrayLike = EVERY_CATEGORY,
    ) -> Tags:
        """Add particles; return their tags. Without `kinds`, these are all kinds in turn."""
        with np.errstate(over="ignore"):  # the world refuses infinite values
            places = np.asarray(positions, np.float32).reshape(-1, 2)
            masses = np.asarray(densities) * np.asarray(radii, np.float64) ** 2
        count = kind_count(self.world)
        if kinds is None and count is not None:
            kinds = (len(self.world) + np.arange(len(places))) % count
        tags = self.world.add(
            places,
            radii,
            velocities=velocities,
            masses=masses,
            movable=movable,
            sensors=sensors,
            kinds=0 if kinds is None else kinds,
            categories=categories,
            masks=masks,
            **self._surface,
        )
        self._columns.update(self.world)
        return tags

    def remove(self, tags: ArrayLike) -> None:
        """Remove particles; tags that do not exist are ignored."""
        rows = np.unique(self._columns.find(tags)[0])
        self.world.remove(self._columns.tags[rows])
        self._columns.update(self.world)
        self._forget_removed()

    def _forget_removed(self) -> None:
        """Forget the forces of the user that the world has removed together with particles."""
        self.attractors = tuple(one for one in self.attractors if self._exists(one.tag))
        if self._held is not None and not self._exists(self._held.id):
            self._held = None
        self._own_forces = len(self.world.forces) - len(self._user_forces)

    def _exists(self, tag: int | None) -> bool:
        return tag is None or bool(len(self._columns.find(tag)[0]))

    def change(self, tags: ArrayLike, **columns: ArrayLike | None) -> None:
        """Set positions, velocities, densities, movable, categories or masks of particles.

        None leaves a column as it is. Rows of tags that do not exist are ignored.
        """
        rows, there = self._columns.find(tags)
        given: dict[str, Any] = {
            name: np.broadcast_to(np.asarray(value), (len(there), *WIDTHS.get(name, ())))[there]
            for name, value in columns.items()
            if value is not None
        }
        if "densities" in given:
            given["masses"] = given.pop("densities") * self._columns.radii[rows] ** 2
        self.world.set(self._columns.tags[rows], **given)
        if not given.keys() <= {"positions", "velocities"}:
            self._columns.update(self.world)

    def add_own_walls(self, lines: Sequence[Polyline]) -> None:
        """Add the walls of a file, before any is drawn; raise a ValueError for the first error."""
        for number, line in enumerate(lines):
            try:
                self._drawn += add_walls(self.world, line)
            except ValueError as error:
                raise ValueError(f"walls[{number}] cannot be added: {error}") from error
        self._own_forces = len(self.world.forces)

    @property
    def _own_walls(self) -> int:
        """Return the number of walls that the user did not draw."""
        return int(np.searchsorted(self.world.walls.ids, self._drawn))

    @property
    def _drawn_walls(self) -> Tags:
        """Return the ids of the walls that the user drew."""
        return self.world.walls.ids[self._own_walls :]

    def add_wall(self, line: Polyline) -> None:
        """Add line segments that a user draws; without friction they have that of drawn walls."""
        friction = self.settings.wall_friction if line.friction is None else line.friction
        add_walls(self.world, replace(line, friction=friction))

    def remove_wall(self, point: Point, reach: float) -> None:
        """Remove the wall that is nearest to a point, if it is within `reach` of it."""
        self.remove_walls(self.world.walls.nearest(point, max_distance=reach).ids)

    def remove_drawn_walls(self) -> None:
        self.remove_walls(self._drawn_walls)

    def remove_walls(self, ids: ArrayLike) -> None:
        self.world.walls.remove(ids)
        self._forget_removed()

    # Forces of the user

    @property
    def _user_forces(self) -> tuple[Any, ...]:
        cursor = () if self._cursor is None else (self._cursor,)
        grab = () if self._held is None else (self._held,)
        return (*map(force_of, (*self.attractors, *cursor)), *grab)

    def attract(self, attractors: tuple[Attractor, ...]) -> None:
        """Replace the attractors of the user; those of particles that do not exist are left out."""
        self.attractors = tuple(one for one in attractors if self._exists(one.tag))
        self._apply()

    def hold(self, inputs: Inputs) -> None:
        """Hold a particle and attract all to the cursor, or end that."""
        held = None if inputs.grab is None else self._grab_of(inputs.grab)
        if (held, inputs.attract) != (self._held, self._cursor):
            self._held, self._cursor = held, inputs.attract
            self._apply()

    def _apply(self) -> None:
        self.world.forces = (*self.world.forces[: self._own_forces], *self._user_forces)

    def _grab_of(self, held: Held) -> jostle.Grab | None:
        """Return the force of a held particle; None if it does not exist."""
        if not self._exists(held.tag):
            return None
        share = self._columns.usual_mass(self.world) / self.world.get(held.tag).masses
        rate = GRAB_RATE * min(max(math.sqrt(math.sqrt(share)), LEAST_RESPONSE), 1.0)
        # A critically damped spring is 2 / rate seconds behind a moving point.
        x, y = (at + 2 / rate * speed for at, speed in zip(held.point, held.velocity, strict=True))
        return jostle.Grab(held.tag, (x, y), rate=rate)

    def save(self, window: Any = None) -> bytes:
        """Return the state; after `load` the simulation continues with the same bits.

        It is the snapshot of the world, with everything else in its attachment. `window` is kept
        there too.
        """
        facts = {
            "settings": asdict(self.settings),
            "view": self.view,
            "own_forces": self._own_forces,
            "pulls": [asdict(attractor) for attractor in self.attractors],
            "home": asdict(self._initial),
            "own_walls": self._own_walls,
            "born": runs(self._columns.born),
            "window": window,
        }
        self.world.attachment = json.dumps(facts)
        return self.world.snapshot()

    def load(self, state: bytes) -> None:
        """Restore a state; raise a ValueError, before any change, if its bytes are wrong."""
        self._take(jostle.World.restore(state))

    def _take(self, world: jostle.World) -> None:
        """Continue from a world with an attachment."""
        state = read(State, attached(world))
        if world.method != state.settings.method:
            raise ValueError(f"settings.method is {state.settings.method!r}, but not in its world")
        for name, there in (("own_forces", len(world.forces)), ("own_walls", len(world.walls))):
            if (own := getattr(state, name)) > there:
                what = name.removeprefix("own_")
                raise ValueError(f"{name} is {own}; its world has {there} {what}")
        times, counts = np.array(state.born, np.float64).reshape(-1, 2).T
        if counts.sum() != len(world):
            raise ValueError(
                f"born has {counts.sum():g} times; its world has {len(world)} particles"
            )
        self.settings, self.view, self._initial = state.settings, state.view, state.home
        born = np.repeat(times, counts.astype(np.int64))
        self.world, self._columns = world, ParticleTable(world, born)
        drawn = world.walls.ids[state.own_walls :]
        first = int(drawn[0]) if len(drawn) else int(world.walls.ids.max(initial=-1)) + 1
        pulls = tuple(one for one in state.pulls if not one.passing)
        self._begin(world, first, state.own_forces, pulls)


def _view_of(world: jostle.World) -> Rect:
    """Return a rectangle around all particles and walls, with a margin."""
    ends = world.walls.segments.reshape(-1, 2)
    places, radii = world.positions, world.radii[:, None]
    corners = np.concatenate([places - radii, places + radii, ends]).astype(np.float64)
    if not len(corners):
        return 0.0, 0.0, 100.0, 100.0
    low, high = corners.min(axis=0), corners.max(axis=0)
    (x0, y0), (x1, y1) = (low + high) / 2 + np.outer((-0.6, 0.6), max(*(high - low), 1e-3))
    return float(x0), float(y0), float(x1), float(y1)


def attached(world: jostle.World) -> Any:
    """Return the values that `Simulation.save` has attached to a world."""
    if world.attachment is None:
        raise ValueError("it is a world without a scene of the simulator")
    try:
        return json.loads(world.attachment)
    except (ValueError, RecursionError) as error:
        raise ValueError("its attachment is not of the simulator") from error


def runs(values: NDArray[np.float64]) -> list[tuple[float, int]]:
    """Return each value of a column, and how many rows in a row have it."""
    starts = np.flatnonzero(np.diff(values, prepend=np.nan))
    counts = np.diff(starts, append=len(values))
    return list(zip(values[starts].tolist(), counts.tolist(), strict=True))
