"""Trails: the positions of particles during the last second, fading.

They are stored in world coordinates, independent of the view, and by tag, independent of rows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import DISCS
from jostle.app.draw.subsampling import subset
from jostle.app.simulate.containers import crosses
from jostle.app.simulate.simulation import Frame

SECONDS = 1.0
POINTS = 20  # per path, evenly over that time
MOST = 150  # paths; their lines take about 4 ms
STRONGEST = 0.95  # alpha at the newest part of a trail


class Trails:
    """A ring buffer of past positions for a fixed choice of particles."""

    def __init__(self) -> None:
        self._forget()

    def clear(self) -> None:
        """Clear all paths at the next frame: another thread may be drawing now."""
        self._cleared = True

    def _forget(self) -> None:
        self._cleared = False
        self._tags = np.empty(0, np.int64)
        self._ring = np.full((POINTS, 0, 2), np.nan)
        self._times = np.full(POINTS, -np.inf)
        self._next = 0
        self._last = -np.inf

    def note(self, frame: Frame) -> None:
        """Record the positions of a frame, if enough time has passed since the last."""
        now = frame.stats.time
        if now < self._last or self._cleared:
            self._forget()  # after a restart or a rewind
        if now - self._last < SECONDS / POINTS * 0.999:
            return
        self._follow(frame)
        self._ring[self._next] = frame.positions[self._rows]
        self._times[self._next] = self._last = now
        self._next = (self._next + 1) % POINTS

    def draw(
        self, painter: Painter, frame: Frame, shades: NDArray[np.uint8], camera: Camera
    ) -> str | None:
        """Draw the paths up to the present positions, the oldest parts first."""
        self.note(frame)
        there = np.isin(self._tags, frame.tags)
        rows = frame.rows(self._tags)
        recent = np.roll(self._ring, -self._next, axis=0)[:, there]
        times = np.roll(self._times, -self._next)
        path = np.concatenate([recent, frame.positions[None, rows].astype(np.float64)])
        ends = np.concatenate([path[:-1], path[1:]], axis=2)
        age = np.clip((frame.stats.time - times) / SECONDS, 0.0, 1.0)
        share = STRONGEST * (1 - np.nan_to_num(age, nan=1.0, posinf=1.0))
        steps, many = ends.shape[:2]
        flat = ends.reshape(-1, 4)
        gaps = np.isnan(flat).any(axis=1) | crosses(frame.container, flat[:, :2], flat[:, 2:])
        kept = np.flatnonzero(~gaps & np.repeat(share > 0.02, many))
        flat = flat[kept]
        colours = np.tile(np.array(DISCS, np.uint8)[shades[rows]], (steps, 1))
        alpha = np.rint(255 * np.repeat(share, many)).astype(np.uint8)
        lines = camera.lines_to_screen(flat[:, :2], flat[:, 2:])
        seen = camera.sees(lines)
        painter.lines(lines[seen], np.column_stack([colours, alpha])[kept][seen])
        movable = int(np.count_nonzero(frame.movable))
        return f"trails: {len(rows):,} of {movable:,} shown" if len(rows) < movable else None

    def _follow(self, frame: Frame) -> None:
        """Keep the paths of particles that exist, and begin those of new ones."""
        moving = np.flatnonzero(frame.movable)
        rows = moving[subset(frame.tags[moving], MOST)]
        tags = frame.tags[rows]
        if not np.array_equal(tags, self._tags):
            ring = np.full((POINTS, len(tags), 2), np.nan)
            _, new, old = np.intersect1d(tags, self._tags, return_indices=True)
            ring[:, new] = self._ring[:, old]
            self._tags, self._ring = tags, ring
        self._rows = rows
