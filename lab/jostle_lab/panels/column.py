"""The column at the left: sections, scrolled if they do not fit."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from imgui_bundle import imgui, imgui_ctx

from jostle_lab.draw.palette import ACCENT, TEXT_SOFT
from jostle_lab.gui.host import Gui
from jostle_lab.gui.style import layout, vec
from jostle_lab.panels import (
    files_panel,
    filter_panel,
    life_panel,
    playback_panel,
    settings_panel,
    statistics_panel,
)
from jostle_lab.panels.widgets import at_right, colours, section, side_panel
from jostle_lab.session import Session
from jostle_lab.simulate.settings import METHODS

TITLE = 21.0
LIFE = "Particle life"
SECTIONS: list[tuple[str, Callable[[Session, Gui], None]]] = [
    ("Scenes", files_panel.build_scenes),
    (LIFE, life_panel.build),
    ("Method", settings_panel.build_method),
    ("Particles and tree", settings_panel.build_tree),
    ("Display", settings_panel.build_display),
    ("World", settings_panel.build_world),
    ("Time", settings_panel.build_time),
    ("Rewind", playback_panel.build_rewind),
    ("Collision filter", filter_panel.build),
    ("Two particles", files_panel.build_why),
    ("Files", files_panel.build),
]


def build(session: Session, gui: Gui) -> None:
    """Build the column, if the window is wide enough."""
    widths = layout(session, *imgui.get_io().display_size)
    if not widths.column:
        return
    with side_panel("controls", (0.0, 0.0), (widths.column, widths.height)):
        _title(session)
        playback_panel.build(session, gui)
        for title, contents in SECTIONS:
            # In other scenes this section could change nothing.
            if title != LIFE or session.frame.matrix is not None:
                section(gui, title, partial(contents, session, gui))
        if not widths.statistics:
            statistics_panel.build_sections(session, gui)


def _title(session: Session) -> None:
    with imgui_ctx.push_font(None, TITLE):
        imgui.text_unformatted(session.engine.scene)
    if session.runner.paused:
        with colours(text=vec(ACCENT)):
            at_right("paused")
    with colours(text=vec(TEXT_SOFT)):
        words = f"{len(session.frame):,} particles · {METHODS[session.settings.method]}"
        imgui.text_unformatted(words)
    imgui.dummy((0.0, 2.0))
