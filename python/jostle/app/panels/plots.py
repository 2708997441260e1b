"""Plots of lines and stacked bars, with the range of the axes in the corners."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from imgui_bundle import imgui, implot
from numpy.typing import NDArray

from jostle.app.draw.palette import TEXT_SOFT, Colour
from jostle.app.gui.style import rgba, vec

Floats = NDArray[np.float64]

BARE = (
    implot.Flags_.no_title | implot.Flags_.no_legend | implot.Flags_.no_menus
    | implot.Flags_.no_box_select | implot.Flags_.no_mouse_text | implot.Flags_.no_inputs
)  # fmt: skip
AXIS = implot.AxisFlags_.no_decorations
SMALL = 12.0


@contextmanager
def plot(
    name: str,
    height: float,
    across: tuple[float, float],
    up: tuple[float, float],
    corners: tuple[str, str],
) -> Iterator[bool]:
    """Make a plot with limits of the axes; `corners` are the texts of the upper two."""
    implot.push_style_var(implot.StyleVar_.plot_padding, (0.0, 3.0))
    seen = implot.begin_plot(f"##{name}", (-1.0, height), BARE)
    if seen:
        grid = AXIS & ~implot.AxisFlags_.no_grid_lines
        implot.setup_axes("", "", AXIS, grid)
        implot.setup_axes_limits(*across, *up, imgui.Cond_.always)
        implot.setup_finish()
    yield seen
    if seen:
        low, size = implot.get_plot_pos(), implot.get_plot_size()
        implot.end_plot()
        imgui.push_font(None, SMALL)
        draw, y = imgui.get_window_draw_list(), low.y + 3.0
        right = low.x + size.x - 6.0 - imgui.calc_text_size(corners[1]).x
        draw.add_text((low.x + 6.0, y), rgba(TEXT_SOFT), corners[0])
        draw.add_text((right, y), rgba(TEXT_SOFT), corners[1])
        imgui.pop_font()
    implot.pop_style_var()


def stack(at: Floats, stacked: Floats, colours: Sequence[Colour], least: float) -> None:
    """Draw stacked bars: the highest first, each covered by those below it.

    Boxes are fast without a graphics card. A layer that is nowhere thicker than `least` is omitted.
    """
    width = float(at[1] - at[0])
    thick = (stacked[1:] - stacked[:-1]).max(axis=1) > least
    for k in np.flatnonzero(thick)[::-1].tolist():
        spec = implot.Spec()
        spec.fill_color, spec.line_weight = vec(colours[k]), 0.0
        spec.line_color = spec.fill_color
        implot.plot_bars(f"##bars {k}", at, stacked[k + 1], width, spec)


def line(name: str, at: Floats, values: Floats, colour: Colour, weight: float = 1.5) -> None:
    """Draw a line."""
    spec = implot.Spec()
    spec.line_color, spec.line_weight = vec(colour), weight
    implot.plot_line(f"##{name}", at, values, spec)
