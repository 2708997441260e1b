"""arcade's engine for platformers: gravity, jumps, ladders and platforms that move."""

from __future__ import annotations

from itertools import chain
from typing import Any

import arcade
import numpy as np
from numpy.typing import NDArray

from jostle.arcade.simple import WALL, PhysicsEngineSimple, lists_of, sides_of, sprites_of

_AXES = (
    ("change_x", "center_x", (("left", "boundary_left", -1), ("right", "boundary_right", 1))),
    ("change_y", "center_y", (("top", "boundary_top", 1), ("bottom", "boundary_bottom", -1))),
)


class PhysicsEnginePlatformer(PhysicsEngineSimple):
    """arcade's engine for platformers, with continuous motion.

    The player falls, stands on walls and platforms, and is carried by platforms. It climbs ramps of
    at most 45° and steps that are not higher than `change_x`. Platforms move by ``change_x`` and
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
        Sprites that do not move. Each update reads which sprites are in these lists; call
        `read_walls` after some have moved.

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
        self.platforms = lists_of(platforms)
        self.ladders = lists_of(ladders)
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
        left, bottom, right, top = sides_of(self.player_sprite)
        area = (left, bottom - y_distance, right, top)
        is_above_floor = len(self._space.query_rect(area, mask=WALL)) > 0
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
        return [sprites_of(sprites) for sprites in chain(self._walls, self.platforms)]

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
        known, self._offsets = self._offsets, {}
        for sprite in chain.from_iterable(self.platforms):
            centers = self._space.get(self._ids[sprite]).positions
            self._offsets[sprite] = known.get(sprite, centers - sprite.position)
        self._moving = list(self._offsets)
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
                setattr(platform, change, -sign * abs(getattr(platform, change)))
        setattr(platform, center, getattr(platform, center) + getattr(platform, change))
