"""Cards over the scene: messages, a recording, an explanation, and the list of mouse and keys."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from imgui_bundle import imgui, imgui_ctx

from jostle_lab.draw.palette import ACCENT, RECORDING
from jostle_lab.gui.host import Gui
from jostle_lab.gui.keymap import GROUPS
from jostle_lab.gui.style import FONT_SIZE, layout, rgba, vec
from jostle_lab.panels import widgets as ui
from jostle_lab.session import Session

EDGE = 12.0  # points to the edges of the scene
FOOT = 36.0  # points, below messages and explanations: for legends
FADE = 1.5  # seconds in which the first hint vanishes
FRAME = 34.0  # points, the margins of a card
FLAGS = (
    imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_inputs
    | imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings
    | imgui.WindowFlags_.no_focus_on_appearing | imgui.WindowFlags_.no_move
)  # fmt: skip
LEFT_GROUPS = 3  # groups of keys in the left column of the help
HELP_SIZE = 58.0, 40.0  # of the help with its margins, in sizes of the font


def build(session: Session, gui: Gui) -> None:
    """Build the cards that are to be shown, inside the part that the panels leave free."""
    sides = layout(session, *imgui.get_io().display_size)
    left, right = sides.column, sides.width - sides.covered
    middle, bottom, widest = (left + right) / 2, sides.height - EDGE, right - left - 2 * EDGE
    explanation = session.explanation
    if explanation is not None:
        # In the other half of the window than the two particles.
        _, y = session.camera.to_screen(np.array(explanation.centres))
        above = float(y.mean()) > session.camera.size[1] / 2
        place = (middle, EDGE) if above else (middle, bottom - FOOT)
        with card(gui, "explanation", place, (0.5, 0.0 if above else 1.0), widest):
            imgui.text(explanation.lines[0])
            for line in explanation.lines[1:]:
                ui.soft(line)
    if session.message:
        with card(gui, "message", (middle, bottom - FOOT), (0.5, 1.0), widest):
            imgui.text(session.message)
    if not (session.message or session.view_options.help):
        _first_hint(session, gui, (middle, bottom - FOOT), widest)
    if not session.view_options.help:
        with card(
            gui, "hint", (right - EDGE / 2, bottom + EDGE / 2), (1.0, 1.0), widest, bare=True
        ):
            if session.files.recording is not None:
                _recording(session.files.recording.seconds)
            ui.soft("H help")


def _first_hint(session: Session, gui: Gui, place: tuple[float, float], widest: float) -> None:
    """Say that particles can be thrown, until one was."""
    thrown = session.interaction.thrown_at
    left = 1.0 if thrown is None else 1.0 - (session.messages.now - thrown) / FADE
    if left > 0 and session.frame.movable.any():
        with (
            imgui_ctx.push_style_var(imgui.StyleVar_.alpha, left),
            card(gui, "first hint", place, (0.5, 1.0), widest),
        ):
            imgui.text("Drag a disc and throw it")
            ui.soft("right click: menu   ·   wheel: zoom   ·   Tab: settings   ·   H: all keys")


@contextmanager
def card(
    gui: Gui,
    name: str,
    place: tuple[float, float],
    pivot: tuple[float, float],
    widest: float,
    *,
    bare: bool = False,
) -> Iterator[None]:
    """Build a card that does not receive the mouse, without a background if it is bare.

    `pivot` is the point of the card, from (0, 0) to (1, 1), that is at `place` in the window. Lines
    longer than `widest`, in points, are wrapped.
    """
    imgui.set_next_window_pos(place, imgui.Cond_.always, pivot)
    imgui.set_next_window_bg_alpha(0.0 if bare else 1.0)
    flags = FLAGS | (imgui.WindowFlags_.no_background if bare else 0)
    with imgui_ctx.begin(name, None, flags):
        with imgui_ctx.push_text_wrap_pos(max(widest - FRAME, FRAME)):
            yield
        gui.mark_window(name)


def _recording(seconds: float) -> None:
    """Build a red dot and the length of the recording, on the line of the hint."""
    at, size = imgui.get_cursor_screen_pos(), imgui.get_font_size()
    draw = imgui.get_window_draw_list()
    draw.add_circle_filled((at.x + size / 2, at.y + size / 2), size / 3, rgba(RECORDING))
    imgui.dummy((size, size))
    imgui.same_line()
    minutes, rest = divmod(int(seconds), 60)
    imgui.text(f"{minutes}:{rest:02}")
    imgui.same_line(0.0, 2 * EDGE)


def build_help(gui: Gui) -> None:
    """Build the list, smaller in a small window."""
    width, height = imgui.get_io().display_size
    size = min(FONT_SIZE, width / HELP_SIZE[0], height / HELP_SIZE[1])
    with (
        card(gui, "help", (width / 2, height / 2), (0.5, 0.5), 2 * width),
        imgui_ctx.push_font(None, max(size, 1.0)),
        imgui_ctx.push_style_var(imgui.StyleVar_.item_spacing, (0.5 * size, 0.3 * size)),
    ):
        names = list(GROUPS)
        for k, column in enumerate((names[:LEFT_GROUPS], names[LEFT_GROUPS:])):
            if k:
                imgui.same_line(0.0, 2.5 * size)
            labels = [control.label for name in column for control in GROUPS[name]]
            keys = max(imgui.calc_text_size(label).x for label in labels) + 1.2 * size
            with imgui_ctx.begin_group():
                for name in column:
                    _group(name, keys)


def _group(name: str, keys: float) -> None:
    """Build a group of keys: its name, and a line for each."""
    ui.soft(name)
    for control in GROUPS[name]:
        with ui.colours(text=vec(ACCENT)):
            imgui.text(control.label)
        imgui.same_line(imgui.get_style().window_padding.x + keys)
        imgui.text(control.meaning)
    imgui.dummy((0.0, imgui.get_font_size() / 3))
