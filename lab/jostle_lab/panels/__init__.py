"""The panels of the settings and the statistics.

Each file builds one panel, or sections of the column at the left, with calls of ImGui. They read a
session and call its methods; every widget is named by `gui.mark`, so that a test can find it. Only
this package and `gui` import ImGui. In reading order:

======================= ========================================================================
widgets                 labels, numbers, buttons and lists; sliders
life_panel              the matrix of particle life; categories and masks
settings_panel          method, sliders of the settings, what is drawn beside the particles
files_panel             the list of scenes; videos and tables in files
statistics_panel        times, pairs, energy, momentum, with their plots
column                  the time, a slider over the last 30 s, and the sections at the left
cards                   messages and explanations over the scene; the list of mouse and keys
menus                   the context menus and their items
open_panel              the window of Ctrl+O
======================= ========================================================================
"""

from collections.abc import Callable

from imgui_bundle import imgui

from jostle_lab.gui.host import Gui
from jostle_lab.gui.style import arrange
from jostle_lab.panels import cards, column, menus, open_panel, statistics_panel
from jostle_lab.session import Session

Builder = Callable[[Session, Gui], None]


def build(session: Session, gui: Gui) -> None:
    """Build everything that covers the scene; the help takes the place of the panels."""
    io = imgui.get_io()
    size, scale = io.display_size, io.display_framebuffer_scale.x
    arrange(session, size.x, size.y, scale)
    options = session.view_options
    if options.panels and not options.help:
        column.build(session, gui)
        statistics_panel.build(session, gui)
    elif not options.help:
        column.build_bar(session, gui)
    cards.build(session, gui)
    if options.help:
        cards.build_help(gui)
    menus.build(session, gui)
    open_panel.build(session, gui)
