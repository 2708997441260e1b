"""The panels of the settings and the statistics.

Each file builds one panel, or one section of the column at the left, with calls of ImGui. They read
a session and call its methods; every widget is named by `gui.mark`, so that a test can find it.
Only this package and `gui` import ImGui. In reading order:

========================= ======================================================================
widgets, sliders          labels, numbers, buttons and lists; sliders
plots                     lines and stacked bars over time
playback_panel            pause, step, restart, previous and next scene
scenes_panel              the list of scenes
life_panel                the matrix of particle life
method_panel              quadtree or brute force, exact physics or the article's program
settings_panel            the sliders of the settings
display_panel             what is drawn beside the particles
rewind_panel              a slider over the last 30 s
files_panel               scenes, videos and tables in files
statistics_panel          times, pairs, energy, momentum
column                    the sections at the left
cards, help_window        messages and explanations over the scene; the list of mouse and keys
menu_items, menus         the items of the context menus; the menus
========================= ======================================================================
"""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import imgui

from jostle.app.gui.host import Gui
from jostle.app.gui.layout import arrange
from jostle.app.panels import cards, column, help_window, menus, statistics_panel
from jostle.app.session import Session

Builder = Callable[[Session, Gui], None]

PANELS: list[Builder] = [column.build, statistics_panel.build]
OVERLAYS: list[Builder] = [cards.build, help_window.build, menus.build]


def build(session: Session, gui: Gui) -> None:
    """Build everything that covers the scene; the help takes the place of the panels."""
    io = imgui.get_io()
    size, scale = io.display_size, io.display_framebuffer_scale.x
    arrange(session, size.x, size.y, scale)
    panels = session.view_options.panels and not session.view_options.help
    for builder in (*(PANELS if panels else ()), *OVERLAYS):
        builder(session, gui)
