"""A window on a world of one's own."""

import numpy as np
import pytest

import jostle
import jostle_lab
from jostle_lab.cli import runs
from jostle_lab.session import Session
from jostle_lab.simulate.simulation import Simulation


def own_world() -> jostle.World:
    world = jostle.World([(0, 0), (9, 1), (3, 8)], radii=[2, 1, 3], gravity=(0, 100))
    world.walls.add([((-20, 30), (20, 30))])
    return world


def test_a_world_is_shown_and_returned_as_it_was_left(monkeypatch) -> None:
    monkeypatch.setattr(runs, "has_display", lambda: True)
    world, other = own_world(), own_world()
    before = world.snapshot()
    after = jostle_lab.show(world, size=(640, 360), steps=5)
    other.step(1 / 60, 5)
    np.testing.assert_array_equal(after.positions, other.positions)
    assert after.time == pytest.approx(5 / 60)
    assert world.snapshot() == before


def test_settings_of_an_own_world_are_not_written_as_those_of_a_scene(tmp_path) -> None:
    session = Session(Simulation.of_own(own_world(), "own"), (640, 360), synchronous=True)
    session.files.folder = tmp_path
    session.files.save_settings()
    assert session.message.endswith("it is a world without a scene, whose file is .jostle")
    assert not [*tmp_path.iterdir()]
    session.files.save()
    (path,) = session.files.scenes()
    assert len(jostle.World.load(path)) == 3


def test_without_a_display_an_error_says_so() -> None:
    with pytest.raises(RuntimeError, match=r"^no window can be opened: there is no display; jost"):
        jostle_lab.show(own_world())


def test_another_object_is_refused() -> None:
    with pytest.raises(TypeError, match=r"^world is a list; it must be a jostle\.World$"):
        jostle_lab.show([own_world()])  # type: ignore[arg-type]
