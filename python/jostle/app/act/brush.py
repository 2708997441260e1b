"""The brush: new particles along the path of the cursor."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from jostle.app.act.commands import Commands, usual
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.placement import random_in_disc
from jostle.app.simulate.simulation import Point

REACH = 6.0  # radii of a particle: the radius of the brush
SPACING = 2.0  # radii: between two positions of the brush at which it adds particles
DROPS = 2  # particles added at each position, if there is room


class Brush:
    """Adds particles at random positions within its radius, where they overlap no other."""

    def __init__(self, engine: Engine, commands: Commands) -> None:
        self._engine, self._commands = engine, commands
        self._rng = np.random.default_rng()
        self._at: Point = (0.0, 0.0)
        self._size = (-1, 0.0)  # number of particles, and the radius of a new one

    @property
    def radius(self) -> float:
        """Return the radius of the brush in units of the world."""
        return REACH * self._particle()

    def begin(self, point: Point) -> None:
        """Add particles around a point, where a stroke begins."""
        self._at = point
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
        offsets = self.radius * random_in_disc(self._rng, len(middles))
        self._commands.paint(middles + offsets)

    def _particle(self) -> float:
        """Return the radius of a new particle; a median, so it is kept while no number changes."""
        frame = self._engine.frame
        if self._size[0] != len(frame):
            self._size = len(frame), usual(frame)[0]
        return self._size[1]
