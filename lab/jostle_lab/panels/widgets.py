"""The widgets of all panels in one style."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, TypeVar

from imgui_bundle import imgui, imgui_ctx

from jostle_lab.draw.palette import ACCENT, TEXT, TEXT_SOFT
from jostle_lab.gui.host import Gui
from jostle_lab.gui.style import CHOSEN, RAISED, vec

LABEL = 92.0  # points: width of the label column
GAP = 6.0
BUTTON = 25.0  # height
CLEAR = imgui.ImVec4(0.0, 0.0, 0.0, 0.0)

T = TypeVar("T")
FIXED = (
    imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_nav
    | imgui.WindowFlags_.no_bring_to_front_on_focus
)  # fmt: skip


def section(gui: Gui, title: str, build: Callable[[], None], *, is_open: bool = True) -> None:
    """Build a heading that a click folds, and below it the contents unless they are folded."""
    flags = imgui.TreeNodeFlags_.default_open if is_open else 0
    with (
        colours(header=CLEAR),
        imgui_ctx.push_style_var(imgui.StyleVar_.frame_padding, (1.0, 1.0)),
    ):
        unfolded = imgui.collapsing_header(title, flags)
    gui.mark(f"section {title}")
    if unfolded:
        build()


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


def select(gui: Gui, name: str, options: Mapping[str, T], now: T, *, reason: str = "") -> T:
    """Build a labelled drop-down list of values by name; return the chosen or the present one."""
    present = next((words for words, value in options.items() if value == now), str(now))
    picked = combo(gui, name, {words: words for words in options}, present, reason=reason)
    return now if picked is None else options[picked]


class Moved(Enum):
    """The state of a slider's change."""

    NOT = 0
    MOVING = 1  # a new value while it is held
    DONE = 2  # released, or typed after a click with Ctrl


@dataclass(frozen=True)
class Range:
    """The range of a slider."""

    low: float
    high: float
    log: bool = False
    whole: bool = False


def slider(gui: Gui, name: str, span: Range, value: float, form: str) -> tuple[Moved, float]:
    """Build a line with a label and a slider; return whether it moved, and to what.

    `form` formats a value, as in C. A click with Ctrl makes the slider a text field, in
    which a number may be outside the range.
    """
    label(name)
    return bare_slider(gui, name, span, value, form, width())


def bare_slider(
    gui: Gui, name: str, span: Range, value: float, form: str, across: float
) -> tuple[Moved, float]:
    """Build a slider of a width without a label, as `slider` does."""
    flags = imgui.SliderFlags_.logarithmic if span.log else 0
    storage, kept = imgui.get_state_storage(), imgui.get_id(f"last value of {name}")
    imgui.set_next_item_width(across)
    new: float
    if span.whole:
        ends = int(span.low), int(span.high)
        changed, new = imgui.slider_int(f"##{name}", int(value), *ends, form, flags)
    else:
        changed, new = imgui.slider_float(f"##{name}", value, span.low, span.high, form, flags)
    gui.mark(name)
    if changed and span.whole:
        storage.set_int(kept, int(new))
    elif changed:
        storage.set_float(kept, new)
    if imgui.is_item_deactivated_after_edit():
        last: float = storage.get_int(kept) if span.whole else storage.get_float(kept)
        return Moved.DONE, last
    return (Moved.MOVING, new) if changed else (Moved.NOT, value)
