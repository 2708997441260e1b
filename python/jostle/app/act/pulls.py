"""Attractors of the user: points, particles, and the cursor while Space is held.

All of them pull by distance × strength, as in the article's fuller program, whatever the mass.
"""

from __future__ import annotations

import math

from jostle.app.simulate.engine import Engine
from jostle.app.simulate.rules import FARTHEST
from jostle.app.simulate.simulation import Frame, Point, Pull, Simulation, Tags

STRENGTH = 4.0  # 1/s²: what starts at rest is there after three quarters of a second
CURSOR_STRENGTH = 8.0  # 1/s²: Space lifts a heap off the ground


class Pulls:
    """The attractions that a person has placed.

    Attributes
    ----------
    placed
        Those that stay, in the order of placing.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self.placed: tuple[Pull, ...] = ()
        self._cursor: Point | None = None
        self._seen: tuple[Pull, ...] = ()  # those of the frame that was looked at last

    def pull_to(self, point: Point | None) -> None:
        """Pull everything to a point as long as this is called; None lets go."""
        ended = point is None and self._cursor is not None
        self._cursor = point and _within_reach(point)
        if ended:
            self._engine.edit(self.apply)

    def place(self, point: Point, strength: float = STRENGTH) -> None:
        """Put an attractor at a place."""
        self._set((*self.placed, Pull(strength, _within_reach(point))))

    def near(self, point: Point, reach: float) -> Pull | None:
        """Return the attractor at a place, if there is one within reach."""
        gaps = [
            (math.dist(pull.point, point), pull) for pull in self.placed if pull.point is not None
        ]
        gap, nearest = min(gaps, key=lambda found: found[0], default=(math.inf, None))
        return nearest if gap <= reach else None

    def lift(self, pull: Pull) -> None:
        """Take one attraction away."""
        self._set(tuple(other for other in self.placed if other is not pull))

    def attracts(self, tag: int) -> bool:
        """Return whether a particle attracts the others."""
        return any(pull.tag == tag for pull in self.placed)

    def let_attract(self, tags: Tags, attracts: bool) -> None:
        """Let particles attract the others, or stop them."""
        chosen = set(tags.tolist())
        rest = tuple(pull for pull in self.placed if pull.tag not in chosen)
        new = tuple(Pull(STRENGTH, tag=tag) for tag in sorted(chosen)) if attracts else ()
        self._set(rest + new)

    def stop(self) -> None:
        """End every attraction that was placed."""
        self._set(())

    def take_over(self, frame: Frame) -> None:
        """Go on with what holds in a frame: a state that is gone back to has attractions too."""
        self.placed = tuple(pull for pull in frame.attractors if not pull.passing)
        self._seen = frame.attractors

    def follow(self, frame: Frame) -> None:
        """Let go of those that are gone."""
        if frame.attractors is not self._seen:
            self.take_over(frame)

    @property
    def felt(self) -> tuple[Pull, ...]:
        """Return every attraction of the moment; any thread may ask."""
        cursor = self._cursor
        if cursor is None:
            return self.placed
        return *self.placed, Pull(CURSOR_STRENGTH, cursor, passing=True)

    def apply(self, simulation: Simulation) -> None:
        """Let the simulation feel what a person wants."""
        self.pull(simulation)

    def pull(self, simulation: Simulation) -> bool:
        """Let the simulation feel what a person wants; tell whether the cursor pulls."""
        felt = self.felt
        simulation.attract(felt)
        return any(pull.passing for pull in felt)

    def _set(self, pulls: tuple[Pull, ...]) -> None:
        self.placed = pulls
        self._engine.edit(self.apply)


def _within_reach(point: Point) -> Point:
    """Return the nearest point within the limits of a world; the camera may be beyond them."""
    x, y = (min(max(side, -FARTHEST), FARTHEST) for side in point)
    return x, y
