"""arcade's collision functions: all pairs in one call, or from a snapshot of a list."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from itertools import chain
from typing import Any, TypeAlias, cast

import arcade
import numpy as np
from arcade import check_for_collision
from arcade.geometry import are_polygons_intersecting, is_point_in_polygon
from numpy.typing import NDArray

from jostle._core import Quadtree

_Floats: TypeAlias = NDArray[np.float64]
_Rows: TypeAlias = NDArray[np.int64]

# arcade ignores two sprites whose centres are farther apart than the sum of this fraction of their
# longer sides. Slightly larger here: the tree may find too many candidates, never too few.
_PART = 0.71 * (1 + 1e-12)
_SLACK = 1e-9


class Snapshot:
    """The sprites of a list at one moment.

    A sprite that moves, turns or changes its size afterwards is searched for at its old place, and
    tested at its new one. So make a new snapshot in each frame.

    Parameters
    ----------
    sprites : SpriteList, or any iterable of sprites
        Sprites with finite positions and sizes.

    Examples
    --------
    >>> import arcade, jostle.arcade
    >>> coins = arcade.SpriteList(lazy=True)
    >>> for x in (0, 30, 60):
    ...     coins.append(arcade.SpriteSolidColor(20, 20, center_x=x))
    >>> now = jostle.arcade.Snapshot(coins)
    >>> [coin.center_x for coin in jostle.arcade.get_sprites_at_point((35, 5), now)]
    [30]
    """

    def __init__(self, sprites: Iterable[Any]) -> None:
        self.sprites = list(sprites)
        self._positions = _table([sprite.position for sprite in self.sprites], 2)
        self._sides = _table([sprite.size for sprite in self.sprites], 2).max(axis=1)

    def __len__(self) -> int:
        return len(self.sprites)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.sprites)

    @cached_property
    def _circles(self) -> Quadtree:
        """The discs that arcade compares before it tests hit boxes."""
        return Quadtree(self._positions, _reach(self._sides))

    @cached_property
    def _centers(self) -> Quadtree:
        return Quadtree(self._positions)

    @cached_property
    def _rows(self) -> dict[Any, list[int]]:
        """The rows of the sprites at each position."""
        found: dict[Any, list[int]] = {}
        for row, sprite in enumerate(self.sprites):
            found.setdefault(sprite.position, []).append(row)
        return found

    @cached_property
    def _polygons(self) -> _Polygons:
        return _Polygons(self.sprites)

    @cached_property
    def _boxes(self) -> Quadtree:
        """The bounds of each hit box, slightly enlarged."""
        low, high = self._polygons.bounds()
        centers, half_sizes = (low + high) / 2, (high - low) / 2
        return Quadtree(centers, 0.0, half_sizes + _SLACK * (1 + np.abs(centers) + half_sizes))

    @cached_property
    def _heights(self) -> tuple[_Floats, _Rows]:
        """The y of every corner, ascending, and the row of its sprite."""
        heights = self._polygons.points[:, 1]
        order = np.argsort(heights, kind="stable")
        return heights[order], self._polygons.owners[order]

    def _at(self, rows: Iterable[int]) -> list[Any]:
        return [self.sprites[row] for row in rows]


def selfcollide(sprites: Iterable[Any]) -> list[tuple[Any, Any]]:
    """Find every pair of colliding sprites of one list.

    Parameters
    ----------
    sprites : SpriteList, Snapshot, or any iterable of sprites
        The sprites.

    Returns
    -------
    list of tuple
        Two sprites for each pair, every pair once, in the order of the list.

    See Also
    --------
    check_for_collisions_between : The pairs of two lists.

    Examples
    --------
    >>> import arcade, jostle.arcade
    >>> rocks = [arcade.SpriteSolidColor(20, 20, center_x=x) for x in (0, 15, 90)]
    >>> pairs = jostle.arcade.selfcollide(rocks)
    >>> [(a.center_x, b.center_x) for a, b in pairs]
    [(0, 15)]
    """
    shot = _snapshot(sprites)
    return _colliding(shot, shot, shot._circles.pairs(sort=True))


def check_for_collisions_between(
    sprites: Iterable[Any], others: Iterable[Any]
) -> list[tuple[Any, Any]]:
    """Find every pair of colliding sprites of two lists.

    Parameters
    ----------
    sprites, others : SpriteList, Snapshot, or any iterable of sprites
        The sprites. One that is in both does not collide with itself.

    Returns
    -------
    list of tuple
        A sprite of the first list and one of the second for each pair, in the order of the
        first list, then of the second.

    See Also
    --------
    selfcollide : The pairs within one list.

    Examples
    --------
    >>> import arcade, jostle.arcade
    >>> shots = [arcade.SpriteSolidColor(4, 4, center_x=x) for x in (0, 50)]
    >>> rocks = [arcade.SpriteSolidColor(20, 20, center_x=x) for x in (5, 90)]
    >>> pairs = jostle.arcade.check_for_collisions_between(shots, rocks)
    >>> [(shot.center_x, rock.center_x) for shot, rock in pairs]
    [(0, 5)]
    """
    a, b = _snapshot(sprites), _snapshot(others)
    pairs = _colliding(a, b, a._circles.pairs(b._circles, sort=True))
    return [(one, other) for one, other in pairs if one is not other]


def check_for_collision_with_list(sprite: Any, sprite_list: Any, method: int = 0) -> list[Any]:
    """Find the sprites of a list that collide with a sprite.

    Parameters
    ----------
    sprite : Sprite
        The sprite; it does not collide with itself.
    sprite_list : SpriteList or Snapshot
        The sprites to check.
    method : int, default 0
        The choice of method of arcade; it has no effect on a snapshot.

    Returns
    -------
    list of Sprite
        Those that collide, in the order of the list.

    Examples
    --------
    >>> import arcade, jostle.arcade
    >>> rocks = [arcade.SpriteSolidColor(20, 20, center_x=x) for x in (0, 15, 90)]
    >>> now = jostle.arcade.Snapshot(rocks)
    >>> jostle.arcade.check_for_collision_with_list(rocks[1], now) == [rocks[0]]
    True
    """
    if not isinstance(sprite_list, Snapshot):
        return list(arcade.check_for_collision_with_list(sprite, sprite_list, method))
    side = np.array(max(sprite.size), np.float64)
    near = sprite_list._circles.query_circle(sprite.position, float(_reach(side)))
    found = sprite_list._at(near.tolist())
    return [other for other in found if other is not sprite and check_for_collision(sprite, other)]


def check_for_collision_with_lists(
    sprite: Any, sprite_lists: Iterable[Any], method: int = 0
) -> list[Any]:
    """Find the sprites of several lists that collide with a sprite.

    Parameters
    ----------
    sprite : Sprite
        The sprite; it does not collide with itself.
    sprite_lists : iterable of SpriteList or Snapshot
        The sprites to check.
    method : int, default 0
        The choice of method of arcade; it has no effect on a snapshot.

    Returns
    -------
    list of Sprite
        Those that collide, list by list.
    """
    found = (check_for_collision_with_list(sprite, one, method) for one in sprite_lists)
    return list(chain.from_iterable(found))


def get_sprites_at_point(point: Any, sprite_list: Any) -> list[Any]:
    """Find the sprites whose hit boxes contain a point.

    Parameters
    ----------
    point : tuple of float
        Its x and y.
    sprite_list : SpriteList or Snapshot
        The sprites to check.

    Returns
    -------
    list of Sprite
        Those that contain the point, in the order of the list.

    Notes
    -----
    arcade counts crossings of a ray to the right. If the point is exactly as high as a corner,
    the count may be wrong, and a sprite far away may be found. This function gives the same answer.
    """
    if not isinstance(sprite_list, Snapshot):
        return list(arcade.get_sprites_at_point(point, sprite_list))
    x, y = point[0], point[1]
    heights, owners = sprite_list._heights
    level = owners[np.searchsorted(heights, y) : np.searchsorted(heights, y, side="right")]
    rows = np.union1d(sprite_list._boxes.query_point((x, y)), level)
    return [
        sprite
        for sprite in sprite_list._at(rows.tolist())
        if is_point_in_polygon(x, y, sprite.hit_box.get_adjusted_points())
    ]


def get_sprites_at_exact_point(point: Any, sprite_list: Any) -> list[Any]:
    """Find the sprites whose position is exactly a point.

    Parameters
    ----------
    point : tuple of float
        Its x and y.
    sprite_list : SpriteList or Snapshot
        The sprites to check.

    Returns
    -------
    list of Sprite
        Those with that position, in the order of the list.
    """
    if not isinstance(sprite_list, Snapshot):
        return list(arcade.get_sprites_at_exact_point(point, sprite_list))
    # A list is never equal to a position, which is a tuple.
    return sprite_list._at(sprite_list._rows.get(point, ()) if isinstance(point, tuple) else ())


def get_sprites_in_rect(rect: Any, sprite_list: Any) -> list[Any]:
    """Find the sprites whose hit box overlaps a rectangle.

    Parameters
    ----------
    rect : arcade.Rect
        The rectangle.
    sprite_list : SpriteList or Snapshot
        The sprites to check.

    Returns
    -------
    list of Sprite
        Those that overlap it, in the order of the list.
    """
    if not isinstance(sprite_list, Snapshot):
        return list(arcade.get_sprites_in_rect(rect, sprite_list))
    corners = rect.to_points()
    xs, ys = [x for x, _ in corners], [y for _, y in corners]
    rows = sprite_list._boxes.query_rect((min(xs), min(ys), max(xs), max(ys)))
    return [
        sprite
        for sprite in sprite_list._at(rows.tolist())
        if are_polygons_intersecting(corners, sprite.hit_box.get_adjusted_points())
    ]


def get_closest_sprite(sprite: Any, sprite_list: Any) -> tuple[Any, float] | None:
    """Find the sprite of a list whose centre is nearest to that of a sprite.

    Parameters
    ----------
    sprite : Sprite
        The sprite. If it is in the list, the result is the sprite itself.
    sprite_list : SpriteList or Snapshot
        The sprites to check.

    Returns
    -------
    tuple of Sprite and float, or None
        The first of the nearest and its distance; None if the list is empty.
    """
    if not isinstance(sprite_list, Snapshot):
        return cast("tuple[Any, float] | None", arcade.get_closest_sprite(sprite, sprite_list))
    if not len(sprite_list):
        return None
    # The tree may round differently from arcade, so arcade's distances of all candidates decide.
    nearest = sprite_list._centers.nearest(sprite.position).distances.item()
    near = sprite_list._centers.query_circle(sprite.position, nearest * (1 + _SLACK) + _SLACK)
    found = sprite_list._at(near.tolist())
    distances = [arcade.get_distance_between_sprites(sprite, other) for other in found]
    least = min(distances)
    return found[distances.index(least)], least


def _table(rows: list[Any], width: int) -> _Floats:
    return np.array(rows, np.float64).reshape(-1, width)


def _snapshot(sprites: Iterable[Any]) -> Snapshot:
    return sprites if isinstance(sprites, Snapshot) else Snapshot(sprites)


def _reach(sides: _Floats) -> _Floats:
    """Return the radii of discs that overlap if arcade tests the hit boxes of two sprites.

    Sides may be negative; arcade squares their sum.
    """
    return np.abs(sides) * _PART + _SLACK


# ---- arcade's test, for many pairs at once -------------------------------------------------------


class _Polygons:
    """The hit boxes of some sprites: their corners, concatenated."""

    def __init__(self, sprites: Iterable[Any]) -> None:
        corners = [sprite.hit_box.get_adjusted_points() for sprite in sprites]
        self.points = _table(list(chain.from_iterable(corners)), 2)
        self.counts = np.fromiter(map(len, corners), np.int64)
        self.starts = np.cumsum(self.counts) - self.counts
        self.owners = np.repeat(np.arange(len(corners)), self.counts)

    def of(self, rows: _Rows, count: int) -> _Floats:
        """Return the corners of rows that have `count` corners each, shape (rows, count, 2)."""
        corners: _Floats = self.points[self.starts[rows, None] + np.arange(count)]
        return corners

    def bounds(self) -> tuple[_Floats, _Floats]:
        """Return the minimum and the maximum corner of each; (0, 0) without corners."""
        low, high = np.zeros((2, len(self.counts), 2))
        some = self.counts > 0
        if some.any():
            low[some] = np.minimum.reduceat(self.points, self.starts[some])
            high[some] = np.maximum.reduceat(self.points, self.starts[some])
        return low, high


def _colliding(a: Snapshot, b: Snapshot, pairs: NDArray[np.int64]) -> list[tuple[Any, Any]]:
    """Return the pairs that collide."""
    first, second = pairs[_near(a, b, pairs)].T
    # Hit boxes are slow to compute, so only those of sprites in candidate pairs are.
    rows, at = np.unique(first, return_inverse=True)
    polygons = _Polygons(a._at(rows.tolist()))
    other_rows, other_at = np.unique(second, return_inverse=True)
    others = _Polygons(b._at(other_rows.tolist()))
    hit = _intersecting(polygons, at, others, other_at)
    return list(zip(a._at(first[hit].tolist()), b._at(second[hit].tolist()), strict=True))


def _near(a: Snapshot, b: Snapshot, pairs: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return for which pairs arcade tests hit boxes, in arcade's own arithmetic."""
    first, second = pairs.T
    reach = (a._sides[first] + b._sides[second]) * 0.71
    difference = a._positions[first] - b._positions[second]
    squares = difference * difference
    near: NDArray[np.bool_] = squares[:, 0] + squares[:, 1] <= reach * reach
    return near


