"""The table of keys is complete, and says what the window does."""

from pathlib import Path

import numpy as np
import pytest

pygame = pytest.importorskip("pygame")

from app_interaction import Driver, world_of  # noqa: E402

from jostle.app.act import help_overlay  # noqa: E402
from jostle.app.act.help_overlay import draw_help  # noqa: E402
from jostle.app.act.keymap import (  # noqa: E402
    GROUPS,
    HELD,
    KEYMAP,
    PANNING,
    Action,
    action_of,
    as_markdown,
    key_of,
)
from jostle.app.draw.software import SoftwarePainter  # noqa: E402
from jostle.app.draw.view_options import ColourBy, TreeView  # noqa: E402
from jostle.app.gui.key_bindings import HANDLERS  # noqa: E402

ROOT = Path(__file__).parents[1]
PROMISED = {
    pygame.K_p: Action.PAUSE,
    pygame.K_o: Action.STEP,
    pygame.K_u: Action.STEP_BACK,
    pygame.K_r: Action.RESTART,
    pygame.K_b: Action.METHOD,
    pygame.K_t: Action.TREE,
    pygame.K_c: Action.CONTACTS,
    pygame.K_v: Action.VELOCITIES,
    pygame.K_l: Action.TRAILS,
    pygame.K_a: Action.CREATE,
    pygame.K_SPACE: Action.ATTRACT,
    pygame.K_TAB: Action.PANELS,
    pygame.K_h: Action.HELP,
    pygame.K_F1: Action.HELP,
    pygame.K_ESCAPE: Action.ESCAPE,
    pygame.K_HOME: Action.HOME,
    pygame.K_LEFT: Action.LEFT,
    pygame.K_RIGHT: Action.RIGHT,
    pygame.K_UP: Action.UP,
    pygame.K_DOWN: Action.DOWN,
}


@pytest.mark.parametrize("key", PROMISED)
def test_key_does_what_it_promises(key: int) -> None:
    assert action_of(key) is PROMISED[key]


def test_every_action_has_a_key_and_does_something() -> None:
    actions = {action for control in KEYMAP for action in control.keys.values()}
    assert actions == set(Action)
    assert set(HANDLERS) == set(Action) - HELD


def test_no_key_means_two_things() -> None:
    keys = [key for control in KEYMAP for key in control.keys]
    assert len(keys) == len(set(keys))


def test_a_line_of_several_keys_tells_which_is_which() -> None:
    assert key_of(Action.STEP) == "O" and key_of(Action.STEP_BACK) == "U"
    assert key_of(Action.HELP) == "H" and key_of(Action.DELETE) == "Del"
    assert key_of(Action.LEFT) == "arrows"


def test_other_keys_do_nothing() -> None:
    assert action_of(pygame.K_F13) is None


def test_every_control_is_explained_once() -> None:
    assert all(control.label and control.meaning for control in KEYMAP)
    assert len({control.label for control in KEYMAP}) == len(KEYMAP)
    assert set(PANNING) == {Action.LEFT, Action.RIGHT, Action.UP, Action.DOWN}


def test_the_document_is_the_table() -> None:
    """To renew it: write what `as_markdown` returns into the file."""
    written = (ROOT / "docs" / "controls.md").read_text(encoding="utf-8")
    assert written == as_markdown()
    assert "docs/controls.md" in (ROOT / "README.md").read_text(encoding="utf-8")
    assert all(f"## {group}" in written for group in GROUPS)


@pytest.mark.parametrize("size", [(1280, 720), (640, 360), (200, 120)])
def test_help_fits_on_the_screen(size: tuple[int, int]) -> None:
    painter = SoftwarePainter(size)
    painter.fill((0, 0, 0))
    draw_help(painter)
    pixels = pygame.surfarray.array3d(painter.canvas())
    assert pixels[size[0] // 2, size[1] // 2].any()
    for edge in (pixels[:4], pixels[-4:], pixels[:, :4], pixels[:, -4:]):
        assert edge.max() == 0


def test_help_in_no_room_at_all_is_no_error() -> None:
    draw_help(SoftwarePainter((1, 1)))


def test_help_is_not_shrunk_in_the_usual_window() -> None:

    width, height = help_overlay._sheet().get_size()
    assert width <= 1280 - 16 and height <= 720 - 16


@pytest.mark.parametrize(
    "name", ["contacts", "forces", "velocities", "labels", "trails", "panels", "help"]
)
def test_the_switches_of_what_is_shown(name: str) -> None:
    driver = Driver(world_of([(100, 100)]))
    (key,) = {
        pygame.key.name(key): key
        for control in KEYMAP
        for key, action in control.keys.items()
        if action.name in (name.upper(),) and key != pygame.K_F1
    }.values()
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
    driver.frames(20)
    driver.session.runner.paused = True
    behind = driver.pixel((105, 100))  # where the disc has been

    def rgba() -> int:
        picture = pygame.surfarray.array3d(driver.window.painter.canvas()).astype(int)
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
    assert not driver.session.open
