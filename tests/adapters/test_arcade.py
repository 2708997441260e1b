"""`jostle.arcade` has the results of arcade, in the order of the list."""

from itertools import combinations, product
from typing import Any

import arcade
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import jostle.arcade as ours

EVERYTHING = 3  # arcade's method that tests all sprites in turn

# Some are not convex, some are very small.
HIT_BOXES: list[Any] = [
    None,
    [(-9, -9), (9, -9), (0, 9)],
    [(-9, -9), (9, -9), (0, -3), (0, 9)],
    [(-9, 0), (0, 9), (9, 0), (0, 2)],
    [(-20, 0), (20, 0)],
    [(0, 0)],
    [],
]


def sprite(rng: np.random.Generator, spread: float) -> Any:
    """Return a sprite like those of games: at integers, or rotated, scaled and flipped."""
    x, y = rng.uniform(0, spread, 2).round(rng.integers(0, 3))
    made = arcade.SpriteSolidColor(*rng.integers(1, 30, 2).tolist(), float(x), float(y))
    shape = HIT_BOXES[rng.choice(len(HIT_BOXES), p=[0.7, *[0.05] * 6])]
    if shape is not None:
        made.hit_box = arcade.hitbox.RotatableHitBox(shape, position=made.position)
    if rng.random() < 0.5:
        made.angle = float(rng.choice([0, 30, 45, 90, rng.uniform(0, 360)]))
    if rng.random() < 0.3:
        made.scale = tuple(rng.choice([0.5, 1, 2, -1, 0], 2).tolist())
    return made


def sprites(seed: int, most: int = 60) -> Any:
    """Return a list of random sprites that needs no window."""
    rng = np.random.default_rng(seed)
    made = arcade.SpriteList(lazy=True)
    spread = rng.choice([20, 100, 300])
    for _ in range(rng.integers(0, most)):
        made.append(sprite(rng, spread))
    return made


def colliding(one: Any, others: Any) -> list[Any]:
    return arcade.check_for_collision_with_list(one, others, EVERYTHING)


seeds = st.integers(0, 2**32 - 1)


@given(seeds, seeds)
def test_all_at_once(seed: int, other_seed: int) -> None:
    a, b = sprites(seed), sprites(other_seed)
    expected = [(one, other) for one in a for other in colliding(one, b)]
    assert ours.check_for_collisions_between(a, b) == expected
    within = [(p, q) for p in a for q in colliding(p, a) if a.index(p) < a.index(q)]
    assert ours.selfcollide(a) == within
    both = [(one, other) for one in a for other in colliding(one, a)]
    assert ours.check_for_collisions_between(a, a) == both


@given(seeds)
def test_a_snapshot_answers_what_the_list_does(seed: int) -> None:
    a = sprites(seed)
    now = ours.Snapshot(a)
    assert (len(now), list(now)) == (len(a), list(a))
    rng = np.random.default_rng(seed)
    for one in [sprite(rng, 100) for _ in range(5)] + list(a)[:5]:
        assert ours.check_for_collision_with_list(one, now) == colliding(one, a)
        assert ours.check_for_collision_with_lists(one, [now, a], 3) == colliding(one, a) * 2
        assert ours.get_closest_sprite(one, now) == arcade.get_closest_sprite(one, a)


@given(seeds)
def test_points_and_rectangles(seed: int) -> None:
    a = sprites(seed)
    now = ours.Snapshot(a)
    rng = np.random.default_rng(seed)
    points = [tuple(point) for point in rng.uniform(-10, 110, (20, 2)).round(1).tolist()]
    # Corners, and points beside them: where arcade miscounts.
    for one in list(a)[:10]:
        points += [one.position, *one.hit_box.get_adjusted_points()]
        points += [(x - 40.5, y) for x, y in one.hit_box.get_adjusted_points()]
    for point in points:
        assert ours.get_sprites_at_point(point, now) == arcade.get_sprites_at_point(point, a)
        found = ours.get_sprites_at_exact_point(point, now)
        assert found == arcade.get_sprites_at_exact_point(point, a)
    for x, y in points[:20]:
        rect = arcade.LBWH(x, y, *rng.integers(0, 50, 2).tolist())
        assert ours.get_sprites_in_rect(rect, now) == arcade.get_sprites_in_rect(rect, a)


def test_tiles_that_only_touch_do_not_collide() -> None:
    places = product(range(0, 96, 16), range(0, 96, 16), (0, 90))
    tiles = [arcade.SpriteSolidColor(16, 16, x, y, angle=angle) for x, y, angle in places]
    expected = [pair for pair in combinations(tiles, 2) if arcade.check_for_collision(*pair)]
    assert ours.selfcollide(tiles) == expected
    assert len(expected) < len(tiles) * 5


def test_a_list_is_answered_by_arcade() -> None:
    a = sprites(1)
    one, rect = a[0], arcade.LBWH(0, 0, 50, 50)
    assert ours.check_for_collision_with_list(one, a) == colliding(one, a)
    at = one.position
    assert ours.get_sprites_at_point(at, a) == arcade.get_sprites_at_point(at, a)
    assert ours.get_sprites_at_exact_point(one.position, a) == [one]
    assert ours.get_sprites_in_rect(rect, a) == arcade.get_sprites_in_rect(rect, a)
    assert ours.get_closest_sprite(one, a) == (one, 0)


def test_none_at_all() -> None:
    nothing = ours.Snapshot([])
    one = arcade.SpriteSolidColor(4, 4)
    assert ours.selfcollide(nothing) == ours.check_for_collisions_between([one], nothing) == []
    assert ours.check_for_collision_with_list(one, nothing) == []
    assert ours.get_sprites_at_point((0, 0), nothing) == []
    assert ours.get_sprites_in_rect(arcade.LBWH(0, 0, 1, 1), nothing) == []
    assert ours.get_closest_sprite(one, nothing) is None


def test_a_position_that_is_no_place_is_refused() -> None:
    with pytest.raises(ValueError, match="finite"):
        ours.selfcollide([arcade.SpriteSolidColor(4, 4, float("nan"))])