def _intersecting(a: _Polygons, rows: _Rows, b: _Polygons, other_rows: _Rows) -> NDArray[np.bool_]:
    """Return which polygons overlap their partners; equal numbers of corners are tested at once."""
    hit = np.zeros(len(rows), np.bool_)
    counts = np.column_stack([a.counts[rows], b.counts[other_rows]])
    for count, other_count in np.unique(counts, axis=0):
        if count and other_count:
            these = np.flatnonzero((counts == (count, other_count)).all(axis=1))
            one, other = a.of(rows[these], count), b.of(other_rows[these], other_count)
            hit[these] = ~(_separated(one, one, other) | _separated(other, one, other))
    return hit


def _separated(sides: _Floats, one: _Floats, other: _Floats) -> NDArray[np.bool_]:
    """Return which polygons a line along one of the sides separates.

    The sums are those of arcade's `are_polygons_intersecting`, in the same order, so the answer is
    the same to the last bit, also for hit boxes that are not convex.
    """
    found = np.zeros(len(one), np.bool_)
    for side in np.moveaxis(sides - np.roll(sides, -1, axis=1), 1, 0):
        normal = (-side[:, 1, None], side[:, 0, None])
        low, high = _projection(normal, one)
        other_low, other_high = _projection(normal, other)
        found |= (high <= other_low) | (other_high <= low)
    return found


def _projection(normal: tuple[_Floats, _Floats], polygons: _Floats) -> tuple[_Floats, _Floats]:
    """Return the minimum and the maximum of each polygon along its normal."""
    along = normal[0] * polygons[:, :, 0] + normal[1] * polygons[:, :, 1]
    return along.min(axis=1), along.max(axis=1)
