"""What is drawn beside the particles."""

from __future__ import annotations

from jostle.app.draw.shown import ColourBy, TreeView
from jostle.app.gui.host import Gui
from jostle.app.panels.widgets import beside, choice, combo, share_out
from jostle.app.session import Session

SWITCHES = ("contacts", "forces", "velocities", "trails", "labels")


def build(session: Session, gui: Gui) -> None:
    """Build the switches."""
    shown = session.shown
    tree = combo(gui, "tree", {view.value: view.value for view in TreeView}, shown.tree.value)
    if tree is not None:
        shown.tree = TreeView(tree)
    colour = combo(gui, "colour by", {by.value: by.value for by in ColourBy}, shown.colour_by.value)
    if colour is not None:
        shown.colour_by = ColourBy(colour)
    across = share_out(3)
    for k, name in enumerate(SWITCHES):
        if k % 3:
            beside()
        if choice(gui, name, name, across, chosen=getattr(shown, name)):
            session.toggle(name)
