"""What must hold of a saved state whatever wrote it: a checksum only says that nothing was lost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jostle.app.simulate.rules import Rule, check, real, whole
from jostle.app.simulate.simulation import Pull, Rect, Tags

MOST = 2**62  # tags, and steps: more than there will ever be


def checked(name: str, value: Any, rule: Rule) -> Any:
    """Return a value that its rule allows; a ValueError says why not."""
    refusal = check(name, value, rule)
    if refusal:
        raise ValueError(refusal)
    return value


def count_of(name: str, value: Any, most: int = MOST) -> int:
    """Return a whole number from 0 to another."""
    return int(checked(name, value, whole(0, most)))


def rect_of(name: str, value: Sequence[Any]) -> Rect:
    """Return the corners of a rectangle."""
    x0, y0, x1, y1 = (float(checked(name, side, real())) for side in value)
    if x0 > x1 or y0 > y1:
        raise ValueError(f"{name} has its corners the wrong way round")
    return x0, y0, x1, y1


def pulls_of(values: Sequence[Any]) -> tuple[Pull, ...]:
    """Return attractions from their fields."""
    pulls = tuple(map(Pull.of, values))
    for pull in pulls:
        checked("an attraction", pull.strength, real())
        for side in pull.point or ():
            checked("the place of an attraction", side, real())
        if pull.tag is not None:
            count_of("what attracts", pull.tag)
    return pulls


def particles_of(
    columns: dict[str, NDArray[Any]], n: int, next_tag: int
) -> tuple[Tags, NDArray[np.float64]]:
    """Return the tags and the times of birth of so many particles."""
    tags, born = columns["tags"], columns["born"]
    of_a_kind = tags.dtype == np.int64 and born.dtype == np.float64
    if not of_a_kind or tags.shape != (n,) or born.shape != (n,):
        raise ValueError(f"it has not one tag and one time for each of {n:,} particles")
    if n and ((np.diff(tags) <= 0).any() or tags[0] < 0 or tags[-1] >= next_tag):
        raise ValueError("its tags are not in the order of adding")
    if not np.isfinite(born).all():
        raise ValueError("its times are no numbers")
    return tags, born
