"""Line segments: the walls inside a container, which a scene, a file or a user adds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle.app.simulate.motors import keeping_walls, shifted
from jostle.app.simulate.settings import Polyline
from jostle.app.simulate.simulation import Point

Floats = NDArray[np.floating]
Ends = NDArray[np.float32]  # (m, 2, 2)


@dataclass
class WallSegments:
    """The walls of a world: first those of the scene and its file, then those drawn by the user.

    Attributes
    ----------
    own
        The number of those of the scene and of its file.
    """

    own: int

    @classmethod
    def of(cls, world: jostle.World) -> WallSegments:
        """Return the walls of a new world: all are its own."""
        return cls(len(world.walls))

    def add(self, world: jostle.World, line: Polyline, *, own: bool) -> None:
        """Add the sides of a polyline to a world; own walls must be added before drawn ones."""
        new = jostle.polyline(line.points, closed=line.closed)
        friction = np.nan if line.friction is None else line.friction
        restitution = np.append(world.wall_restitution, np.full(len(new), line.restitution))
        frictions = np.append(world.wall_friction, np.full(len(new), friction))
        rows = np.arange(len(world.walls), len(world.walls) + len(new))
        self._set(world, np.concatenate([world.walls, new]), restitution, frictions)
        if any(line.velocity) and len(new):
            motor = jostle.Motor(walls=rows, velocity=line.velocity, period=line.period)
            world.forces = (*world.forces, motor)
        if line.temperature is not None and len(new):
            world.forces = (*world.forces, jostle.ThermalWalls(line.temperature, walls=rows))
        self.own += len(new) if own else 0

    def remove(self, world: jostle.World, rows: ArrayLike) -> None:
        """Remove walls from a world; rows that do not exist are ignored."""
        ends = world.walls
        keep = np.ones(len(ends), np.bool_)
        wanted = np.asarray(rows, np.int64).reshape(-1)
        keep[wanted[(wanted >= 0) & (wanted < len(keep))]] = False
        own = int(np.count_nonzero(keep[: self.own]))
        restitution, friction = world.wall_restitution[keep], world.wall_friction[keep]
        velocities, forces = world.wall_velocities[keep], keeping_walls(world.forces, keep)
        world.forces = ()  # forces of walls do not let them be removed
        self._set(world, ends[keep], restitution, friction)
        world.wall_velocities, world.forces = velocities, forces
        self.own = own

    def set_friction(self, world: jostle.World, friction: float | None) -> None:
        """Set the friction of the drawn walls; that of the particles, if None."""
        frictions = world.wall_friction.copy()
        frictions[self.own :] = np.nan if friction is None else friction
        world.wall_friction = frictions

    def shift(self, world: jostle.World, by: Floats) -> None:
        """Move all walls of a world."""
        if by.any():
            world.forces = shifted(world.forces, by)
            if len(world.walls):
                world.walls = world.walls + by

    def _set(self, world: jostle.World, ends: Ends, restitution: Floats, friction: Floats) -> None:
        world.walls = ends  # this alone can be refused
        world.wall_restitution, world.wall_friction = restitution, friction


def nearest(ends: Floats, point: Point) -> tuple[int, float]:
    """Return the row of the nearest wall and its distance; -1 and inf if there is none."""
    if len(ends) == 0:
        return -1, np.inf
    gaps = _distances(np.array([point]), ends)
    row = int(np.argmin(gaps))
    return row, float(gaps[row])


def clear_of(positions: Floats, radii: Floats, ends: Floats) -> NDArray[np.bool_]:
    """Return which discs overlap no wall."""
    clear = np.ones(len(positions), np.bool_)
    if len(ends) and len(positions):
        boxes = np.concatenate([ends.min(axis=1), ends.max(axis=1)], axis=1)
        discs = jostle.Quadtree(positions.astype(np.float64), radii.astype(np.float64))
        near, wall = discs.pairs(jostle.Quadtree(boxes=boxes.astype(np.float64))).T.astype(np.intp)
        overlap = _distances(positions[near], ends[wall]) < radii[near]
        clear[near[overlap]] = False
    return clear


def _distances(points: Floats, ends: Floats) -> Floats:
    """Return the distance of each point from the wall of the same row."""
    start, along = ends[:, 0].astype(np.float64), np.diff(ends.astype(np.float64), axis=1)[:, 0]
    offset = points - start
    share = (offset * along).sum(axis=1) / (along * along).sum(axis=1)
    away = offset - np.clip(share, 0.0, 1.0)[:, None] * along
    distances: Floats = np.sqrt((away * away).sum(axis=1))
    return distances
