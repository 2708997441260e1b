"""The panels: everything that can be set, and everything that is measured, beside the scene.

Each file builds one panel, or one section of the column at the left, with calls of ImGui. They
look at a session and call its methods; every widget is named by `gui.mark`, so that a test can
find it. Only this folder and `gui` know ImGui; import it where `gui.available()`.
In reading order:

========================= ======================================================================
ink, widgets, sliders     colours; labels, numbers, sliders, choices and icons in one look
plots                     lines and layers over time
transport, scenes         pause, step, restart; the list of scenes and what to look at
method, rules, looks      brute force or tree; the sliders; what is drawn
past, files               going back; scenes, films and tables in files
figures                   the statistics
column                    the sections at the left, one below the other
menus                     those of the right mouse button
========================= ======================================================================
"""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import imgui

from jostle.app.gui.host import Gui
from jostle.app.gui.layout import arrange
from jostle.app.panels import column, figures
from jostle.app.session import Session

Builder = Callable[[Session, Gui], None]

BUILDERS: list[Builder] = [column.build, figures.build]


def build(session: Session, gui: Gui) -> None:
    """Build all panels, unless help lies over all; call it between `gui.begin` and `gui.end`."""
    io = imgui.get_io()
    size, scale = io.display_size, io.display_framebuffer_scale.x
    arrange(session, size.x, size.y, scale)
    if session.shown.panels and not session.shown.help:
        for builder in BUILDERS:
            builder(session, gui)
