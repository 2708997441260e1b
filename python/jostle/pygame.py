"""pygame's sprite collisions for thousands of sprites: change one import.

`groupcollide`, `spritecollide`, `spritecollideany`
    As in `pygame.sprite`, on the same groups, with the same answers in the same order.
`prefilter`
    Calls a `collided` of your own only for sprites that are near each other.
`selfcollide`
    The pairs within one group, each once.
`collide_rect_objects`, `collide_rect_lists`
    `Rect.collideobjectsall` and `Rect.collidelistall` for many rects at once.
`Group`, `Snapshot`
    A `pygame.sprite.Group` with queries: rectangles, nearest sprites, rays.
`collide_rect`, `collide_rect_ratio`, `collide_circle`, `collide_circle_ratio`, `collide_mask`
    pygame's own, for `collided`.

There is no index to update: each call reads the current rects. Requires pygame-ce.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Sized
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, overload

import numpy as np
import pygame
from numpy.typing import ArrayLike, NDArray
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
from jostle.results import RayHit
from jostle.sprites import Collided, Near, Prefilter, Radii, rows_of

if not hasattr(pygame, "FRect"):
    raise ImportError("jostle.pygame needs pygame-ce; what is installed here is pygame")

__all__ = [
    "Group",
    "Prefilter",
    "Snapshot",
    "collide_circle",
    "collide_circle_ratio",
    "collide_mask",
    "collide_rect",
    "collide_rect_lists",
    "collide_rect_objects",
    "collide_rect_ratio",
    "groupcollide",
    "prefilter",
    "selfcollide",
    "spritecollide",
    "spritecollideany",
]

Rule: TypeAlias = Literal["rect", "circle", "mask", "within"]
_Point: TypeAlias = tuple[float, float] | pygame.Vector2

if TYPE_CHECKING:  # pygame's group is generic only for type checkers
    _AnyGroup = pygame.sprite.Group[Any]
else:
    _AnyGroup = pygame.sprite.Group

_TYPES = (pygame.Rect, pygame.FRect)
# They accept any collection of sprites, but their annotations only groups.
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
    if not (broad_phase and isinstance(groupb, Collection) and _rule_of(collided)):
        return _their_groupcollide(groupa, groupb, dokilla, dokillb, collided)
    left = list(groupa)
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
    if collided is None or not (broad_phase and _rule_of(collided)):
        return _their_spritecollide(sprite, group, dokill, collided)
    sprites = list(group)
    if collided is collide_rect and sprites:  # which pygame would call for each sprite
        return _their_spritecollide(sprite, sprites, dokill)
    near = _near([sprite], sprites, collided) if sprites else None
    if near is None:
        return _their_spritecollide(sprite, sprites, dokill, collided)
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
        return _their_spritecollideany(sprite, group, collided)
    sprites = list(group)
    near = _near([sprite], sprites, collided) if sprites else None
    if near is None:
        return _their_spritecollideany(sprite, sprites, collided)
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
    near = _near(sprites, None, collided) if broad_phase and len(sprites) > 1 else None
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
    return _collide_each(list(rects), things, taken)


def _collide_each(asked: list[Any], things: list[Any], taken: list[Any]) -> list[list[Any]]:
    """Find for each rect the things whose rect, in `taken`, it overlaps."""
    pairs = _pairs_of_rects(asked, taken)
    if pairs is None:
        each = [rect.collidelistall(taken) for rect in asked]
        return [[things[row] for row in hits] for hits in each]
    rows = list(range(len(asked)))
    found = sprite_dict(pairs, rows, things)
    return [found.get(row, []) for row in rows]


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


class Snapshot:
    """The sprites of a `Group` with their rects at one moment.

    `Group.snapshot` makes it. Its queries do not read the rects again, so many single queries
    are fast. Later changes of the sprites or of the group do not change the answers.

    Parameters
    ----------
    sprites : list of sprite
        The sprites.
    sides : ndarray of float64, shape (n, 4)
        Position and size of each rect: x, y, width and height.
    tree : Quadtree, optional
        A tree of these rects; if omitted, it is built.

    See Also
    --------
    Group.snapshot : Returns it.

    Examples
    --------
    >>> import pygame
    >>> from jostle.pygame import Group
    >>> bird = pygame.sprite.Sprite()
    >>> bird.rect = pygame.Rect(40, 0, 10, 10)
    >>> seen = Group(bird).snapshot()
    >>> bird.rect.x = 500
    >>> [hit for y in (-5, 5, 15) for hit in seen.raycast((0, y), (1, 0))][1::2]
    [inf, 40.0, inf]
    """

    def __init__(
        self, sprites: list[Any], sides: NDArray[np.float64], tree: Quadtree | None = None
    ) -> None:
        self._sprites, self._sides = sprites, sides
        self._tree = _tree_of(sprites, sides) if tree is None else tree

    def __len__(self) -> int:
        return len(self._sprites)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}({len(self)} sprites)>"

    @cached_property
    def _rects(self) -> list[Any]:
        """Copies of the rects. A Rect of the same whole numbers may replace an FRect."""
        fits_int = (self._sides >= -(2.0**31)) & (self._sides < 2.0**31)
        whole = (self._sides == np.trunc(self._sides)) & fits_int
        kinds = [pygame.Rect if fits else pygame.FRect for fits in whole.all(axis=1).tolist()]
        return [kind(*sides) for kind, sides in zip(kinds, self._sides.tolist(), strict=True)]

    def query_rect(self, rect: Any) -> list[Any]:
        """Find the sprites whose rects overlap a rect, as `Group.query_rect` does.

        Parameters
        ----------
        rect : pygame.Rect, pygame.FRect or what an FRect can be made of, or many of them
            The rects to test.

        Returns
        -------
        list of sprite, or list of list of sprite
            In the order of the group.
        """
        return _query_rect(rect, self._sprites, self._rects)

    def nearest(self, point: Any, k: int = 1, *, max_distance: float = math.inf) -> list[Any]:
        """Find the sprites whose rects are nearest to a point, as `Group.nearest` does.

        Parameters
        ----------
        point : array_like, shape (2,) or (n, 2)
            The points.
        k : int, default 1
            Number of sprites to find.
        max_distance : float, default inf
            Ignore sprites farther than this, in units of length.

        Returns
        -------
        list of sprite, or list of list of sprite
            At most k for each point, the nearest first.
        """
        ids = self._tree.nearest(point, k, max_distance=max_distance).ids
        if ids.ndim == 1:
            return self._named(ids.tolist())
        return [self._named(row) for row in ids.tolist()]

    def _named(self, rows: list[int]) -> list[Any]:
        return [self._sprites[row] for row in rows if row >= 0]

    @overload
    def raycast(
        self, origin: _Point, direction: _Point, *, max_distance: float = math.inf
    ) -> tuple[Any, float]: ...
    @overload
    def raycast(
        self, origin: ArrayLike, direction: ArrayLike, *, max_distance: float = math.inf
    ) -> tuple[Any, Any]: ...
    def raycast(
        self, origin: Any, direction: Any, *, max_distance: float = math.inf
    ) -> tuple[Any, Any]:
        """Find the first sprite that a ray hits, or each of many, as `Group.raycast` does.

        Parameters
        ----------
        origin, direction : array_like, shape (2,) or (n, 2)
            Start and direction of each ray.
        max_distance : float, default inf
            Maximum length of the rays, in units of length.

        Returns
        -------
        tuple of sprite and float, or of list of sprite and ndarray of float64, shape (n,)
            The sprite that is hit and its distance; None and infinity if nothing is hit.
        """
        hit = self._tree.raycast(origin, direction, max_distance=max_distance)
        if isinstance(hit, RayHit):
            return (self._sprites[hit.id] if hit.id >= 0 else None), hit.distance
        return [self._sprites[row] if row >= 0 else None for row in hit.ids.tolist()], hit.distances


class Group(_AnyGroup):
    """A group with queries, always for the current rects.

    It has all methods of `pygame.sprite.Group`. Each query takes one rect, point or ray and
    returns one answer, or takes many and returns all answers.

    Each query reads all rects, about 0.13 µs for each sprite, and compares them with the
    previous ones; a tree is built only if one has changed. Many queries are therefore
    fastest in one call, or with `snapshot`, which reads the rects once.

    Parameters
    ----------
    *sprites : pygame.sprite.Sprite, or iterables of them
        The first members.

    See Also
    --------
    Snapshot : The same queries without reading the rects again.

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

    _kept: tuple[NDArray[np.float64], Quadtree] | None = None

    def snapshot(self) -> Snapshot:
        """Read the rects once, for any number of queries.

        Returns
        -------
        Snapshot
            With `query_rect`, `nearest` and `raycast` for the current rects. It does not
            change when sprites move: make a new one in each frame.

        Raises
        ------
        TypeError
            If a sprite's `rect` is not a rect.
        ValueError
            If a number of a rect is not finite.

        Examples
        --------
        >>> import pygame
        >>> from jostle.pygame import Group
        >>> bird = pygame.sprite.Sprite()
        >>> bird.rect = pygame.Rect(40, 0, 10, 10)
        >>> now = Group(bird).snapshot()
        >>> [len(now.nearest((x, 5), max_distance=20)) for x in (0, 30, 60, 90)]
        [0, 1, 1, 0]
        """
        sprites, kept = self.sprites(), self._kept
        sides = _sides(sprites)
        if kept is not None and np.array_equal(kept[0], sides):
            return Snapshot(sprites, sides, kept[1])
        made = Snapshot(sprites, sides)
        self._kept = sides, made._tree
        return made

    def query_rect(self, rect: Any) -> list[Any]:
        """Find the sprites whose rects overlap a rect, or each of many.

        Parameters
        ----------
        rect : pygame.Rect, pygame.FRect or what an FRect can be made of, or many of them
            The rects to test. Many are a list or tuple of rects, or of x, y, width and
            height, or an array of shape (n, 4).

        Returns
        -------
        list of sprite, or list of list of sprite
            In the order of the group; for many rects one list for each. Rects that only
            touch do not overlap, and a rect without area overlaps nothing.

        Raises
        ------
        TypeError
            If `rect` is neither a rect nor a list, tuple or array of rects.

        Examples
        --------
        >>> import pygame
        >>> from jostle.pygame import Group
        >>> bird = pygame.sprite.Sprite()
        >>> bird.rect = pygame.Rect(40, 0, 10, 10)
        >>> views = [pygame.Rect(0, 0, 20, 20), pygame.Rect(30, 0, 20, 20)]
        >>> [len(seen) for seen in Group(bird).query_rect(views)]
        [0, 1]
        """
        sprites = self.sprites()
        return _query_rect(rect, sprites, [sprite.rect for sprite in sprites])

    def nearest(self, point: Any, k: int = 1, *, max_distance: float = math.inf) -> list[Any]:
        """Find the sprites whose rects are nearest to a point, or to each of many.

        Parameters
        ----------
        point : array_like, shape (2,) or (n, 2)
            The points.
        k : int, default 1
            Number of sprites to find.
        max_distance : float, default inf
            Ignore sprites farther than this, in units of length.

        Returns
        -------
        list of sprite, or list of list of sprite
            At most k, the nearest first, at equal distances in the order of the group; for
            many points one list for each. Inside a rect the distance is 0.

        Raises
        ------
        TypeError
            If `point` holds no real numbers, or a sprite's `rect` is not a rect.
        ValueError
            If a number is not finite, `point` has another shape, or `k` or
            `max_distance` is out of range.

        Examples
        --------
        >>> import pygame
        >>> from jostle.pygame import Group
        >>> bird = pygame.sprite.Sprite()
        >>> bird.rect = pygame.Rect(40, 0, 10, 10)
        >>> [len(found) for found in Group(bird).nearest([(0, 0), (30, 0)], max_distance=20)]
        [0, 1]
        """
        return self.snapshot().nearest(point, k, max_distance=max_distance)

    @overload
    def raycast(
        self, origin: _Point, direction: _Point, *, max_distance: float = math.inf
    ) -> tuple[Any, float]: ...
    @overload
    def raycast(
        self, origin: ArrayLike, direction: ArrayLike, *, max_distance: float = math.inf
    ) -> tuple[Any, Any]: ...
    def raycast(
        self, origin: Any, direction: Any, *, max_distance: float = math.inf
    ) -> tuple[Any, Any]:
        """Find the first sprite that a ray hits, or each of many.

        Parameters
        ----------
        origin, direction : array_like, shape (2,) or (n, 2)
            Start and direction of each ray; a direction may have any length except 0. One
            origin may have many directions, and many origins one direction.
        max_distance : float, default inf
            Maximum length of the rays, in units of length.

        Returns
        -------
        tuple of sprite and float, or of list of sprite and ndarray of float64, shape (n,)
            The first sprite that is hit, and the distance to its rect along the ray; None and
            infinity if nothing is hit.

        Raises
        ------
        TypeError
            If an argument holds no real numbers, or a sprite's `rect` is not a rect.
        ValueError
            If a number is not finite, a direction is (0, 0), an argument has another
            shape, or `max_distance` is negative.

        Examples
        --------
        >>> import pygame
        >>> from jostle.pygame import Group
        >>> bird = pygame.sprite.Sprite()
        >>> bird.rect = pygame.Rect(40, 0, 10, 10)
        >>> hits, distances = Group(bird).raycast((0, 5), [(1, 0), (0, 1), (-1, 0)])
        >>> [hit is bird for hit in hits], distances
        ([True, False, False], array([40., inf, inf]))
        """
        return self.snapshot().raycast(origin, direction, max_distance=max_distance)


