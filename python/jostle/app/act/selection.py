"""Which particles are chosen, remembered by their tags."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from jostle.app.simulate.simulation import Frame, Tags

NOBODY: Tags = np.empty(0, np.int64)


class Selection:
    """A set of tags; what is no longer in the world falls out of it.

    Attributes
    ----------
    tags
        (k,) ascending.
    """

    def __init__(self) -> None:
        self.tags: Tags = NOBODY
        self._seen: Tags = NOBODY  # the tags of the frame that was looked at last

    def __len__(self) -> int:
        return len(self.tags)

    def __contains__(self, tag: int) -> bool:
        return bool(np.isin(tag, self.tags))

    def take(self, tags: ArrayLike, *, add: bool = False) -> None:
        """Choose these, or these too."""
        chosen = np.unique(np.asarray(tags, np.int64))
        self.tags = np.union1d(self.tags, chosen) if add else chosen

    def toggle(self, tag: int) -> None:
        """Choose one more, or let go of it."""
        one = np.array([tag], np.int64)
        self.tags = np.setxor1d(self.tags, one)

    def clear(self) -> None:
        """Choose nothing."""
        self.tags = NOBODY

    def around(self, tag: int) -> Tags:
        """Return the selection where the particle is part of it, else the particle alone."""
        return self.tags if tag in self else np.array([tag], np.int64)

    def follow(self, frame: Frame) -> None:
        """Let go of what is gone; costs nothing while the frame's tags are the same array."""
        if frame.tags is not self._seen and len(self.tags):
            self.tags = frame.tags[frame.rows(self.tags)]
        self._seen = frame.tags
