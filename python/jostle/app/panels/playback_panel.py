"""The playback buttons: pause, step, restart, previous and next scene."""

from __future__ import annotations

import math
from collections.abc import Callable

from imgui_bundle import imgui

from jostle.app.act.keymap import Action, key_of
from jostle.app.gui.host import Gui
from jostle.app.panels.theme import ACCENT, CHOSEN, RAISED, TEXT, TEXT_SOFT, rgba, vec
from jostle.app.panels.widgets import button_width, colours, hint, same_line
from jostle.app.session import Session

HEIGHT = 30.0
SIGN = 5.0  # half the height of an icon

Draw = Callable[[imgui.ImDrawList, float, float, int], None]


def build(session: Session, gui: Gui) -> None:
    """Build the row of buttons."""
    across = button_width(6)
    step_back = session.runner.step_back if session.runner.history.can_go_back else None
    buttons: list[tuple[str, Draw, Callable[[], object] | None, Action | None]] = [
        ("previous scene", _previous, session.runner.previous_scene, Action.PREVIOUS_SCENE),
        ("step back", _back, step_back, Action.STEP_BACK),
        (
            "pause",
            _play if session.runner.paused else _pause,
            session.runner.toggle_pause,
            Action.PAUSE,
        ),
        ("step", _forward, session.runner.single_step, Action.STEP),
        ("next scene", _next, session.runner.next_scene, Action.NEXT_SCENE),
        ("restart", _restart, session.runner.restart, Action.RESTART),
    ]
    for k, (name, draw, command, action) in enumerate(buttons):
        if k:
            same_line()
        held = name == "pause" and session.runner.paused
        if _sign_button(gui, name, draw, across, chosen=held, off=command is None) and command:
            command()
        words = "resume" if held else name
        hint(words.capitalize() + (f"  ({key_of(action)})" if action else ""))


def _sign_button(
    gui: Gui, name: str, draw: Draw, across: float, *, chosen: bool, off: bool
) -> bool:
    imgui.begin_disabled(off)
    back = CHOSEN if chosen else RAISED
    with colours(
        button=vec(back, 0.7), button_hovered=vec(ACCENT, 0.25), button_active=vec(CHOSEN)
    ):
        clicked = imgui.button(f"##{name}", (across, HEIGHT))
    imgui.end_disabled()
    gui.mark(name)
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    x, y = round((low.x + high.x) / 2), round((low.y + high.y) / 2)
    draw(imgui.get_window_draw_list(), x, y, rgba(TEXT_SOFT, 0.4) if off else rgba(TEXT))
    return clicked


def _triangle(draw: imgui.ImDrawList, x: float, y: float, direction: float, colour: int) -> None:
    """Draw a triangle around a point, towards the sign of `direction`."""
    draw.add_triangle_filled(
        (x - direction * SIGN * 0.7, y - SIGN),
        (x - direction * SIGN * 0.7, y + SIGN),
        (x + direction * SIGN, y),
        colour,
    )


def _bar(draw: imgui.ImDrawList, x: float, y: float, colour: int) -> None:
    draw.add_rect_filled((x - 1, y - SIGN), (x + 1, y + SIGN), colour)


def _play(draw: imgui.ImDrawList, x: float, y: float, colour: int) -> None:
    _triangle(draw, x, y, 1.2, colour)


def _pause(draw: imgui.ImDrawList, x: float, y: float, colour: int) -> None:
    for side in (-3, 3):
        draw.add_rect_filled((x + side - 1.5, y - SIGN), (x + side + 1.5, y + SIGN), colour)


def _forward(draw: imgui.ImDrawList, x: float, y: float, colour: int) -> None:
    _bar(draw, x - 6, y, colour)
    _triangle(draw, x + 2, y, 1.0, colour)


def _back(draw: imgui.ImDrawList, x: float, y: float, colour: int) -> None:
    _bar(draw, x + 6, y, colour)
    _triangle(draw, x - 2, y, -1.0, colour)


def _next(draw: imgui.ImDrawList, x: float, y: float, colour: int) -> None:
    _triangle(draw, x - 5, y, 0.8, colour)
    _triangle(draw, x + 2, y, 0.8, colour)
    _bar(draw, x + 8, y, colour)


def _previous(draw: imgui.ImDrawList, x: float, y: float, colour: int) -> None:
    _bar(draw, x - 8, y, colour)
    _triangle(draw, x - 2, y, -0.8, colour)
    _triangle(draw, x + 5, y, -0.8, colour)


def _restart(draw: imgui.ImDrawList, x: float, y: float, colour: int) -> None:
    """Draw a circular arrow."""
    radius = SIGN + 0.5
    draw.path_arc_to((x, y), radius, -0.35 * math.pi, 1.2 * math.pi, 20)
    draw.path_stroke(colour, 1.8)
    tip_x = x + radius * math.cos(-0.35 * math.pi)
    tip_y = y + radius * math.sin(-0.35 * math.pi)
    draw.add_triangle_filled(
        (tip_x - 4.5, tip_y - 1.5), (tip_x + 1.5, tip_y - 3.5), (tip_x + 1.0, tip_y + 3.0), colour
    )
