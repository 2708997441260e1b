"""Forces of walls, in a world whose walls are removed or moved."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle

Forces = tuple[Any, ...]

ARGUMENTS = ("ids", "walls", "center", "angular_velocity", "velocity", "period")  # of a motor


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
            new.append(_with(force, walls=kept(force.walls)))
        elif not isinstance(force, jostle.ThermalWalls):
            new.append(force)
        elif len(walls := kept(force.walls)) or force.sides:
            hot = jostle.ThermalWalls(force.temperature, force.sides, force.seed, walls=walls)
            new.append(hot)
    return tuple(new)


def shifted(forces: Forces, by: NDArray[np.floating]) -> Forces:
    """Return forces whose motors have shifted centres."""
    return tuple(
        _with(force, center=np.array(force.center) + by)
        if isinstance(force, jostle.Motor)
        else force
        for force in forces
    )


def _with(motor: jostle.Motor, **changes: Any) -> jostle.Motor:
    """Return a motor with some other arguments."""
    return jostle.Motor(**{name: getattr(motor, name) for name in ARGUMENTS} | changes)
