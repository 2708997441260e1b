"""Picking: the particle under the cursor, and those inside a box."""

from __future__ import annotations

import numpy as np

from jostle.app.simulate.simulation import Frame, Point, Rect, Tags


def pick(frame: Frame, point: Point, reach: float) -> int | None:
    """Return the tag of the particle under a point, or of the nearest within `reach` of it."""
    if len(frame) == 0:
        return None
    away = frame.positions.astype(np.float64) - np.array(point)
    gaps = np.hypot(away[:, 0], away[:, 1]) - frame.radii
    nearest = int(np.argmin(gaps))
    return int(frame.tags[nearest]) if gaps[nearest] <= reach else None


def pick_first(frame: Frame, point: Point) -> int | None:
    """Return the tag of the first particle in list order under a point: the article's rule."""
    away = frame.positions.astype(np.float64) - np.array(point)
    under = np.flatnonzero(np.hypot(away[:, 0], away[:, 1]) <= frame.radii)
    return int(frame.tags[under[0]]) if len(under) else None


def inside(frame: Frame, rect: Rect) -> Tags:
    """Return the tags of the particles whose centres lie in a box, in ascending order."""
    x, y = frame.positions[:, 0], frame.positions[:, 1]
    chosen = (x >= rect[0]) & (y >= rect[1]) & (x <= rect[2]) & (y <= rect[3])
    found: Tags = frame.tags[chosen]
    return found