def _query_rect(rect: Any, sprites: list[Any], rects: list[Any]) -> list[Any]:
    """Answer `query_rect` for one rect or many."""
    if not _is_many(rect):
        return [sprites[row] for row in _as_rect("rect", rect).collidelistall(rects)]
    asked = [_as_rect(f"rect[{row}]", one) for row, one in enumerate(rect)]
    return _collide_each(asked, sprites, rects)


def _is_many(rect: Any) -> bool:
    """Return whether it is a list, tuple or array of rects, not one rect."""
    if isinstance(rect, np.ndarray):
        return rect.ndim == 2
    return isinstance(rect, (list, tuple)) and all(map(_is_like_a_rect, rect))


def _is_like_a_rect(thing: Any) -> bool:
    """Return whether it is a rect, has one, or may be x, y, width and height."""
    four = isinstance(thing, Sized) and len(thing) == 4
    return four or isinstance(thing, _TYPES) or hasattr(thing, "rect")


def _as_rect(name: str, rect: Any) -> Any:
    """Return a rect, the rect of a sprite, or an FRect made from the argument."""
    if isinstance(rect, _TYPES):
        return rect
    if isinstance(own := getattr(rect, "rect", None), _TYPES):
        return own
    try:
        return pygame.FRect(rect)
    except TypeError as error:
        rule = "it must be a pygame.Rect, a pygame.FRect or x, y, width and height"
        raise TypeError(f"{name} is {rect!r}; {rule}") from error


