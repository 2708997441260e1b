"""A scene in the article's programs; `Simulation` is one of either rules."""

from __future__ import annotations

import math
import time
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle_lab import article
from jostle_lab.simulate.packing import (
    ATTRACTORS,
    COUNT,
    Arrays,
    column,
    pack,
    particles_of,
    unpack,
    within,
)
from jostle_lab.simulate.settings import SETTINGS, Polyline, Settings
from jostle_lab.simulate.simulation import (
    PLAIN,
    WIDTHS,
    Attractor,
    Energies,
    Frame,
    FrameContacts,
    FrameRequest,
    Point,
    Rect,
    StepStats,
    Tags,
    find,
)
from jostle_lab.simulate.validation import FARTHEST, Fields, each, one_of, read, whole
from jostle_lab.simulate.world_simulation import WorldSimulation

LARGEST = 1e9  # radius in pixels, and density: masses stay below 1e30, as in a world
MOST_PIXELS = 10**9  # of a side of the display
FRAME_RATE = 30  # the rate of the article's window; the article counts in frames
GRAVITY = 0.5  # pixels per frame, added in each frame
DEFAULT_N = 500
WINDOW = (800, 500)  # pixels
NO_WALLS = "The article's rules have no walls inside the window."

# The values of a saved state; its arrays are tags, times of birth and those of the program.
STATE_FIELDS = Fields(
    {
        "method": one_of(*article.METHODS),
        "size": each(whole(article.SMALLEST_SIDE, MOST_PIXELS), "width", "height"),
        "counters": each(COUNT, "tests", "repeats", "hits"),
        "settings": SETTINGS,
        "frames": COUNT,
        "next_tag": COUNT,
        "pulls": ATTRACTORS,
    }
)


