"""Categories and masks in `find_pairs` and in a `World`."""

import re
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracle import ALL_BITS, Shapes, by_row, may_pair, pairs_within

import jostle

STEP = 1 / 60
ROCK, GHOST = 1, 2


def world_of(n: int, seed: int, **arguments: Any) -> jostle.World:
    """Discs that overlap many others, in a box with gravity."""
    rng = np.random.default_rng(seed)
    side = np.sqrt(n)
    arguments = {
        "gravity": (0, 5),
        "restitution": 0.5,
        "container": jostle.Box(0, 0, side, side),
        **arguments,
    }
    return jostle.World(
        rng.uniform(0, side, (n, 2)),
        rng.uniform(0.2, 0.5, n),
        velocities=rng.uniform(-3, 3, (n, 2)),
        **arguments,
    )


@given(st.integers(0, 2**32 - 1), st.sampled_from(["quadtree", "brute"]))
def test_only_pairs_that_may_touch_do(seed: int, method: Any) -> None:
    n = 60
    bits = np.random.default_rng(seed).integers(0, 8, (2, n)).astype(np.uint32)
    world = world_of(n, seed, categories=bits[0], masks=bits[1], method=method)
    allowed = may_pair(bits[0], bits[1], bits[0], bits[1])
    shapes = Shapes(world.positions, world.radii, None)
    world.on_touch = "ignore"
    expected = pairs_within(shapes, allowed)
    np.testing.assert_array_equal(by_row(world.last_step.contacts.pairs), expected)
    np.testing.assert_array_equal(by_row(world.pairs()), expected)
    world.on_touch = "bounce"
    for _ in range(5):
        world.step(STEP)
        pairs = world.last_step.contacts.pairs
        assert allowed[pairs[:, 0], pairs[:, 1]].all()


def test_they_are_columns() -> None:
    world = jostle.World(np.zeros((3, 2)), 1.0)
    assert world.categories.tolist() == [1, 1, 1] and world.masks.tolist() == [ALL_BITS] * 3
    assert world.masks.dtype == world.categories.dtype == np.uint32
    assert not world.masks.flags.writeable
    world.categories = GHOST
    world.masks = [1, 2, -1]
    assert world.add([(5, 5)], 1.0, categories=7).tolist() == [3]
    world.set([0, 1], categories=[4, 8], masks=~8)
    assert world.categories.tolist() == [4, 8, GHOST, 7]
    assert world.masks.tolist() == [ALL_BITS - 8] * 2 + [ALL_BITS] * 2
    world.remove(0)
    again = jostle.World.restore(world.snapshot())
    np.testing.assert_array_equal(again.categories, [8, GHOST, 7])
    np.testing.assert_array_equal(again.masks, world.masks)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"categories": [1, 2]}, ValueError, "categories has shape (2,); it must be"),
        ({"masks": 2**32}, ValueError, "masks is 4294967296; "),
        ({"masks": [0, 0, 2**32]}, ValueError, "masks[2] is 4294967296; "),
        ({"categories": 1.0}, TypeError, "categories must hold integers, not float"),
        ({"masks": [[1, 1, 1]]}, ValueError, "masks has shape (1, 3)"),
    ],
)
def test_wrong_ones_are_refused(
    arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    points = [(0, 0), (1, 0), (9, 0)]
    still = np.zeros((3, 2))
    world = jostle.World(points, 1.0, velocities=still)
    before = world.snapshot()
    for call in (
        lambda: jostle.find_pairs(points, 1.0, **arguments),
        lambda: jostle.World(points, 1.0, velocities=still, **arguments),
        lambda: world.add(points, 1.0, velocities=still, **arguments),
        lambda: world.set([0, 1, 2], **arguments),
        *(partial(setattr, world, *item) for item in arguments.items()),
    ):
        with pytest.raises(error, match=f"^{re.escape(message)}"):
            call()
    assert world.snapshot() == before


def test_discs_that_may_not_touch_cost_nothing() -> None:
    """Two dense clouds of bullets, which do not hit each other."""
    for of_all in (0, 1):
        world = world_of(20_000, 1, categories=GHOST, masks=ROCK * of_all, restitution=1.0)
        world.step(STEP)
        assert world.stats.tests == 0
    world.masks = ROCK | GHOST
    world.step(STEP)
    assert world.stats.tests > 20_000


def test_a_platform_that_only_some_stand_on() -> None:
    """An immovable disc with a category that only one of two may touch."""
    world = jostle.World(
        [(0, 0), (0, 2.5), (0.0, 5)],
        1.0,
        movable=[False, True, True],
        gravity=(0, -9.8),
        restitution=0.3,
        categories=[GHOST, ROCK, GHOST],
        masks=[-1, ROCK, -1],
    )
    world.step(STEP, steps=180)
    assert world.positions[1, 1] < -9, "it falls through"
    assert world.positions[2, 1] == pytest.approx(2, abs=0.02), "it rests"
