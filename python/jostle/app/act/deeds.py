"""Commands on particles: make, copy, remove, stop, fix, scatter; and walls."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle.app.simulate.engine import REFUSALS, Edit, Engine, sentence
from jostle.app.simulate.article_simulation import NO_WALLS
from jostle.app.simulate.room import free_places
from jostle.app.simulate.segments import nearest
from jostle.app.simulate.settings import Polyline
from jostle.app.simulate.simulation import Container, Frame, Point, Rect, Simulation, Tags
from jostle.app.simulate.walls import bounds

CLONE_GAP = 1.05  # diameters between a particle and its clone
PARTY_SPEED = 0.4  # diagonals of the view a second, of the fastest guest
DENSITIES = 1.0, 20.0  # the article's range, for colours that differ
PLAIN_RADIUS, PLAIN_DENSITY = 10.0, 1.0  # of a new particle, where there is none to go by


class Deeds:
    """Acts on particles and walls; what the simulation refuses becomes a sentence."""

    def __init__(self, engine: Engine, say: Callable[[str | None], None]) -> None:
        self._engine = engine
        self._say = say
        self._chance = np.random.default_rng()

    # Some particles

    def create(self, point: Point) -> None:
        """Add a particle at rest, of the size and density that are usual here."""
        radius, density = usual(self._engine.frame)
        self._edit(lambda simulation: simulation.add([point], [(0, 0)], [radius], [density]))

    def clone(self, tags: Tags) -> None:
        """Add a copy of each beside it, all moved by the same way; where walls are, anywhere."""

        def work(simulation: Simulation) -> None:
            frame = simulation.frame()
            rows = frame.rows(tags)
            if not len(rows):
                return
            places, there = _places_beside(frame, rows, simulation.view)
            rows = rows[there]
            simulation.add(
                places[there],
                frame.velocities[rows],
                frame.radii[rows],
                frame.densities[rows],
                frame.movable[rows],
            )
            if not there.all():
                self._say(f"There was room for {len(rows):,} of {len(there):,} copies.")

        self._edit(work)

    def delete(self, tags: Tags) -> None:
        """Take particles away."""
        self._edit(lambda simulation: simulation.remove(tags))

    def stop(self, tags: Tags) -> None:
        """Take all speed from particles."""
        self._edit(lambda simulation: simulation.change(tags, velocities=(0, 0)))

    def fix(self, tags: Tags, *, movable: bool) -> None:
        """Stop particles and make them immovable, or movable; the article has only movable ones."""
        if self._engine.settings.by_article:
            self._say("By the article's rules everything can move.")
            return
        self._edit(lambda simulation: simulation.change(tags, velocities=(0, 0), movable=movable))

    # All that can move

    def scramble(self) -> None:
        """Send every particle to a random place between the walls."""

        def work(simulation: Simulation) -> None:
            frame = simulation.frame()
            tags = frame.tags[frame.movable]
            simulation.change(tags, positions=self._places(frame, simulation.view))

        self._edit(work)

    def dance(self) -> None:
        """Give every particle a random place, velocity and colour; colours are densities."""

        def work(simulation: Simulation) -> None:
            frame = simulation.frame()
            tags = frame.tags[frame.movable]
            n = len(tags)
            angle, fastest = self._chance.uniform(0, 2 * math.pi, n), _party_speed(simulation.view)
            speed = self._chance.uniform(0, fastest, n)
            simulation.change(
                tags,
                positions=self._places(frame, simulation.view),
                velocities=np.stack([speed * np.cos(angle), speed * np.sin(angle)], axis=1),
                densities=np.rint(self._chance.uniform(*DENSITIES, n)),
            )

        self._edit(work)

    def _places(self, frame: Frame, view: Rect) -> NDArray[np.float64]:
        """Return random places inside the walls, and in view, for what can move."""
        return scatter(self._chance, frame.container, view, frame.radii[frame.movable])

    # Walls

    @property
    def drawn_walls(self) -> NDArray[np.intp]:
        """Return the rows of the walls that a user drew."""
        frame = self._engine.frame
        return np.arange(frame.own_walls, len(frame.walls))

    def wall(self, start: Point, end: Point) -> None:
        """Draw a wall: a line segment."""
        if self._engine.settings.by_article:
            self._say(NO_WALLS)
            return
        self._edit(lambda simulation: simulation.add_wall(Polyline((start, end))))

    def erase_wall(self, point: Point, reach: float) -> None:
        """Remove the wall that is nearest to a point, if it is within `reach` of it."""

        def work(simulation: Simulation) -> None:
            row, distance = nearest(simulation.frame().walls, point)
            if distance <= reach:
                simulation.remove_walls([row])

        self._edit(work)

    def clear_walls(self) -> None:
        """Remove every wall that was drawn."""

        def work(simulation: Simulation) -> None:
            frame = simulation.frame()
            simulation.remove_walls(np.arange(frame.own_walls, len(frame.walls)))

        if len(self.drawn_walls):
            self._edit(work)

    def _edit(self, work: Callable[[Simulation], object]) -> None:
        self._engine.edit(_or_say(work, self._say))


def _or_say(work: Callable[[Simulation], object], say: Callable[[str | None], None]) -> Edit:
    """Return an edit that turns a refusal into a sentence."""

    def edit(simulation: Simulation) -> None:
        try:
            work(simulation)
        except REFUSALS as error:
            say(sentence(error))

    return edit


def usual(frame: Frame) -> tuple[float, float]:
    """Return the median radius and density of what can move."""
    radii, densities = frame.radii[frame.movable], frame.densities[frame.movable]
    if len(radii) == 0:
        return PLAIN_RADIUS, PLAIN_DENSITY
    return float(np.median(radii)), float(np.median(densities))


def scatter(
    chance: np.random.Generator, container: Container, view: Rect, radii: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return random places for discs: inside the container, and where it is larger, in view."""
    n = len(radii)
    if isinstance(container, jostle.Circle):
        angle = chance.uniform(0, 2 * math.pi, n)
        reach = np.maximum(container.radius - radii, 0) * np.sqrt(chance.uniform(0, 1, n))
        around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        inside: NDArray[np.float64] = np.array(container.center) + around * reach[:, None]
        return inside
    low, high = np.array(view[:2]), np.array(view[2:])
    walls = bounds(container)
    if walls is not None:
        low, high = np.clip(low, walls[:2], walls[2:]), np.clip(high, walls[:2], walls[2:])
    room = np.maximum((high - low)[None, :] - 2 * radii[:, None], 0.0)
    places: NDArray[np.float64] = (low + high) / 2 + room * chance.uniform(-0.5, 0.5, (n, 2))
    return places


