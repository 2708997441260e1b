"""The list of scenes, and the description of the present one."""

from __future__ import annotations

from imgui_bundle import imgui

import jostle
from jostle.app.draw.palette import ACCENT
from jostle.app.gui.host import Gui
from jostle.app.gui.style import CHOSEN, vec
from jostle.app.panels.widgets import at_right, colours, wrapped
from jostle.app.session import Session

ROWS = 6  # visible
LINE, PADDING = 22.0, 5.0  # points
BY_ARTICLE = (
    "The article's own rules. Balls overlap, piles never come to rest, and energy is not conserved."
)


def build(session: Session, gui: Gui) -> None:
    """Build the list and the description."""
    names, present = jostle.scenes.names(), session.engine.scene
    with colours(child_bg=vec((255, 255, 255), 0.025)):
        imgui.push_style_var(imgui.StyleVar_.window_padding, (8.0, PADDING))
        imgui.push_style_var(imgui.StyleVar_.item_spacing, (8.0, 3.0))
        imgui.begin_child(
            "scenes", (0.0, LINE * min(ROWS, len(names)) + PADDING),
            imgui.ChildFlags_.always_use_window_padding,
        )  # fmt: skip
        if imgui.is_window_appearing() and present in names:
            imgui.set_scroll_y(LINE * (names.index(present) - ROWS // 2))  # whole rows
        for name in names:
            _line(session, gui, name, present=name == present)
        imgui.end_child()
        imgui.pop_style_var(2)
    if session.settings.by_article:
        wrapped(BY_ARTICLE)
    elif present in names:
        wrapped(jostle.scenes.describe(present))


def _line(session: Session, gui: Gui, name: str, *, present: bool) -> None:
    with colours(
        header=vec(CHOSEN), header_hovered=vec(CHOSEN if present else ACCENT, 1 if present else 0.2)
    ):
        flags = imgui.SelectableFlags_.allow_overlap
        clicked, _ = imgui.selectable(f"{name}##scene", present, flags, (0.0, LINE - 3.0))
    gui.mark(f"scene {name}")
    at_right(f"{jostle.scenes.default_count(name):,}", quiet=not present)
    if clicked:
        session.runner.choose_scene(name)
