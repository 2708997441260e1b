"""The table of keys is complete, and says what the window does."""

import pytest

pygame = pytest.importorskip("pygame")

from jostle.app.controls import CONTROLS, PANNING, Action, action_of  # noqa: E402
from jostle.app.helping import draw_help  # noqa: E402
from jostle.app.software import SoftwarePainter  # noqa: E402

PROMISED = {
    pygame.K_p: Action.PAUSE,
    pygame.K_o: Action.STEP,
    pygame.K_r: Action.RESTART,
    pygame.K_b: Action.METHOD,
    pygame.K_t: Action.TREE,
    pygame.K_h: Action.HELP,
    pygame.K_ESCAPE: Action.QUIT,
    pygame.K_HOME: Action.HOME,
    pygame.K_LEFT: Action.LEFT,
    pygame.K_RIGHT: Action.RIGHT,
    pygame.K_UP: Action.UP,
    pygame.K_DOWN: Action.DOWN,
}


@pytest.mark.parametrize("key", PROMISED)
def test_key_does_what_it_promises(key: int) -> None:
    assert action_of(key) is PROMISED[key]


def test_every_action_has_exactly_one_key() -> None:
    actions = [action for control in CONTROLS for action in control.keys.values()]
    assert sorted(actions, key=lambda action: action.value) == list(Action)


def test_other_keys_do_nothing() -> None:
    assert action_of(pygame.K_F13) is None


def test_every_control_is_explained_once() -> None:
    assert all(control.label and control.meaning for control in CONTROLS)
    assert len({control.label for control in CONTROLS}) == len(CONTROLS)
    assert set(PANNING) == {Action.LEFT, Action.RIGHT, Action.UP, Action.DOWN}


def test_help_fits_on_the_screen() -> None:
    painter = SoftwarePainter((1280, 720))
    draw_help(painter)
    pixels = pygame.surfarray.array3d(painter.canvas())
    assert pixels[640, 360].any() and not pixels[5, 5].any()
    assert pixels[:, :20].max() == 0 and pixels[:, -20:].max() == 0
