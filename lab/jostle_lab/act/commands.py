"""Commands on particles: make, copy, remove, stop, fix, scatter; the brush; and walls."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle_lab.schema import EVERY_CATEGORY, Polyline
from jostle_lab.simulate.containers import (
    Floats,
    are_inside,
    bounds,
    common,
    diagonal,
    directions,
    free_among,
    free_positions,
    random_in_disc,
)
from jostle_lab.simulate.engine import Engine
from jostle_lab.simulate.frame import Frame, Point, Rect, Tags
from jostle_lab.simulate.region import Container
from jostle_lab.simulate.simulation import Simulation

CLONE_GAP = 1.05  # diameters between a particle and its clone
TOP_SPEED = 0.4  # largest random speed, in diagonals of the view per second
DENSITIES = 1.0, 20.0  # the article's range, for colours that differ
PLAIN_RADIUS, PLAIN_DENSITY = 10.0, 1.0  # of a new particle, if there is no other


class Commands:
    """Commands on particles and walls: each is an edit of the engine."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._edit = engine.edit
        self.rng = np.random.default_rng()
        self.kind = 0  # the kind of new particles, where forces depend on it
        self.new_filter = {"categories": 1, "masks": EVERY_CATEGORY}  # of new particles

    @property
    def new_kind(self) -> int | None:
        """Return the kind of new particles; None if forces do not depend on kinds."""
        matrix = self._engine.frame.matrix
        return None if matrix is None else self.kind % len(matrix)

    # Some particles

    def create(self, point: Point) -> None:
        """Add a particle at rest, with the median radius and density."""
        self._add(np.array([point]))

    def paint(self, points: NDArray[np.float64], stroke: int) -> None:
        """Add such particles at those points at which they overlap nothing."""
        self._add(points, f"brush {stroke}")

    def _add(self, points: NDArray[np.float64], stroke: str = "") -> None:
        """Add particles of the chosen kind and filter; those of a stroke where nothing is."""
        frame = self._engine.frame
        radius, density = usual(frame)
        kinds = self.new_kind
        # A copy, because the edit may run after the next change of the filter.
        bits = dict(self.new_filter)

        def work(simulation: Simulation) -> None:
            free = free_among(simulation.world, points, radius) if stroke else slice(None)
            if n := len(points[free]):
                simulation.add(
                    points[free], (0, 0), [radius] * n, [density] * n, kinds=kinds, **bits
                )

        self._edit(work, stroke)

    def clone(self, tags: Tags) -> None:
        """Add a copy of each particle, all shifted alike; where a wall is, at a free position."""

        def work(simulation: Simulation) -> str | None:
            frame = simulation.frame()
            rows = frame.rows(tags)
            if not len(rows):
                return None
            places = frame.positions[rows] + _beside(frame, rows)
            radii = frame.radii[rows].astype(np.float64)
            beside = are_inside(places, radii, frame.container)
            _add_copies(simulation, frame, rows[beside], places[beside])
            beyond = rows[~beside]
            free, found = free_positions(
                simulation.world, frame.radii[beyond], simulation.view, len(frame)
            )
            _add_copies(simulation, frame, beyond[found], free)
            added = len(rows) - len(beyond) + len(free)
            if added == len(rows):
                return None
            return f"There was room for {added:,} of {len(rows):,} copies."

        self._edit(work)

    def delete(self, tags: Tags) -> None:
        self._edit(lambda simulation: simulation.remove(tags))

    def stop(self, tags: Tags) -> None:
        """Set the velocity of particles to 0."""
        self._edit(lambda simulation: simulation.change(tags, velocities=(0, 0)))

    def fix(self, tags: Tags, *, movable: bool) -> None:
        """Stop particles, and make them immovable or movable."""
        self._edit(lambda simulation: simulation.change(tags, velocities=(0, 0), movable=movable))

    def set_bit(self, tags: Tags, column: str, bit: int, *, on: bool) -> None:
        """Set or clear one bit of the categories or masks of particles; of new ones if no tags."""

        def work(simulation: Simulation) -> None:
            frame = simulation.frame()
            rows = frame.rows(tags)
            changed = _with_bit(getattr(frame, column)[rows], bit, on)
            simulation.change(frame.tags[rows], **{column: changed})

        if len(tags):
            self._edit(work)
        else:
            self.new_filter[column] = int(_with_bit(self.new_filter[column], bit, on))

    # All that can move

    def scramble(self) -> None:
        """Move every particle to a random position inside the container."""
        self._scatter()

    def randomise(self) -> None:
        """Give every particle a random position, velocity and density, and so a random colour."""
        self._scatter(all_columns=True)

    def _scatter(self, *, all_columns: bool = False) -> None:
        """Move every movable particle to a random position."""

        def work(simulation: Simulation) -> None:
            frame, view, rng = simulation.frame(), simulation.view, self.rng
            radii = frame.radii[frame.movable]
            columns = {"positions": scatter(rng, frame.container, view, radii)}
            if all_columns:
                speeds = rng.uniform(0, TOP_SPEED * diagonal(view), (len(radii), 1))
                columns["velocities"] = speeds * directions(rng, len(radii))
                columns["densities"] = np.rint(rng.uniform(*DENSITIES, len(radii)))
            simulation.change(frame.tags[frame.movable], **columns)

        self._edit(work)

    # Walls

    @property
    def drawn_walls(self) -> NDArray[np.intp]:
        """Return the rows of the walls that a user drew."""
        frame = self._engine.frame
        return np.arange(frame.own_walls, len(frame.walls))

    def wall(self, start: Point, end: Point) -> None:
        """Add a wall: a line segment."""
        self._edit(lambda simulation: simulation.add_wall(Polyline((start, end))))

    def erase_wall(self, point: Point, reach: float) -> None:
        """Remove the wall that is nearest to a point, if it is within `reach` of it."""

        self._edit(lambda simulation: simulation.remove_wall(point, reach))

    def clear_walls(self) -> None:
        if len(self.drawn_walls):
            self._edit(Simulation.remove_drawn_walls)


