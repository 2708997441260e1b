"""Line segments: the walls inside a container, which a scene, a file or a user adds."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

import jostle
from jostle_lab.simulate.forces import keeping_walls, shifted
from jostle_lab.simulate.frame import Point
from jostle_lab.simulate.settings import Polyline

Floats = NDArray[np.floating]
Ends = NDArray[np.float32]  # (m, 2, 2)


class WallSegments:
    """The walls of a world: first its `own`, of the scene and its file, then drawn ones."""

    def __init__(self, world: jostle.World, own: int) -> None:
        self._world, self.own = world, own

    def add(self, line: Polyline, *, own: bool) -> None:
        """Add the sides of a polyline; own walls must be added before drawn ones."""
        world = self._world
        new = jostle.polyline(np.asarray(line.points, np.float32), closed=line.closed)
        friction = np.nan if line.friction is None else line.friction
        restitution = np.append(world.wall_restitution, np.full(len(new), line.restitution))
        frictions = np.append(world.wall_friction, np.full(len(new), friction))
        rows = np.arange(len(world.walls), len(world.walls) + len(new))
        self._set(np.concatenate([world.walls, new]), restitution, frictions)
        if any(line.velocity) and len(new):
            motor = jostle.Motor(walls=rows, velocity=line.velocity, period=line.period)
            world.forces = (*world.forces, motor)
        if line.temperature is not None and len(new):
            world.forces = (*world.forces, jostle.ThermalWalls(line.temperature, walls=rows))
        self.own += len(new) if own else 0

    def remove(self, rows: ArrayLike) -> None:
        """Remove walls; rows that do not exist are ignored."""
        world, ends = self._world, self._world.walls
        keep = np.ones(len(ends), np.bool_)
        wanted = np.asarray(rows, np.int64).reshape(-1)
        keep[wanted[(wanted >= 0) & (wanted < len(keep))]] = False
        own = int(np.count_nonzero(keep[: self.own]))
        restitution, friction = world.wall_restitution[keep], world.wall_friction[keep]
        velocities, forces = world.wall_velocities[keep], keeping_walls(world.forces, keep)
        world.forces = ()  # forces of walls do not let them be removed
        self._set(ends[keep], restitution, friction)
        world.wall_velocities, world.forces = velocities, forces
        self.own = own

    def set_friction(self, friction: float | None) -> None:
        """Set the friction of the drawn walls; that of the particles, if None."""
        frictions = self._world.wall_friction.copy()
        frictions[self.own :] = np.nan if friction is None else friction
        self._world.wall_friction = frictions

    def shift(self, by: Floats) -> None:
        if by.any():
            self._world.forces = shifted(self._world.forces, by)
            if len(self._world.walls):
                self._world.walls = self._world.walls + by

    def _set(self, ends: Ends, restitution: Floats, friction: Floats) -> None:
        self._world.walls = ends  # this alone can be refused
        self._world.wall_restitution, self._world.wall_friction = restitution, friction


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
