"""pygame's sprite collisions for thousands of sprites: change one import.

`groupcollide`, `spritecollide`, `spritecollideany`
    As in `pygame.sprite`, on the same groups, with the same answers in the same order.
`selfcollide`
    The pairs within one group, each once.
`collide_rect_objects`, `collide_rect_lists`
    `Rect.collideobjectsall` and `Rect.collidelistall` for many rects at once.
`Group`
    A `pygame.sprite.Group` that answers questions about places.
`collide_rect`, `collide_rect_ratio`, `collide_circle`, `collide_circle_ratio`, `collide_mask`
    pygame's own, for `collided`.

There is no index to keep: each call reads the rects as they are. Needs pygame-ce.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable
from itertools import combinations
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

import numpy as np
import pygame
from numpy.typing import NDArray
from pygame.sprite import (
    AbstractGroup,
    Sprite,
    collide_circle,
    collide_circle_ratio,
    collide_mask,
    collide_rect,
    collide_rect_ratio,
)

from jostle._core import Quadtree, sprite_dict, sprite_pairs, sprite_sides
from jostle.sprites import Collided, Near, Radii

if not hasattr(pygame, "FRect"):
    raise ImportError("jostle.pygame needs pygame-ce; what is installed here is pygame")

__all__ = [
    "Group",
    "collide_circle",
    "collide_circle_ratio",
    "collide_mask",
    "collide_rect",
    "collide_rect_lists",
    "collide_rect_objects",
    "collide_rect_ratio",
    "groupcollide",
    "selfcollide",
    "spritecollide",
    "spritecollideany",
]

Rule: TypeAlias = Literal["rect", "circle", "mask"]

if TYPE_CHECKING:  # a group of pygame says what it holds to type checkers alone
    _AnyGroup = pygame.sprite.Group[Any]
else:
    _AnyGroup = pygame.sprite.Group

_TYPES = (pygame.Rect, pygame.FRect)
# They take any collection of sprites; their annotations speak of groups alone.
_their_groupcollide: Callable[..., dict[Any, list[Any]]] = pygame.sprite.groupcollide
_their_spritecollide: Callable[..., list[Any]] = pygame.sprite.spritecollide
_their_spritecollideany: Callable[..., Any] = pygame.sprite.spritecollideany
_LARGEST_RATIO = 1e6


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
        They may share sprites, or be the same.
    dokilla, dokillb : bool
        Whether to kill the sprites of either group that collide.
    collided : callable, optional
        What colliding means, as in pygame; the rects overlap if left out. pygame's own
        `collide_*` are answered without calling them, where that gives the same answer.
        `collide_mask` is called where two masks may meet. **A function of your own is
        called only for sprites whose rects overlap.**
    broad_phase : bool, default True
        False leaves all to pygame: `collided` is called for every pair.

    Returns
    -------
    dict of sprite to list of sprite
        The sprites of `groupa` that collide and what they collide with, both in the
        order of their groups.

    Notes
    -----
    As in pygame, what `dokillb` has killed collides with nothing after it, and
    `collide_circle` stores a `radius` in sprites that have none. Each `rect` and `radius`
    is read once. With a `kill` of your own, the search begins anew after each kill,
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
    left = list(groupa)
    if not (broad_phase and isinstance(groupb, Collection) and _can_be_asked(collided)):
        return _their_groupcollide(left, groupb, dokilla, dokillb, collided)
    found = _met_and_killed(left, groupb, collided) if dokillb else _met(left, groupb, collided)
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
        Where to look.
    dokill : bool
        Whether to kill what collides.
    collided : callable, optional
        As for `groupcollide`.
    broad_phase : bool, default True
        False leaves all to pygame.

    Returns
    -------
    list of sprite
        In the order of the group.

    Notes
    -----
    One sprite against a group is as quick in pygame where rects are compared, so pygame
    does that itself. Ask for many at once with `groupcollide`.

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
    sprites = list(group)
    if collided is None or not (broad_phase and sprites and _can_be_asked(collided)):
        return _their_spritecollide(sprite, sprites, dokill, collided)
    if collided is collide_rect:  # by which pygame would take thrice as long
        return _their_spritecollide(sprite, sprites, dokill)
    near = _near([sprite], sprites, collided)
    if near is None:
        return _their_spritecollide(sprite, sprites, dokill, collided)
    near.radii.store([sprite, *sprites])
    hits = [sprites[row] for row in near.decided([sprite], sprites, collided)[:, 1].tolist()]
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
        Where to look.
    collided : callable, optional
        As for `groupcollide`.
    broad_phase : bool, default True
        False leaves all to pygame.

    Returns
    -------
    sprite or None
        None if nothing collides.

    Notes
    -----
    pygame, which stops at the first, is the quickest here: all that is added is that a
    function of your own is called only where rects overlap.

    Examples
    --------
    >>> import pygame
    >>> from jostle.pygame import spritecollideany
    >>> ship, mine = pygame.sprite.Sprite(), pygame.sprite.Sprite()
    >>> ship.rect, mine.rect = pygame.Rect(0, 0, 10, 10), pygame.Rect(8, 0, 10, 10)
    >>> spritecollideany(ship, pygame.sprite.Group(mine)) is mine
    True
    """
    sprites = list(group)
    near = None
    if broad_phase and collided is not None and sprites and _is_of_ones_own(collided):
        near = _near([sprite], sprites, collided)
    if near is not None and collided is not None:
        candidates = (sprites[row] for row in near.pairs[:, 1].tolist())
        return next((other for other in candidates if collided(sprite, other)), None)
    return _their_spritecollideany(sprite, sprites, collided)


