"""The widgets of all panels in one style: label, control, number; sliders."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, TypeVar

from imgui_bundle import imgui, imgui_ctx

from jostle_lab.draw.palette import ACCENT, TEXT, TEXT_SOFT
from jostle_lab.gui.host import Gui
from jostle_lab.gui.style import CHOSEN, FILLED, RAISED, rgba, vec

LABEL = 92.0  # points: width of the label column
NUMBER = 62.0  # width of the number column
GAP = 6.0
BUTTON = 25.0  # height
ABOVE, HEAD = 4.0, 21.0  # of a heading
CLEAR = imgui.ImVec4(0.0, 0.0, 0.0, 0.0)

T = TypeVar("T")
FIXED = (
    imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_nav
    | imgui.WindowFlags_.no_bring_to_front_on_focus
)  # fmt: skip
STILL = imgui.WindowFlags_.no_scrollbar | imgui.WindowFlags_.no_scroll_with_mouse


def section(gui: Gui, title: str, build: Callable[[], None]) -> None:
    """Build a foldable section: its heading, and its contents in a child window.

    ImGui's output for a child window is a draw list of its own, which is redrawn separately.
    """
    imgui.dummy((0.0, ABOVE))
    storage, kept = imgui.get_state_storage(), imgui.get_id(f"{title} is open")
    is_open = storage.get_bool(kept, True)
    if imgui.invisible_button(f"##{title}", (max(width(), 1.0), HEAD)):
        storage.set_bool(kept, not is_open)
    gui.mark(f"section {title}")
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    draw, middle = imgui.get_window_draw_list(), round((low.y + high.y) / 2)
    draw.add_text((low.x, middle - imgui.get_font_size() / 2), rgba(TEXT), title)
    after = low.x + imgui.calc_text_size(title).x + 10
    draw.add_line((after, middle + 0.5), (high.x - 16, middle + 0.5), rgba(RAISED))
    _chevron(high.x - 5, down=is_open)
    if is_open:
        flags = imgui.ChildFlags_.auto_resize_y
        with imgui_ctx.begin_child(title, child_flags=flags, window_flags=STILL):
            build()


def _chevron(x: float, *, down: bool) -> None:
    """Draw a chevron at the middle height of the last widget."""
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    tint, y = rgba(ACCENT if imgui.is_item_hovered() else TEXT_SOFT), round((low.y + high.y) / 2)
    draw, rise = imgui.get_window_draw_list(), 2.0 if down else -2.0
    for side in (-4.0, 4.0):
        draw.add_line((x + side, y - rise), (x, y + rise), tint, 1.5)


@contextmanager
def side_panel(name: str, place: tuple[float, float], size: tuple[float, float]) -> Iterator[None]:
    """Build the contents in a window of fixed place and size at a side."""
    imgui.set_next_window_pos(place)
    imgui.set_next_window_size(size)
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 0.0)
    imgui.push_style_var(imgui.StyleVar_.window_border_size, 0.0)
    imgui.begin(name, None, FIXED)
    imgui.pop_style_var(2)
    with imgui_ctx.push_style_var(imgui.StyleVar_.item_spacing, (8.0, 4.0)):
        yield
    imgui.end()


@contextmanager
def colours(**by_name: imgui.ImVec4) -> Iterator[None]:
    for name, colour in by_name.items():
        imgui.push_style_color(getattr(imgui.Col_, name), colour)
    yield
    imgui.pop_style_color(len(by_name))


def width() -> float:
    """Return the width from here to the right edge."""
    return imgui.get_content_region_avail().x


def label(text: str) -> None:
    imgui.align_text_to_frame_padding()
    soft(text)
    imgui.same_line(LABEL)


def soft(text: str) -> None:
    imgui.text_disabled(text)


def wrapped(text: str) -> None:
    """Draw wrapped text in the softer colour."""
    with imgui_ctx.push_text_wrap_pos():
        soft(text)


def at_right(text: str, *, quiet: bool = False) -> None:
    """Draw right-aligned text on the line of the last widget."""
    imgui.same_line()
    space = width() - imgui.calc_text_size(text).x
    imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(space, 0.0))
    (soft if quiet else imgui.text)(text)


def row(name: str, value: str) -> None:
    """Draw a line with a name and a value; a long value gets a line of its own."""
    soft(name)
    if imgui.get_item_rect_size().x + imgui.calc_text_size(value).x > width():
        imgui.dummy((0.0, 0.0))
    at_right(value)


def signed(value: float, form: str) -> str:
    """Return a number with a minus sign, none before zeros."""
    words = format(value, form)
    if not any(digit in words for digit in "123456789"):
        words = words.lstrip("+-")
    return words.replace("-", "\u2212")


def hint(text: str) -> None:
    """Show a tooltip for the last widget, also if it is disabled."""
    flags = imgui.HoveredFlags_.for_tooltip | imgui.HoveredFlags_.allow_when_disabled
    if text and imgui.is_item_hovered(flags):
        imgui.set_next_window_size_constraints((0, 0), (320, 400))
        with imgui_ctx.begin_tooltip(), imgui_ctx.push_text_wrap_pos(290.0):
            imgui.text_unformatted(text)


def choice(
    gui: Gui, name: str, text: str, across: float, *, chosen: bool, reason: str = ""
) -> bool:
    """Build a button that is highlighted if chosen; `reason` says why it is disabled."""
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


class Button(NamedTuple):
    """A button with the name of its mark, and a tooltip if there is one."""

    name: str
    text: str
    command: Callable[[], object]
    about: str = ""


def buttons(gui: Gui, *line: Button) -> None:
    """Build a line of buttons, and run the clicked command."""
    for (name, text, command, about), across in in_rows(line, len(line)):
        if choice(gui, name, text, across, chosen=False):
            command()
        hint(about)


def in_rows(items: Iterable[T], columns: int) -> Iterator[tuple[T, float]]:
    """Yield items with the width of their buttons, of which `columns` fill a line."""
    across = (width() - GAP * (columns - 1)) / columns
    for k, item in enumerate(items):
        if k % columns:
            imgui.same_line(0.0, GAP)
        yield item, across


def combo(
    gui: Gui, name: str, options: dict[str, str], chosen: str, *, reason: str = ""
) -> str | None:
    """Build a labelled drop-down list, {value: text}; return a new choice."""
    label(name)
    picked = None
    imgui.begin_disabled(bool(reason))
    imgui.set_next_item_width(width())
    flags = imgui.ComboFlags_.no_arrow_button
    is_open = imgui.begin_combo(f"##{name}", options.get(chosen, chosen), flags)
    gui.mark(name)
    _chevron(imgui.get_item_rect_max().x - 13, down=True)
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


def select(gui: Gui, name: str, options: Mapping[str, T], now: T, *, reason: str = "") -> T:
    """Build a labelled drop-down list of values by name; return the chosen or the present one."""
    present = next((words for words, value in options.items() if value == now), str(now))
    picked = combo(gui, name, {words: words for words in options}, present, reason=reason)
    return now if picked is None else options[picked]


KNOB = 6.0  # radius
PADDING = 2.0  # of ImGui, between the edge of a slider and its knob
HIDDEN = dict.fromkeys(
    ("frame_bg", "frame_bg_hovered", "frame_bg_active", "slider_grab", "slider_grab_active"), CLEAR
)
DIGITS = 2  # significant digits of a logarithmic slider


class Moved(Enum):
    """The state of a slider's change."""

    NOT = 0
    MOVING = 1  # a new value while it is held
    DONE = 2  # released, or typed


