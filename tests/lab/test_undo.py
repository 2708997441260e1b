"""Undo and redo of every edit, and edits that are kept when the window is closed."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pygame
import pytest
from lab_interaction import FRAME, Driver, post, world_of

from jostle_lab.act.interaction import Tool
from jostle_lab.schema import Settings
from jostle_lab.simulate.history import Undo
from jostle_lab.simulate.start import start
from jostle_lab.storage.files import autosave_path

CTRL, SHIFT = pygame.KMOD_LCTRL, pygame.KMOD_LSHIFT
PLACES = [(100, 100), (300, 100), (500, 100), (700, 400)]

Edit = Callable[[Driver], object]


def state_of(driver: Driver) -> bytes:
    driver.session.engine.wait()
    return driver.session.engine.simulation.save()


def draw(tool: Tool, start: tuple[int, int], end: tuple[int, int]) -> Edit:
    def edit(driver: Driver) -> None:
        driver.session.interaction.choose(tool)
        driver.drag(start, end)

    return edit


def throw(driver: Driver) -> None:
    driver.down((300, 100))
    for x in (320, 360, 400):
        driver.move(driver.pixel((x, 100)))
        driver.frames(1)
    driver.up((400, 100))


def hold_space(driver: Driver) -> None:
    driver.key(pygame.K_SPACE, up=False)
    driver.frames(3)
    driver.key_up(pygame.K_SPACE)


def press(key: int, point: tuple[int, int] = (600, 300)) -> Edit:
    def edit(driver: Driver) -> None:
        driver.point_at(point)
        driver.key(key)

    return edit


def call(method: str, *arguments: object, **options: object) -> Edit:
    """Return the call of a method of the session's parts."""
    *path, name = method.split(".")

    def edit(driver: Driver) -> None:
        part: object = driver.session
        for each in path:
            part = getattr(part, each)
        getattr(part, name)(*arguments, **options)

    return edit


ONE = np.array([1])
EDITS = {
    "add": press(pygame.K_a),
    "clone": press(pygame.K_d, (300, 100)),
    "delete": press(pygame.K_DELETE, (300, 100)),
    "throw": throw,
    "brush": draw(Tool.BRUSH, (200, 300), (600, 300)),
    "wall": draw(Tool.WALL, (200, 300), (600, 300)),
    "attractor": draw(Tool.ATTRACTOR, (200, 300), (205, 300)),
    "attract": hold_space,
    "gravity key": press(pygame.K_PLUS),
    "gravity": call("runner.adjust", "gravity", (3.0, 4.0)),
    "count": call("runner.adjust", "n", 7),
    "container": call("runner.adjust", "container", "circle"),
    "size": call("runner.adjust", "world_size", 1.5),
    "friction": call("runner.adjust", "friction", 0.3),
    "stop": call("interaction.commands.stop", ONE),
    "fix": call("interaction.commands.fix", ONE, movable=False),
    "filter": call("interaction.commands.set_bit", ONE, "masks", 3, on=False),
    "scatter": call("interaction.commands.scramble"),
    "attracting": call("interaction.attractors.set_attracting", ONE, True),
}


@pytest.mark.parametrize("name", EDITS)
def test_undo_brings_back_exactly_the_state_before_an_edit_and_redo_the_one_after(
    name: str,
) -> None:
    driver = Driver(world_of(PLACES, gravity=(0.0, 10.0)))
    driver.frames(5)
    before = state_of(driver)
    EDITS[name](driver)
    driver.frames(4)
    after = state_of(driver)
    assert after != before
    driver.session.runner.paused = True
    driver.key(pygame.K_z, mod=CTRL)
    assert state_of(driver) == before, name
    assert driver.session.message == "Undo: 0 more"
    driver.key(pygame.K_y, mod=CTRL)
    assert state_of(driver) == after
    driver.key(pygame.K_z, mod=CTRL)
    driver.key(pygame.K_z, mod=CTRL | SHIFT)
    assert state_of(driver) == after
    driver.key(pygame.K_y, mod=CTRL)
    assert driver.session.message == "There is nothing to redo."


def test_edits_are_undone_one_after_the_other_and_a_new_one_ends_redo() -> None:
    driver = Driver(world_of(PLACES), paused=True)
    states = [state_of(driver)]
    for name in ("add", "wall", "delete"):
        EDITS[name](driver)
        states.append(state_of(driver))
    for state in states[-2::-1]:
        driver.session.runner.undo()
        assert state_of(driver) == state
    driver.session.runner.undo()
    driver.session.runner.redo()
    assert state_of(driver) == states[1]
    EDITS["stop"](driver)
    driver.session.runner.redo()
    assert state_of(driver) == states[1]
    driver.session.runner.undo()
    driver.session.runner.undo()
    assert state_of(driver) == states[0]


def test_a_moved_slider_is_one_edit_and_two_sliders_are_two() -> None:
    driver = Driver(world_of(PLACES), paused=True)
    before = state_of(driver)
    for value in range(10):
        driver.session.runner.adjust("drag", value / 10)
    middle = state_of(driver)
    driver.session.runner.adjust("friction", 0.5)
    driver.session.runner.undo()
    assert state_of(driver) == middle
    driver.session.runner.undo()
    assert state_of(driver) == before