def selfcollide(
    group: Iterable[Any], collided: Collided | None = None, *, broad_phase: bool = True
) -> list[tuple[Any, Any]]:
    """Find the sprites of a group that collide with each other.

    Parameters
    ----------
    group : pygame.sprite.Group, or another collection of sprites
        Where to look.
    collided : callable, optional
        As for `groupcollide`; its first argument is the sprite that comes first in the
        group.
    broad_phase : bool, default True
        False calls `collided` for every pair.

    Returns
    -------
    list of tuple of two sprites
        Each pair once, in the order of the group.

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
    near = None
    if broad_phase and len(sprites) > 1 and _can_be_asked(collided):
        near = _near(sprites, None, collided)
    if near is None:
        meet = collide_rect if collided is None else collided
        return [(a, b) for a, b in combinations(sprites, 2) if meet(a, b)]
    near.radii.store(sprites)
    pairs = near.decided(sprites, sprites, collided)
    return [(sprites[i], sprites[j]) for i, j in pairs.tolist()]


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
        What to ask for.
    objects : iterable
        Rects, or whatever has one as its attribute `rect`.
    key : callable, optional
        Gives the rect of an object; is called once for each.

    Returns
    -------
    list of list
        For each rect what ``rect.collideobjectsall(objects, key=key)`` answers.

    Examples
    --------
    >>> from pygame import Rect
    >>> from jostle.pygame import collide_rect_objects
    >>> rooms = {"hall": Rect(0, 0, 50, 20), "cellar": Rect(0, 20, 50, 20)}
    >>> collide_rect_objects([Rect(4, 15, 2, 9), Rect(60, 0, 5, 5)], rooms, key=rooms.get)
    [['hall', 'cellar'], []]
    """
    asked, things = list(rects), list(objects)
    taken = things if key is None else [key(thing) for thing in things]
    pairs = _pairs_of_rects(asked, taken)
    if pairs is None:
        each = [rect.collidelistall(taken) for rect in asked]
        return [[things[row] for row in hits] for hits in each]
    rows = list(range(len(asked)))
    found = sprite_dict(pairs, rows, things)
    return [found.get(row, []) for row in rows]


