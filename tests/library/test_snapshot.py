"""`World.snapshot`, `restore`, `save` and `load`: a world in bytes and in files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from copies import WAYS
from signals import lets_others_run

import jostle

STEP = 1 / 60
FILES = Path(__file__).parent / "data"  # written by crates/jostle/tests/snapshot_format.rs
TEXT = json.dumps({"name": "µ 🎱", "view": [0, 1.5]}, ensure_ascii=False)


def pile() -> jostle.World:
    """Discs in resting contact, with a force and various settings."""
    world = jostle.scenes.create("pile", n=200)
    world.forces = [
        jostle.Springs([(3, 4), (5, 6)], 20, 5, damping=0.1, max_stretch=[1e-3, 500]),
        jostle.Attractor(particle=7, strength=0.01),
    ]
    world.threads, world.substeps, world.leaf_capacity, world.drag = 2, 3, 17, 0.01
    world.step(STEP, steps=60)
    return world


def assert_same(a: jostle.World, b: jostle.World) -> None:
    assert a.state_hash() == b.state_hash()
    assert (a.time, a.forces, a.container) == (b.time, b.forces, b.container)
    for name in ("threads", "substeps", "leaf_capacity", "drag", "gravity", "on_touch", "method"):
        np.testing.assert_equal(getattr(a, name), getattr(b, name))
    assert a.last_step.contacts == b.last_step.contacts


def through_file(world: jostle.World) -> jostle.World:
    world.save(Path("a world"))
    return jostle.World.load("a world")


@pytest.mark.parametrize(
    "way", [lambda world: jostle.World.restore(world.snapshot()), through_file, *WAYS]
)
def test_a_restored_world_goes_on_to_the_bit(
    way: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    world = pile()
    world.attachment = TEXT
    again = way(world)
    assert again is not world
    assert again.attachment == TEXT
    assert_same(again, world)
    for each in (world, again):
        each.remove([1])
        each.step(STEP, steps=100)
    assert_same(again, world)
    assert again.stats == world.stats


def test_statistics_are_those_of_steps_after_the_snapshot() -> None:
    world = pile()
    assert world.stats.tests > 0
    again = jostle.World.restore(world.snapshot())
    assert again.stats == jostle.Stats(0, 0, 0, 0)


def test_a_text_is_no_part_of_the_state() -> None:
    world = pile()
    assert world.attachment is None
    before, size = world.state_hash(), len(world.snapshot())
    for text in ("", TEXT, None):
        world.attachment = text
        assert world.attachment == text
        assert world.state_hash() == before
    assert len(world.snapshot()) == size
    world.attachment = TEXT
    for wrong, error in ((3, TypeError), (b"{}", TypeError), ("\udcff", UnicodeEncodeError)):
        with pytest.raises(error):
            world.attachment = wrong  # type: ignore[assignment]
        assert world.attachment == TEXT
    with pytest.raises(TypeError, match=r"^attachment must be str or None, not int$"):
        world.attachment = 3  # type: ignore[assignment]


def test_files_of_this_format_can_be_loaded() -> None:
    world = jostle.World.load(FILES / "snapshot-asleep.jostle")
    assert world.ids.tolist() == [0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 11]
    assert world.asleep.tolist() == [True] * 6 + [False] + [True] * 2 + [False] * 2
    assert [type(force).__name__ for force in world.forces] == ["Springs", "Motor"]
    assert json.loads(str(world.attachment)) == {"name": "µ"}
    assert world.add((1, 1), 0.5) == 12 and world.radii[-1] == 0.5
    world = jostle.World.load(FILES / "snapshot-forces.jostle")
    assert len(world.forces) == 11 and world.walls.velocities.tolist() == [[0.25, 0], [0, 0]]
    assert world.sensors.tolist() == [False, True, False, False, False, False]


def test_other_bytes_like_objects() -> None:
    data = pile().snapshot()
    assert isinstance(data, bytes)
    for same in (bytearray(data), memoryview(data)):
        assert jostle.World.restore(same).snapshot() == data


@pytest.mark.parametrize(("data", "kind"), [("words", "str"), (5, "int")])
def test_what_is_no_bytes_is_refused(data: Any, kind: str) -> None:
    with pytest.raises(TypeError, match=f"^data must be bytes, not {kind}"):
        jostle.World.restore(data)


def test_files_raise_what_python_raises(tmp_path: Path) -> None:
    missing = tmp_path / "missing"
    with pytest.raises(FileNotFoundError) as caught:
        jostle.World.load(missing)
    assert (Path(caught.value.filename), caught.value.errno) == (missing, 2)
    with pytest.raises(FileNotFoundError):
        pile().save(missing / "world")
    with pytest.raises(OSError, match="directory"):
        pile().save(tmp_path)
    with pytest.raises(OSError, match="directory"):
        jostle.World.load(tmp_path)
    assert [*tmp_path.iterdir()] == []
    assert [*tmp_path.parent.glob("*.part")] == []


def test_other_threads_run_meanwhile() -> None:
    world = jostle.scenes.create("gas", n=2_000_000)
    assert lets_others_run(lambda: jostle.World.restore(world.snapshot()))


def test_worlds_with_enormous_impulses_can_be_restored() -> None:
    """Impulses above the largest number of float32 are counted as that, so sums are never NaN."""
    rng = np.random.default_rng(1)
    finite = 0
    for _ in range(20):
        world = jostle.World(
            rng.uniform(1, 5, (3, 2)),
            0.4,
            velocities=rng.normal(0, 1e12, (3, 2)),
            masses=1e30,
            friction=0.7,
            restitution=1.0,
            container=jostle.Box(0, 0, 6, 6),
        )
        world.step(3e-11)
        impulses = world.last_step.wall_contacts.friction_impulses
        assert np.isfinite(impulses).all()
        finite += len(impulses)
        assert jostle.World.restore(world.snapshot()).state_hash() == world.state_hash()
    assert finite > 0


def test_walls_that_were_stopped_keep_what_rounding_removed() -> None:
    """A restored world continues with the same bits."""
    walls = {"segments": [((-5, 5), (5, 5.3))], "velocities": (0, -0.1)}
    world = jostle.World([(0, 0)], 1.0, velocities=[(0, 3)], walls=walls)
    world.step(1 / 60, steps=10)
    world.walls.velocities = (0, 0)
    other = jostle.World.restore(world.snapshot())
    for each in (world, other):
        each.step(1 / 60, steps=120)
    assert world.state_hash() == other.state_hash()
