"""Motors of a world whose walls are removed or moved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import jostle

Forces = tuple[Any, ...]

ARGUMENTS = ("ids", "walls", "center", "angular_velocity", "velocity", "period")  # of a motor


def keeping_walls(forces: Forces, keep: NDArray[np.bool_]) -> Forces:
    """Return forces whose motors drive only the walls that are kept, by their new indices."""
    index = np.cumsum(keep) - 1
    return _changed(forces, lambda motor: {"walls": index[motor.walls[keep[motor.walls]]]})


def shifted(forces: Forces, by: NDArray[np.floating]) -> Forces:
    """Return forces whose motors have shifted centres."""
    return _changed(forces, lambda motor: {"center": np.array(motor.center) + by})


def _changed(forces: Forces, changes: Callable[[jostle.Motor], dict[str, Any]]) -> Forces:
    """Return forces whose motors have other arguments."""
    return tuple(
        jostle.Motor(**{name: getattr(force, name) for name in ARGUMENTS} | changes(force))
        if isinstance(force, jostle.Motor)
        else force
        for force in forces
    )