def _places_beside(
    frame: Frame, rows: NDArray[np.intp], view: Rect
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return places for copies, and which of them have one."""
    places = frame.positions[rows] + _beside(frame, rows)
    there, walls = np.ones(len(rows), np.bool_), bounds(frame.container)
    if walls is None:
        return places, there
    radii = frame.radii[rows].astype(np.float64)
    low, high = np.array(walls[:2]) + radii[:, None], np.array(walls[2:]) - radii[:, None]
    beyond = np.flatnonzero(((places < low) | (places > high)).any(axis=1))
    within = np.setdiff1d(np.arange(len(rows)), beyond)
    free, found = free_places(
        np.concatenate([frame.positions, places[within]]),
        np.concatenate([frame.radii, radii[within]]),
        radii[beyond], frame.container, view, len(frame), frame.walls,
    )  # fmt: skip
    there[beyond] = False
    places[beyond[found]], there[beyond[found]] = free, True
    return places, there


def _beside(frame: Frame, rows: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return the shift that puts copies beside their originals, on the side with more room."""
    places, radii = frame.positions[rows].astype(np.float64), frame.radii[rows, None]
    low, high = (places - radii).min(axis=0)[0], (places + radii).max(axis=0)[0]
    walls = bounds(frame.container)
    right = walls is None or low + high <= walls[0] + walls[2]
    way = CLONE_GAP * (high - low)
    return np.array([way if right else -way, 0.0])


def _party_speed(view: Rect) -> float:
    min_x, min_y, max_x, max_y = view
    return PARTY_SPEED * math.hypot(max_x - min_x, max_y - min_y)
