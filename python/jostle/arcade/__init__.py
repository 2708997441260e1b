"""arcade's collision functions and engines, for thousands of sprites.

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

from arcade import check_for_collision

from jostle.arcade.collisions import (
    Snapshot,
    check_for_collision_with_list,
    check_for_collision_with_lists,
    check_for_collisions_between,
    get_closest_sprite,
    get_sprites_at_exact_point,
    get_sprites_at_point,
    get_sprites_in_rect,
    selfcollide,
)
from jostle.arcade.platformer import PhysicsEnginePlatformer
from jostle.arcade.simple import PhysicsEngineSimple

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