def collide_rect_lists(rects: Iterable[Any], others: Iterable[Any]) -> list[list[int]]:
    """Find for each of many rects which of some others it overlaps.

    Parameters
    ----------
    rects : iterable of pygame.Rect or pygame.FRect
        What to ask for.
    others : iterable
        Rects, or whatever has one as its attribute `rect`.

    Returns
    -------
    list of list of int
        For each rect what ``rect.collidelistall(others)`` answers: indices, ascending.

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


class Group(_AnyGroup):
    """A group that answers questions about places, always for the rects as they are now.

    It does whatever `pygame.sprite.Group` does. Nothing has to be told when sprites move:
    each question reads the rects, and builds a tree of them if one has changed.

    Parameters
    ----------
    *sprites : pygame.sprite.Sprite, or iterables of them
        The first members.

    Examples
    --------
    >>> import pygame
    >>> from jostle.pygame import Group
    >>> birds = Group()
    >>> for x in (0, 40, 300):
    ...     bird = pygame.sprite.Sprite(birds)
    ...     bird.rect = pygame.Rect(x, 0, 10, 10)
    >>> camera = pygame.Rect(0, 0, 100, 100)
    >>> [bird.rect.x for bird in birds.query_rect(camera)]
    [0, 40]
    >>> bird.rect.x = 90
    >>> [bird.rect.x for bird in birds.query_rect(camera)]
    [0, 40, 90]
    >>> [bird.rect.x for bird in birds.nearest((70, 5), k=2)]
    [40, 90]
    >>> hit, distance = birds.raycast((70, 5), (-1, 0))
    >>> hit.rect.x, distance
    (40, 20.0)
    """

    _kept: _Kept | None = None

    def query_rect(self, rect: Any) -> list[Any]:
        """Find the sprites whose rects overlap a rect.

        Parameters
        ----------
        rect : pygame.Rect, pygame.FRect or what an FRect can be made of
            Where to look. `collide_rect_objects` takes many at once.

        Returns
        -------
        list of sprite
            In the order of the group. Touching is not overlapping, and a rect without
            area overlaps nothing.
        """
        asked = rect if isinstance(rect, _TYPES) else pygame.FRect(rect)
        sprites = self.sprites()
        return [sprites[row] for row in asked.collidelistall([s.rect for s in sprites])]

    def nearest(self, point: Any, k: int = 1, *, max_distance: float = math.inf) -> list[Any]:
        """Find the sprites whose rects are nearest to a point.

        Parameters
        ----------
        point : pair of float
            Where to measure from.
        k : int, default 1
            How many to find.
        max_distance : float, default inf
            Find nothing farther than this.

        Returns
        -------
        list of sprite
            At most k, the nearest first, of two as near the first in the group. Inside a
            rect the distance is 0.
        """
        sprites, tree = self._index()
        ids = tree.nearest(tuple(point), k, max_distance=max_distance).ids
        return [sprites[row] for row in ids.tolist() if row >= 0]

    def raycast(
        self, origin: Any, direction: Any, *, max_distance: float = math.inf
    ) -> tuple[Any | None, float]:
        """Find the first sprite that a ray hits.

        Parameters
        ----------
        origin, direction : pair of float
            Where the ray begins and where it goes; the direction may have any length but 0.
        max_distance : float, default inf
            How far it goes.

        Returns
        -------
        tuple of sprite and float
            The sprite and how far its rect is along the ray; None and infinity where the
            ray hits nothing.
        """
        sprites, tree = self._index()
        hit = tree.raycast(tuple(origin), tuple(direction), max_distance=max_distance)
        return (sprites[hit.id] if hit.id >= 0 else None), hit.distance

    def _index(self) -> tuple[list[Any], Quadtree]:
        """Return the sprites and a tree of their rects, the last one if it still holds."""
        sprites, kept = self.sprites(), self._kept
        sides = _sides(sprites)
        if kept is None or not np.array_equal(kept.sides, sides):
            half_sizes = sides[:, 2:] / 2
            tree = Quadtree(sides[:, :2] + half_sizes, half_sizes=np.abs(half_sizes))
            self._kept = kept = _Kept(sides, tree)
        return sprites, kept.tree


class _Kept(NamedTuple):
    """A tree and what it was built from."""

    sides: NDArray[np.float64]
    tree: Quadtree


def _sides(sprites: list[Any]) -> NDArray[np.float64]:
    """Return x, y, width and height of each rect."""
    sides = sprite_sides(sprites, _TYPES)
    if sides is None:
        rects = (sprite.rect for sprite in sprites)
        sides = np.array([(r.x, r.y, r.w, r.h) for r in rects], np.float64)
    return sides


# ---- what meets, and what is killed --------------------------------------------------------------


def _met(left: list[Any], groupb: Collection[Any], collided: Collided | None) -> dict[Any, Any]:
    """Do `groupcollide` where nothing is killed on the way."""
    right = list(groupb)
    near = _near(left, right, collided) if left and right else None
    if near is None:
        return _their_groupcollide(left, right, False, False, collided)
    near.radii.store(left)
    near.radii.store(right)
    pairs = near.decided(left, right, collided)
    return sprite_dict(pairs, left, right)


def _met_and_killed(
    left: list[Any], groupb: Collection[Any], collided: Collided | None
) -> dict[Any, list[Any]]:
    """Do `groupcollide` with `dokillb`: one sprite of `left` after the other."""
    found: dict[Any, list[Any]] = {}
    done = 0
    while done < len(left):
        right = list(groupb)
        near = _near(left[done:], right, collided) if right else None
        if near is None:
            for sprite in left[done:]:
                if hits := _their_spritecollide(sprite, groupb, True, collided):
                    found[sprite] = hits
            break
        near.radii.store(right)
        count = _kill_along(near, left[done:], right, groupb, collided, found)
        near.radii.store(left[done : done + count])
        done += count
    return found


def _kill_along(
    near: Near,
    left: list[Any],
    right: list[Any],
    groupb: Collection[Any],
    collided: Collided | None,
    found: dict[Any, list[Any]],
) -> int:
    """Kill what meets, and return how many of `left` had their turn.

    Ends early where nothing is left to meet, and where code of somebody else has run, after
    which nobody knows where the sprites are.
    """
    alive = groupb.has_internal if isinstance(groupb, AbstractGroup) else None
    remaining = len(right)
    for row, candidates in near.by_left():
        sprite = left[row]
        hits = [
            right[other]
            for _, other, sure in candidates
            if (alive is None or alive(right[other]))
            and (sure or (collided is not None and collided(sprite, right[other])))
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
    """Whether killing it runs no code but pygame's."""
    own = getattr(sprite.kill, "__func__", None)
    return own is Sprite.kill and all(
        _is_pygames(group.remove_internal) for group in Sprite.groups(sprite)
    )


