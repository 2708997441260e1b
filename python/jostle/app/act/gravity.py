"""Changes of the direction and strength of gravity while the scene runs."""

from __future__ import annotations

import math
from collections.abc import Callable

from jostle.app.simulate.engine import Engine
from jostle.app.simulate.simulation import Point, Simulation

FALL_TIME = 1.5  # seconds: gravity that is switched on brings a ball down the view in this time


class Gravity:
    """What a person does to gravity; rules that do not allow it answer with a sentence."""

    def __init__(self, engine: Engine, say: Callable[[str | None], None]) -> None:
        self._engine = engine
        self._say = say

    @property
    def value(self) -> Point:
        """Return gravity as it is now, world units a second squared, y down."""
        return self._engine.rules.gravity or (0.0, 0.0)

    def set(self, value: Point) -> None:
        """Set both components."""
        self._change(lambda old: value)

    def set_downwards(self, strength: float) -> None:
        """Set gravity to point down, or up where it is negative."""
        self.set((0.0, strength))

    def scale(self, factor: float) -> None:
        """Multiply it; from nothing, more of it is a gentle fall."""

        def scaled(old: Point) -> Point:
            if old == (0.0, 0.0) and factor > 1:
                return 0.0, self._gentle()
            return old[0] * factor, old[1] * factor

        self._change(scaled)

    def invert(self) -> None:
        """Let everything fall the other way."""
        self._change(lambda old: (-old[0], -old[1]))

    def zero(self) -> None:
        """Switch it off."""
        self.set((0.0, 0.0))

    def turn(self) -> None:
        """Turn it a quarter: down, left, up, right."""

        def turned(old: Point) -> Point:
            return (0.0, self._gentle()) if old == (0.0, 0.0) else (-old[1], old[0])

        self._change(turned)

    def _gentle(self) -> float:
        _, min_y, _, max_y = self._engine.view
        return 2 * (max_y - min_y) / FALL_TIME**2

    def _change(self, new: Callable[[Point], Point]) -> None:
        def work(simulation: Simulation) -> None:
            value = new(simulation.rules.gravity or (0.0, 0.0))
            value = value[0] + 0.0, value[1] + 0.0  # no minus in front of a zero
            self._say(simulation.adjust("gravity", value) or in_words(value))

        self._engine.edit(work)


def in_words(gravity: Point) -> str:
    """Return gravity as people read it."""
    x, y = gravity
    strength = math.hypot(x, y)
    if strength == 0:
        return "No gravity"
    if x and y:
        return f"Gravity {x:.4g} to the right, {y:.4g} down"
    way = ("down" if y > 0 else "up") if y else ("to the right" if x > 0 else "to the left")
    return f"Gravity {strength:.4g} {way}"
