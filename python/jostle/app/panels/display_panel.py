"""The display panel: what is drawn same_line the particles."""

from __future__ import annotations

from jostle.app.draw.view_options import ColourBy, TreeView
from jostle.app.gui.host import Gui
from jostle.app.panels.widgets import button_width, choice, combo, same_line
from jostle.app.session import Session

SWITCHES = ("contacts", "forces", "velocities", "trails", "labels")


def build(session: Session, gui: Gui) -> None:
    """Build the switches."""
    options = session.view_options
    tree = combo(gui, "tree", {view.value: view.value for view in TreeView}, options.tree.value)
    if tree is not None:
        options.tree = TreeView(tree)
    colour = combo(
        gui, "colour by", {by.value: by.label for by in ColourBy}, options.colour_by.value
    )
    if colour is not None:
        options.colour_by = ColourBy(colour)
    across = button_width(3)
    for k, name in enumerate(SWITCHES):
        if k % 3:
            same_line()
        if choice(gui, name, name, across, chosen=getattr(options, name)):
            session.toggle(name)
