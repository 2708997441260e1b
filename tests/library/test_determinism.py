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


@pytest.mark.parametrize(
    ("n", "fallen", "steps", "collisions"),
    [(6_000, 65, 12, 50_000), pytest.param(20_000, 125, 10, 10_000, marks=pytest.mark.slow)],
)
def test_threads_do_not_show_while_a_pile_lands(
    n: int, fallen: int, steps: int, collisions: int
) -> None:
    """A falling disc may hit one at rest while both have other impacts, in different blocks.

    In the larger pile such a pair has shown the number of threads after 134 steps.
    """
    world = jostle.scenes.create("pile", n=n)
    world.threads = 1
    world.step(STEP, fallen)
    begun = world.snapshot()
    hashes = []
    for threads in (1, 2):
        world = jostle.World.restore(begun)
        world.threads = threads
        world.step(STEP, steps)
        assert world.last_call.collisions > collisions
        hashes.append(world.state_hash())
    assert hashes[0] == hashes[1]
