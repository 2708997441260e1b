"""Scenes, pictures, tables, trajectories: written, read again, and refused where they are wrong."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pygame
import pytest
from lab_scenes import in_many_scenes
from outputs import table

import jostle
from jostle_lab.draw.view_options import ColourBy, TreeView
from jostle_lab.schema import Settings
from jostle_lab.session import Session
from jostle_lab.simulate.frame import Attractor
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.simulate.start import start
from jostle_lab.storage import files
from jostle_lab.storage.config import read_config
from jostle_lab.storage.files import new_path


@pytest.fixture
def session(open_session, tmp_path: Path) -> Session:
    session = open_session("gas", 60)
    session.files.folder = tmp_path / "out"
    return session


def save(session: Session, path: Path) -> None:
    """Save the scene with a name of the test's choice."""
    session.files.folder = path.parent
    session.files.save()
    session.files.scenes()[0].rename(path)


@in_many_scenes
def test_a_state_goes_on_to_the_bit(settings: Settings) -> None:
    simulation = start(settings)
    for _ in range(5):
        simulation.step()
    simulation.remove([2, 5])
    simulation.attract((Attractor(3.0, (10.0, 20.0)), Attractor(2.0, tag=7)))
    simulation.add([(50.0, 60.0)], [(1.0, 2.0)], 5.0, 2.0)
    simulation.step()
    again = Simulation.resume(simulation.save())
    assert again.settings == simulation.settings == settings
    assert again.view == simulation.view
    for _ in range(10):
        assert again.save() == simulation.save()
        simulation.step()
        again.step()
    one, other = simulation.frame(), again.frame()
    columns = ("positions", "velocities", "radii", "densities", "movable", "tags", "born")
    for name in (*columns, "kinds", "matrix"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert one.attractors == other.attractors
    assert simulation.add([(9, 9)], [(0, 0)], 1.0) == again.add([(9, 9)], [(0, 0)], 1.0)


def test_other_bytes_leave_a_simulation_as_it_was() -> None:
    simulation = start(Settings("gas", 5))
    before = simulation.save()
    for wrong in (
        b"",
        b"words",
        jostle.World([(0, 0)], 1.0).snapshot(),
        before[:-1],
        before[: len(before) // 2],
        before + b"x",
    ):
        with pytest.raises(ValueError, match=r"it is|data is"):
            simulation.load(wrong)
        assert simulation.save() == before


def attached(state: bytes, text: str) -> bytes:
    """A state with another attachment."""
    world = jostle.World.restore(state)
    world.attachment = text
    return world.snapshot()


def changed(state: bytes, **changes: object) -> bytes:
    """A state with other values in its attachment."""
    facts = json.loads(jostle.World.restore(state).attachment)
    return attached(state, json.dumps(facts | changes))


WRONG = {
    "too few times": {"born": [[0.0, 5]]},
    "too many times": {"born": [[0.0, 1e18]]},
    "half a particle": {"born": [[0.0, 19.5], [1.0, 0.5]]},
    "less than no particles": {"born": [[0.0, 21], [1.0, -1]]},
    "no times": {"born": [[float("nan"), 20]]},
    "no table of times": {"born": [0.0] * 20},
    "no attraction": {
        "pulls": [{"strength": float("nan"), "point": [0, 0], "tag": None, "passing": False}]
    },
    "nowhere": {
        "pulls": [{"strength": 1.0, "point": [0, float("inf")], "tag": None, "passing": False}]
    },
    "less than no forces": {"own_forces": -1},
    "more forces than there are": {"own_forces": 1},
    "no view": {"view": [0, 0, float("nan"), 1]},
    "other walls": {"home": {"view": [0, 0, 1, 1], "rect": [0, 0, 1, 1], "kind": "cone", "n": 3}},
    "half a number": {
        "home": {"view": [0, 0, 1, 1], "rect": [0, 0, 1, 1], "kind": "box", "n": 2.5}
    },
    "a method that there is not": {
        "settings": {**asdict(Settings("gas", 20)), "method": "article-brute"}
    },
}


@pytest.mark.parametrize("changes", WRONG.values(), ids=list(WRONG))
def test_a_state_with_a_wrong_value_leaves_a_simulation_as_it_was(changes: dict) -> None:
    simulation = start(Settings("gas", 20))
    before = simulation.save()
    assert changed(before) == before
    with pytest.raises(ValueError, match=r"\w+ \w+ \w+"):
        simulation.load(changed(before, **changes))
    assert simulation.save() == before


@in_many_scenes
def test_a_saved_scene_comes_back_with_all_that_belongs_to_it(tmp_path: Path, settings) -> None:
    first = Session(start(settings), (640, 360), synchronous=True)
    for _ in range(5):
        first.engine.step()
    first.camera.zoom_at((100, 100), 2.0)
    first.view_options.tree, first.view_options.colour_by = TreeView.FILLED, ColourBy.MASS
    first.view_options.velocities = True
    save(first, tmp_path / "one.jostle")
    second = Session(start(Settings("rain", 5)), (1280, 720), synchronous=True)
    second.files.load(tmp_path / "one.jostle")
    assert second.message == "Loaded one.jostle"
    assert second.settings == first.settings
    assert second.engine.simulation.save() == first.engine.simulation.save()
    assert second.view_options.tree == TreeView.FILLED
    assert second.view_options.colour_by == ColourBy.MASS
    assert second.view_options.velocities
    assert second.camera.scale == pytest.approx(2 * first.camera.scale)
    assert second.camera.center == pytest.approx(first.camera.center)
    for _ in range(3):
        first.engine.step()
        second.engine.step()
    assert second.engine.simulation.save() == first.engine.simulation.save()


def test_files_have_names_of_their_own_and_a_notice_says_where_they_are(
    session: Session, tmp_path: Path
) -> None:
    for _ in range(3):
        session.files.save()
        session.files.screenshot()
    names = {path.name for path in session.files.folder.iterdir()}
    assert len(names) == 6
    assert all(name.startswith("gas-") for name in names)
    session.files.save()
    assert session.message == f"Saved {session.files.scenes()[0]}"
    assert len(session.files.scenes()) == 4
    path = new_path(tmp_path, "../a b/c", ".png")
    assert path.parent == tmp_path and path.name.startswith("-a-b-c-")


def test_a_world_that_no_window_has_saved_is_opened_and_begins_again(tmp_path: Path) -> None:
    world = jostle.World([(0, 0), (30, 0)], 1.0, velocities=[(10, 0), (0, 0)])
    world.save(tmp_path / "own.jostle")
    session = Session(start(Settings("gas", 5)), (640, 360), synchronous=True)
    session.files.load(tmp_path / "own.jostle")
    assert session.message == "Loaded own.jostle" and len(session.frame) == 2
    x0, y0, x1, y1 = session.engine.view
    assert x0 < -1 and x1 > 31 and y0 < -1 and y1 > 1
    for _ in range(3):
        session.engine.step()
    assert session.frame.positions[0, 0] > 0
    session.files.save()  # with a name that no scene has
    session.files.load(session.files.scenes()[0])
    assert session.frame.positions[0, 0] > 0
    session.runner.restart()
    session.engine.wait()
    assert session.frame.stats.time > 0, "it begins where it was loaded"
    session.close()


def wrong_files(folder: Path, session: Session) -> dict[str, Path]:
    save(session, folder / "good.jostle")
    good = (folder / "good.jostle").read_bytes()
    bad = {
        "empty.jostle": b"",
        "picture.jostle": b"\x89PNG\r\n\x1a\n" + bytes(100),
        "cut.jostle": good[: len(good) // 2],
        "bent.jostle": good[:400] + bytes([good[400] ^ 1]) + good[401:],
        "longer.jostle": good + b"x",
    }
    text = jostle.World.restore(good).attachment
    for name, (old, new) in {
        "setting": ('"seed": 0', '"seeb": 0'),
        "value": ('"seed": 0', '"seed": []'),
        "shown": ('"outline"', '"outlime"'),
        "camera": ('"at_home"', '"at_hame"'),
    }.items():
        assert text.count(old) == 1
        bad[f"{name}.jostle"] = attached(good, text.replace(old, new))
    window = json.loads(text)["window"]
    for name, other in {
        "scale": {"scale": float("nan")},
        "scaled-to-nothing": {"scale": 0},
        "scaled-beyond": {"scale": 1e308, "size": [1e-9, 1e-9]},
        "turned": {"scale": -1.0},
        "nowhere": {"center": [0, float("nan")], "at_home": False},
        "no-screen": {"size": [0, 0]},
        "words": {"scale": "wide"},
    }.items():
        camera = window["camera"] | other
        bad[f"{name}.jostle"] = changed(good, window=window | {"camera": camera})
    bad["deep.jostle"] = attached(good, "[" * 100_000)
    for name, data in bad.items():
        (folder / name).write_bytes(data)
    return {name: folder / name for name in (*bad, "missing.jostle")}


SAID = {
    "picture.jostle": "holds 108 bytes of something else; it does not begin as a snapshot does",
    "plain.jostle": "it is a world without a scene of the simulator",
    "deep.jostle": "its attachment is not of the simulator",
    "setting.jostle": "settings.seeb is not a setting; did you mean seed?",
    "shown.jostle": "shown.tree is 'outlime'; it must be 'off', 'outline'",
    "nowhere.jostle": "window.camera.center[1] is nan; it must be at most 1e+30",
}


def test_wrong_files_are_refused_in_a_sentence_and_nothing_is_lost(session, tmp_path) -> None:
    for name, path in wrong_files(tmp_path, session).items():
        before = session.engine.simulation, session.engine.simulation.save()
        looks = session.camera.center, session.camera.scale, session.view_options.tree
        session.messages.say("nothing")
        session.files.load(path)
        assert session.message.startswith(name), name
        assert len(session.message) < 200 and SAID.get(name, "") in session.message
        assert before == (session.engine.simulation, session.engine.simulation.save())
        assert looks == (session.camera.center, session.camera.scale, session.view_options.tree)
    session.files.load(tmp_path / "good.jostle")
    assert session.message == "Loaded good.jostle"


def test_a_screenshot_is_the_picture_and_an_export_that_fails_becomes_a_notice(
    session: Session, monkeypatch
) -> None:
    session.files.screenshot()
    (path,) = session.files.folder.glob("*.png")
    picture = pygame.image.load(path)
    assert picture.get_size() == (640, 360)
    assert len(np.unique(pygame.surfarray.array2d(picture))) > 30

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files, "write_states", full)
    session.files.export_csv()
    session.advance(0.0)  # shows the results
    assert "No space left" in session.message


def test_csv_has_every_particle_and_the_sums_over_time(session: Session) -> None:
    session.engine.edit(lambda simulation: simulation.remove([0, 5]))
    for _ in range(60):
        session.messages.now += 1 / 60
        session.advance(1 / 60)
    session.files.export_csv()
    session.advance(0.0)  # shows the results
    energies, positions = sorted(
        session.files.folder.glob("*.csv"), key=lambda path: -len(path.name)
    )
    assert session.message == f"Saved {positions}"
    rows, sums, frame = table(positions), table(energies), session.frame
    assert list(rows[0]) == ["time", "id", "x", "y", "vx", "vy", "radius", "mass"]
    found = np.array([[float(value) for value in row.values()] for row in rows], np.float32)
    columns = (frame.tags, frame.positions, frame.velocities, frame.radii, frame.masses)
    np.testing.assert_array_equal(found[:, 1:], np.column_stack(columns))
    assert len(sums) == len(session.runner.statistics.sums) > 5
    assert {"time", "kinetic", "potential", "momentum_x"} <= set(sums[0])
    assert float(sums[-1]["kinetic"]) == session.runner.statistics.sums["kinetic"][-1]


def test_settings_that_were_tuned_in_the_window_are_a_file_to_run(session: Session) -> None:
    for name, value in (("gravity", (3.0, 40.0)), ("drag", 0.25), ("n", 50), ("substeps", 3)):
        session.runner.adjust(name, value)
    session.view_options.trails = True
    session.files.save_settings()
    (path,) = session.files.folder.glob("gas-*.toml")
    assert session.message == f"Saved {path}"
    config = read_config(path)
    assert config.settings == session.settings and config.view_options["trails"] is True
    world = start(config.settings).world
    assert world.gravity.tolist() == [3, 40] and (world.drag, len(world)) == (0.25, 50)


def test_csv_of_nothing(session: Session) -> None:
    session.runner.begin(Settings("gas", 0))
    session.files.export_csv()
    session.advance(0.0)  # shows the results
    positions = min(session.files.folder.glob("*.csv"), key=lambda path: len(path.name))
    assert positions.read_text() == "time,id,x,y,vx,vy,radius,mass\n"


def test_gsd_has_ten_states_a_second_and_the_last_is_the_present_one(session: Session) -> None:
    import gsd.hoomd as gsd_hoomd

    for step in range(60):
        if step == 30:
            session.engine.edit(lambda simulation: simulation.remove([0, 5]))
        session.engine.step()
    session.engine.edit(lambda simulation: simulation.change([7], movable=False))
    session.files.export_gsd()
    session.advance(0.0)  # shows the results
    (path,) = session.files.folder.glob("*.gsd")
    with gsd_hoomd.open(str(path), "r") as trajectory:
        assert 9 <= len(trajectory) <= 12
        counts = [snapshot.particles.N for snapshot in trajectory]
        assert counts[0] == 60 and counts[-1] == 58
        last = trajectory[-1]
        np.testing.assert_array_equal(last.log["particles/id"], session.frame.tags)
        assert last.log["time"] == pytest.approx(1.0)
        kinds = np.array(last.particles.types)[last.particles.typeid]
        np.testing.assert_array_equal(kinds == "fixed", session.frame.tags == 7)
