"""Forces of walls, in a world whose walls are removed or moved."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle

Forces = tuple[Any, ...]


def keeping_walls(forces: Forces, keep: NDArray[np.bool_]) -> Forces:
    """Return forces that name only the walls that are kept, by their new indices.

    Thermal walls of which none is left are left out.
    """
    index = np.cumsum(keep) - 1

    def kept(walls: ArrayLike) -> NDArray[np.intp]:
        rows = np.asarray(walls, np.intp)
        return index[rows[keep[rows]]]

    new: list[Any] = []
    for force in forces:
        if isinstance(force, jostle.Motor):
            new.append(_like(force, walls=kept(force.walls)))
        elif not isinstance(force, jostle.ThermalWalls):
            new.append(force)
        elif len(walls := kept(force.walls)) or force.sides:
            hot = jostle.ThermalWalls(force.temperature, force.sides, force.seed, walls=walls)
            new.append(hot)
    return tuple(new)


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