def _sides(sprites: list[Any]) -> NDArray[np.float64]:
    """Return x, y, width and height of each rect, shape (n, 4)."""
    sides = sprite_sides(sprites, _TYPES)
    if sides is None:
        rows = [_four(f"sprites[{row}].rect", s.rect) for row, s in enumerate(sprites)]
        sides = np.array(rows, np.float64)
    return sides


def _four(name: str, rect: Any) -> tuple[float, float, float, float]:
    """Return x, y, width and height of a rect of any class."""
    if not isinstance(rect, _TYPES):
        rect = _as_rect(name, rect)
    return rect.x, rect.y, rect.w, rect.h


def _tree_of(sprites: list[Any], sides: NDArray[np.float64]) -> Quadtree:
    """Build a tree of the rects."""
    wrong = np.flatnonzero(~np.isfinite(sides).all(axis=1))
    if wrong.size:
        row = int(wrong[0])
        raise ValueError(f"sprites[{row}].rect is {sprites[row].rect}; it must be finite")
    half_sizes = sides[:, 2:] / 2
    return Quadtree(sides[:, :2] + half_sizes, half_sizes=np.abs(half_sizes))


# ---- collisions and kills ------------------------------------------------------------------------


def _met(left: list[Any], groupb: Collection[Any], collided: Collided | None) -> dict[Any, Any]:
    """Do `groupcollide` without `dokillb`."""
    right = list(groupb)
    near = _near(left, right, collided) if left and right else None
    if near is None:
        return _their_groupcollide(left, right, False, False, collided)
    near.radii.store(left)
    near.radii.store(right)
    return sprite_dict(near.decided(left, right), left, right)


