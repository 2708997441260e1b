"""`jostle.World` as the app sees it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import jostle
from jostle.app.simulate.attractions import Attractions
from jostle.app.simulate.columns import Columns
from jostle.app.simulate.copies import copies_of
from jostle.app.simulate.emitters import Emitters
from jostle.app.simulate.segments import Segments
from jostle.app.simulate.settings import Polyline, Settings
from jostle.app.simulate.simulation import Container, Frame, Point, Pull, Rect, Tags, Wants
from jostle.app.simulate.walls import Home, bounds, brought_in, center_of
from jostle.app.simulate.world_frame import frame_of
from jostle.app.simulate.world_state import WorldState

TIME_STEP = 1 / 60
BRUTE_LIMIT = 30_000  # above it one step of brute force would freeze the picture for seconds
HAND_RATE = 40.0  # 1/s: the spring of the hand brings a particle near in a few hundredths
LEAST_EASE = 0.3  # of that rate, for the heaviest: a hundred times the usual mass lags threefold
SPEED_LIMIT = 4.0  # a held particle's speed, in diagonals of the view a second

# Settings that are attributes of a world, by the same name.
RULES = (
    *("method", "leaf_capacity", "max_depth", "gravity", "drag", "restitution", "substeps"),
    *("threads", "on_touch", "sleeping"),
)
MOST_AT_ONCE = 100_000  # particles that a slider adds to a running scene


class WorldSimulation:
    """A world with right physics.

    Parameters
    ----------
    settings
        What to show; its rules are laid over those of the world.
    view
        The part of the world to look at: min_x, min_y, max_x, max_y.
    create
        Makes the world.
    """

    time_step = TIME_STEP

    def __init__(self, settings: Settings, view: Rect, create: Callable[[], jostle.World]) -> None:
        self.settings = settings
        self.scene = settings.scene
        self.view = view
        self.world = create()
        self._columns = Columns(self.world)
        self._segments = Segments.of(self.world)
        self._attractions = Attractions(len(self.world.forces))
        for name in RULES:
            value = getattr(settings, name)
            if value is not None:
                setattr(self.world, name, value)
        if settings.friction is not None:
            self._rub(settings.friction)
        if settings.container_restitution is not None:
            self.world.container_restitution = settings.container_restitution
        self._home = Home.of(self.world.container, view, settings.n)
        self.emitters: Emitters | None = None
        if settings.world_size != 1.0 or settings.container is not None:
            self._fit_walls()

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
        """Return the world's walls."""
        return self.world.container

    @property
    def adjustable(self) -> frozenset[str]:
        """Return what can change while it runs."""
        return frozenset({*RULES, "friction", "time_scale", "n", "world_size", "container"})

    @property
    def rules(self) -> Settings:
        """Return the settings with the world's own rules."""
        rules = {name: getattr(self.world, name) for name in RULES}
        return replace(self.settings, **rules, friction=self._columns.friction)

    def frame(self, wants: Wants = Wants()) -> Frame:  # noqa: B008 (it is frozen)
        """Return the present state."""
        pulls, begun_with = self._attractions.pulls, self._home.n
        return frame_of(
            self.world, self._columns, self._segments, wants, pulls, self.scene, begun_with
        )

    # Acting

    def step(self) -> None:
        """Go on by 1/60 s."""
        self.world.step(self.time_step)
        renumbered = self.world.renumbered
        if renumbered is not None:
            before = self._columns.tags
            heirs = self._columns.merge(self.world, renumbered)
            self._attractions.merge(self.world, self._columns, before, heirs)
        if self.emitters is not None:
            self._emit(self.emitters)

    def _emit(self, emitters: Emitters) -> None:
        """Let drops come out; the oldest go where there are too many."""
        gone = emitters.step(self.world, self.time_step, self._columns.friction)
        if gone is not None:
            self._columns.remove(self.world, gone)
        elif len(self.world) > len(self._columns.tags):
            self._columns.add(self.world)
        else:
            return
        self._attractions.renew(self.world, self._columns)

    def adjust(self, name: str, value: Any) -> str | None:
        """Change a setting; a sentence says why where that cannot be, and nothing has changed."""
        before = self.settings
        self.settings = replace(before, **{name: value})
        try:
            if name == "n":
                self._take_number(value)
            elif name in ("world_size", "container"):
                self._fit_walls()
            elif name == "method" and value == "brute" and len(self) > BRUTE_LIMIT:
                raise ValueError(
                    f"Brute force is too slow to watch above {BRUTE_LIMIT:,} particles."
                )
            elif name == "friction":
                self._rub(value)
            elif name in RULES:
                setattr(self.world, name, value)
        except (ValueError, TypeError, OverflowError) as error:
            self.settings = before
            return str(error)
        return None

    def _rub(self, friction: float) -> None:
        """Give all particles a coefficient of friction."""
        self.world.friction = friction
        self._columns.copy(self.world)

    def _fit_walls(self) -> None:
        """Give the world the walls of the settings, and bring inside what is out."""
        world, settings = self.world, self.settings
        before = center_of(bounds(world.container) or self._home.rect)
        world.container, self.view = self._home.fitted(settings.container, settings.world_size)
        shift = np.array(center_of(bounds(world.container) or self._home.rect)) - np.array(before)
        self._segments.shift(world, shift)
        places = world.positions.astype(np.float64) + shift
        inside = brought_in(places, self._columns.radii.astype(np.float64), world.container)
        world.positions = np.where(self._columns.movable[:, None], inside, places)

    def _take_number(self, n: int) -> None:
        """Add copies of particles where there is room for all of them, or remove the last ones.

        `n` counts what can move; of a scene with emitters it is the cap.
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
            raise ValueError(f"Brute force is too slow to watch above {BRUTE_LIMIT:,} particles.")
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
        self._attractions.lift(self.world)
        self.world.remove(self._columns.ids[rows])
        self._attractions.own = len(self.world.forces)  # some may have been tied to what is gone
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
        """Add the walls of a file, before any is drawn; raise a ValueError with the first wrong."""
        for number, line in enumerate(lines):
            try:
                self._segments.add(self.world, line, own=True)
            except ValueError as error:
                raise ValueError(f"walls[{number}] cannot be added: {error}") from error
        # The motors of walls that move are the world's own.
        self._attractions = Attractions(len(self.world.forces))

    def add_wall(self, line: Polyline) -> None:
        """Add line segments that a user draws."""
        self._segments.add(self.world, line, own=False)

    def remove_walls(self, rows: ArrayLike) -> None:
        """Remove line segments by their rows in the frame."""
        self._segments.remove(self.world, rows)

    def attract(self, pulls: tuple[Pull, ...]) -> None:
        """Replace the attractions that a person has placed."""
        self._attractions.place(self.world, self._columns, pulls)

    def drag(self, tag: int, point: Point, velocity: Point) -> None:
        """Draw a held particle to the hand by a critically damped spring.

        Its velocity changes, not its place: so it still pushes what is in its way, and is held up
        by what it cannot push. The spring's step is implicit, so no stiffness is too much for it.
        Immovable particles stay.
        """
        rows, _ = self._columns.find(tag)
        if not len(rows) or not self._columns.movable[rows[0]]:
            return
        (row,), dt = rows, self.time_step
        rate = HAND_RATE * self._ease(row)
        way = np.array(point) - self.world.positions[row]
        if isinstance(self.container, jostle.Torus):
            sides = np.array([self.container.width, self.container.height])
            way -= sides * np.round(way / sides)  # the short way, across a seam if need be
        pulled = self.world.velocities[row] + dt * rate * (rate * way + 2 * np.array(velocity))
        pulled /= (1 + dt * rate) ** 2
        limit, speed = SPEED_LIMIT * self._diagonal(), math.hypot(*pulled)
        held = int(self._columns.ids[row])
        self.world.set(held, velocities=pulled * min(1.0, limit / max(speed, limit)))

    def _ease(self, row: int) -> float:
        """Return how readily a particle follows the hand: 1, or less for one that is heavy here."""
        share = self._columns.usual_mass(self.world) / float(self.world.masses[row])
        return min(max(math.sqrt(math.sqrt(share)), LEAST_EASE), 1.0)

    def save(self) -> bytes:
        """Return the state."""
        return WorldState(
            self.settings, self.view, self._home, self.world, self._columns, self._segments,
            self._attractions, self.emitters,
        ).save()  # fmt: skip

    def load(self, state: bytes) -> None:
        """Restore a state from bytes; raise a ValueError if they are wrong."""
        new = WorldState.load(state)
        self.settings, self.view, self._home = new.settings, new.view, new.home
        self.world, self._columns, self._segments = new.world, new.columns, new.segments
        self._attractions, self.emitters = new.attractions, new.emitters

    def _diagonal(self) -> float:
        min_x, min_y, max_x, max_y = self.view
        return math.hypot(max_x - min_x, max_y - min_y)
