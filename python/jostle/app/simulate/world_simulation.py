"""`jostle.World` as the app sees it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle.app.simulate.emitters import Emitters
from jostle.app.simulate.packing import blob, pack, unpack
from jostle.app.simulate.room import free_places
from jostle.app.simulate.settings import Settings, settings_of
from jostle.app.simulate.simulation import (
    Container,
    Energies,
    Facts,
    Frame,
    Point,
    Pull,
    Rect,
    Tags,
    Touching,
    TreeBoxes,
    Wants,
)
from jostle.app.simulate.walls import Home, bounds, brought_in, center_of

TIME_STEP = 1 / 60
BRUTE_LIMIT = 30_000  # above it one step of brute force would freeze the picture for seconds
HAND_RATE = 40.0  # 1/s: the spring of the hand brings a particle near in a few hundredths
LEAST_EASE = 0.3  # of that rate, for the heaviest: a hundred times the usual mass lags threefold
SPEED_LIMIT = 4.0  # a held particle's speed, in diagonals of the view a second

# Settings that are attributes of a world, by the same name.
RULES = (
    *("method", "leaf_capacity", "max_depth", "gravity", "drag", "restitution", "substeps"),
    *("threads", "on_touch"),
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
        self._own_forces = len(self.world.forces)  # those of a person come behind
        self._pulls: tuple[Pull, ...] = ()
        self._heirs: dict[int, int] = {}  # by tag: which particle one that attracted has joined
        self._tags: Tags = np.arange(len(self.world), dtype=np.int64)
        self._next_tag = len(self.world)
        self._born: NDArray[np.float64] = np.zeros(len(self.world))
        self._note_columns()
        for name in RULES:
            value = getattr(settings, name)
            if value is not None:
                setattr(self.world, name, value)
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
        return frozenset({*RULES, "time_scale", "n", "world_size", "container"})

    @property
    def rules(self) -> Settings:
        """Return the settings with the world's own rules."""
        return replace(self.settings, **{name: getattr(self.world, name) for name in RULES})

    # Looking

    def frame(self, wants: Wants = Wants()) -> Frame:  # noqa: B008 (it is frozen)
        """Return the present state."""
        world = self.world
        return Frame(
            positions=world.positions,
            velocities=world.velocities,
            radii=self._radii,
            densities=self._densities,
            movable=self._movable,
            tags=self._tags,
            born=self._born,
            container=world.container,
            facts=self._facts(),
            energies=self._energies() if wants.energies else None,
            tree=self._tree_boxes() if wants.tree else None,
            touching=self._touching() if wants.contacts else None,
            springs=self._springs(),
            attractors=self._pulls,
            scene=self.scene,
            begun_with=self._home.n,
        )

    def _facts(self) -> Facts:
        world, stats = self.world, self.world.stats
        return Facts(
            time=world.time,
            pairs_tested=stats.tests,
            touching=len(world.contacts.pairs),
            nodes=stats.nodes,
            depth=stats.depth,
            kinetic_energy=world.kinetic_energy,
            stage_times=dict(world.profile),
        )

    def _energies(self) -> Energies:
        world = self.world
        return Energies(world.kinetic_energy, world.potential_energy, world.momentum)

    def _touching(self) -> Touching:
        contacts = self.world.contacts
        return Touching(contacts.pairs, contacts.normals, contacts.depths)

    def _springs(self) -> NDArray[np.uint32] | None:
        pairs = [force.pairs for force in self.world.forces if isinstance(force, jostle.Springs)]
        return np.concatenate(pairs) if pairs else None

    def _tree_boxes(self) -> TreeBoxes:
        """Build a tree over the present positions, with the world's settings, for its boxes."""
        world = self.world
        nodes = jostle.Quadtree(
            world.positions,
            self._radii,
            leaf_capacity=world.leaf_capacity,
            max_depth=world.max_depth,
        ).nodes()
        return TreeBoxes(
            np.asarray(nodes.boxes, np.float64),
            np.asarray(nodes.depths, np.intp),
            np.asarray(nodes.counts, np.intp),
            nodes.is_leaf,
        )

    def _note_columns(self) -> None:
        """Copy what only edits change, so a picture of a million need not copy it every time."""
        world = self.world
        self._radii: NDArray[np.float32] = world.radii
        self._movable: NDArray[np.bool_] = world.movable
        self._usual_mass: float | None = None  # the median; only the hand asks for it
        masses, areas = world.masses, self._radii**2
        self._densities = np.divide(masses, areas, out=np.zeros_like(masses), where=areas > 0)

    # Acting

    def step(self) -> None:
        """Go on by 1/60 s."""
        self.world.step(self.time_step)
        renumbered = self.world.renumbered
        if renumbered is not None:
            self._follow_merging(renumbered)
        if self.emitters is not None:
            self._emit(self.emitters)

    def _emit(self, emitters: Emitters) -> None:
        """Let drops come out; the oldest go where there are too many."""
        gone = emitters.step(self.world, self.time_step)
        if gone is not None:
            self._tags, self._born = np.delete(self._tags, gone), np.delete(self._born, gone)
        new = len(self.world) - len(self._tags)
        self._tag_last(new)
        if new or gone is not None:
            self._note_columns()
            self._renew_pulls()

    def _tag_last(self, count: int) -> Tags:
        """Give tags to particles that have just been added."""
        tags = np.arange(self._next_tag, self._next_tag + count, dtype=np.int64)
        self._next_tag += count
        self._tags = np.concatenate([self._tags, tags])
        self._born = np.concatenate([self._born, np.full(count, self.world.time)])
        return tags

    def _follow_merging(self, renumbered: NDArray[np.uint32]) -> None:
        """Give what has become of several particles the tag of the oldest of them."""
        before = self._tags
        _, oldest = np.unique(renumbered, return_index=True)
        self._tags, self._born = before[oldest], self._born[oldest]
        heirs = self._tags[renumbered]
        for row in np.flatnonzero(
            np.isin(before, [pull.tag for pull in self._pulls if pull.tag is not None])
        ):
            self._heirs[int(before[row])] = int(heirs[row])
        self._note_columns()
        self._renew_pulls()

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
            elif name in RULES:
                setattr(self.world, name, value)
        except (ValueError, TypeError, OverflowError) as error:
            self.settings = before
            return str(error)
        return None

    def _fit_walls(self) -> None:
        """Give the world the walls of the settings, and bring inside what is out."""
        world, settings = self.world, self.settings
        before = center_of(bounds(world.container) or self._home.rect)
        world.container, self.view = self._home.fitted(settings.container, settings.world_size)
        shift = np.array(center_of(bounds(world.container) or self._home.rect)) - np.array(before)
        places = world.positions.astype(np.float64) + shift
        inside = brought_in(places, self._radii.astype(np.float64), world.container)
        world.positions = np.where(self._movable[:, None], inside, places)

    def _take_number(self, n: int) -> None:
        """Add copies of particles where there is room for all of them, or remove the last ones.

        `n` counts what can move; of a scene with emitters it is the cap.
        """
        if self.emitters is not None:
            self.emitters.cap = n
            return
        moving = np.flatnonzero(self._movable)
        more = n - len(moving)
        if more <= 0:
            self.remove(self._tags[moving[n:]])
            return
        if self.method == "brute" and len(self) + more > BRUTE_LIMIT:
            raise ValueError(f"Brute force is too slow to watch above {BRUTE_LIMIT:,} particles.")
        if more > MOST_AT_ONCE or len(moving) == 0 or not self._add_copies(moving, more):
            raise ValueError(f"There is no room for {more:,} more particles.")

    def _add_copies(self, rows: NDArray[np.intp], count: int) -> bool:
        """Add copies of some of the rows at free random places, if there is one for each."""
        world = self.world
        chance = np.random.default_rng([self.settings.seed, self._next_tag])
        rows = chance.choice(rows, count)
        places, found = free_places(
            world.positions, self._radii, self._radii[rows], world.container, self.view,
            int(chance.integers(2**31)),
        )  # fmt: skip
        if len(found) < count:
            return False
        self.add(places, world.velocities[rows], self._radii[rows], self._densities[rows])
        return True

    def add(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        densities: ArrayLike = 1.0,
        movable: ArrayLike = True,
    ) -> Tags:
        """Add particles; return their tags."""
        places = np.asarray(positions, np.float32).reshape(-1, 2)
        ids = self.world.add(
            places,
            np.broadcast_to(np.asarray(velocities, np.float32), places.shape),
            radii,
            densities=densities,
            movable=np.asarray(movable),
        )
        tags = self._tag_last(len(ids))
        self._note_columns()
        return tags

    def remove(self, tags: ArrayLike) -> None:
        """Remove particles."""
        rows = np.unique(self._find(tags)[0])
        self.world.forces = self.world.forces[: self._own_forces]
        self.world.remove(rows)
        self._own_forces = len(self.world.forces)  # some may have been tied to what is gone
        self._tags, self._born = np.delete(self._tags, rows), np.delete(self._born, rows)
        self._note_columns()
        self._renew_pulls()

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
        rows, there = self._find(tags)
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
            columns["masses"] = columns["masses"] * self._radii[rows] ** 2
        self.world.set(rows, **columns)
        if movable is not None or densities is not None:
            self._note_columns()

    def attract(self, pulls: tuple[Pull, ...]) -> None:
        """Replace the attractions that a person has placed.

        A person may not have seen yet that a particle has merged: what has become of it attracts.
        """
        pulls = tuple(filter(None, map(self._living, pulls)))
        if pulls != self._pulls:
            self._tie(pulls)

    def _living(self, pull: Pull) -> Pull | None:
        """Return an attraction, of the heir where its particle has merged; None if it is gone."""
        tag = pull.tag
        while tag is not None and not len(self._find(tag)[0]):
            if tag not in self._heirs:
                return None
            tag = self._heirs[tag]
        return pull if tag == pull.tag else replace(pull, tag=tag)

    def _tie(self, pulls: tuple[Pull, ...]) -> None:
        """Write attractions into the world, to the rows of the moment."""
        forces = []
        for pull in pulls:
            if pull.point is not None:
                forces.append(jostle.Attractor(pull.point, pull.strength))
            elif pull.tag is not None:
                forces += [
                    jostle.Attractor(strength=pull.strength, particle=int(row))
                    for row in self._find(pull.tag)[0]
                ]
        self.world.forces = (*self.world.forces[: self._own_forces], *forces)
        self._pulls = pulls

    def _renew_pulls(self) -> None:
        """Tie attractions to the rows of the moment; those of particles that are gone end."""
        self._tie(tuple(filter(None, map(self._living, self._pulls))))

    def drag(self, tag: int, point: Point, velocity: Point) -> None:
        """Draw a held particle to the hand by a critically damped spring.

        Its velocity changes, not its place: so it still pushes what is in its way, and is held up
        by what it cannot push. The spring's step is implicit, so no stiffness is too much for it.
        """
        rows, _ = self._find(tag)
        if not len(rows):
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
        self.world.set([row], velocities=[pulled * min(1.0, limit / max(speed, limit))])

    def _ease(self, row: int) -> float:
        """Return how readily a particle follows the hand: 1, or less for one that is heavy here."""
        if self._usual_mass is None:
            self._usual_mass = float(np.median(self.world.masses[self._movable]))
        share = self._usual_mass / float(self.world.masses[row])
        return min(max(math.sqrt(math.sqrt(share)), LEAST_EASE), 1.0)

    def save(self) -> bytes:
        """Return the state."""
        facts = {
            "settings": asdict(self.settings),
            "view": self.view,
            "next_tag": self._next_tag,
            "own_forces": self._own_forces,
            "pulls": [asdict(pull) for pull in self._pulls],
            "home": asdict(self._home),
            "emitters": self._emitted(),
        }
        snapshot = blob(self.world.snapshot())
        return pack("world", facts, {"tags": self._tags, "born": self._born, "world": snapshot})

    def load(self, state: bytes) -> None:
        """Go back to a state; a ValueError says what is wrong with other bytes."""
        facts, columns = unpack("world", state)
        world = jostle.World.restore(columns["world"].tobytes())
        settings, home = settings_of(facts["settings"]), Home.read(facts["home"])
        pulls = tuple(Pull.of(pull) for pull in facts["pulls"])
        emitters = None
        if facts["emitters"] is not None:
            emitters = Emitters(home.n, settings.seed)  # the nozzles are those of the first number
            emitters.cap, emitters.emitted, emitters.debt = facts["emitters"]
        self.settings, self.world, self.view = settings, world, tuple(facts["view"])
        self._home, self.emitters = home, emitters
        self._own_forces, self._pulls, self._heirs = facts["own_forces"], pulls, {}
        self._tags, self._born = columns["tags"], columns["born"]
        self._next_tag = facts["next_tag"]
        self._note_columns()

    def _emitted(self) -> tuple[int, int, float] | None:
        """Return the state of the emitters, if there are any."""
        emitters = self.emitters
        return (emitters.cap, emitters.emitted, emitters.debt) if emitters else None

    def _find(self, tags: ArrayLike) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Return the rows of the tags that are there, in their order, and which those are."""
        wanted = np.atleast_1d(np.asarray(tags, np.int64))
        at = np.searchsorted(self._tags, wanted)
        there = at < len(self._tags)
        there[there] = self._tags[at[there]] == wanted[there]
        return at[there], there

    def _diagonal(self) -> float:
        min_x, min_y, max_x, max_y = self.view
        return math.hypot(max_x - min_x, max_y - min_y)
