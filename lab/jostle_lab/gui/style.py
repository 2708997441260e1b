"""The style of the panels: widths, colours, spacing and font."""

from dataclasses import dataclass
from functools import lru_cache

from imgui_bundle import imgui, implot

from jostle_lab.draw.palette import ACCENT, PANEL, PANEL_EDGE, TEXT, TEXT_SOFT, Colour, blend
from jostle_lab.draw.text import FONT, ICONS, font_file
from jostle_lab.session import Session

COLUMN, STATISTICS = 290.0, 296.0  # points
NARROW = 0.42  # largest fraction of the window's width for the column
LEAST_COLUMN = 220.0  # in a narrower window there is no column
STATISTICS_FROM = 1180.0  # in a narrower window the statistics are in the column
FONT_SIZE, ICON_SIZE = 15.0, 13.0  # points
FIELD: Colour = (30, 37, 47)  # frames of sliders and fields
RAISED: Colour = (41, 51, 64)  # buttons, headers, hovered widgets
PRESSED: Colour = (54, 70, 82)
CHOSEN: Colour = blend(PANEL[:3], ACCENT, 0.34)  # of a widget that is on
FILLED: Colour = blend(PANEL[:3], ACCENT, 0.7)  # of the filled part of a slider


@dataclass(frozen=True)
class Layout:
    """Widths of the panels in points, 0 if hidden, and the size of the window."""

    column: float
    statistics: float
    covered: float  # at the right: nothing if the statistics are folded
    width: float
    height: float


def layout(session: Session, width: float, height: float) -> Layout:
    """Return the layout of a window of a size in points."""
    column = min(COLUMN, NARROW * width)
    if column < LEAST_COLUMN or not session.view_options.panels:
        return Layout(0.0, 0.0, 0.0, width, height)
    statistics = STATISTICS if width >= STATISTICS_FROM else 0.0
    covered = statistics if session.view_options.statistics else 0.0
    return Layout(column, statistics, covered, width, height)


def arrange(session: Session, width: float, height: float, scale: float) -> None:
    """Set the camera's margins to the panels; `scale` is pixels per point."""
    widths = layout(session, width, height)
    session.camera.set_margins(round(widths.column * scale), round(widths.covered * scale))


def apply() -> None:
    """Set the style of the present contexts of ImGui and ImPlot."""
    fonts = imgui.get_io().fonts
    for font, size in ((FONT, FONT_SIZE), (ICONS, ICON_SIZE)):
        path, config = font_file(font), imgui.ImFontConfig()
        config.pixel_snap_h, config.merge_mode = True, font is ICONS
        if path is not None:
            fonts.add_font_from_file_ttf(path, size, config)
    _measures(imgui.get_style())
    _colours(imgui.get_style())
    _plots(implot.get_style())


def _measures(style: imgui.Style) -> None:
    style.window_rounding = style.popup_rounding = 8.0
    style.child_rounding = style.scrollbar_rounding = 6.0
    style.frame_rounding = style.grab_rounding = 4.0
    style.window_padding = imgui.ImVec2(14.0, 12.0)
    style.frame_padding = imgui.ImVec2(8.0, 4.0)
    style.item_spacing = imgui.ImVec2(8.0, 7.0)
    style.item_inner_spacing = imgui.ImVec2(8.0, 4.0)
    style.scrollbar_size = 11.0
    style.grab_min_size = 10.0
    style.window_border_size = style.popup_border_size = 1.0
    style.frame_border_size = 0.0


def _colours(style: imgui.Style) -> None:
    soft = blend(PANEL[:3], ACCENT, 0.45)
    names: dict[str, imgui.ImVec4] = {
        "text": vec(TEXT),
        "text_disabled": vec(TEXT_SOFT),
        "window_bg": vec(PANEL[:3]),
        "child_bg": vec(PANEL[:3], 0.0),
        "popup_bg": vec(PANEL[:3]),
        "border": vec(PANEL_EDGE),
        "separator": vec(PANEL_EDGE),
        "scrollbar_bg": vec(PANEL[:3], 0.0),
        "scrollbar_grab": vec(RAISED),
        "scrollbar_grab_hovered": vec(PRESSED),
        "scrollbar_grab_active": vec(soft),
        "check_mark": vec(ACCENT),
        "slider_grab": vec(FILLED),
        "slider_grab_active": vec(ACCENT),
        "text_selected_bg": vec(soft, 0.6),
    }
    for name, ordinary in (("frame_bg", FIELD), ("button", RAISED), ("header", RAISED)):
        names[name] = vec(ordinary)
        names[f"{name}_hovered"] = vec(blend(ordinary, PRESSED, 0.6))
        names[f"{name}_active"] = vec(PRESSED)
    for name, colour in names.items():
        style.set_color_(getattr(imgui.Col_, name), colour)


def _plots(style: implot.Style) -> None:
    names = {
        "frame_bg": vec(FIELD, 0.0),
        "plot_bg": vec(FIELD, 0.55),
        "axis_grid": vec(TEXT_SOFT, 0.16),
    }
    for name, colour in names.items():
        style.set_color_(getattr(implot.Col_, name), colour)
    style.plot_border_size = 0.0


@lru_cache(maxsize=256)
def rgba(colour: Colour, alpha: float = 1.0) -> int:
    """Return a colour as an integer, for draw lists."""
    red, green, blue = colour
    return round(255 * alpha) << 24 | blue << 16 | green << 8 | red


@lru_cache(maxsize=256)
def vec(colour: Colour, alpha: float = 1.0) -> imgui.ImVec4:
    """Return a colour as a vector, for styles."""
    red, green, blue = (channel / 255 for channel in colour)
    return imgui.ImVec4(red, green, blue, alpha)
