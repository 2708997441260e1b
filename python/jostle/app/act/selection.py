"""The selected particles, by their tags."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from jostle.app.simulate.simulation import Frame, Tags

NO_TAGS: Tags = np.empty(0, np.int64)


class Selection:
    """A set of tags. Tags of particles that no longer exist are removed.

    Attributes
    ----------
    tags
        (k,) ascending.
    """

    def __init__(self) -> None:
        self.tags: Tags = NO_TAGS
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
        """Select or deselect a particle."""
        one = np.array([tag], np.int64)
        self.tags = np.setxor1d(self.tags, one)

    def clear(self) -> None:
        """Deselect all particles."""
        self.tags = NO_TAGS

    def around(self, tag: int) -> Tags:
        """Return the selection if it contains the particle, else the particle alone."""
        return self.tags if tag in self else np.array([tag], np.int64)

    def follow(self, frame: Frame) -> None:
        """Remove tags that do not exist; no work while the frame's tags are the same array."""
        if frame.tags is not self._seen and len(self.tags):
            self.tags = frame.tags[frame.rows(self.tags)]
        self._seen = frame.tags
