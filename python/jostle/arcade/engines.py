"""arcade's two engines with continuous motion, on `jostle.Space.move_and_slide`."""

from __future__ import annotations

from itertools import chain
from typing import Any

import arcade
import numpy as np
from numpy.typing import NDArray

from jostle._core import Space
from jostle.results import Slide
from jostle.walls import polyline

_WALL, _PLAYER = 1, 2
_AXES = (
    ("change_x", "center_x", (("left", "boundary_left", -1), ("right", "boundary_right", 1))),
    ("change_y", "center_y", (("top", "boundary_top", 1), ("bottom", "boundary_bottom", -1))),
)
_TOUCH = 1e-6  # pixels; too small to be seen


class PhysicsEngineSimple:
    """arcade's engine for games seen from above, with continuous motion.

    `update` moves the player by ``change_x`` and ``change_y``. It slides along walls, and passes
    through none at any speed. Walls have the outlines of their hit boxes, also rotated ones; the
    player is the bounding box of its hit box.

    Parameters
    ----------
    player_sprite : Sprite
        The sprite to move.
    walls : SpriteList or iterable of SpriteList, optional
        Sprites that do not move. Sprites that are added to these lists or removed from them are
        noticed; call `read_walls` after some have moved.

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

    _up = (0.0, 0.0)

    def __init__(self, player_sprite: Any, walls: Any = None) -> None:
        if not isinstance(player_sprite, arcade.Sprite):
            raise TypeError(f"player_sprite is a {type(player_sprite).__name__}, must be a Sprite")
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
        """Read the positions and the hit boxes of all walls again."""
        self._space = Space()
        self._player = self._space.add((0, 0), half_sizes=(1, 1), categories=_PLAYER)
        self._known: list[list[Any]] = []
        self._ids: dict[Any, NDArray[np.int64]] = {}
        self._sprites: dict[int, Any] = {}

    def update(self) -> list[Any]:
        """Move the player, and return the sprites that it has met, each once."""
        return self._met(self._slide())

    def _obstacles(self) -> list[list[Any]]:
        """The sprites that stop the player, list by list."""
        return [_listed(sprites) for sprites in self._walls]

    def _slide(self, **options: Any) -> list[Slide]:
        """Move the player by its velocity, first along y, then along x, as arcade does."""
        self._read_changes()
        player = self.player_sprite
        low, high = np.reshape(_sides(player), (2, 2))
        self._space.set(self._player, positions=(low + high) / 2, half_sizes=(high - low) / 2)
        options = {"mask": _WALL, "up": self._up, **options}
        fall = self._space.move_and_slide(self._player, (0, player.change_y), **options)
        slides, step = [fall], player.change_x
        if fall.on_floor:
            # A displacement is as long as the way along the floor, `change_x` is its part along x.
            step /= float(fall.normals[fall.hits == fall.floor][0, 1])
        if step:
            # Downwards too, so that the floor is met, and carries the player in the next update.
            way = (step, -_TOUCH if fall.on_floor else 0)
            slides.append(self._space.move_and_slide(self._player, way, **options))
        x, y = np.sum([slide.displacement for slide in slides], axis=0).tolist()
        player.position = (player.center_x + x, player.center_y + y)
        return slides

    def _met(self, slides: list[Slide]) -> list[Any]:
        hits = np.concatenate([slide.hits for slide in slides])
        return list(dict.fromkeys(self._sprites[hit] for hit in hits.tolist()))

    def _read_changes(self) -> None:
        """Add sprites that are new in the lists, and remove those that are no longer there."""
        lists = self._obstacles()
        if lists == self._known:
            return
        self._known = [list(sprites) for sprites in lists]
        obstacles = dict.fromkeys(chain.from_iterable(lists))
        for sprite in self._ids.keys() - obstacles.keys():
            self._space.remove(self._ids.pop(sprite))
        new = [sprite for sprite in obstacles if sprite not in self._ids]
        boxes = [sprite for sprite in new if _is_box(sprite)]
        sides = np.reshape([_sides(sprite) for sprite in boxes], (-1, 4))
        ids = self._space.add(boxes=sides, categories=_WALL)
        self._ids.update(zip(boxes, ids[:, None], strict=True))
        for sprite in new:
            if sprite not in self._ids:
                points = sprite.hit_box.get_adjusted_points()
                segments = polyline(points, closed=len(points) > 2)
                self._ids[sprite] = self._space.add(segments=segments, categories=_WALL)
        self._sprites = {id: sprite for sprite, ids in self._ids.items() for id in ids.tolist()}


class PhysicsEnginePlatformer(PhysicsEngineSimple):
    """arcade's engine for platformers, with continuous motion.

    The player falls, stands on walls and platforms, climbs ramps of at most 45° and steps that are
    not higher than `change_x`, and is carried by platforms. Platforms move by ``change_x`` and
    ``change_y`` and reverse at their boundaries.

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
        Sprites that do not move. Sprites that are added to these lists or removed from them are
        noticed; call `read_walls` after some have moved.

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
        """Read the positions and the hit boxes of all walls and platforms again."""
        super().read_walls()
        self._moving: list[Any] = []
        self._offsets: dict[Any, NDArray[Any]] = {}

    def update(self) -> list[Any]:
        """Move the platforms and the player, and return the sprites that it has met, each once."""
        player = self.player_sprite
        if not self.is_on_ladder():
            player.change_y -= self.gravity_constant
        for platform in chain.from_iterable(self.platforms):
            _move(platform)
        slides = self._slide(step_height=abs(player.change_x), constant_speed=True)
        if slides[0].on_floor:
            player.change_y = min(0, getattr(self._sprites[slides[0].floor], "change_y", 0))
            self.jumps_since_ground = 0
        elif slides[0].on_ceiling:
            player.change_y = 0
        return self._met(slides)

    def is_on_ladder(self) -> bool:
        """Whether the player touches a ladder."""
        lists = self.ladders
        return any(arcade.check_for_collision_with_list(self.player_sprite, one) for one in lists)

    def can_jump(self, y_distance: float = 5) -> bool:
        """Whether the player is at most `y_distance` above a floor, or may jump in the air."""
        self._read_changes()
        left, bottom, right, top = _sides(self.player_sprite)
        area = (left, bottom - y_distance, right, top)
        is_above_floor = len(self._space.query_rect(area, mask=_WALL)) > 0
        if is_above_floor:
            self.jumps_since_ground = 0
        more = self.allow_multi_jump and self.jumps_since_ground < self.allowed_jumps
        return is_above_floor or more

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

    def _obstacles(self) -> list[list[Any]]:
        return [_listed(sprites) for sprites in chain(self._walls, self.platforms)]

    def _read_changes(self) -> None:
        """Read also where the platforms are."""
        known = self._known
        super()._read_changes()
        if self._known is not known:
            self._read_platforms()
        if self._moving:
            places = np.array([platform.position for platform in self._moving])
            self._space.set(self._moving_ids, positions=places[self._owners] + self._from_places)

    def _read_platforms(self) -> None:
        """List the shapes of all platforms; one that is new was added where it is now."""
        self._moving = list(dict.fromkeys(chain.from_iterable(self.platforms)))
        for sprite in self._moving:
            if sprite not in self._offsets:
                centers = self._space.get(self._ids[sprite]).positions
                self._offsets[sprite] = centers - np.array(sprite.position)
        counts = [len(self._ids[sprite]) for sprite in self._moving]
        self._owners = np.repeat(np.arange(len(counts)), counts)
        if self._moving:
            self._moving_ids = np.concatenate([self._ids[sprite] for sprite in self._moving])
            self._from_places = np.concatenate([self._offsets[one] for one in self._moving])


