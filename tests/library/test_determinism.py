"""The optimised wheel reaches the states that the core's own tests have pinned."""

import re
from pathlib import Path

import pytest

import jostle

SOURCE = Path(__file__).parents[2] / "crates" / "jostle" / "tests" / "determinism.rs"
PINNED = {
    name: int(value.replace("_", ""), 16)
    for name, value in re.findall(r'\("(\w+)", (0x[0-9a-f_]+)\)', SOURCE.read_text())
}
STEP = 1 / 60
MOST = 1000
STEPS = 240


def test_every_scene_is_pinned() -> None:
    assert sorted(PINNED) == sorted(jostle.scenes.names())


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(PINNED))
def test_a_scene_ends_in_its_pinned_state(name: str) -> None:
    count = min(MOST, jostle.scenes.default_count(name))
    world = jostle.scenes.create(name, n=count)
    world.step(STEP, STEPS)
    assert f"{world.state_hash():#018x}" == f"{PINNED[name]:#018x}"


@pytest.mark.slow
def test_threads_do_not_show_in_a_large_pile() -> None:
    """A falling disc may hit one at rest while both have other impacts, in different blocks.

    Such a pair has shown the number of threads after 134 steps.
    """
    world = jostle.scenes.create("pile", n=20_000)
    world.step(STEP, 125)
    begun = world.snapshot()
    hashes = []
    for threads in (1, 2):
        world = jostle.World.restore(begun)
        world.threads = threads
        world.step(STEP, 10)
        hashes.append(world.state_hash())
    assert hashes[0] == hashes[1]


def test_threads_do_not_show_while_a_pile_lands() -> None:
    """A falling disc may hit one at rest while both have other impacts, in different blocks."""
    world = jostle.scenes.create("pile", n=6_000)
    world.step(STEP, 65)
    begun = world.snapshot()
    hashes = []
    for threads in (1, 2):
        world = jostle.World.restore(begun)
        world.threads = threads
        world.step(STEP, 12)
        assert world.collisions.pairs > 50_000
        hashes.append(world.state_hash())
    assert hashes[0] == hashes[1]
