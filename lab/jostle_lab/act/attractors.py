"""Gravity, and attractors of the user: points, particles, and the cursor while Space is held.

The acceleration is distance × strength, independent of the mass, as in the article's program.
"""

import math
from collections.abc import Callable

from jostle_lab.schema import FARTHEST
from jostle_lab.simulate.engine import Engine
from jostle_lab.simulate.frame import Attractor, Point, Tags
from jostle_lab.simulate.simulation import Simulation

STRENGTH = 4.0  # 1/s²: a particle at rest arrives after 0.75 s
CURSOR_STRENGTH = 8.0  # 1/s²: enough to lift a pile
FALL_TIME = 1.5  # seconds in which a ball falls through the view after gravity is switched on


class Attractors:
    """The attractors of the user: the simulation has them, and this changes them."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        # The attraction to the cursor while a key is held; an input of each step.
        self.cursor: Attractor | None = None

    @property
    def placed(self) -> tuple[Attractor, ...]:
        """Return the permanent ones of the last frame, in the order of placing."""
        return tuple(one for one in self._engine.frame.attractors if not one.passing)

    def place(self, point: Point, strength: float = STRENGTH) -> None:
        """Add an attractor at a point."""
        new = Attractor(strength, _within_reach(point))
        self._change(lambda present: (*present, new))

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
        self._change(lambda present: tuple(other for other in present if other != attractor))

    def attracts(self, tag: int) -> bool:
        """Return whether a particle is an attractor."""
        return any(attractor.tag == tag for attractor in self.placed)

    def set_attracting(self, tags: Tags, attracts: bool) -> None:
        """Make particles attractors, or end that."""
        chosen = set(tags.tolist())
        new = tuple(Attractor(STRENGTH, tag=tag) for tag in sorted(chosen)) if attracts else ()
        self._change(lambda present: (*(a for a in present if a.tag not in chosen), *new))

    def stop(self) -> None:
        self._change(lambda present: ())

    def _change(self, change: Callable[[tuple[Attractor, ...]], tuple[Attractor, ...]]) -> None:
        self._engine.edit(lambda simulation: simulation.attract(change(simulation.attractors)))

    def attract_to_cursor(self, point: Point | None) -> None:
        """Attract all particles to a point until this is called with None."""
        self.cursor = point and Attractor(CURSOR_STRENGTH, _within_reach(point), passing=True)


def _within_reach(point: Point) -> Point:
    """Return the nearest point within the limits of a world, which the camera may exceed."""
    x, y = (min(max(side, -FARTHEST), FARTHEST) for side in point)
    return x, y


class Gravity:
    """Changes of gravity by the user."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    @property
    def value(self) -> Point:
        """Return gravity in world units per second squared, y down."""
        return self._engine.effective_settings.gravity or (0.0, 0.0)

    def set(self, value: Point) -> None:
        self._change(lambda old: value)

    def scale(self, factor: float) -> None:
        """Multiply gravity; from 0, an increase sets a moderate value."""

        def scaled(old: Point) -> Point:
            if old == (0.0, 0.0) and factor > 1:
                return 0.0, self._moderate()
            return old[0] * factor, old[1] * factor

        self._change(scaled)

    def invert(self) -> None:
        self._change(lambda old: (-old[0], -old[1]))

    def zero(self) -> None:
        self.set((0.0, 0.0))

    def turn(self) -> None:
        """Turn gravity by 90°: down, left, up, right."""
        self._change(
            lambda old: (0.0, self._moderate()) if old == (0.0, 0.0) else (-old[1], old[0])
        )

    def _moderate(self) -> float:
        _, min_y, _, max_y = self._engine.view
        return 2 * (max_y - min_y) / FALL_TIME**2

    def _change(self, new: Callable[[Point], Point]) -> None:
        def work(simulation: Simulation) -> str:
            value = new(simulation.effective_settings.gravity or (0.0, 0.0))
            value = value[0] + 0.0, value[1] + 0.0  # no negative zero
            return simulation.adjust("gravity", value) or as_text(value)

        self._engine.edit(work, "gravity")


def as_text(gravity: Point) -> str:
    """Return gravity as a message."""
    x, y = gravity
    strength = math.hypot(x, y)
    if strength == 0:
        return "Zero gravity"
    if x and y:
        return f"Gravity x {x:.4g}, y {y:.4g}"
    direction = ("down" if y > 0 else "up") if y else ("to the right" if x > 0 else "to the left")
    return f"Gravity {strength:.4g} {direction}"