def _is_pygames_iteration(group: Collection[Any]) -> bool:
    """Whether a group holds what its members are, or is no group and stays as it is."""
    return not isinstance(group, AbstractGroup) or (
        _is_pygames(group.__iter__) and _is_pygames(group.sprites)
    )


def _is_pygames(method: Any) -> bool:
    return getattr(method, "__module__", None) == "pygame.sprite"


# ---- who is near whom ----------------------------------------------------------------------------


def _near(left: list[Any], right: list[Any] | None, collided: Collided | None) -> Near | None:
    """Find who may meet whom; None where only pygame can tell."""
    rule = _rule_of(collided)
    radii = Radii()
    name, ratio = rule or ("rect", 1.0)
    found = sprite_pairs(left, right, name, ratio, _TYPES, radii)
    if found is None:
        return None
    pairs, sure = found
    if rule is None:
        sure = np.zeros(len(pairs), np.bool_)
    return Near(pairs, sure, radii)


def _rule_of(collided: Collided | None) -> tuple[Rule, float] | None:
    """Return the rule and the ratio of what pygame brings along, None for anything else."""
    if collided is None or collided is collide_rect:
        return "rect", 1.0
    if collided is collide_circle:
        return "circle", 1.0
    if collided is collide_mask:
        return "mask", 1.0
    if type(collided) is collide_rect_ratio:
        return "rect", float(collided.ratio)
    if type(collided) is collide_circle_ratio:
        return "circle", float(collided.ratio)
    return None


def _is_of_ones_own(collided: Collided) -> bool:
    """Whether it is a function that pygame did not bring along."""
    return _can_be_asked(collided) and _rule_of(collided) is None


def _can_be_asked(collided: Collided | None) -> bool:
    """Whether there is anything to gain: what is wrong is left for pygame to refuse."""
    if isinstance(collided, (collide_rect_ratio, collide_circle_ratio)):
        ratio = collided.ratio
        plain = type(ratio) in (int, float) and math.isfinite(ratio)
        return plain and abs(ratio) <= _LARGEST_RATIO
    return collided is None or callable(collided)


def _pairs_of_rects(asked: list[Any], things: list[Any]) -> NDArray[np.uint32] | None:
    """Find which rects overlap which things; None where only pygame can tell."""
    if not all(isinstance(rect, _TYPES) for rect in asked):
        return None
    rects = []
    for thing in things:
        rect = thing if isinstance(thing, _TYPES) else getattr(thing, "rect", None)
        # pygame takes what it can from a sequence before it looks for a `rect`.
        if not isinstance(rect, _TYPES) or (rect is not thing and hasattr(thing, "__getitem__")):
            return None
        rects.append(rect)
    found = sprite_pairs(asked, rects, "rects", 1.0, _TYPES)
    return None if found is None else found[0]
