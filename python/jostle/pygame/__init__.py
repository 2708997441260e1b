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

import pygame
from pygame.sprite import (
    collide_circle,
    collide_circle_ratio,
    collide_mask,
    collide_rect,
    collide_rect_ratio,
)

if not hasattr(pygame, "FRect"):
    raise ImportError("jostle.pygame needs pygame-ce; what is installed here is pygame")

from jostle.pygame.collisions import (
    groupcollide,
    prefilter,
    selfcollide,
    spritecollide,
    spritecollideany,
)
from jostle.pygame.groups import Group, Snapshot
from jostle.pygame.rects import collide_rect_lists, collide_rect_objects
from jostle.sprites import Prefilter

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
