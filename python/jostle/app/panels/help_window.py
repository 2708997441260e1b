"""The list of mouse and keys, in two columns in the middle of the window."""

from __future__ import annotations

from imgui_bundle import imgui

from jostle.app.draw.palette import ACCENT
from jostle.app.gui.host import Gui
from jostle.app.gui.keymap import GROUPS
from jostle.app.gui.style import FONT_SIZE, vec
from jostle.app.panels.cards import card
from jostle.app.panels.widgets import colours, soft
from jostle.app.session import Session

LEFT_GROUPS = 3  # groups in the left column
SIZE = 58.0, 40.0  # of the list with its margins, in sizes of the font


def build(session: Session, gui: Gui) -> None:
    """Build the list, if it is wanted; smaller in a small window."""
    if not session.view_options.help:
        return
    width, height = imgui.get_io().display_size
    size = min(FONT_SIZE, width / SIZE[0], height / SIZE[1])
    with card(gui, "help", (width / 2, height / 2), (0.5, 0.5), 2 * width):
        imgui.push_font(None, max(size, 1.0))
        imgui.push_style_var(imgui.StyleVar_.item_spacing, (0.5 * size, 0.3 * size))
        names = list(GROUPS)
        for k, column in enumerate((names[:LEFT_GROUPS], names[LEFT_GROUPS:])):
            if k:
                imgui.same_line(0.0, 2.5 * size)
            imgui.begin_group()
            labels = [control.label for name in column for control in GROUPS[name]]
            keys = max(imgui.calc_text_size(label).x for label in labels) + 1.2 * size
            for name in column:
                _group(name, keys)
            imgui.end_group()
        imgui.pop_style_var()
        imgui.pop_font()


def _group(name: str, keys: float) -> None:
    """Build a group of keys: its name, and a line for each."""
    soft(name)
    for control in GROUPS[name]:
        with colours(text=vec(ACCENT)):
            imgui.text(control.label)
        imgui.same_line(imgui.get_style().window_padding.x + keys)
        imgui.text(control.meaning)
    imgui.dummy((0.0, imgui.get_font_size() / 3))
