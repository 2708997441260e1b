"""`jostle.pygame` on pairs of sprites that touch within a millionth of a pixel."""

import math
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pygame
import pytest
from pygame import FRect, Rect
from pygame.sprite import collide_circle, collide_circle_ratio, collide_rect, collide_rect_ratio

import jostle.pygame as ours

Pair = tuple[Any, Any]
NEAR = 1e-6
"""How close to touching, in pixels."""


def sprite(rect: Any, radius: float | None = None) -> Any:
    made: Any = pygame.sprite.Sprite()
    made.rect = rect
    if radius is not None:
        made.radius = radius
    return made


def some_rect(draw: random.Random, kind: type, spread: float) -> Any:
    numbers = [draw.uniform(-spread, spread) for _ in range(2)]
    return kind(*numbers, draw.uniform(1, spread / 8), draw.uniform(1, spread / 8))


def kinds(draw: random.Random) -> tuple[type, type]:
    return draw.choice([(FRect, FRect), (FRect, FRect), (FRect, Rect), (Rect, FRect), (Rect, Rect)])


def circles_with_radius(draw: random.Random, ratio: float) -> Pair:
    """Two circles; the second radius makes them touch."""
    a, b = (some_rect(draw, kind, draw.choice([8, 900, 30_000])) for kind in kinds(draw))
    distance = math.hypot(a.centerx - b.centerx, a.centery - b.centery)
    radius = draw.uniform(0, distance / ratio)
    radius = draw.choice([radius, math.floor(radius)])
    other = (distance + draw.uniform(-NEAR, NEAR)) / ratio - radius
    return sprite(a, radius), sprite(b, other)


def circles_without_radius(draw: random.Random, ratio: float) -> Pair:
    """Two FRects near the origin; the second one's place makes their circles touch."""
    a, b = some_rect(draw, FRect, 4), FRect(0, 0, draw.uniform(0.1, 1), draw.uniform(0.1, 1))
    reach = ratio * (math.hypot(*a.size) + math.hypot(*b.size)) / 2
    angle = draw.uniform(0, math.tau)
    b.x = a.centerx + reach * math.cos(angle) - b.w / 2 + draw.uniform(-NEAR, NEAR)
    b.y = a.centery + reach * math.sin(angle) - b.h / 2
    return sprite(a), sprite(b)


def some_circles(ratio: float) -> Callable[[random.Random], Pair]:
    ways = (circles_with_radius, circles_with_radius, circles_without_radius)
    return lambda draw: draw.choice(ways)(draw, ratio)


def some_rects(ratio: float) -> Callable[[random.Random], Pair]:
    """Return a maker of two rects side by side once they are scaled, a few float32 apart."""

    def make(draw: random.Random) -> Pair:
        left, right = kinds(draw)
        a, b = (some_rect(draw, kind, draw.choice([8, 900, 30_000])) for kind in (left, right))
        b.y = a.y
        edge = np.float32(a.x + a.w + (a.w + b.w) * (ratio - 1) / 2)
        for _ in range(draw.randint(0, 2)):
            edge = np.nextafter(edge, np.float32(draw.choice([-1e9, 1e9])))
        b.x = float(edge)
        return draw.choice([(sprite(a), sprite(b)), (sprite(b), sprite(a))])

    return make


RULES: dict[str, tuple[Any, Callable[[random.Random], Pair]]] = {
    "none": (None, some_rects(1)),
    "rect": (collide_rect, some_rects(1)),
    "rect ratio 1.3": (collide_rect_ratio(1.3), some_rects(1.3)),
    "rect ratio 0.7": (collide_rect_ratio(0.7), some_rects(0.7)),
    "prefilter": (ours.prefilter(collide_rect), some_rects(1)),
    "circle": (collide_circle, some_circles(1)),
    "circle ratio 1.7": (collide_circle_ratio(1.7), some_circles(1.7)),
    "circle ratio 0.6": (collide_circle_ratio(0.6), some_circles(0.6)),
    "circle ratio 3": (collide_circle_ratio(3), some_circles(3)),
}


@pytest.mark.parametrize("rule", RULES)
def test_pairs_that_touch_within_a_millionth_of_a_pixel(rule: str) -> None:
    """2,500 pairs for each rule, 22,500 in all; pygame is called on copies.

    Edges of rects, which are float32, are at most two numbers of that type apart.
    """
    collided, make = RULES[rule]
    draw = random.Random(rule)
    theirs = collide_rect if collided is None or rule == "prefilter" else collided
    wrong, hits = [], 0
    for _ in range(2_500):
        a, b = make(draw)
        copies = [sprite(s.rect.copy(), getattr(s, "radius", None)) for s in (a, b)]
        want = bool(theirs(*copies))
        hits += want
        if bool(ours.selfcollide([a, b], collided)) != want:
            wrong.append((a.rect, b.rect, vars(a).get("radius"), vars(b).get("radius"), want))
        assert [vars(s).get("radius") for s in (a, b)] == [vars(s).get("radius") for s in copies]
    assert wrong == []
    assert 250 < hits < 2_250, "the pairs do not lie on both sides of touching"


@pytest.mark.parametrize("rule", RULES)
def test_no_candidate_is_missed_in_groups_of_touching_pairs(rule: str) -> None:
    """Enough sprites for trees."""
    collided, make = RULES[rule]
    draw = random.Random(rule)
    pairs = [make(draw) for _ in range(150)]
    left, right = ([pair[k] for pair in pairs] for k in (0, 1))
    want = pygame.sprite.groupcollide(left, right, False, False, collided)
    assert ours.groupcollide(left, right, False, False, collided) == want


def test_the_centre_of_an_frect_is_a_double() -> None:
    a = sprite(FRect(509.6, 215.8, 3.4, 2), 1)
    b = sprite(FRect(650.6, 730.2, 36.8, 44), 557.141962266652)
    for library in (pygame.sprite, ours):
        assert library.groupcollide([a], [b], False, False, collide_circle) == {a: [b]}
        assert library.spritecollide(b, [a], False, collide_circle) == [a]
