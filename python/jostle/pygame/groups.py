"""A group of sprites with queries: rectangles, nearest sprites, rays."""

from __future__ import annotations

import math
from collections.abc import Sized
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias, overload

import numpy as np
import pygame
from numpy.typing import ArrayLike, NDArray

from jostle._core import Quadtree, sprite_sides
from jostle.pygame.candidates import RECTS
from jostle.pygame.rects import collide_each
from jostle.results import RayHit

_Point: TypeAlias = tuple[float, float] | pygame.Vector2

if TYPE_CHECKING:  # pygame's group is generic only for type checkers
    _AnyGroup = pygame.sprite.Group[Any]
else:
    _AnyGroup = pygame.sprite.Group


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

        See Also
        --------
        Snapshot : What it returns.

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

        See Also
        --------
        collide_rect_objects : Many rects against rects that are in no group.

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

        See Also
        --------
        Group.raycast : The first sprite in a direction.

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

        See Also
        --------
        Group.nearest : The nearest sprite in any direction.

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
    return collide_each(asked, sprites, rects)


def _is_many(rect: Any) -> bool:
    """Return whether it is a list, tuple or array of rects, not one rect."""
    if isinstance(rect, np.ndarray):
        return rect.ndim == 2
    return isinstance(rect, (list, tuple)) and all(map(_is_like_a_rect, rect))


def _is_like_a_rect(thing: Any) -> bool:
    """Return whether it is a rect, has one, or may be x, y, width and height."""
    four = isinstance(thing, Sized) and len(thing) == 4
    return four or isinstance(thing, RECTS) or hasattr(thing, "rect")


def _as_rect(name: str, rect: Any) -> Any:
    """Return a rect, the rect of a sprite, or an FRect made from the argument."""
    if isinstance(rect, RECTS):
        return rect
    if isinstance(own := getattr(rect, "rect", None), RECTS):
        return own
    try:
        return pygame.FRect(rect)
    except TypeError as error:
        rule = "it must be a pygame.Rect, a pygame.FRect or x, y, width and height"
        raise TypeError(f"{name} is {rect!r}; {rule}") from error


def _sides(sprites: list[Any]) -> NDArray[np.float64]:
    """Return x, y, width and height of each rect, shape (n, 4)."""
    sides = sprite_sides(sprites, RECTS)
    if sides is None:
        rows = [_four(f"sprites[{row}].rect", s.rect) for row, s in enumerate(sprites)]
        sides = np.array(rows, np.float64)
    return sides


def _four(name: str, rect: Any) -> tuple[float, float, float, float]:
    """Return x, y, width and height of a rect of any class."""
    if not isinstance(rect, RECTS):
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
