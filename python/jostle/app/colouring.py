"""Which particle gets which colour of the ramp.

A scene is coloured by what tells its particles apart: density as in the article where it varies,
else radius, else speed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle.app.palette import FIXED_SHADE, SHADES
from jostle.app.simulation import Frame

FAST = 2.5  # the speed that gets the last colour, in root mean squares
FORGET = 0.995  # a frame: how slowly the ramp follows a world that comes to rest
VARIES = 1.05  # largest over smallest, above which a column is worth showing

Shades = NDArray[np.uint8]


class Colouring:
    """Shades for one scene; make a new one when the scene starts again."""

    def __init__(self) -> None:
        self._fixed_shades: Shades | None = None
        self._reference = 0.0
        self.shows = "speed"

    def shades(self, frame: Frame) -> Shades:
        """Return a shade in 0..SHADES for each particle."""
        if self._fixed_shades is None or len(self._fixed_shades) != len(frame.radii):
            self._fixed_shades = self._by_kind(frame)
        if self.shows != "speed":
            return self._fixed_shades
        return _with_fixed(self._by_speed(frame), frame)

    def _by_kind(self, frame: Frame) -> Shades:
        """Shade by density or radius; settle what this scene shows."""
        for name, values in (("density", frame.densities), ("radius", frame.radii)):
            if _spread(values[frame.movable]) > VARIES:
                self.shows = name
                return _with_fixed(_buckets(_unit(values)), frame)
        self.shows = "speed"
        return np.zeros(len(frame.radii), np.uint8)

    def _by_speed(self, frame: Frame) -> Shades:
        speeds = np.hypot(frame.velocities[:, 0], frame.velocities[:, 1])
        rms = float(np.sqrt(np.mean(speeds * speeds))) if len(speeds) else 0.0
        self._reference = max(rms * FAST, self._reference * FORGET, 1e-9)
        return _buckets(speeds / self._reference)


def _spread(values: NDArray[np.float32]) -> float:
    if len(values) == 0:
        return 1.0
    low, high = float(values.min()), float(values.max())
    return high / low if low > 0 else (2 * VARIES if high > 0 else 1.0)


def _unit(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the values stretched over 0..1, on a logarithmic scale where they span decades."""
    if values.min() > 0 and values.max() > 30 * values.min():
        values = np.log(values)
    low, high = float(values.min()), float(values.max())
    unit: NDArray[np.float32] = (values - low) / (high - low)
    return unit


def _buckets(unit: NDArray[np.floating]) -> Shades:
    shades: Shades = np.clip(unit * SHADES, 0, SHADES - 1).astype(np.uint8)
    return shades


def _with_fixed(shades: Shades, frame: Frame) -> Shades:
    return np.where(frame.movable, shades, np.uint8(FIXED_SHADE))
