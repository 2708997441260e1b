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
