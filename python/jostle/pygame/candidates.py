"""Which pairs of sprites or rects collide by the rules of pygame, or have to be tested."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

import numpy as np
import pygame
from numpy.typing import NDArray
from pygame.sprite import (
    collide_circle,
    collide_circle_ratio,
    collide_mask,
    collide_rect,
    collide_rect_ratio,
)

from jostle._core import sprite_pairs
from jostle.sprites import Collided, Near, Prefilter, Radii

Rule: TypeAlias = Literal["rect", "circle", "mask", "within"]

RECTS = (pygame.Rect, pygame.FRect)
_LARGEST_RATIO = 1e6


def find_near(left: list[Any], right: list[Any] | None, collided: Collided | None) -> Near | None:
    """Find the pairs that collide or have to be tested; None if only pygame can decide."""
    rule = rule_of(collided)
    if rule is None:
        return None
    radii = Radii()
    found = sprite_pairs(left, right, *rule, RECTS, radii)
    if found is None:
        return None
    ask = collided.collided if isinstance(collided, Prefilter) else collided
    return Near(*found, ask, radii)


def rule_of(collided: Collided | None) -> tuple[Rule, float] | None:
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


def pairs_of_rects(asked: list[Any], things: list[Any]) -> NDArray[np.uint32] | None:
    """Find the overlaps of rects and things; None if only pygame can decide."""
    if not all(isinstance(rect, RECTS) for rect in asked):
        return None
    rects = []
    for thing in things:
        rect = thing if isinstance(thing, RECTS) else getattr(thing, "rect", None)
        # pygame reads a sequence as a rect before it reads the attribute `rect`.
        if not isinstance(rect, RECTS) or (rect is not thing and hasattr(thing, "__getitem__")):
            return None
        rects.append(rect)
    found = sprite_pairs(asked, rects, "rects", 1.0, RECTS)
    return None if found is None else found[0]