class ArticleSimulation:
    """A scene under the article's rules, with their errors.

    The scene `article` is the article's own program. Other scenes provide the positions, velocities
    and sizes of their particles, on whole pixels, in a rectangle. Scene, number, seed and the
    method come from the settings; the rules are the article's. It has the methods of
    `WorldSimulation`.
    """

    time_step = 1 / FRAME_RATE
    adjustable = frozenset({"method", "time_scale"})

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        rules = settings.method.removeprefix("article-")
        if settings.scene == "article":
            n = DEFAULT_N if settings.n is None else settings.n
            sides = (
                max(round(side * settings.world_size), article.SMALLEST_SIDE) for side in WINDOW
            )
            self.program = article.Simulation(n, rules, settings.seed, *sides)
        else:
            source = WorldSimulation.of_scene(
                replace(settings, method="quadtree", container=None)  # a display is a rectangle
            )
            self.program = article_of(source.frame(), source.view, rules)
        self._take_size()
        self.attractors: tuple[Attractor, ...] = ()
        self._frames = 0
        self._milliseconds = 0.0
        self._tags: Tags = np.arange(len(self), dtype=np.int64)
        self._next_tag = len(self)
        self._born = np.zeros(len(self))

    def __len__(self) -> int:
        return len(self.program.particles)

    @property
    def effective_settings(self) -> Settings:
        """Return the settings, with the article's constants."""
        return replace(
            self.settings,
            leaf_capacity=article.MAX_PER_BOX,
            max_depth=article.MAX_LEVEL + 1,
            gravity=(0.0, GRAVITY * FRAME_RATE**2),
            drag=0.0,
            restitution=article.ELASTICITY,
            substeps=1,
            threads=1,
        )

    # Reading

    def frame(self, request: FrameRequest = FrameRequest()) -> Frame:  # noqa: B008 (it is frozen)
        rows = [
            (p.x, p.y, p.speed * math.sin(p.angle), -p.speed * math.cos(p.angle), p.radius,
             p.density) for p in self.program.particles
        ]  # fmt: skip
        table = np.array(rows, np.float32).reshape(-1, 6)
        positions, velocities, radii = table[:, 0:2], table[:, 2:4] * FRAME_RATE, table[:, 4]
        energies = _energies(positions, velocities, table[:, 5] * radii**2)
        return Frame(
            positions=positions,
            velocities=velocities,
            radii=radii,
            densities=table[:, 5],
            movable=np.ones(len(table), np.bool_),
            tags=self._tags,
            born=self._born,
            container=self.container,
            stats=self._stats(energies),
            energies=energies if request.energies else None,
            tree=self._nodes() if request.tree else None,
            contacts=_contacts(positions, radii) if request.contacts else None,
            attractors=self.attractors,
        )

    def _stats(self, energies: Energies) -> StepStats:
        """Return the numbers of the last frame; a pair in two leaves counts twice."""
        program = self.program
        return StepStats(
            time=self._frames * self.time_step,
            pairs_tested=program.tests,
            touching=program.hits,
            nodes=len(program.leaves),
            depth=max((leaf[4] for leaf in program.leaves), default=0),
            kinetic_energy=energies.kinetic,
            stage_times={"frame": self._milliseconds},  # the article has no separate stages
        )

    def _nodes(self) -> jostle.Nodes:
        """Return the leaves of the last frame; brute force has none."""
        leaves = np.array(self.program.leaves, np.int64).reshape(-1, 5)
        low, high = leaves[:, :2], leaves[:, :2] + leaves[:, 2:4]
        places = np.array([(p.x, p.y) for p in self.program.particles]).reshape(-1, 1, 2)
        counts = ((places >= low) & (places < high)).all(axis=2).sum(axis=0)
        corners = np.concatenate([low, high], axis=1).astype(np.float64)
        return jostle.Nodes(corners, leaves[:, 4], counts, np.ones(len(leaves), np.bool_))

    # Changing

    def step(self) -> None:
        """Advance by one frame of the article."""
        before, start = self.save(), time.perf_counter()
        if wrong := self._try_frame():
            self.load(before)
            raise ValueError(f"{wrong}; the step was not made.")
        self._frames += 1
        self._milliseconds = (time.perf_counter() - start) * 1e3

    def _try_frame(self) -> str:
        """Make one frame; return a description of an error, or an empty text."""
        failed = ""
        try:
            for attractor in self.attractors:
                self._attract_to(attractor)
            self.program.frame()
        except (ValueError, OverflowError) as error:  # from an infinite number
            failed = str(error)
        self.program.release()  # `drag` applies to one frame
        for row, p in enumerate(self.program.particles):
            if not all(abs(number) <= FARTHEST for number in (p.x, p.y, p.speed)):
                state = f"at ({p.x:.4g}, {p.y:.4g}) with speed {p.speed:.4g}"
                return f"Particle {self._tags[row]} would be {state}, beyond {FARTHEST:g}"
        return failed

    def _attract_to(self, attractor: Attractor) -> None:
        """Accelerate all particles by distance × strength, before the frame."""
        followed = self._particle(attractor.tag)
        point = (followed.x, followed.y) if followed is not None else attractor.point
        if point is None:
            return
        gain = attractor.strength / FRAME_RATE**2
        for particle in self.program.particles:
            dx, dy = point[0] - particle.x, point[1] - particle.y
            particle.angle, particle.speed = article.add_vectors(
                (particle.angle, particle.speed), (math.atan2(dx, -dy), gain * math.hypot(dx, dy))
            )

    def adjust(self, name: str, value: Any) -> str | None:
        """Switch between the article's two programs with the same particles, or set the speed."""
        if name == "method" and str(value).startswith("article-"):
            self.program.method = value.removeprefix("article-")
        elif name != "time_scale":
            return "The article's rules are fixed."
        self.settings = replace(self.settings, **{name: value})
        return None

    def add(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        densities: ArrayLike = 1.0,
        **columns: ArrayLike | None,
    ) -> Tags:
        """Add particles with whole numbers, as in the article; all are movable, without kinds."""
        given: dict[str, Any] = {**PLAIN, **columns}
        if np.any(given["sensors"]):
            raise ValueError("The article's particles cannot be sensors.")
        if any(np.not_equal(given[name], PLAIN[name]).any() for name in ("categories", "masks")):
            raise ValueError("The article's particles have no collision filter.")
        places = np.asarray(positions, np.float64).reshape(-1, 2)
        within("positions", places, -FARTHEST, FARTHEST)
        n = len(places)
        self.program.particles += _particles(places, velocities, radii, densities)
        tags = np.arange(self._next_tag, self._next_tag + n, dtype=np.int64)
        self._next_tag += n
        self._tags = np.concatenate([self._tags, tags])
        self._born = np.concatenate([self._born, np.full(n, self._frames * self.time_step)])
        return tags

    def remove(self, tags: ArrayLike) -> None:
        keep = ~np.isin(self._tags, np.asarray(tags))
        particles = zip(self.program.particles, keep, strict=True)
        self.program.particles = [particle for particle, kept in particles if kept]
        self._tags, self._born = self._tags[keep], self._born[keep]
        left = {None, *self._tags.tolist()}
        self.attractors = tuple(one for one in self.attractors if one.tag in left)

    def change(self, tags: ArrayLike, **columns: ArrayLike | None) -> None:
        """Set positions, velocities, densities; the article has no immovable particles."""
        rows, there = find(self._tags, tags)
        for name, value in columns.items():
            if value is None:
                continue
            shape = len(there), *WIDTHS[name]
            values = np.broadcast_to(np.asarray(value, np.float64), shape)[there].tolist()
            for row, new in zip(rows.tolist(), values, strict=True):
                _set(self.program.particles[row], name, new)

    def add_wall(self, line: Polyline) -> None:
        """Raise a ValueError: the article has no walls inside its display."""
        raise ValueError(NO_WALLS)

    def remove_walls(self, rows: ArrayLike) -> None:
        """Do nothing: there are none."""

    def attract(self, attractors: tuple[Attractor, ...]) -> None:
        self.attractors = attractors

    def drag(self, tag: int, point: Point, velocity: Point) -> None:
        """Move a particle towards the cursor, by the article's rule of the mouse."""
        particle = self._particle(tag)
        if particle is not None:
            self.program.held = particle
            self.program.drag_to(*point)

    def _particle(self, tag: int | None) -> article.Particle | None:
        rows = [] if tag is None else find(self._tags, tag)[0].tolist()
        return self.program.particles[rows[0]] if rows else None

    def save(self) -> bytes:
        program = self.program
        facts = {
            "settings": asdict(self.settings),
            "method": program.method,
            "size": [program.width, program.height],
            "counters": [program.tests, program.repeats, program.hits],
            "frames": self._frames,
            "next_tag": self._next_tag,
            "pulls": [asdict(attractor) for attractor in self.attractors],
        }
        numbers = [(p.x, p.y, p.speed, p.angle) for p in program.particles]
        sizes = [(p.radius, p.density, *p.rectangle) for p in program.particles]
        arrays = {
            "numbers": np.array(numbers, np.float64).reshape(-1, 4),
            "sizes": np.array(sizes, np.int64).reshape(-1, 6),
            "leaves": np.array(program.leaves, np.int64).reshape(-1, 5),
            "tags": self._tags,
            "born": self._born,
        }
        return pack("article", facts, arrays)

    def load(self, state: bytes) -> None:
        """Restore a state; raise a ValueError, before any change, if its bytes are wrong."""
        facts, arrays = unpack("article", state)
        facts = read(facts, STATE_FIELDS)
        settings, method, next_tag = facts["settings"], facts["method"], facts["next_tag"]
        if settings.method != f"article-{method}":
            raise ValueError(f"method is {method!r}, but settings.method {settings.method!r}")
        program = article.Simulation.of(_saved_particles(arrays), method, *facts["size"])
        program.tests, program.repeats, program.hits = facts["counters"]
        leaves = _saved(arrays, "leaves", "<i8", 5)
        within("leaves", leaves, 0, MOST_PIXELS)
        program.leaves = [(x, y, w, h, level) for x, y, w, h, level in leaves.tolist()]
        self._tags, self._born = particles_of(arrays, len(program.particles), next_tag)
        self.settings, self.program, self.attractors = settings, program, facts["pulls"]
        self._frames, self._next_tag = facts["frames"], next_tag
        self._take_size()

    def _take_size(self) -> None:
        """Set view and container from the program's display."""
        self.view: Rect = (0.0, 0.0, float(self.program.width), float(self.program.height))
        self.container = jostle.Box(*self.view)