@dataclass(frozen=True)
class Range:
    """The range of a slider.

    A logarithmic one may begin at 0: then 1 is added to all values.
    """

    low: float
    high: float
    log: bool = False
    whole: bool = False

    def position(self, value: float) -> float:
        """Return the position of a value, 0 at the left and 1 at the right."""
        low, high, value = self._bend(self.low), self._bend(self.high), self._bend(value)
        return min(max((value - low) / (high - low), 0.0), 1.0)

    def value(self, position: float) -> float:
        """Return the rounded value at a position."""
        low, high = self._bend(self.low), self._bend(self.high)
        value = low + (high - low) * position
        if self.log:
            value = round_to(math.exp(value) - (self.low <= 0), DIGITS)
        else:
            value = round_to(value, 3, of=self.high - self.low)
        value = min(max(value, self.low), self.high)
        return round(value) if self.whole else value

    def _bend(self, value: float) -> float:
        if not self.log:
            return value
        return math.log(max(value, self.low) + (self.low <= 0))


def round_to(value: float, digits: int, of: float | None = None) -> float:
    """Round to a number of significant digits, of the value or of the size of another."""
    size = abs(value if of is None else of)
    return round(value, digits - 1 - math.floor(math.log10(size))) if size > 0 else 0.0


def slider(
    gui: Gui, name: str, span: Range, value: float, write: Callable[[float], str]
) -> tuple[Moved, float]:
    """Build one line: label, slider, number; return whether it moved, and to what.

    `write` formats a value. A typed number may be outside the range.
    """
    with imgui_ctx.push_id(name):
        label(name)
        moved, value = _track(gui, name, span, value)
        imgui.same_line(0.0, GAP)
        typed = _number(gui, name, write(value))
    if typed is not None:
        return Moved.DONE, round(typed) if span.whole else typed
    return moved, value


