"""arcade's collision functions for thousands of sprites: all pairs in one call, or from a snapshot.

`check_for_collisions_between`, `selfcollide`
    Every pair of colliding sprites of two lists, or of one, in a single call.
`Snapshot`
    The sprites of a list at one moment. The functions below take it in place of a list.
`check_for_collision_with_list`, `check_for_collision_with_lists`, `get_sprites_at_point`,
`get_sprites_at_exact_point`, `get_sprites_in_rect`, `get_closest_sprite`
    As in arcade, with the same answers in the order of the list.
`check_for_collision`
    arcade's own.
`PhysicsEngineSimple`, `PhysicsEnginePlatformer`
    arcade's engines with continuous motion, on `jostle.Space.move_and_slide`.

A single query has to read the whole list, as arcade does. So for a list these functions call
arcade's own. A snapshot reads the list once, for any number of queries.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from itertools import chain
from typing import Any, NamedTuple, TypeAlias, cast

import arcade
import numpy as np
from arcade import check_for_collision
from arcade.geometry import are_polygons_intersecting, is_point_in_polygon
from numpy.typing import NDArray

from jostle._core import Quadtree, Space

__all__ = [
    "PhysicsEnginePlatformer",
    "PhysicsEngineSimple",
    "Snapshot",
    "check_for_collision",
    "check_for_collision_with_list",
    "check_for_collision_with_lists",
    "check_for_collisions_between",
    "get_closest_sprite",
    "get_sprites_at_exact_point",
    "get_sprites_at_point",
    "get_sprites_in_rect",
    "selfcollide",
]

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


class PhysicsEngineSimple:
    """arcade's engine for games seen from above, with continuous motion.

    `update` moves the player by ``change_x`` and ``change_y``. It slides along walls, and passes
    through none at any speed. Each sprite is the bounding box of its hit box, so rotated and
    round walls are boxes here.

    Parameters
    ----------
    player_sprite : Sprite
        The sprite to move.
    walls : SpriteList or iterable of SpriteList, optional
        Sprites that do not move. They are read here; call `read_walls` after they have changed.

    Examples
    --------
    >>> import arcade, jostle.arcade
    >>> player = arcade.SpriteSolidColor(20, 20, center_x=0)
    >>> walls = arcade.SpriteList(lazy=True)
    >>> walls.append(arcade.SpriteSolidColor(20, 200, center_x=60))
    >>> engine = jostle.arcade.PhysicsEngineSimple(player, walls)
    >>> player.change_x = 500
    >>> engine.update() == [walls[0]], player.right
    (True, 50.0)
    """

    _up: tuple[float, float] = (0.0, 0.0)

    def __init__(self, player_sprite: Any, walls: Any = None) -> None:
        self.player_sprite = player_sprite
        self.walls = walls

    @property
    def walls(self) -> list[Any]:
        """The lists of sprites that stop the player and do not move."""
        return self._walls

    @walls.setter
    def walls(self, walls: Any) -> None:
        self._walls = _lists(walls)
        self.read_walls()

    def read_walls(self) -> None:
        """Read the positions and the sizes of all walls again."""
        self._space = Space()
        self._sprites: dict[int, Any] = {}
        self._add(chain.from_iterable(self._walls))
        self._player = self._space.add(**_centered(self.player_sprite), categories=_PLAYER)

    def update(self) -> list[Any]:
        """Move the player, and return the sprites that it has met, each once."""
        return self._slide().sprites

    def _add(self, sprites: Iterable[Any]) -> _Rows:
        """Add sprites as obstacles; return their ids."""
        sprites = list(sprites)
        ids = self._space.add(boxes=_sides(sprites), categories=_WALL)
        self._sprites.update(zip(ids.tolist(), sprites, strict=True))
        return ids

    def _slide(self) -> _Met:
        """Move the player by its velocity."""
        player = self.player_sprite
        place = _centered(player)
        self._space.set(self._player, positions=place["positions"], half_sizes=place["half_sizes"])
        slide = self._space.move_and_slide(
            self._player, (player.change_x, player.change_y), mask=_WALL, up=self._up
        )
        x, y = slide.displacement.tolist()
        player.position = (player.center_x + x, player.center_y + y)
        hits = list(dict.fromkeys(slide.hits.tolist()))
        vertical = bool(slide.on_floor or slide.on_ceiling)
        return _Met([self._sprites[hit] for hit in hits], bool(slide.on_floor), vertical)


class PhysicsEnginePlatformer(PhysicsEngineSimple):
    """arcade's engine for platformers, with continuous motion.

    The player falls, stands on walls and platforms, and is carried by platforms. Platforms move by
    ``change_x`` and ``change_y`` and turn at their boundaries. Each sprite is the bounding box
    of its hit box; there are no ramps.

    Parameters
    ----------
    player_sprite : Sprite
        The sprite to move.
    platforms : SpriteList or iterable of SpriteList, optional
        Sprites that move; they are read in each `update`.
    gravity_constant : float, default 0.5
        Velocity that the player gains downwards in each `update`.
    ladders : SpriteList or iterable of SpriteList, optional
        Sprites on which the player does not fall.
    walls : SpriteList or iterable of SpriteList, optional
        Sprites that do not move. They are read here; call `read_walls` after they have changed.

    Examples
    --------
    >>> import arcade, jostle.arcade
    >>> player = arcade.SpriteSolidColor(20, 20, center_y=500)
    >>> ground = arcade.SpriteList(lazy=True)
    >>> ground.append(arcade.SpriteSolidColor(400, 20))
    >>> engine = jostle.arcade.PhysicsEnginePlatformer(player, walls=ground)
    >>> for frame in range(60):
    ...     met = engine.update()
    >>> player.bottom, player.change_y, engine.can_jump()
    (10.0, 0, True)
    """

    _up = (0.0, 1.0)

    def __init__(
        self,
        player_sprite: Any,
        platforms: Any = None,
        gravity_constant: float = 0.5,
        ladders: Any = None,
        walls: Any = None,
    ) -> None:
        self.platforms = _lists(platforms)
        self.ladders = _lists(ladders)
        self.gravity_constant = gravity_constant
        self.jumps_since_ground = 0
        self.allowed_jumps = 1
        self.allow_multi_jump = False
        super().__init__(player_sprite, walls)

    def read_walls(self) -> None:
        """Read the positions and the sizes of all walls and platforms again."""
        super().read_walls()
        self._moving = list(chain.from_iterable(self.platforms))
        self._moving_ids = self._add(self._moving)

    def update(self) -> list[Any]:
        """Move the platforms and the player, and return the sprites that it has met, each once."""
        if not self.is_on_ladder():
            self.player_sprite.change_y -= self.gravity_constant
        self._move_platforms()
        met = self._slide()
        if met.vertical:
            self.player_sprite.change_y = 0
        if met.on_floor:
            self.jumps_since_ground = 0
        return met.sprites

    def is_on_ladder(self) -> bool:
        """Whether the player touches a ladder."""
        lists = self.ladders
        return any(arcade.check_for_collision_with_list(self.player_sprite, one) for one in lists)

    def can_jump(self, y_distance: float = 5) -> bool:
        """Whether the player is at most `y_distance` above a floor, or may jump in the air."""
        left, bottom, right, top = _sides([self.player_sprite])[0].tolist()
        below = self._space.query_rect((left, bottom - y_distance, right, top), mask=_WALL)
        if len(below):
            self.jumps_since_ground = 0
        more = self.allow_multi_jump and self.jumps_since_ground < self.allowed_jumps
        return bool(len(below) or more)

    def jump(self, velocity: float) -> None:
        """Set the velocity upwards, and count the jump."""
        self.player_sprite.change_y = velocity
        self.increment_jump_counter()

    def increment_jump_counter(self) -> None:
        """Count a jump that did not call `jump`."""
        if self.allow_multi_jump:
            self.jumps_since_ground += 1

    def enable_multi_jump(self, allowed_jumps: int) -> None:
        """Allow this number of jumps before the player touches the ground again."""
        self.allowed_jumps = allowed_jumps
        self.allow_multi_jump = True

    def disable_multi_jump(self) -> None:
        """Allow jumps from the ground only."""
        self.allow_multi_jump = False
        self.allowed_jumps = 1
        self.jumps_since_ground = 0

    def _move_platforms(self) -> None:
        for platform in self._moving:
            for axis, low, high in (("x", "left", "right"), ("y", "bottom", "top")):
                _turn(platform, axis, low, high)
        if self._moving:
            self._space.set(
                self._moving_ids, positions=[sprite.position for sprite in self._moving]
            )


_WALL, _PLAYER = 1, 2


class _Met(NamedTuple):
    """What a player has met."""

    sprites: list[Any]
    on_floor: bool
    vertical: bool


def _turn(sprite: Any, axis: str, low: str, high: str) -> None:
    """Move a platform along an axis by its velocity, and turn it at its boundaries."""
    change = getattr(sprite, f"change_{axis}")
    setattr(sprite, f"center_{axis}", getattr(sprite, f"center_{axis}") + change)
    for side, sign in ((high, 1), (low, -1)):
        limit = getattr(sprite, f"boundary_{side}")
        if limit is not None and sign * change > 0 and sign * (getattr(sprite, side) - limit) >= 0:
            setattr(sprite, side, limit)
            setattr(sprite, f"change_{axis}", -change)


def _lists(sprites: Any) -> list[Any]:
    """Some lists of sprites: none, one or many."""
    if sprites is None:
        return []
    return [sprites] if isinstance(sprites, arcade.SpriteList) else list(sprites)


def _sides(sprites: list[Any]) -> _Floats:
    """The bounding boxes of hit boxes."""
    rows = [(sprite.left, sprite.bottom, sprite.right, sprite.top) for sprite in sprites]
    return _table(rows, 4)


def _centered(sprite: Any) -> dict[str, Any]:
    """The bounding box of a hit box as centre and half size."""
    sides = _sides([sprite])[0]
    return {"positions": (sides[:2] + sides[2:]) / 2, "half_sizes": (sides[2:] - sides[:2]) / 2}
