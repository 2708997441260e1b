"""`jostle.World` as a `Simulation`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import jostle
from jostle.app.simulate.attractor_forces import AttractorForces
from jostle.app.simulate.containers import InitialRegion, bounds, center_of, moved_inside
from jostle.app.simulate.copies import copies_of
from jostle.app.simulate.emitters import Emitters
from jostle.app.simulate.particle_table import ParticleTable
from jostle.app.simulate.settings import Polyline, Settings
from jostle.app.simulate.simulation import (
    Attractor,
    Container,
    Frame,
    FrameRequest,
    Point,
    Rect,
    Tags,
)
from jostle.app.simulate.wall_segments import WallSegments
from jostle.app.simulate.world_frame import frame_of
from jostle.app.simulate.world_state import WorldState

TIME_STEP = 1 / 60
BRUTE_LIMIT = 30_000  # particles; with more a step of brute force takes seconds
DRAG_RATE = 40.0  # 1/s: rate of the spring that pulls a held particle to the cursor
LEAST_RESPONSE = 0.3  # times that rate, for the heaviest particles
SPEED_LIMIT = 4.0  # of a held particle, in diagonals of the view per second

# Settings that are attributes of a world, by the same name.
WORLD_SETTINGS = (
    *("method", "leaf_capacity", "max_depth", "gravity", "drag", "restitution", "substeps"),
    *("threads", "on_touch", "sleeping"),
)
FRICTIONS = ("friction", "wall_friction")
MOST_AT_ONCE = 100_000  # particles that are added to a running scene at once


class WorldSimulation:
    """A world as a simulation.

    Parameters
    ----------
    settings
        Its values override those of the world.
    view
        The visible part of the world: min_x, min_y, max_x, max_y.
    create
        Makes the world.
    """

    time_step = TIME_STEP

    def __init__(self, settings: Settings, view: Rect, create: Callable[[], jostle.World]) -> None:
        self.settings = settings
        self.scene = settings.scene
        self.view = view
        self.world = create()
        self._columns = ParticleTable(self.world)
        self._segments = WallSegments.of(self.world)
        self._attractions = AttractorForces(len(self.world.forces))
        for name in WORLD_SETTINGS:
            value = getattr(settings, name)
            if value is not None:
                setattr(self.world, name, value)
        if settings.friction is not None:
            self._set_friction(settings.friction)
        if settings.container_restitution is not None:
            self.world.container_restitution = settings.container_restitution
        self._initial = InitialRegion.of(self.world.container, view, settings.n)
        self.emitters: Emitters | None = None
        if settings.world_size != 1.0 or settings.container is not None:
            self._fit_container()

    @classmethod
    def of_scene(cls, settings: Settings) -> WorldSimulation:
        """Return a scene of `jostle.scenes`."""
        scene, n, seed = settings.scene, settings.n, settings.seed
        view = jostle.scenes.view(scene, n)
        simulation = cls(settings, view, lambda: jostle.scenes.create(scene, n=n, seed=seed))
        if scene == "emitters":
            simulation.emitters = Emitters(n, seed)
        return simulation

    def __len__(self) -> int:
        return len(self.world)

    @property
    def method(self) -> str:
        """Return "quadtree" or "brute"."""
        return self.world.method

    @property
    def container(self) -> Container:
        """Return the world's container."""
        return self.world.container

    @property
    def adjustable(self) -> frozenset[str]:
        """Return the settings that can change while it runs."""
        return frozenset(
            {*WORLD_SETTINGS, *FRICTIONS, "time_scale", "n", "world_size", "container"}
        )

    @property
    def effective_settings(self) -> Settings:
        """Return the settings, with the values of the world."""
        rules = {name: getattr(self.world, name) for name in WORLD_SETTINGS}
        friction, of_walls = self._columns.friction, self.settings.wall_friction
        of_walls = friction if of_walls is None else of_walls
        return replace(self.settings, **rules, friction=friction, wall_friction=of_walls)

    def frame(self, request: FrameRequest = FrameRequest()) -> Frame:  # noqa: B008 (it is frozen)
        """Return the present state."""
        attractors, begun_with = self._attractions.attractors, self._initial.n
        return frame_of(
            self.world, self._columns, self._segments, request, attractors, self.scene, begun_with
        )

    # Changing

    def step(self) -> None:
        """Advance by 1/60 s."""
        self.world.step(self.time_step)
        renumbered = self.world.renumbered
        if renumbered is not None:
            before = self._columns.tags
            heirs = self._columns.merge(self.world, renumbered)
            self._attractions.merge(self.world, self._columns, before, heirs)
        if self.emitters is not None:
            self._emit(self.emitters)

    def _emit(self, emitters: Emitters) -> None:
        """Add drops, and remove the oldest above the cap."""
        gone = emitters.step(self.world, self.time_step, self._columns.friction)
        if gone is not None:
            self._columns.remove(self.world, gone)
        elif len(self.world) > len(self._columns.tags):
            self._columns.add(self.world)
        else:
            return
        self._attractions.renew(self.world, self._columns)

    def adjust(self, name: str, value: Any) -> str | None:
        """Change a setting; return a message if it is refused, without any change."""
        before = self.settings
        self.settings = replace(before, **{name: value})
        try:
            if name == "n":
                self._set_count(value)
            elif name in ("world_size", "container"):
                self._fit_container()
            elif name == "method" and value == "brute" and len(self) > BRUTE_LIMIT:
                raise ValueError(
                    f"Brute force is too slow for more than {BRUTE_LIMIT:,} particles."
                )
            elif name == "friction":
                self._set_friction(value)
            elif name == "wall_friction":
                self._segments.set_friction(self.world, value)
            elif name in WORLD_SETTINGS:
                setattr(self.world, name, value)
        except (ValueError, TypeError, OverflowError) as error:
            self.settings = before
            return str(error)
        return None

    def _set_friction(self, friction: float) -> None:
        """Set the coefficient of friction of all particles."""
        self.world.friction = friction
        self._columns.copy(self.world)

    def _fit_container(self) -> None:
        """Set the container of the settings, and move particles inside."""
        world, settings = self.world, self.settings
        before = center_of(bounds(world.container) or self._initial.rect)
        world.container, self.view = self._initial.fitted(settings.container, settings.world_size)
        shift = np.array(center_of(bounds(world.container) or self._initial.rect)) - np.array(
            before
        )
        self._segments.shift(world, shift)
        places = world.positions.astype(np.float64) + shift
        inside = moved_inside(places, self._columns.radii.astype(np.float64), world.container)
        world.positions = np.where(self._columns.movable[:, None], inside, places)

    def _set_count(self, n: int) -> None:
        """Add copies of particles if there are enough free positions, or remove the last ones.

        `n` is the number of movable particles; with emitters it is the cap.
        """
        if self.emitters is not None:
            self.emitters.cap = n
            return
        moving = np.flatnonzero(self._columns.movable)
        more = n - len(moving)
        if more <= 0:
            self.remove(self._columns.tags[moving[n:]])
            return
        if self.method == "brute" and len(self) + more > BRUTE_LIMIT:
            raise ValueError(f"Brute force is too slow for more than {BRUTE_LIMIT:,} particles.")
        copies = None
        if more <= MOST_AT_ONCE and len(moving):
            copies = copies_of(
                self.world, self._columns, moving, more, self.view, self.settings.seed
            )
        if copies is None:
            raise ValueError(f"There is no room for {more:,} more particles.")
        self.add(*copies)

    def add(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        densities: ArrayLike = 1.0,
        movable: ArrayLike = True,
        sensors: ArrayLike = False,
    ) -> Tags:
        """Add particles; return their tags."""
        with np.errstate(over="ignore"):  # the world refuses infinite values
            places = np.asarray(positions, np.float32).reshape(-1, 2)
        self.world.add(
            places,
            np.broadcast_to(np.asarray(velocities, np.float32), places.shape),
            radii,
            densities=densities,
            movable=np.asarray(movable),
            sensors=np.asarray(sensors),
            friction=self._columns.friction,
        )
        return self._columns.add(self.world)

    def remove(self, tags: ArrayLike) -> None:
        """Remove particles."""
        rows = np.unique(self._columns.find(tags)[0])
        self._attractions.detach(self.world)
        self.world.remove(self._columns.ids[rows])
        self._attractions.own = len(
            self.world.forces
        )  # some may have ended with the removed particles
        self._columns.remove(self.world, rows)
        self._attractions.renew(self.world, self._columns)

    def change(
        self,
        tags: ArrayLike,
        *,
        positions: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
        densities: ArrayLike | None = None,
        movable: ArrayLike | None = None,
    ) -> None:
        """Set columns of particles."""
        rows, there = self._columns.find(tags)
        columns: dict[str, Any] = {}
        for name, value, width in [
            ("positions", positions, 2),
            ("velocities", velocities, 2),
            ("masses", densities, 1),
            ("movable", movable, 1),
        ]:
            if value is not None:
                shape = (len(there), 2) if width == 2 else (len(there),)
                columns[name] = np.broadcast_to(np.asarray(value), shape)[there]
        if densities is not None:
            columns["masses"] = columns["masses"] * self._columns.radii[rows] ** 2
        self.world.set(self._columns.ids[rows], **columns)
        if movable is not None or densities is not None:
            self._columns.copy(self.world)

    def add_own_walls(self, lines: Sequence[Polyline]) -> None:
        """Add the walls of a file, before any is drawn; raise a ValueError for the first error."""
        for number, line in enumerate(lines):
            try:
                self._segments.add(self.world, line, own=True)
            except ValueError as error:
                raise ValueError(f"walls[{number}] cannot be added: {error}") from error
        # The motors of moving walls, and thermal walls, are forces of the world.
        self._attractions = AttractorForces(len(self.world.forces))

    def add_wall(self, line: Polyline) -> None:
        """Add line segments that a user draws; without friction they have that of drawn walls."""
        friction = self.settings.wall_friction if line.friction is None else line.friction
        self._segments.add(self.world, replace(line, friction=friction), own=False)

    def remove_walls(self, rows: ArrayLike) -> None:
        """Remove line segments by their rows in the frame."""
        self._attractions.detach(self.world)
        self._segments.remove(self.world, rows)
        self._attractions.own = len(self.world.forces)  # some may have ended with their walls
        self._attractions.renew(self.world, self._columns)

    def attract(self, attractors: tuple[Attractor, ...]) -> None:
        """Replace the attractors of the user."""
        self._attractions.place(self.world, self._columns, attractors)

    def drag(self, tag: int, point: Point, velocity: Point) -> None:
        """Accelerate a held particle towards the cursor by a critically damped spring.

        Only its velocity changes, so it collides with other particles. The spring is integrated
        implicitly, so it is stable for any stiffness. Immovable particles are not changed.
        """
        rows, _ = self._columns.find(tag)
        if not len(rows) or not self._columns.movable[rows[0]]:
            return
        (row,), dt = rows, self.time_step
        rate = DRAG_RATE * self._response(row)
        offset = np.array(point) - self.world.positions[row]
        if isinstance(self.container, jostle.Torus):
            sides = np.array([self.container.width, self.container.height])
            offset -= sides * np.round(offset / sides)  # minimum image
        dragged = self.world.velocities[row] + dt * rate * (rate * offset + 2 * np.array(velocity))
        dragged /= (1 + dt * rate) ** 2
        limit, speed = SPEED_LIMIT * self._diagonal(), math.hypot(*dragged)
        held = int(self._columns.ids[row])
        self.world.set(held, velocities=dragged * min(1.0, limit / max(speed, limit)))

    def _response(self, row: int) -> float:
        """Return the factor of the rate for a particle: 1, or less for a heavy one."""
        share = self._columns.usual_mass(self.world) / float(self.world.masses[row])
        return min(max(math.sqrt(math.sqrt(share)), LEAST_RESPONSE), 1.0)

    def save(self) -> bytes:
        """Return the state."""
        return WorldState(
            self.settings, self.view, self._initial, self.world, self._columns, self._segments,
            self._attractions, self.emitters,
        ).save()  # fmt: skip

    def load(self, state: bytes) -> None:
        """Restore a state from bytes; raise a ValueError if they are wrong."""
        new = WorldState.load(state)
        self.settings, self.view, self._initial = new.settings, new.view, new.home
        self.world, self._columns, self._segments = new.world, new.columns, new.segments
        self._attractions, self.emitters = new.attractions, new.emitters

    def _diagonal(self) -> float:
        min_x, min_y, max_x, max_y = self.view
        return math.hypot(max_x - min_x, max_y - min_y)
