"""pygame's functions for collisions of sprites, with its answers in its order."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from itertools import combinations
from typing import Any

import pygame
from pygame.sprite import collide_rect

from jostle.pygame.candidates import find_near, rule_of
from jostle.pygame.kills import met, met_and_killed, their_groupcollide, their_spritecollide
from jostle.sprites import Collided, Prefilter, rows_of

their_spritecollideany: Callable[..., Any] = pygame.sprite.spritecollideany


def groupcollide(
    groupa: Iterable[Any],
    groupb: Iterable[Any],
    dokilla: bool,
    dokillb: bool,
    collided: Collided | None = None,
    *,
    broad_phase: bool = True,
) -> dict[Any, list[Any]]:
    """Find which sprites of one group collide with which of another.

    Parameters
    ----------
    groupa, groupb : pygame.sprite.Group, or another collection of sprites
        They may share sprites, or be the same group.
    dokilla, dokillb : bool
        Whether to kill the sprites of either group that collide.
    collided : callable, optional
        Tests a pair, as in pygame; if omitted, rects that overlap collide. pygame's own
        `collide_*` are computed without calling them, except `collide_mask`, which is
        called if two masks may overlap. A function of your own is called for every
        pair, as in pygame, and takes as long; `prefilter` makes it faster.
    broad_phase : bool, default True
        False calls pygame's own function.

    Returns
    -------
    dict of sprite to list of sprite
        The sprites of `groupa` that collide, each with the sprites that it collides with,
        both in the order of their groups.

    See Also
    --------
    prefilter : Limit the pairs for which a function of your own is called.
    selfcollide : The pairs within one group.

    Notes
    -----
    As in pygame, a sprite killed by `dokillb` does not collide with later sprites, and
    `collide_circle` stores a `radius` in sprites that have none. Each `rect` and `radius`
    is read once. With a `kill` of your own, the search starts again after each kill,
    because sprites may have moved.

    Examples
    --------
    >>> import pygame
    >>> from jostle.pygame import groupcollide
    >>> def sprite(x, y, size):
    ...     made = pygame.sprite.Sprite()
    ...     made.rect = pygame.Rect(x, y, size, size)
    ...     return made
    >>> rocks = pygame.sprite.Group(sprite(0, 0, 50), sprite(90, 0, 50))
    >>> shots = pygame.sprite.Group(sprite(20, 20, 2), sprite(70, 20, 2))
    >>> {rock.rect.x: len(hits) for rock, hits in groupcollide(rocks, shots, False, True).items()}
    {0: 1}
    >>> shots
    <Group(1 sprites)>
    """
    if not (broad_phase and isinstance(groupb, Collection) and rule_of(collided)):
        return their_groupcollide(groupa, groupb, dokilla, dokillb, collided)
    left = list(groupa)
    found = met_and_killed(left, groupb, collided) if dokillb else met(left, groupb, collided)
    if dokilla:
        for sprite in found:
            sprite.kill()
    return found


def spritecollide(
    sprite: Any,
    group: Iterable[Any],
    dokill: bool,
    collided: Collided | None = None,
    *,
    broad_phase: bool = True,
) -> list[Any]:
    """Find the sprites of a group that collide with a sprite.

    Parameters
    ----------
    sprite : pygame.sprite.Sprite
        It may be in the group itself.
    group : pygame.sprite.Group, or another collection of sprites
        The sprites to test.
    dokill : bool
        Whether to kill the sprites that collide.
    collided : callable, optional
        As for `groupcollide`.
    broad_phase : bool, default True
        False calls pygame's own function.

    Returns
    -------
    list of sprite
        In the order of the group.

    See Also
    --------
    groupcollide : All sprites of one group against those of another.

    Notes
    -----
    For rects, one sprite against a group is as fast in pygame, so pygame's own function is
    called. For many sprites use `groupcollide`.

    Examples
    --------
    >>> import pygame
    >>> from jostle.pygame import collide_circle, spritecollide
    >>> ship, mine = pygame.sprite.Sprite(), pygame.sprite.Sprite()
    >>> ship.rect, mine.rect = pygame.Rect(0, 0, 10, 10), pygame.Rect(12, 0, 10, 10)
    >>> spritecollide(ship, pygame.sprite.Group(mine), False)
    []
    >>> len(spritecollide(ship, pygame.sprite.Group(mine), False, collide_circle))
    1
    """
    if collided is None or not (broad_phase and rule_of(collided)):
        return their_spritecollide(sprite, group, dokill, collided)
    sprites = list(group)
    if collided is collide_rect and sprites:  # which pygame would call for each sprite
        return their_spritecollide(sprite, sprites, dokill)
    near = find_near([sprite], sprites, collided) if sprites else None
    if near is None:
        return their_spritecollide(sprite, sprites, dokill, collided)
    near.radii.store([sprite, *sprites])
    hits = [sprites[row] for row in near.decided([sprite], sprites)[:, 1].tolist()]
    if dokill:
        for hit in hits:
            hit.kill()
    return hits


def spritecollideany(
    sprite: Any,
    group: Iterable[Any],
    collided: Collided | None = None,
    *,
    broad_phase: bool = True,
) -> Any | None:
    """Find the first sprite of a group that collides with a sprite.

    Parameters
    ----------
    sprite : pygame.sprite.Sprite
        It may be in the group itself.
    group : pygame.sprite.Group, or another collection of sprites
        The sprites to test.
    collided : callable, optional
        As for `groupcollide`.
    broad_phase : bool, default True
        False calls pygame's own function.

    Returns
    -------
    sprite or None
        None if nothing collides.

    See Also
    --------
    spritecollide : All sprites that collide with one.

    Notes
    -----
    pygame's own function stops at the first hit and is the fastest, so it is called except
    for a `prefilter`.

    Examples
    --------
    >>> import pygame
    >>> from jostle.pygame import spritecollideany
    >>> ship, mine = pygame.sprite.Sprite(), pygame.sprite.Sprite()
    >>> ship.rect, mine.rect = pygame.Rect(0, 0, 10, 10), pygame.Rect(8, 0, 10, 10)
    >>> spritecollideany(ship, pygame.sprite.Group(mine)) is mine
    True
    """
    if not (broad_phase and isinstance(collided, Prefilter)):
        return their_spritecollideany(sprite, group, collided)
    sprites = list(group)
    near = find_near([sprite], sprites, collided) if sprites else None
    if near is None:
        return their_spritecollideany(sprite, sprites, collided)
    candidates = (sprites[row] for row in near.pairs[:, 1].tolist())
    return next((other for other in candidates if collided.collided(sprite, other)), None)


def selfcollide(
    group: Iterable[Any], collided: Collided | None = None, *, broad_phase: bool = True
) -> list[tuple[Any, Any]]:
    """Find the sprites of a group that collide with each other.

    Parameters
    ----------
    group : pygame.sprite.Group, or another collection of sprites
        The sprites to test.
    collided : callable, optional
        As for `groupcollide`; its first argument is the sprite that comes first in the
        group.
    broad_phase : bool, default True
        False calls `collided` for every pair.

    Returns
    -------
    list of tuple of two sprites
        Each pair once, in the order of the group.

    See Also
    --------
    groupcollide : Two groups.

    Examples
    --------
    >>> import pygame
    >>> from jostle.pygame import selfcollide
    >>> balls = pygame.sprite.Group()
    >>> for x in (0, 8, 30):
    ...     ball = pygame.sprite.Sprite(balls)
    ...     ball.rect = pygame.Rect(x, 0, 10, 10)
    >>> [(a.rect.x, b.rect.x) for a, b in selfcollide(balls)]
    [(0, 8)]
    """
    sprites = list(group)
    near = find_near(sprites, None, collided) if broad_phase and len(sprites) > 1 else None
    if near is None:
        meet = collide_rect if collided is None else collided
        return [(a, b) for a, b in combinations(sprites, 2) if meet(a, b)]
    near.radii.store(sprites)
    pairs = near.decided(sprites, sprites)
    return [(sprites[i], sprites[j]) for i, j in rows_of(pairs)]


def prefilter(collided: Collided, reach: float = 0.0) -> Prefilter:
    """Call a function of your own only for sprites whose rects are near.

    Parameters
    ----------
    collided : callable
        Takes two sprites and returns whether they collide. It must not move, add or remove
        sprites.
    reach : float, default 0.0
        Largest gap between two rects, along x and along y, at which `collided` may
        return true, in units of length, at least 0.

    Returns
    -------
    Prefilter
        A callable for the argument `collided` of the functions of this module and of
        `pygame.sprite`. A pair is passed to your function if its rects overlap as in
        `Rect.colliderect`, or if the gap is at most `reach` on both axes. A gap of
        exactly `reach` is included; rects that only touch have a gap of 0. All other pairs
        do not collide.

    Raises
    ------
    TypeError
        If `collided` is not callable, or `reach` is not a number.
    ValueError
        If `reach` is negative or not finite.

    See Also
    --------
    groupcollide : Takes the result as `collided`.

    Notes
    -----
    The gap along x is the distance from the `right` of one rect to the `left` of the other;
    this includes rects without area. Without `prefilter` a function is called for every
    pair, which takes as long as in pygame.

    Examples
    --------
    >>> import pygame
    >>> from jostle.pygame import groupcollide, prefilter
    >>> def sprite(x):
    ...     made = pygame.sprite.Sprite()
    ...     made.rect = pygame.Rect(x, 0, 10, 10)
    ...     return made
    >>> def hears(guard, thief):
    ...     return guard.rect.inflate(80, 80).colliderect(thief.rect)
    >>> guards, thieves = [sprite(0), sprite(500)], [sprite(35), sprite(300)]
    >>> found = groupcollide(guards, thieves, False, False, prefilter(hears, reach=40))
    >>> [(guard.rect.x, [thief.rect.x for thief in near]) for guard, near in found.items()]
    [(0, [35])]
    """
    return Prefilter(collided, reach)
