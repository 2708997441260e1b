"""The display panel: what is drawn beside the particles."""

from __future__ import annotations

from jostle.app.draw.view_options import ColourBy, TreeView
from jostle.app.gui.host import Gui
from jostle.app.panels.widgets import choice, combo, in_rows
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
    for name, across in in_rows(SWITCHES, 3):
        if choice(gui, name, name, across, chosen=getattr(options, name)):
            session.toggle(name)
