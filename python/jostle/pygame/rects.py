"""Overlaps of many rects with many rects or objects that have one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from jostle._core import sprite_dict
from jostle.pygame.candidates import pairs_of_rects


def collide_rect_objects(
    rects: Iterable[Any],
    objects: Iterable[Any],
    *,
    key: Callable[[Any], Any] | None = None,
) -> list[list[Any]]:
    """Find for each of many rects the objects whose rects it overlaps.

    Parameters
    ----------
    rects : iterable of pygame.Rect or pygame.FRect
        The rects to test.
    objects : iterable
        Rects, or objects with an attribute `rect`.
    key : callable, optional
        Returns the rect of an object; it is called once for each.

    Returns
    -------
    list of list
        For each rect the result of ``rect.collideobjectsall(objects, key=key)``.

    See Also
    --------
    collide_rect_lists : Indices instead of objects.

    Examples
    --------
    >>> from pygame import Rect
    >>> from jostle.pygame import collide_rect_objects
    >>> rooms = {"hall": Rect(0, 0, 50, 20), "cellar": Rect(0, 20, 50, 20)}
    >>> collide_rect_objects([Rect(4, 15, 2, 9), Rect(60, 0, 5, 5)], rooms, key=rooms.get)
    [['hall', 'cellar'], []]
    """
    things = list(objects)
    taken = things if key is None else [key(thing) for thing in things]
    return collide_each(list(rects), things, taken)


def collide_rect_lists(rects: Iterable[Any], others: Iterable[Any]) -> list[list[int]]:
    """Find for each of many rects the indices of the others that it overlaps.

    Parameters
    ----------
    rects : iterable of pygame.Rect or pygame.FRect
        The rects to test.
    others : iterable
        Rects, or objects with an attribute `rect`.

    Returns
    -------
    list of list of int
        For each rect the result of ``rect.collidelistall(others)``: indices, ascending.

    See Also
    --------
    collide_rect_objects : Objects instead of indices.

    Examples
    --------
    >>> from pygame import Rect
    >>> from jostle.pygame import collide_rect_lists
    >>> others = [Rect(3, 3, 9, 9), Rect(4, 4, 1, 1)]
    >>> collide_rect_lists([Rect(0, 0, 5, 5), Rect(9, 9, 1, 1)], others)
    [[0, 1], [0]]
    """
    taken = list(others)
    return collide_rect_objects(rects, range(len(taken)), key=taken.__getitem__)


def collide_each(asked: list[Any], things: list[Any], taken: list[Any]) -> list[list[Any]]:
    """Find for each rect the things whose rect, in `taken`, it overlaps."""
    pairs = pairs_of_rects(asked, taken)
    if pairs is None:
        each = [rect.collidelistall(taken) for rect in asked]
        return [[things[row] for row in hits] for hits in each]
    rows = list(range(len(asked)))
    found = sprite_dict(pairs, rows, things)
    return [found.get(row, []) for row in rows]