def _met_and_killed(
    left: list[Any], groupb: Collection[Any], collided: Collided | None
) -> dict[Any, list[Any]]:
    """Do `groupcollide` with `dokillb`: one sprite of `left` after another."""
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


# ---- candidate pairs -----------------------------------------------------------------------------


def _near(left: list[Any], right: list[Any] | None, collided: Collided | None) -> Near | None:
    """Find the pairs that collide or have to be tested; None if only pygame can decide."""
    rule = _rule_of(collided)
    if rule is None:
        return None
    radii = Radii()
    found = sprite_pairs(left, right, *rule, _TYPES, radii)
    if found is None:
        return None
    ask = collided.collided if isinstance(collided, Prefilter) else collided
    return Near(*found, ask, radii)


def _rule_of(collided: Collided | None) -> tuple[Rule, float] | None:
    """Return the rule and its number, None for functions that cannot be computed here."""
    if isinstance(collided, Prefilter):
        return "within", collided.reach
    if collided is None or collided is collide_rect:
        return "rect", 1.0
    if collided is collide_circle:
        return "circle", 1.0
    if collided is collide_mask:
        return "mask", 1.0
    if type(collided) is collide_rect_ratio and _is_plain(collided.ratio):
        return "rect", float(collided.ratio)
    if type(collided) is collide_circle_ratio and _is_plain(collided.ratio):
        return "circle", float(collided.ratio)
    return None


def _is_plain(ratio: Any) -> bool:
    """Return whether Rust computes with a ratio as Python does."""
    return type(ratio) in (int, float) and abs(ratio) <= _LARGEST_RATIO


def _pairs_of_rects(asked: list[Any], things: list[Any]) -> NDArray[np.uint32] | None:
    """Find the overlaps of rects and things; None if only pygame can decide."""
    if not all(isinstance(rect, _TYPES) for rect in asked):
        return None
    rects = []
    for thing in things:
        rect = thing if isinstance(thing, _TYPES) else getattr(thing, "rect", None)
        # pygame reads a sequence as a rect before it reads the attribute `rect`.
        if not isinstance(rect, _TYPES) or (rect is not thing and hasattr(thing, "__getitem__")):
            return None
        rects.append(rect)
    found = sprite_pairs(asked, rects, "rects", 1.0, _TYPES)
    return None if found is None else found[0]