Simulation = WorldSimulation | ArticleSimulation


def _set(particle: article.Particle, name: str, value: Any) -> None:
    if name == "positions":
        particle.x, particle.y = value
    elif name == "velocities":
        x, y = value
        particle.speed, particle.angle = math.hypot(x, y) / FRAME_RATE, math.atan2(x, -y)
    elif name == "densities":
        particle.density = max(round(value), 1)
        particle.__post_init__()  # mass and drag follow


def _energies(
    positions: NDArray[np.float32], velocities: NDArray[np.float32], masses: NDArray[np.float32]
) -> Energies:
    """Return the sums; the potential energy is 0 at y = 0."""
    momenta = masses[:, None].astype(np.float64) * velocities
    kinetic = 0.5 * (momenta * velocities).sum()
    potential = -GRAVITY * FRAME_RATE**2 * (masses.astype(np.float64) * positions[:, 1]).sum()
    x, y = momenta.sum(axis=0).tolist()
    return Energies(float(kinetic), float(potential), (x, y))


def _contacts(positions: NDArray[np.float32], radii: NDArray[np.float32]) -> FrameContacts:
    """Return the contacts; the article computes no impulses, and none with walls."""
    pairs, normals, depths = jostle.Quadtree(positions, radii).contacts()
    rows, none = np.empty(0, np.int64), np.empty(0, np.float32)
    return FrameContacts(
        pairs, normals, depths, np.zeros_like(depths), rows, none.reshape(0, 2), none
    )


