"""arcade's engine for games seen from above, on `jostle.Space.move_and_slide`."""

from __future__ import annotations

from itertools import chain
from typing import Any

import arcade
import numpy as np
from numpy.typing import NDArray

from jostle._core import Space
from jostle.results import Slide
from jostle.walls import polyline

WALL, _PLAYER = 1, 2
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
        Sprites that do not move. Each update reads which sprites are in these lists; call
        `read_walls` after some have moved.

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
        self._walls = lists_of(walls)
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
        return [sprites_of(sprites) for sprites in self._walls]

    def _slide(self, **options: Any) -> list[Slide]:
        """Move the player by its velocity, first along y, then along x, as arcade does."""
        self._read_changes()
        player = self.player_sprite
        low, high = np.reshape(sides_of(player), (2, 2))
        self._space.set(self._player, positions=(low + high) / 2, half_sizes=(high - low) / 2)
        options = {"mask": WALL, "up": self._up, **options}
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
        sides = np.reshape([sides_of(sprite) for sprite in boxes], (-1, 4))
        ids = self._space.add(boxes=sides, categories=WALL)
        self._ids.update(zip(boxes, ids[:, None], strict=True))
        for sprite in new:
            if sprite not in self._ids:
                points = sprite.hit_box.get_adjusted_points()
                segments = polyline(points, closed=len(points) > 2)
                self._ids[sprite] = self._space.add(segments=segments, categories=WALL)
        self._sprites = {id: sprite for sprite, ids in self._ids.items() for id in ids.tolist()}


def lists_of(sprites: Any) -> list[Any]:
    """Some lists of sprites: none, one or many."""
    if sprites is None:
        return []
    return [sprites] if isinstance(sprites, arcade.SpriteSequence) else list(sprites)


def sprites_of(sprites: Any) -> list[Any]:
    """The sprites of a list, without a copy if it is a `SpriteList`."""
    return sprites.sprite_list if isinstance(sprites, arcade.SpriteList) else list(sprites)


def sides_of(sprite: Any) -> tuple[float, float, float, float]:
    """The bounding box of a hit box."""
    return sprite.left, sprite.bottom, sprite.right, sprite.top


def _is_box(sprite: Any) -> bool:
    """Whether a hit box is a rectangle along the axes."""
    points = sprite.hit_box.get_adjusted_points()
    corners = {(x, y) for x, _ in points for _, y in points}
    return len(points) == 4 == len(corners) and set(map(tuple, points)) == corners