def _add_copies(
    simulation: Simulation, frame: Frame, rows: NDArray[np.intp], places: Floats
) -> None:
    """Add copies of rows of a frame at other places."""
    if len(rows):
        simulation.add(
            places, frame.velocities[rows], frame.radii[rows], frame.densities[rows],
            movable=frame.movable[rows],
            sensors=False if frame.sensors is None else frame.sensors[rows] != 0,
            kinds=None if frame.kinds is None else frame.kinds[rows],
            categories=frame.categories[rows], masks=frame.masks[rows],
        )  # fmt: skip


def _with_bit(bits: ArrayLike, bit: int, on: bool) -> NDArray[np.uint32]:
    flag = np.uint32(1 << bit)
    with_it: NDArray[np.uint32] = np.asarray(bits, np.uint32) | flag
    return with_it if on else with_it ^ flag


def usual(frame: Frame) -> tuple[float, float]:
    """Return the median radius and density of the movable particles."""
    radii, densities = frame.radii[frame.movable], frame.densities[frame.movable]
    if len(radii) == 0:
        return PLAIN_RADIUS, PLAIN_DENSITY
    return float(np.median(radii)), float(np.median(densities))


def scatter(rng: np.random.Generator, container: Container, view: Rect, radii: Floats) -> Floats:
    """Return random positions for discs, inside both the container and the view."""
    n = len(radii)
    if isinstance(container, jostle.Circle):
        reach = np.maximum(container.radius - radii, 0)[:, None]
        inside: Floats = container.center + reach * random_in_disc(rng, n)
        return inside
    low, high = np.array(common(bounds(container), view)).reshape(2, 2)
    room = np.maximum((high - low)[None, :] - 2 * radii[:, None], 0.0)
    places: Floats = (low + high) / 2 + room * rng.uniform(-0.5, 0.5, (n, 2))
    return places


def _beside(frame: Frame, rows: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return the shift from the originals to their copies, to the side with more space."""
    places, radii = frame.positions[rows].astype(np.float64), frame.radii[rows, None]
    low, high = (places - radii).min(axis=0)[0], (places + radii).max(axis=0)[0]
    walls = bounds(frame.container)
    right = walls is None or low + high <= walls[0] + walls[2]
    shift = CLONE_GAP * (high - low)
    return np.array([shift if right else -shift, 0.0])


# The brush

REACH = 6.0  # radii of a particle: the radius of the brush
SPACING = 2.0  # radii: between two positions of the brush at which it adds particles
DROPS = 2  # particles added at each position, if there is room


class Brush:
    """Adds particles at random positions within its radius, where they overlap no other."""

    def __init__(self, engine: Engine, commands: Commands) -> None:
        self._engine, self._commands = engine, commands
        self._at: Point = (0.0, 0.0)
        self._strokes = 0
        self._size = (-1, 0.0)  # number of particles, and the radius of a new one

    @property
    def radius(self) -> float:
        """Return the radius of the brush in units of the world."""
        return REACH * self._particle()

    def begin(self, point: Point) -> None:
        """Add particles around a point, where a stroke begins."""
        self._at, self._strokes = point, self._strokes + 1
        self._add(np.array([point]))

    def stroke(self, point: Point) -> None:
        """Add particles along the line to a point."""
        spacing, length = SPACING * self._particle(), math.dist(self._at, point)
        count = int(length / spacing)
        if count == 0:
            return
        ahead = (np.array(point) - self._at) * (spacing / length)
        places = self._at + ahead * np.arange(1, count + 1)[:, None]
        self._at = (float(places[-1, 0]), float(places[-1, 1]))
        self._add(places)

    def _add(self, middles: NDArray[np.float64]) -> None:
        middles = np.repeat(middles, DROPS, axis=0)
        offsets = self.radius * random_in_disc(self._commands.rng, len(middles))
        self._commands.paint(middles + offsets, self._strokes)

    def _particle(self) -> float:
        """Return the radius of a new particle; a median, so it is kept while no number changes."""
        frame = self._engine.frame
        if self._size[0] != len(frame):
            self._size = len(frame), usual(frame)[0]
        return self._size[1]
