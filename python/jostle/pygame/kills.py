"""`groupcollide`, with and without killing the sprites that collide."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

import pygame
from pygame.sprite import AbstractGroup, Sprite

from jostle._core import sprite_dict
from jostle.pygame.candidates import find_near
from jostle.sprites import Collided, Near

# They accept any collection of sprites, but their annotations only groups.
their_groupcollide: Callable[..., dict[Any, list[Any]]] = pygame.sprite.groupcollide
their_spritecollide: Callable[..., list[Any]] = pygame.sprite.spritecollide


def met(left: list[Any], groupb: Collection[Any], collided: Collided | None) -> dict[Any, Any]:
    """Do `groupcollide` without `dokillb`."""
    right = list(groupb)
    near = find_near(left, right, collided) if left and right else None
    if near is None:
        return their_groupcollide(left, right, False, False, collided)
    near.radii.store(left)
    near.radii.store(right)
    return sprite_dict(near.decided(left, right), left, right)


def met_and_killed(
    left: list[Any], groupb: Collection[Any], collided: Collided | None
) -> dict[Any, list[Any]]:
    """Do `groupcollide` with `dokillb`: one sprite of `left` after another."""
    found: dict[Any, list[Any]] = {}
    done = 0
    while done < len(left):
        right = list(groupb)
        near = find_near(left[done:], right, collided) if right else None
        if near is None:
            for sprite in left[done:]:
                if hits := their_spritecollide(sprite, groupb, True, collided):
                    found[sprite] = hits
            break
        near.radii.store(right)
        count = _kill_along(near, left[done:], right, groupb, found)
        near.radii.store(left[done : done + count])
        done += count
    return found


def _kill_along(
    near: Near,
    left: list[Any],
    right: list[Any],
    groupb: Collection[Any],
    found: dict[Any, list[Any]],
) -> int:
    """Kill the sprites that collide, and return how many of `left` were handled.

    Ends early if no sprite is left to collide with, and after a call of the user's code, which
    may have moved sprites.
    """
    alive = groupb.has_internal if isinstance(groupb, AbstractGroup) else None
    ask = near.collided
    remaining = len(right)
    for row, candidates in near.by_left():
        sprite = left[row]
        hits = [
            right[other]
            for _, other, sure in candidates
            if (alive is None or alive(right[other]))
            and (sure or (ask is not None and ask(sprite, right[other])))
        ]
        if not hits:
            continue
        found[sprite] = hits
        known = _is_pygames_iteration(groupb) and all(_is_pygames_kill(hit) for hit in hits)
        for hit in hits:
            hit.kill()
        remaining -= len(hits) if alive else 0
        if not known or remaining <= 0:
            return row + 1
    return len(left)


def _is_pygames_kill(sprite: Any) -> bool:
    """Return whether killing it runs only pygame's code."""
    own = getattr(sprite.kill, "__func__", None)
    return own is Sprite.kill and all(
        _is_pygames(group.remove_internal) for group in Sprite.groups(sprite)
    )


def _is_pygames_iteration(group: Collection[Any]) -> bool:
    """Return whether iteration over a group is pygame's own, or it is not a group."""
    return not isinstance(group, AbstractGroup) or (
        _is_pygames(group.__iter__) and _is_pygames(group.sprites)
    )


def _is_pygames(method: Any) -> bool:
    return getattr(method, "__module__", None) == "pygame.sprite"
