"""A slider with a label and a number that can be typed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from imgui_bundle import imgui, imgui_ctx

from jostle_lab.draw.palette import ACCENT, TEXT, TEXT_SOFT
from jostle_lab.gui.host import Gui
from jostle_lab.gui.style import FILLED, RAISED, rgba, vec
from jostle_lab.panels.widgets import CLEAR, GAP, NUMBER, colours, hint, label, width

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
    gui: Gui,
    name: str,
    span: Range,
    value: float,
    write: Callable[[float], str],
    *,
    reason: str = "",
) -> tuple[Moved, float]:
    """Build one line: label, slider, number; return whether it moved, and to what.

    `write` formats a value. `reason` says why it is disabled; it is empty if it is not.
    """
    imgui.push_id(name)
    label(name)
    imgui.begin_disabled(bool(reason))
    moved, value = _track(gui, name, span, value)
    imgui.end_disabled()
    hint(reason)
    imgui.same_line(0.0, GAP)
    imgui.begin_disabled(bool(reason))
    typed = _number(gui, name, write(value), soft=bool(reason))
    imgui.end_disabled()
    imgui.pop_id()
    if typed is not None:
        kept = min(max(typed, span.low), span.high)
        return Moved.DONE, round(kept) if span.whole else kept
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


def _number(gui: Gui, name: str, text: str, *, soft: bool) -> float | None:
    """Build the number as a text field without a frame; return a typed number."""
    room, padding = max(width(), 8.0), imgui.get_style().frame_padding
    size = imgui.ImVec2(room, imgui.get_frame_height())
    low, editing = imgui.get_cursor_screen_pos(), imgui.get_id("##number")
    lit = imgui.is_mouse_hovering_rect(low, low + size) and not soft
    frame, left = vec(RAISED), padding.x
    if imgui.internal.get_active_id() != editing:  # flush right, until it is edited
        frame, left = CLEAR, room - imgui.calc_text_size(text).x
    colour = vec(TEXT_SOFT if soft else ACCENT if lit else TEXT)
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