def _track(gui: Gui, name: str, span: Range, value: float) -> tuple[Moved, float]:
    """Build the slider: input by ImGui, own drawing."""
    storage, kept = imgui.get_state_storage(), imgui.get_id("position")
    position = span.position(value)
    imgui.set_next_item_width(width() - NUMBER - GAP)
    with imgui_ctx.push_style_var(imgui.StyleVar_.grab_min_size, 2 * KNOB), colours(**HIDDEN):
        flags = imgui.SliderFlags_.no_input
        changed, new = imgui.slider_float("##track", position, 0.0, 1.0, "", flags)
    gui.mark(name)
    moved, active = Moved.NOT, imgui.is_item_active()
    if imgui.is_item_deactivated_after_edit():
        moved, position = Moved.DONE, storage.get_float(kept)
    elif active:
        moved, position = (Moved.MOVING if changed else Moved.NOT), new
        storage.set_float(kept, new)
    _draw(position, active=active)
    return moved, span.value(position) if active or moved is Moved.DONE else value


def _draw(position: float, *, active: bool) -> None:
    """Draw the track, its filled part and a round knob at the last item."""
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    off = imgui.get_style().alpha < 0.9  # disabled
    draw, y = imgui.get_window_draw_list(), round((low.y + high.y) / 2)
    first, last = low.x + PADDING + KNOB, high.x - PADDING - KNOB
    x = first + (last - first) * position
    draw.add_line((first, y), (last, y), rgba(RAISED), 3.0)
    draw.add_line((first, y), (x, y), rgba(RAISED if off else FILLED), 3.0)
    lit = active or imgui.is_item_hovered()
    colour = RAISED if off else TEXT if active else ACCENT
    draw.add_circle_filled((x, y), KNOB + (1.0 if lit and not off else 0.0), rgba(colour))


def _number(gui: Gui, name: str, text: str) -> float | None:
    """Build the number as a text field without a frame; return a typed number."""
    room, padding = max(width(), 8.0), imgui.get_style().frame_padding
    size = imgui.ImVec2(room, imgui.get_frame_height())
    low, editing = imgui.get_cursor_screen_pos(), imgui.get_id("##number")
    lit = imgui.is_mouse_hovering_rect(low, low + size)
    frame, left = vec(RAISED), padding.x
    if imgui.internal.get_active_id() != editing:  # flush right, until it is edited
        frame, left = CLEAR, room - imgui.calc_text_size(text).x
    colour = vec(ACCENT if lit else TEXT)
    flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
    imgui.set_next_item_width(room)
    with (
        colours(frame_bg=frame, text=colour),
        imgui_ctx.push_style_var(imgui.StyleVar_.frame_padding, (left, padding.y)),
    ):
        entered, words = imgui.input_text("##number", text, flags)
    gui.mark(f"{name} number")
    try:
        number = float(words.replace(",", "").replace("\u2212", "-"))
    except ValueError:
        return None
    return number if entered and math.isfinite(number) else None
