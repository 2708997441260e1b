"""The particles under the cursor or in a box, and the selected ones, by their tags."""

import numpy as np
from numpy.typing import ArrayLike

from jostle_lab.simulate.frame import Frame, Point, Rect, Tags

NO_TAGS: Tags = np.empty(0, np.int64)


def pick(frame: Frame, point: Point, reach: float) -> int | None:
    """Return the tag of the particle under a point, or of the nearest within `reach` of it."""
    if len(frame) == 0:
        return None
    away = frame.positions.astype(np.float64) - np.array(point)
    gaps = np.hypot(away[:, 0], away[:, 1]) - frame.radii
    nearest = int(np.argmin(gaps))
    return int(frame.tags[nearest]) if gaps[nearest] <= reach else None


def inside(frame: Frame, rect: Rect) -> Tags:
    """Return the tags of the particles whose centres lie in a box, in ascending order."""
    x, y = frame.positions[:, 0], frame.positions[:, 1]
    chosen = (x >= rect[0]) & (y >= rect[1]) & (x <= rect[2]) & (y <= rect[3])
    return frame.tags[chosen]


class Selection:
    """A set of tags. Tags of particles that no longer exist are removed."""

    def __init__(self) -> None:
        self.tags: Tags = NO_TAGS  # (k,) ascending
        self._seen: Tags = NO_TAGS  # the tags of the last frame

    def __len__(self) -> int:
        return len(self.tags)

    def __contains__(self, tag: int) -> bool:
        return bool(np.isin(tag, self.tags))

    def take(self, tags: ArrayLike, *, add: bool = False) -> None:
        """Select particles, in place of or in addition to the present selection."""
        chosen = np.unique(np.asarray(tags, np.int64))
        self.tags = np.union1d(self.tags, chosen) if add else chosen

    def toggle(self, tag: int) -> None:
        self.tags = np.setxor1d(self.tags, np.array([tag], np.int64))

    def clear(self) -> None:
        self.tags = NO_TAGS

    def around(self, tag: int | None) -> Tags:
        """Return the selection if it contains the particle, else the particle alone, if any."""
        if tag is None:
            return NO_TAGS
        return self.tags if tag in self else np.array([tag], np.int64)

    def follow(self, frame: Frame) -> None:
        """Remove tags that do not exist; no work while the frame's tags are the same array."""
        if frame.tags is not self._seen and len(self.tags):
            self.tags = frame.tags[frame.rows(self.tags)]
        self._seen = frame.tags
