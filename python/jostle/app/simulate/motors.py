"""Motors of a world whose walls are removed or moved."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import jostle

Forces = tuple[Any, ...]


def keeping_walls(forces: Forces, keep: NDArray[np.bool_]) -> Forces:
    """Return forces whose motors drive only the walls that are kept, by their new indices."""
    index = np.cumsum(keep) - 1
    return tuple(
        _like(force, walls=index[force.walls[keep[force.walls]]])
        if isinstance(force, jostle.Motor)
        else force
        for force in forces
    )


def shifted(forces: Forces, by: NDArray[np.floating]) -> Forces:
    """Return forces whose motors have shifted centres."""
    return tuple(
        _like(force, center=np.array(force.center) + by)
        if isinstance(force, jostle.Motor)
        else force
        for force in forces
    )


def _like(motor: jostle.Motor, **changes: Any) -> jostle.Motor:
    arguments = {
        "ids": motor.ids,
        "walls": motor.walls,
        "center": motor.center,
        "angular_velocity": motor.angular_velocity,
        "velocity": motor.velocity,
        "period": motor.period,
        **changes,
    }
    return jostle.Motor(**arguments)
