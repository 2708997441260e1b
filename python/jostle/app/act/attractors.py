"""Attractors of the user: points, particles, and the cursor while Space is held.

The acceleration is distance × strength, independent of the mass, as in the article's program.
"""

from __future__ import annotations

import math

from jostle.app.simulate.engine import Engine
from jostle.app.simulate.simulation import Attractor, Frame, Point, Simulation, Tags
from jostle.app.simulate.validation import FARTHEST

STRENGTH = 4.0  # 1/s²: a particle at rest arrives after 0.75 s
CURSOR_STRENGTH = 8.0  # 1/s²: enough to lift a pile


class Attractors:
    """The attractors that the user has placed.

    Attributes
    ----------
    placed
        The permanent ones, in the order of placing.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self.placed: tuple[Attractor, ...] = ()
        self._cursor: Point | None = None
        self._seen: tuple[Attractor, ...] = ()  # those of the last frame

    def attract_to_cursor(self, point: Point | None) -> None:
        """Attract all particles to a point until this is called with None."""
        ended = point is None and self._cursor is not None
        self._cursor = point and _within_reach(point)
        if ended:
            self._engine.edit(self.apply)

    def place(self, point: Point, strength: float = STRENGTH) -> None:
        """Add an attractor at a point."""
        self._set((*self.placed, Attractor(strength, _within_reach(point))))

    def near(self, point: Point, reach: float) -> Attractor | None:
        """Return the nearest attractor within `reach` of a point, or None."""
        gaps = [
            (math.dist(attractor.point, point), attractor)
            for attractor in self.placed
            if attractor.point is not None
        ]
        gap, nearest = min(gaps, key=lambda found: found[0], default=(math.inf, None))
        return nearest if gap <= reach else None

    def remove(self, attractor: Attractor) -> None:
        """Remove an attractor."""
        self._set(tuple(other for other in self.placed if other is not attractor))

    def attracts(self, tag: int) -> bool:
        """Return whether a particle is an attractor."""
        return any(attractor.tag == tag for attractor in self.placed)

    def set_attracting(self, tags: Tags, attracts: bool) -> None:
        """Make particles attractors, or end that."""
        chosen = set(tags.tolist())
        rest = tuple(attractor for attractor in self.placed if attractor.tag not in chosen)
        new = tuple(Attractor(STRENGTH, tag=tag) for tag in sorted(chosen)) if attracts else ()
        self._set(rest + new)

    def stop(self) -> None:
        """Remove all attractors."""
        self._set(())

    def adopt(self, frame: Frame) -> None:
        """Take the attractors of a frame: a rewound state has its own."""
        self.placed = tuple(attractor for attractor in frame.attractors if not attractor.passing)
        self._seen = frame.attractors

    def follow(self, frame: Frame) -> None:
        """Take the attractors of a frame if they have changed."""
        if frame.attractors is not self._seen:
            self.adopt(frame)

    @property
    def active(self) -> tuple[Attractor, ...]:
        """Return the attractors that act now, with the cursor; any thread may call it."""
        cursor = self._cursor
        if cursor is None:
            return self.placed
        return *self.placed, Attractor(CURSOR_STRENGTH, cursor, passing=True)

    def apply(self, simulation: Simulation) -> None:
        """Set the attractors of a simulation."""
        self.update(simulation)

    def update(self, simulation: Simulation) -> bool:
        """Let the simulation feel what a person wants; tell whether the cursor attractors."""
        active = self.active
        simulation.attract(active)
        return any(attractor.passing for attractor in active)

    def _set(self, attractors: tuple[Attractor, ...]) -> None:
        self.placed = attractors
        self._engine.edit(self.apply)


def _within_reach(point: Point) -> Point:
    """Return the nearest point within the limits of a world, which the camera may exceed."""
    x, y = (min(max(side, -FARTHEST), FARTHEST) for side in point)
    return x, y
