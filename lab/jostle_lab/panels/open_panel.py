"""The window of Ctrl+O: the path of a scene, and the saved scenes."""

from pathlib import Path

from imgui_bundle import imgui, imgui_ctx

from jostle_lab.gui.host import Gui
from jostle_lab.panels import widgets as ui
from jostle_lab.session import Session

NAME = "Open a scene"
WIDTH = 420.0  # points
MOST = 12  # files in the list


def build(session: Session, gui: Gui) -> None:
    """Show the window, and open the file that is entered or clicked."""
    choice = session.choice
    if choice is None:
        return
    if not choice.shown:
        imgui.open_popup(NAME)
    with imgui_ctx.begin_popup(NAME) as popup:
        if not popup:
            session.choice = None  # a click elsewhere, or Esc
            return
        gui.mark_window("open")
        imgui.text(NAME)
        if not choice.shown:
            imgui.set_keyboard_focus_here()
        choice.shown = True
        imgui.set_next_item_width(WIDTH)
        flags = imgui.InputTextFlags_.enter_returns_true
        entered, choice.path = imgui.input_text("##path", choice.path, flags)
        gui.mark("open path")
        ui.soft("The path of a .jostle file, then Enter; or drop a file on the window.")
        chosen = Path(choice.path).expanduser() if entered and choice.path else None
        for path in session.files.scenes()[:MOST]:
            if imgui.selectable(path.name, False)[0]:
                chosen = path
            gui.mark(f"open {path.name}")
        if chosen is not None:
            session.files.load(chosen)
            session.choice = None
            imgui.close_current_popup()
