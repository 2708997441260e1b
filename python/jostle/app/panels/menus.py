"""The menus of the right mouse button, drawn with ImGui."""

from __future__ import annotations

from imgui_bundle import imgui

from jostle.app.act.menu import Item, Menu, Number
from jostle.app.draw.palette import TEXT_SOFT
from jostle.app.gui.host import Gui
from jostle.app.session import Session

POPUP = "menu"
NUMBER_WIDTH = 90.0


def build(session: Session, gui: Gui) -> None:
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
        _fill(session, gui, menu)
    imgui.end_popup()


def _fill(session: Session, gui: Gui, menu: Menu) -> None:
    red, green, blue = TEXT_SOFT
    soft = imgui.ImVec4(red / 255, green / 255, blue / 255, 1.0)
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
            _number(gui, line)
        else:
            _item(session, gui, line)


def _item(session: Session, gui: Gui, item: Item) -> None:
    clicked, _ = imgui.menu_item(item.label, item.key, item.checked, item.enabled)
    gui.mark(f"menu {item.name}")
    if clicked:
        item.act()
        session.menu = None


def _number(gui: Gui, number: Number) -> None:
    """Take a number when Enter is pressed."""
    imgui.begin_disabled(not number.enabled)
    imgui.set_next_item_width(NUMBER_WIDTH)
    flags = imgui.InputTextFlags_.enter_returns_true
    typed, value = imgui.input_float(
        f"{number.label}##{number.name}", number.value, format="%.5g", flags=flags
    )
    gui.mark(f"menu {number.name}")
    if typed:
        number.act(value)
    imgui.end_disabled()
