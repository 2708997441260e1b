"""The column at the left: sections, scrolled if they do not fit."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import imgui

from jostle.app.draw.formatting import method_name
from jostle.app.gui.host import Gui
from jostle.app.gui.layout import layout
from jostle.app.panels import (
    display_panel,
    files_panel,
    life_panel,
    method_panel,
    playback_panel,
    rewind_panel,
    scenes_panel,
    settings_panel,
    statistics_panel,
)
from jostle.app.panels.theme import ACCENT, TEXT_SOFT, vec
from jostle.app.panels.widgets import at_right, colours, part, section
from jostle.app.session import Session

TITLE = 21.0
LIFE = "Particle life"
SECTIONS: list[tuple[str, Callable[[Session, Gui], None]]] = [
    ("Scenes", scenes_panel.build),
    (LIFE, life_panel.build),
    ("Method", method_panel.build),
    ("Particles and tree", settings_panel.build_tree),
    ("Display", display_panel.build),
    ("World", settings_panel.build_world),
    ("Time", settings_panel.build_time),
    ("Rewind", rewind_panel.build),
    ("Two particles", files_panel.build_why),
    ("Files", files_panel.build),
]

FIXED = (
    imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_nav
    | imgui.WindowFlags_.no_bring_to_front_on_focus
)  # fmt: skip


def build(session: Session, gui: Gui) -> None:
    """Build the column, if the window is wide enough."""
    widths = layout(session, *imgui.get_io().display_size)
    if not widths.column:
        return
    imgui.set_next_window_pos((0.0, 0.0))
    imgui.set_next_window_size((widths.column, widths.height))
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 0.0)
    imgui.push_style_var(imgui.StyleVar_.window_border_size, 0.0)
    imgui.begin("controls", None, FIXED & ~imgui.WindowFlags_.no_scrollbar)
    imgui.pop_style_var(2)
    imgui.push_style_var(imgui.StyleVar_.item_spacing, (8.0, 4.0))
    _title(session)
    playback_panel.build(session, gui)
    for title, contents in SECTIONS:
        if title == LIFE and session.frame.matrix is None:
            continue
        if section(gui, title):
            with part(title):
                contents(session, gui)
    if not widths.statistics:
        statistics_panel.build_sections(session, gui)
    imgui.pop_style_var()
    imgui.end()


def _title(session: Session) -> None:
    imgui.push_font(None, TITLE)
    imgui.text_unformatted(session.engine.scene)
    imgui.pop_font()
    if session.runner.paused:
        with colours(text=vec(ACCENT)):
            at_right("paused")
    with colours(text=vec(TEXT_SOFT)):
        words = f"{len(session.frame):,} particles · {method_name(session.settings.method)}"
        imgui.text_unformatted(words)
    imgui.dummy((0.0, 2.0))