def _saved_particles(arrays: Arrays) -> list[article.Particle]:
    """Return the particles of a saved state; raise a ValueError with a wrong number."""
    numbers, sizes = _saved(arrays, "numbers", "<f8", 4), _saved(arrays, "sizes", "<i8", 6)
    if len(numbers) != len(sizes):
        raise ValueError(f"numbers has {len(numbers)} rows, but sizes {len(sizes)}")
    within("numbers", numbers, -FARTHEST, FARTHEST)
    within("sizes", sizes[:, :2], 1, LARGEST)
    within("sizes", sizes, -4 * FARTHEST, 4 * FARTHEST)
    particles = []
    for (x, y, speed, angle), (radius, density, left, top, width, height) in zip(
        numbers.tolist(), sizes.tolist(), strict=True
    ):
        particle = article.Particle(x, y, radius, density, speed, angle)
        particle.rectangle = left, top, width, height
        particles.append(particle)
    return particles


def _saved(arrays: Arrays, name: str, kind: str, width: int) -> NDArray[Any]:
    """Return a saved table of any number of rows."""
    rows = len(arrays[name]) if name in arrays and arrays[name].ndim else 0
    return column(arrays, name, kind, (rows, width))


def article_of(frame: Frame, view: Rect, rules: str) -> article.Simulation:
    """Return the article's program over the particles of a frame.

    Its display is the view, and positions are shifted accordingly; radii and densities become
    whole numbers of at least 1, as in the article.
    """
    min_x, min_y, max_x, max_y = view
    places = frame.positions - np.array([min_x, min_y])
    particles = _particles(places, frame.velocities, frame.radii, frame.densities)
    width, height = (
        max(math.ceil(side), article.SMALLEST_SIDE) for side in (max_x - min_x, max_y - min_y)
    )
    return article.Simulation.of(particles, rules, width=width, height=height)


def _particles(
    places: NDArray[np.floating], velocities: ArrayLike, radii: ArrayLike, densities: ArrayLike
) -> list[article.Particle]:
    """Return particles of the article; it has velocities in pixels per frame."""
    n, particles = len(places), []
    for (x, y), (dx, dy), radius, density in zip(
        places.tolist(),
        (np.broadcast_to(np.asarray(velocities), (n, 2)) / FRAME_RATE).tolist(),
        np.broadcast_to(np.asarray(radii), n).tolist(),
        np.broadcast_to(np.asarray(densities), n).tolist(),
        strict=True,
    ):
        radius, density = max(round(radius), 1), max(round(density), 1)
        speed, angle = math.hypot(dx, dy), math.atan2(dx, -dy)
        particles.append(article.Particle(x, y, radius, density, speed, angle))
    return particles
