"""The menus of the right mouse button, drawn with ImGui."""

from __future__ import annotations

from imgui_bundle import imgui

from jostle.app import gui
from jostle.app.menu import Item, Menu, Number
from jostle.app.palette import TEXT_SOFT
from jostle.app.session import Session

POPUP = "menu"
NUMBER_WIDTH = 90.0


def build(session: Session) -> None:
    """Show the menu that is open, if there is one, and do what is clicked."""
    menu = session.menu
    if menu is None:
        return
    if not menu.shown:
        imgui.open_popup(POPUP)
        menu.shown = True
    if not imgui.begin_popup(POPUP):
        session.menu = None  # clicked beside it, or Esc
        return
    if menu.is_over(session.frame):
        session.menu = None
        imgui.close_current_popup()
    else:
        _fill(session, menu)
    imgui.end_popup()


def _fill(session: Session, menu: Menu) -> None:
    soft = imgui.ImVec4(*(channel / 255 for channel in TEXT_SOFT), 1.0)
    imgui.text(menu.title(session.frame))
    for name, value in menu.facts(session.frame):
        imgui.text_colored(soft, name)
        imgui.same_line(imgui.get_font_size() * 5)
        imgui.text(value)
    imgui.separator()
    for line in menu.lines(session):
        if line is None:
            imgui.separator()
        elif isinstance(line, Number):
            _number(session, line)
        else:
            _item(session, line)


def _item(session: Session, item: Item) -> None:
    clicked, _ = imgui.menu_item(item.label, item.key, item.checked, item.enabled)
    gui.mark(f"menu {item.name}")
    if clicked:
        item.act()
        session.menu = None


def _number(session: Session, number: Number) -> None:
    """Take a number when Enter is pressed or the field is left."""
    imgui.begin_disabled(not number.enabled)
    imgui.set_next_item_width(NUMBER_WIDTH)
    _, value = imgui.input_float(f"{number.label}##{number.name}", number.value, format="%.5g")
    gui.mark(f"menu {number.name}")
    if imgui.is_item_deactivated_after_edit():
        number.act(value)
    imgui.end_disabled()
