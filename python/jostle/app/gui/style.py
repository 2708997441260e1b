"""The style of the panels: colours, spacing and font."""

from __future__ import annotations

from imgui_bundle import imgui, implot

from jostle.app.draw import palette
from jostle.app.draw.palette import Colour, blend
from jostle.app.draw.text import FONTS, ICONS, font_file

FONT_SIZE, ICON_SIZE = 15.0, 13.0  # points

FIELD: Colour = (30, 37, 47)  # frames of sliders and fields
RAISED: Colour = (41, 51, 64)  # buttons, headers, hovered widgets
PRESSED: Colour = (54, 70, 82)


def apply() -> None:
    """Set the style of the present contexts of ImGui and ImPlot."""
    fonts = imgui.get_io().fonts
    for files, size in ((FONTS, FONT_SIZE), (ICONS, ICON_SIZE)):
        path, config = font_file(files), imgui.ImFontConfig()
        config.pixel_snap_h, config.merge_mode = True, files is ICONS
        if path is not None:
            fonts.add_font_from_file_ttf(path, size, config)
    _measures(imgui.get_style())
    _colours(imgui.get_style())
    _plots(implot.get_style())


def _measures(style: imgui.Style) -> None:
    style.window_rounding = style.popup_rounding = 8.0
    style.child_rounding = 6.0
    style.frame_rounding = style.grab_rounding = style.tab_rounding = 4.0
    style.scrollbar_rounding = 6.0
    style.window_padding = imgui.ImVec2(14.0, 12.0)
    style.frame_padding = imgui.ImVec2(8.0, 4.0)
    style.item_spacing = imgui.ImVec2(8.0, 7.0)
    style.item_inner_spacing = imgui.ImVec2(8.0, 4.0)
    style.scrollbar_size = 11.0
    style.grab_min_size = 10.0
    style.window_border_size = style.popup_border_size = 1.0
    style.frame_border_size = 0.0
    style.window_title_align = imgui.ImVec2(0.0, 0.5)
    style.window_menu_button_position = imgui.Dir.right


def _colours(style: imgui.Style) -> None:
    panel = palette.PANEL[:3]
    accent, soft = palette.ACCENT, blend(panel, palette.ACCENT, 0.45)
    names: dict[str, imgui.ImVec4] = {
        "text": _of(palette.TEXT),
        "text_disabled": _of(palette.TEXT_SOFT),
        "window_bg": _of(panel),
        "child_bg": _of(panel, 0.0),
        "popup_bg": _of(panel),
        "border": _of(palette.PANEL_EDGE),
        "title_bg": _of(panel, palette.PANEL[3] / 255),
        "title_bg_active": _of(panel, palette.PANEL[3] / 255),
        "title_bg_collapsed": _of(panel, palette.PANEL[3] / 255),
        "menu_bar_bg": _of(FIELD),
        "scrollbar_bg": _of(panel, 0.0),
        "scrollbar_grab": _of(RAISED),
        "scrollbar_grab_hovered": _of(PRESSED),
        "scrollbar_grab_active": _of(soft),
        "check_mark": _of(accent),
        "slider_grab": _of(blend(FIELD, accent, 0.75)),
        "slider_grab_active": _of(accent),
        "separator": _of(palette.PANEL_EDGE),
        "separator_hovered": _of(soft),
        "separator_active": _of(accent),
        "resize_grip": _of(RAISED, 0.0),
        "resize_grip_hovered": _of(PRESSED),
        "resize_grip_active": _of(soft),
        "tab": _of(FIELD),
        "tab_hovered": _of(PRESSED),
        "tab_selected": _of(RAISED),
        "tab_selected_overline": _of(accent),
        "plot_lines": _of(accent),
        "plot_histogram": _of(accent),
        "text_selected_bg": _of(soft, 0.6),
        "table_header_bg": _of(FIELD),
        "table_border_strong": _of(palette.PANEL_EDGE),
        "table_border_light": _of(FIELD),
        "modal_window_dim_bg": _of((0, 0, 0), 0.45),
    }
    for name, ordinary in (("frame_bg", FIELD), ("button", RAISED), ("header", RAISED)):
        names[name] = _of(ordinary)
        names[f"{name}_hovered"] = _of(blend(ordinary, PRESSED, 0.6))
        names[f"{name}_active"] = _of(PRESSED)
    for name, colour in names.items():
        style.set_color_(getattr(imgui.Col_, name), colour)


def _plots(style: implot.Style) -> None:
    names = {
        "frame_bg": _of(FIELD, 0.0),
        "plot_bg": _of(FIELD, 0.55),
        "plot_border": _of(palette.PANEL_EDGE),
        "legend_bg": _of(palette.PANEL[:3], 0.0),
        "legend_border": _of(palette.PANEL_EDGE, 0.0),
        "axis_text": _of(palette.TEXT_SOFT),
        "axis_grid": _of(palette.TEXT_SOFT, 0.16),
        "inlay_text": _of(palette.TEXT_SOFT),
    }
    for name, colour in names.items():
        style.set_color_(getattr(implot.Col_, name), colour)
    style.plot_padding = imgui.ImVec2(4.0, 6.0)
    style.label_padding = imgui.ImVec2(4.0, 3.0)
    style.plot_border_size = 0.0


def _of(colour: Colour, alpha: float = 1.0) -> imgui.ImVec4:
    red, green, blue = (channel / 255 for channel in colour)
    return imgui.ImVec4(red, green, blue, alpha)
