"""The table of keys is complete, and says what the window does."""

from pathlib import Path

import controls
import numpy as np
import pygame
import pytest
from lab_interaction import Driver, world_of

from jostle_lab.draw.view_options import ColourBy, TreeView
from jostle_lab.gui.keymap import GROUPS, HANDLERS, HELD, KEYMAP, PANNING, command_of, key_of
from jostle_lab.schema import Settings
from jostle_lab.simulate.start import start
from jostle_lab.window import Window

ROOT = Path(__file__).parents[2]

PROMISED = {
    pygame.K_p: "pause", pygame.K_o: "step", pygame.K_u: "step back", pygame.K_r: "restart",
    pygame.K_b: "method", pygame.K_t: "tree", pygame.K_c: "contacts", pygame.K_v: "velocities",
    pygame.K_l: "trails", pygame.K_a: "create", pygame.K_SPACE: "attract", pygame.K_TAB: "panels",
    pygame.K_h: "help", pygame.K_F1: "help", pygame.K_ESCAPE: "escape", pygame.K_HOME: "home",
    pygame.K_LEFT: "left", pygame.K_RIGHT: "right", pygame.K_UP: "up", pygame.K_DOWN: "down",
    pygame.K_F13: None,
}  # fmt: skip

# Labels that are not the names of their keys in pygame.
SPELLED = {"Del": "delete", "+": "plus", "−": "minus", ",": "comma", ".": "period"}
SPELLED |= {"[": "leftbracket", "]": "rightbracket", "Esc": "escape"}


@pytest.mark.parametrize("key", PROMISED)
def test_key_does_what_it_promises(key: int) -> None:
    assert command_of(key) == PROMISED[key]
    assert command_of(key, pygame.KMOD_LSHIFT | pygame.KMOD_NUM) == PROMISED[key]


@pytest.mark.parametrize(
    ("key", "command"),
    [("z", "undo"), ("y", "redo"), ("s", "save"), ("o", "open"), ("q", "quit"), ("c", None)],
)
def test_keys_with_control_have_commands_of_their_own(key: str, command: str | None) -> None:
    number = getattr(pygame, f"K_{key}")
    assert command_of(number, pygame.KMOD_LCTRL) == command
    assert command_of(number) != command
    assert command_of(pygame.K_z, pygame.KMOD_RCTRL | pygame.KMOD_LSHIFT) == "redo"


def test_a_label_names_the_key_of_its_command() -> None:
    commands = [command for control in KEYMAP for command in control.keys]
    for command in set(commands) - PANNING.keys():
        label = key_of(command)
        control, name = label.startswith("Ctrl+"), label.removeprefix("Ctrl+")
        name = SPELLED.get(name, name)
        key = getattr(pygame, f"K_{name.lower() if len(name) == 1 else name.upper()}")
        assert command_of(key, control * pygame.KMOD_LCTRL) == command


def test_every_command_has_a_key_and_an_explanation_and_no_key_means_two_things() -> None:
    commands = [command for control in KEYMAP for command in control.keys]
    assert len(commands) == len(set(commands))
    assert {*HANDLERS, *HELD} == set(commands)
    assert not HELD & HANDLERS.keys()
    keys = [key for control in KEYMAP for names in control.keys.values() for key in names.split()]
    assert len(keys) == len(set(keys))
    assert all(control.label and control.meaning for control in KEYMAP)
    assert len({control.label for control in KEYMAP}) == len(KEYMAP)
    assert set(PANNING) == {"left", "right", "up", "down"}


def test_a_line_of_several_keys_tells_which_is_which() -> None:
    assert key_of("step") == "O" and key_of("step back") == "U"
    assert key_of("help") == "H" and key_of("delete") == "Del"
    assert key_of("left") == "arrows"


def test_the_document_is_the_table() -> None:
    written = (ROOT / "docs" / "controls.md").read_text(encoding="utf-8")
    assert written == controls.as_markdown(), "run: python docs/controls.py"
    assert "docs/controls.md" in (ROOT / "README.md").read_text(encoding="utf-8")
    assert all(f"## {group}" in written for group in GROUPS)


def help_in(size: tuple[int, int]) -> pygame.Rect:
    """Where the list is in a window of a size."""
    window = Window(start(Settings("gas", 5)), size, synchronous=True)
    window.session.toggle("help")
    for _ in range(4):
        window.frame(1 / 60)
    place = window.gui.marks["help"]
    window.close()
    return place


@pytest.mark.parametrize("size", [(1280, 720), (640, 360), (200, 120)])
def test_help_fits_on_the_screen(size: tuple[int, int]) -> None:
    place = help_in(size)
    assert pygame.Rect((0, 0), size).contains(place)
    assert place.width > size[0] / 2
    assert abs(place.centerx - size[0] / 2) < 4


def test_help_in_no_room_at_all_is_no_error_and_in_the_usual_window_it_is_not_shrunk() -> None:
    assert min(help_in((1, 1)).size) > 0
    assert help_in((1280, 720)).size == help_in((1920, 1080)).size


@pytest.mark.parametrize(
    "name", ["contacts", "forces", "velocities", "labels", "trails", "panels", "help"]
)
def test_the_switches_of_what_is_shown(name: str) -> None:
    driver = Driver(world_of([(100, 100)]))
    keys = next(control.keys[name] for control in KEYMAP if name in control.keys)
    key = getattr(pygame, f"K_{keys.split()[0]}")
    before = getattr(driver.session.view_options, name)
    driver.key(key)
    assert getattr(driver.session.view_options, name) is not before
    driver.key(key)
    assert getattr(driver.session.view_options, name) is before


def test_e_cycles_what_the_colours_tell() -> None:
    driver = Driver(world_of([(100, 100)]))
    seen = set()
    for _ in ColourBy:
        driver.key(pygame.K_e)
        seen.add(driver.session.view_options.colour_by)
    assert seen == set(ColourBy)


def test_x_clears_the_trails() -> None:
    driver = Driver(world_of([(100, 100)], gravity=(900.0, 0.0)))
    driver.session.view_options.trails, driver.session.view_options.tree = True, TreeView.OFF
    for _ in range(20):
        driver.frames()
    driver.session.runner.paused = True
    behind = driver.pixel((105, 100))  # where the disc has been

    def rgba() -> int:
        picture = pygame.surfarray.array3d(driver.window.screen.canvas()).astype(int)
        around = picture[behind[0] - 3 : behind[0] + 4, behind[1] - 3 : behind[1] + 4]
        return int(np.ptp(around, axis=(0, 1)).max())

    assert rgba() > 10
    driver.key(pygame.K_x)
    assert rgba() == 0


def test_u_undoes_and_goes_a_step_back() -> None:
    driver = Driver(world_of([(100, 100)], gravity=(0.0, 100.0)))
    driver.frames(5)
    times = [driver.session.frame.stats.time]
    driver.key(pygame.K_u)
    times.append(driver.session.frame.stats.time)
    assert times[0] - times[1] == pytest.approx(1 / 60) and driver.session.runner.paused


def test_the_escape_key_closes_the_help_first() -> None:
    driver = Driver(world_of([(100, 100)]))
    driver.key(pygame.K_h)
    driver.key(pygame.K_ESCAPE)
    assert driver.session.open and not driver.session.view_options.help
    driver.key(pygame.K_ESCAPE)
    assert driver.session.open and driver.session.message == "Ctrl+Q quits."
    driver.key(pygame.K_q, mod=pygame.KMOD_LCTRL)
    assert not driver.session.open
