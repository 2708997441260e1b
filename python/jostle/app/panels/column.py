"""The column at the left: sections one below the other, scrolled where they do not fit."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import imgui

from jostle.app.draw.words import method_name
from jostle.app.gui.host import Gui
from jostle.app.gui.layout import layout
from jostle.app.panels import figures, files, looks, method, past, rules, scenes, transport
from jostle.app.panels.ink import ACCENT, TEXT_SOFT, vec
from jostle.app.panels.widgets import at_right, colours, part, section
from jostle.app.session import Session

TITLE = 21.0
SECTIONS: list[tuple[str, Callable[[Session, Gui], None]]] = [
    ("Scenes", scenes.build),
    ("Method", method.build),
    ("Particles and tree", rules.build_tree),
    ("Shown", looks.build),
    ("World", rules.build_world),
    ("Time", rules.build_time),
    ("The last half minute", past.build),
    ("Two particles", files.build_why),
    ("Files", files.build),
]

FIXED = (
    imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_nav
    | imgui.WindowFlags_.no_bring_to_front_on_focus
)  # fmt: skip


def build(session: Session, gui: Gui) -> None:
    """Build the column, if there is room for one."""
    room = layout(session, *imgui.get_io().display_size)
    if not room.column:
        return
    imgui.set_next_window_pos((0.0, 0.0))
    imgui.set_next_window_size((room.column, room.height))
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 0.0)
    imgui.push_style_var(imgui.StyleVar_.window_border_size, 0.0)
    imgui.begin("controls", None, FIXED & ~imgui.WindowFlags_.no_scrollbar)
    imgui.pop_style_var(2)
    imgui.push_style_var(imgui.StyleVar_.item_spacing, (8.0, 4.0))
    _title(session)
    transport.build(session, gui)
    for title, contents in SECTIONS:
        if section(gui, title):
            with part(title):
                contents(session, gui)
    if not room.figures:
        figures.build_sections(session, gui)
    imgui.pop_style_var()
    imgui.end()


def _title(session: Session) -> None:
    imgui.push_font(None, TITLE)
    imgui.text_unformatted(session.engine.scene)
    imgui.pop_font()
    if session.paused:
        with colours(text=vec(ACCENT)):
            at_right("paused")
    with colours(text=vec(TEXT_SOFT)):
        words = f"{len(session.frame):,} particles · {method_name(session.settings.method)}"
        imgui.text_unformatted(words)
    imgui.dummy((0.0, 2.0))
