"""The colour of each particle.

The automatic choice is the kind if forces depend on it, else the density if it varies, as in the
article, else the radius if it varies, else the speed.
"""

import math

import numpy as np
from numpy.typing import NDArray

from jostle_lab.draw.palette import DISCS, FIRST_KIND, FIXED_SHADE, KINDS, SHADES
from jostle_lab.draw.text import Legend
from jostle_lab.draw.view_options import ColourBy
from jostle_lab.simulate.frame import Frame

FAST = 2.5  # times the root mean square speed: the speed of the last colour
ENERGETIC = 4.0  # times the mean energy: the energy of the last colour
DECAY = 0.995  # per frame, of the upper end of the ramp
VARIES = 1.05  # largest over smallest, above which a column varies
DECADES = 30.0  # largest over smallest, above which a ramp is logarithmic
YOUNG = 1.0  # seconds: the least span of the ramp of ages

COLUMNS = {"density": "densities", "radius": "radii", "mass": "masses"}  # of a frame

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
Shades = NDArray[np.uint8]
Values = NDArray[np.floating]


class Colouring:
    """Shades for one scene; make a new one when the scene starts again."""

    def __init__(self) -> None:
        self.shows = "speed"  # name of the quantity
        # The values at both ends of the ramp; None for random colours and kinds.
        self.range: tuple[float, float] | None = None
        self._reference = 0.0
        # Frames share the columns that only edits change. An edit renews all of them, also this.
        self._movable: NDArray[np.bool_] | None = None
        self._automatic = "speed"  # the automatic choice for these columns
        self._kept: Shades | None = None  # the shades by one of them

    def shades(self, frame: Frame, by: ColourBy = ColourBy.AUTO) -> Shades:
        """Return a shade, an index into DISCS, for each particle."""
        if frame.movable is not self._movable:
            self._movable, self._automatic, self._kept = frame.movable, _choice(frame), None
        shows = self._automatic if by is ColourBy.AUTO else by.label
        if shows != self.shows:
            self.shows, self._reference, self._kept = shows, 0.0, None
        if shows in COLUMNS:
            shades = self._by_column(frame)
        elif shows in ("kind", "random"):
            self.range = None
            kinds = np.zeros(len(frame), np.uint8) if frame.kinds is None else frame.kinds
            of_kinds = (FIRST_KIND + kinds % len(KINDS)).astype(np.uint8)
            shades = of_kinds if shows == "kind" else _buckets(hashed(frame.tags))
        else:
            shades = self._by_motion(frame)
        return np.where(frame.movable, shades, np.uint8(FIXED_SHADE))

    @property
    def legend(self) -> Legend | None:
        """Return the legend of the colours; None for random colours and kinds."""
        if self.range is None:
            return None
        low, high = (f"{value:,.3g}" if abs(value) < 1e4 else f"{value:,.0f}"
                     for value in self.range)  # fmt: skip
        unit = {"speed": "units/s", "age": "s"}.get(self.shows)
        name = f"{self.shows} ({unit})" if unit else self.shows
        return Legend(name, low, high, tuple(DISCS[:SHADES]))

    def _by_column(self, frame: Frame) -> Shades:
        """Shade by a column that only edits change."""
        if self._kept is None:
            values = getattr(frame, COLUMNS[self.shows])
            self._kept = _buckets(self._unit(values, frame.movable))
        return self._kept

    def _unit(self, values: Values, movable: NDArray[np.bool_]) -> Values:
        """Scale to 0..1, logarithmically if the values span decades."""
        self.range = _extremes(values[movable]) or _extremes(values)
        if self.range is None:
            return values
        low, high = self.range
        if high <= low:
            return np.full(len(values), 0.5)
        if low > 0 and high > DECADES * low:
            scaled: Values = np.log(np.maximum(values, low) / low) / np.log(high / low)
            return scaled
        return (values - low) / (high - low)

    def _by_motion(self, frame: Frame) -> Shades:
        """Shade by speed, energy or age; the upper end of the ramp changes slowly."""
        if self.shows == "age":
            ages = np.maximum(frame.stats.time - frame.born, 0.0)
            oldest = max(float(ages[frame.movable].max(initial=0.0)), YOUNG)
            self.range = oldest, 0.0  # young particles are bright
            return _buckets(1 - ages / oldest)
        x, y = frame.velocities[:, 0], frame.velocities[:, 1]
        squares = x * x + y * y
        if self.shows == "speed":
            values = np.sqrt(squares)
            top = math.sqrt(_mean(squares)) * FAST
        else:
            values = 0.5 * frame.masses * squares
            top = _mean(values) * ENERGETIC
        self._reference = max(top, self._reference * DECAY, 1e-9)
        self.range = 0.0, self._reference
        return _buckets(values / np.float32(self._reference))


def _choice(frame: Frame) -> str:
    """Return the name of the quantity that is shown automatically."""
    if frame.kinds is not None:
        return "kind"
    chosen = "speed"
    for name, values in (("radius", frame.radii), ("density", frame.densities)):
        if _spread(_extremes(values[frame.movable])) > VARIES:
            chosen = name
    return chosen


def _spread(extremes: tuple[float, float] | None) -> float:
    low, high = extremes or (1.0, 1.0)
    return high / low if low > 0 else (2 * VARIES if high > 0 else 1.0)


def _buckets(unit: Values) -> Shades:
    shades: Shades = np.clip(unit * SHADES, 0, SHADES - 1).astype(np.uint8)
    return shades


def _extremes(values: Values) -> tuple[float, float] | None:
    """Return the smallest and the largest value; None if there is none."""
    return (float(values.min()), float(values.max())) if len(values) else None


def _mean(values: Values) -> float:
    """Return the mean; 0 if there is no value."""
    return float(values.mean(dtype=np.float64)) if len(values) else 0.0


def hashed(tags: NDArray[np.integer]) -> NDArray[np.float64]:
    """Return a hash in 0..1 for each tag."""
    state = (tags.astype(np.uint64) + np.uint64(1)) * _GOLDEN
    state = (state ^ (state >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    return (state >> np.uint64(11)) / 2.0**53