def test_u_goes_back_in_time_and_leaves_undo_alone() -> None:
    driver = Driver(world_of(PLACES, gravity=(0.0, 10.0)))
    before = state_of(driver)
    EDITS["delete"](driver)
    driver.frames(10)
    for _ in range(3):
        driver.key(pygame.K_u)
    assert len(driver.session.frame) == 3
    driver.key(pygame.K_z, mod=CTRL)
    assert state_of(driver) == before
    driver.session.runner.rewind(1000.0)
    assert driver.session.frame.stats.time == 0


@pytest.mark.parametrize("key", [pygame.K_r, pygame.K_RIGHTBRACKET])
def test_what_a_restart_or_another_scene_removes_comes_back_by_undo(key: int) -> None:
    driver = Driver(start(Settings("gas", 30)))
    driver.session.interaction.commands.wall((10, 10), (40, 10))
    driver.session.interaction.attractors.place((20.0, 20.0))
    driver.session.runner.adjust("gravity", (0.0, 50.0))
    driver.frames(5)
    driver.session.runner.paused = True
    before = state_of(driver)
    driver.key(key)
    assert len(driver.session.interaction.commands.drawn_walls) == 0
    assert not driver.session.frame.attractors and driver.session.frame.stats.time == 0
    if key == pygame.K_r:
        assert "Ctrl+Z" in driver.session.message
        assert driver.session.settings.gravity == (0.0, 50.0)
    driver.key(pygame.K_z, mod=CTRL)
    assert state_of(driver) == before and driver.session.engine.scene == "gas"


def test_states_beyond_the_budget_are_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = start(Settings("gas", 30))
    size = len(simulation.save())
    monkeypatch.setattr("jostle_lab.simulate.history.UNDO_BUDGET", 3.5 * size)
    undo = Undo()
    for _ in range(10):
        undo.record("", simulation)
    assert len(undo.past) == 3


# Closing the window


@pytest.mark.parametrize(
    "quit", [lambda d: d.key(pygame.K_q, mod=CTRL), lambda d: post(pygame.QUIT)]
)
def test_unsaved_edits_are_saved_when_the_window_is_closed_and_the_next_start_says_where(
    quit: Edit, capsys: pytest.CaptureFixture[str]
) -> None:
    driver = Driver(world_of(PLACES))
    driver.session.interaction.commands.wall((10, 10), (40, 10))
    driver.frames(3)
    quit(driver)
    driver.frames(1)
    assert not driver.session.open
    driver.session.close()
    path = autosave_path()
    assert path.exists() and str(path) in capsys.readouterr().err
    driver = Driver(world_of(PLACES))
    driver.session.files.mention_autosave()
    assert "Unsaved edits of the last session are in" in driver.session.message
    driver.session.files.mention_autosave()
    assert not path.exists() and path.with_name("recovered.jostle").exists()


def test_without_edits_or_after_saving_nothing_is_saved(tmp_path: Path) -> None:
    driver = Driver(world_of(PLACES))
    driver.frames(3)
    driver.session.quit()
    assert not autosave_path().exists()
    driver = Driver(start(Settings("gas", 10)))
    driver.session.files.folder = tmp_path
    driver.session.interaction.commands.delete(ONE)
    driver.key(pygame.K_s, mod=CTRL)
    driver.frames(3)
    assert len(driver.session.files.scenes()) == 1
    driver.session.quit()
    assert not autosave_path().exists()
    driver = Driver(start(Settings("gas", 10)))
    driver.session.interaction.commands.delete(ONE)
    driver.key(pygame.K_RIGHTBRACKET)  # the edits of the scene before are given up
    driver.session.quit()
    assert not autosave_path().exists()


def test_a_file_is_opened_by_control_o_or_dropped_on_the_window(tmp_path: Path) -> None:
    driver = Driver(start(Settings("gas", 10)))
    driver.session.files.folder = tmp_path
    driver.session.files.save()
    (path,) = driver.session.files.scenes()
    driver.session.runner.begin(Settings("pile", 30))
    post(pygame.DROPFILE, file=str(path))
    driver.frames(2)
    assert driver.session.engine.scene == "gas" and len(driver.session.frame) == 10
    driver.key(pygame.K_o, mod=CTRL)
    assert driver.session.choice is not None


def test_the_energy_has_a_new_reference_after_a_key_has_changed_gravity() -> None:
    driver = Driver(world_of(PLACES, gravity=(0.0, 100.0)))
    driver.frames(30)
    driver.key(pygame.K_0)
    driver.frames(3)
    statistics = driver.session.runner.statistics
    assert statistics.reference is not None
    assert statistics.reference.time > 0 and statistics.energy_drift == pytest.approx(0, abs=1e-6)
    driver.session.traces.refresh(driver.session.frame, driver.session.messages.now + FRAME)
    assert driver.session.frame.energies is None or driver.session.frame.energies.potential == 0
