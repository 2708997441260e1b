"""The context menus, drawn with ImGui."""

from __future__ import annotations

from imgui_bundle import imgui

from jostle.app.act.menu import Menu
from jostle.app.gui.host import Gui
from jostle.app.gui.keymap import key_of
from jostle.app.panels.menu_items import Item, Number, lines_of
from jostle.app.panels.widgets import soft
from jostle.app.session import Session

POPUP = "menu"
NUMBER_WIDTH = 90.0


def build(session: Session, gui: Gui) -> None:
    """Show the open menu, and run the clicked command."""
    menu = session.interaction.menu
    if menu is None:
        return
    if not menu.shown:
        imgui.open_popup(POPUP)
        menu.shown = True
    if not imgui.begin_popup(POPUP):
        session.interaction.menu = None  # a click elsewhere, or Esc
        return
    if menu.is_over(session.frame):
        session.interaction.menu = None
        imgui.close_current_popup()
    else:
        _fill(session, gui, menu)
    imgui.end_popup()


def _fill(session: Session, gui: Gui, menu: Menu) -> None:
    imgui.text(menu.title(session.frame))
    for name, value in menu.numbers(session.frame):
        soft(name)
        imgui.same_line(imgui.get_font_size() * 5)
        imgui.text(value)
    imgui.separator()
    for line in lines_of(session, menu):
        if line is None:
            imgui.separator()
        elif isinstance(line, Number):
            _number(gui, line)
        else:
            _item(session, gui, line)


def _item(session: Session, gui: Gui, item: Item) -> None:
    key = key_of(item.key) if item.key else ""
    clicked, _ = imgui.menu_item(item.label, key, item.checked, item.enabled)
    gui.mark(f"menu {item.name}")
    if clicked:
        item.command()
        session.interaction.menu = None


def _number(gui: Gui, number: Number) -> None:
    """Build a number field; Enter applies it."""
    imgui.begin_disabled(not number.enabled)
    imgui.set_next_item_width(NUMBER_WIDTH)
    flags = imgui.InputTextFlags_.enter_returns_true
    typed, value = imgui.input_float(
        f"{number.label}##{number.name}", number.value, format="%.5g", flags=flags
    )
    gui.mark(f"menu {number.name}")
    if typed:
        number.command(value)
    imgui.end_disabled()
