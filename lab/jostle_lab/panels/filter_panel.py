"""The collision filter of the selected particles, or of new ones: eight categories and masks."""

from __future__ import annotations

from imgui_bundle import imgui, imgui_ctx

from jostle_lab.gui.host import Gui
from jostle_lab.panels.widgets import choice, hint, in_rows, label, soft
from jostle_lab.session import Session

SHOWN = 8  # of 32 categories; the others stay as they are
COLUMNS = {
    "categories": ("category", "Bit {0}: {1} in the categories of files and of World."),
    "masks": ("collides with", "Bit {0} of the mask: collisions with particles of category {0}."),
}


def build(session: Session, gui: Gui) -> None:
    """Build a line of categories and one of masks; a click changes one bit.

    Of several selected particles the first one is shown, so that a frame takes the same time for
    any number of them.
    """
    tags, commands = session.interaction.selection.tags, session.interaction.commands
    soft(f"of {len(tags):,} selected" if len(tags) else "of new particles")
    # Without padding, so that a digit is centred on a narrow button.
    padding = 0.0, imgui.get_style().frame_padding.y
    with imgui_ctx.push_style_var(imgui.StyleVar_.frame_padding, padding):
        for column, (words, about) in COLUMNS.items():
            rows = session.frame.rows(tags[:1])
            new = commands.new_filter[column]
            bits = int(getattr(session.frame, column)[rows[0]]) if len(rows) else new
            label(words)
            for bit, across in in_rows(range(SHOWN), SHOWN):
                on = bool(bits >> bit & 1)
                if choice(gui, f"{words} {bit}", str(bit), across, chosen=on):
                    commands.set_bit(tags, column, bit, on=not on)
                hint(about.format(bit, 1 << bit))
