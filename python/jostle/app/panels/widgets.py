"""The few widgets that all panels are made of, in one look: label, control, number at the right."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import imgui

from jostle.app.gui import Gui
from jostle.app.panels.ink import ACCENT, CHOSEN, RAISED, TEXT, TEXT_SOFT, ink, vec

LABEL = 92.0  # points: where controls begin, the same in every section
NUMBER = 62.0  # the room for numbers at the right
GAP = 6.0
BUTTON = 25.0  # height
CLEAR = imgui.ImVec4(0.0, 0.0, 0.0, 0.0)

Col = imgui.Col_


def section(gui: Gui, title: str, *, open_at_first: bool = True) -> bool:
    """Head a section that can be folded; return whether it is open."""
    imgui.dummy((0.0, 3.0))
    flags = imgui.TreeNodeFlags_.default_open if open_at_first else imgui.TreeNodeFlags_.none
    with colours(header=CLEAR, header_hovered=vec(RAISED, 0.5), header_active=vec(RAISED)):
        is_open = imgui.collapsing_header(f"##{title}", flags | imgui.TreeNodeFlags_.allow_overlap)
    gui.mark(f"section {title}")
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    draw, middle = imgui.get_window_draw_list(), (low.y + high.y) / 2
    draw.add_text((low.x + 24, middle - imgui.get_font_size() / 2), ink(TEXT), title)
    line = low.x + 32 + imgui.calc_text_size(title).x
    draw.add_line((line, middle + 0.5), (high.x, middle + 0.5), ink(RAISED))
    return is_open


@contextmanager
def colours(**by_name: imgui.ImVec4) -> Iterator[None]:
    """Colour what is built inside."""
    for name, colour in by_name.items():
        imgui.push_style_color(getattr(Col, name), colour)
    yield
    imgui.pop_style_color(len(by_name))


def width() -> float:
    """Return the room from here to the right edge."""
    return imgui.get_content_region_avail().x


def label(text: str) -> None:
    """Write a label at the left, and go on where controls begin."""
    imgui.align_text_to_frame_padding()
    soft(text)
    imgui.same_line(LABEL + imgui.get_style().window_padding.x)


def soft(text: str) -> None:
    """Write in the softer colour."""
    imgui.text_disabled(text)


def at_right(text: str, *, quiet: bool = False) -> None:
    """Write up to the right edge, on the line of the last widget."""
    imgui.same_line()
    room = width() - imgui.calc_text_size(text).x
    imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(room, 0.0))
    (soft if quiet else imgui.text)(text)


def row(name: str, value: str) -> None:
    """Write a line of a name and its number."""
    soft(name)
    at_right(value)


def hint(text: str) -> None:
    """Explain the last widget where the mouse rests on it, switched off or not."""
    flags = imgui.HoveredFlags_.for_tooltip | imgui.HoveredFlags_.allow_when_disabled
    if text and imgui.is_item_hovered(flags):
        imgui.set_next_window_size_constraints((0, 0), (320, 400))
        if imgui.begin_tooltip():
            imgui.push_text_wrap_pos(290.0)
            imgui.text_unformatted(text)
            imgui.pop_text_wrap_pos()
            imgui.end_tooltip()


def choice(
    gui: Gui, name: str, text: str, across: float, *, chosen: bool, reason: str = ""
) -> bool:
    """Build a button that stays down while it is chosen; `reason` says why it cannot be."""
    back, ahead = (CHOSEN, TEXT) if chosen else (RAISED, TEXT_SOFT)
    over = CHOSEN if chosen else ACCENT
    imgui.begin_disabled(bool(reason))
    with colours(
        button=vec(back, 1.0 if chosen else 0.7),
        button_hovered=vec(over, 1.0 if chosen else 0.25),
        button_active=vec(CHOSEN),
        text=vec(ahead),
    ):
        clicked = imgui.button(f"{text}##{name}", (across, BUTTON))
    imgui.end_disabled()
    gui.mark(name)
    hint(reason)
    return clicked and not reason


def share_out(count: int) -> float:
    """Return the width of each of `count` buttons that fill the rest of the line."""
    return (width() - GAP * (count - 1)) / count


def beside() -> None:
    """Go on at the right of the last button."""
    imgui.same_line(0.0, GAP)


def combo(
    gui: Gui, name: str, options: dict[str, str], chosen: str, *, reason: str = ""
) -> str | None:
    """Build a labelled list to choose from, {value: words}; return what was chosen now."""
    label(name)
    picked = None
    imgui.begin_disabled(bool(reason))
    imgui.set_next_item_width(width())
    is_open = imgui.begin_combo(f"##{name}", options.get(chosen, chosen))
    gui.mark(name)
    if is_open:
        for value, words in options.items():
            if imgui.selectable(words, value == chosen)[0]:
                picked = value
            gui.mark(f"{name}: {value}")
        imgui.end_combo()
    imgui.end_disabled()
    if not is_open:
        hint(reason)
    return picked
