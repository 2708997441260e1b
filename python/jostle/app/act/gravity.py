"""Changes of the direction and strength of gravity while the scene runs."""

from __future__ import annotations

import math
from collections.abc import Callable

from jostle.app.simulate.engine import Engine
from jostle.app.simulate.simulation import Point, Simulation

FALL_TIME = 1.5  # seconds in which a ball falls through the view after gravity is switched on


class Gravity:
    """Changes of gravity by the user; an error becomes a message."""

    def __init__(self, engine: Engine, say: Callable[[str | None], None]) -> None:
        self._engine = engine
        self._say = say

    @property
    def value(self) -> Point:
        """Return gravity in world units per second squared, y down."""
        return self._engine.effective_settings.gravity or (0.0, 0.0)

    def set(self, value: Point) -> None:
        """Set both components."""
        self._change(lambda old: value)

    def set_downwards(self, strength: float) -> None:
        """Set gravity to point down, or up where it is negative."""
        self.set((0.0, strength))

    def scale(self, factor: float) -> None:
        """Multiply gravity; from 0, an increase sets a moderate value."""

        def scaled(old: Point) -> Point:
            if old == (0.0, 0.0) and factor > 1:
                return 0.0, self._moderate()
            return old[0] * factor, old[1] * factor

        self._change(scaled)

    def invert(self) -> None:
        """Invert gravity."""
        self._change(lambda old: (-old[0], -old[1]))

    def zero(self) -> None:
        """Set gravity to 0."""
        self.set((0.0, 0.0))

    def turn(self) -> None:
        """Turn gravity by 90°: down, left, up, right."""

        def turned(old: Point) -> Point:
            return (0.0, self._moderate()) if old == (0.0, 0.0) else (-old[1], old[0])

        self._change(turned)

    def _moderate(self) -> float:
        _, min_y, _, max_y = self._engine.view
        return 2 * (max_y - min_y) / FALL_TIME**2

    def _change(self, new: Callable[[Point], Point]) -> None:
        def work(simulation: Simulation) -> None:
            value = new(simulation.effective_settings.gravity or (0.0, 0.0))
            value = value[0] + 0.0, value[1] + 0.0  # no negative zero
            self._say(simulation.adjust("gravity", value) or as_text(value))

        self._engine.edit(work)


def as_text(gravity: Point) -> str:
    """Return gravity as a message."""
    x, y = gravity
    strength = math.hypot(x, y)
    if strength == 0:
        return "No gravity"
    if x and y:
        return f"Gravity x {x:.4g}, y {y:.4g}"
    direction = ("down" if y > 0 else "up") if y else ("to the right" if x > 0 else "to the left")
    return f"Gravity {strength:.4g} {direction}"