def _move(platform: Any) -> None:
    """Reverse a platform at its boundaries, and move it, axis by axis, as arcade does."""
    if platform.change_x == platform.change_y == 0:
        return
    for change, center, sides in _AXES:
        for side, boundary, sign in sides:
            limit = getattr(platform, boundary)
            if limit is not None and sign * (getattr(platform, side) - limit) >= 0:
                setattr(platform, side, limit)
                if sign * getattr(platform, change) > 0:
                    setattr(platform, change, -getattr(platform, change))
        if getattr(platform, change) != 0:
            setattr(platform, center, getattr(platform, center) + getattr(platform, change))


def _lists(sprites: Any) -> list[Any]:
    """Some lists of sprites: none, one or many."""
    if sprites is None:
        return []
    return [sprites] if isinstance(sprites, arcade.SpriteSequence) else list(sprites)


def _listed(sprites: Any) -> list[Any]:
    """The sprites of a list, without a copy if it is a `SpriteList`."""
    return sprites.sprite_list if isinstance(sprites, arcade.SpriteList) else list(sprites)


def _sides(sprite: Any) -> tuple[float, float, float, float]:
    """The bounding box of a hit box."""
    return sprite.left, sprite.bottom, sprite.right, sprite.top


def _is_box(sprite: Any) -> bool:
    """Whether a hit box is a rectangle along the axes."""
    points = sprite.hit_box.get_adjusted_points()
    corners = {(x, y) for x, _ in points for _, y in points}
    return len(points) == 4 == len(corners) and set(map(tuple, points)) == corners
