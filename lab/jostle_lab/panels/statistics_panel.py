"""The statistics panel: times of the stages, tested pairs, energy and momentum, with plots."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from itertools import zip_longest

import numpy as np
from imgui_bundle import imgui, imgui_ctx, implot

from jostle_lab.draw.palette import TEXT, TEXT_SOFT, Colour
from jostle_lab.draw.text import pairs_of, plural, scientific, share
from jostle_lab.gui.host import Gui
from jostle_lab.gui.style import RAISED, layout, rgba, vec
from jostle_lab.measure import SPAN, Floats
from jostle_lab.panels import widgets as ui
from jostle_lab.session import Session

BARE = (
    implot.Flags_.no_title | implot.Flags_.no_legend | implot.Flags_.no_menus
    | implot.Flags_.no_box_select | implot.Flags_.no_mouse_text | implot.Flags_.no_inputs
)  # fmt: skip
AXIS = implot.AxisFlags_.no_decorations
SMALL = 12.0
TAB = 34.0  # height of the folded panel
UNSEEN = 0.5  # points; thinner layers are not drawn
COLUMN_GAP = 18.0
LONG = 1e5  # larger numbers have a power of ten
# Whole points: at fractions of a pixel the width of a line varies.
THICK, THIN = 3.0, 2.0
TEXT_HEIGHT = 18.0  # points, of the text in a plot's corners
MARGIN = 0.08  # of the range of a plot, free above and below
LEAST_PLOT, MOST_PLOT = 44.0, 150.0
RESETS = (
    "The reference is reset when particles are added, removed or merged, and when gravity or the "
    "container changes."
)
TEXT_LINES = 572.0  # points, of everything except the three plots

# Stages in the order of work, from cool to warm; then drawing.
STAGES: dict[str, Colour] = {
    "bounds": (79, 109, 158),
    "build": (85, 144, 168),
    "pairs": (111, 176, 162),
    "contacts": (167, 197, 140),
    "resting": (198, 205, 130),
    "events": (226, 198, 124),
    "correction": (218, 172, 110),
    "store": (150, 158, 172),
    "forces": (131, 121, 210),
    "draw": (224, 155, 106),
    "panels": (201, 104, 106),
}
TOTAL: Colour = (220, 227, 236)
ENERGIES: dict[str, Colour] = {
    "total": TOTAL, "kinetic": (226, 198, 124), "potential": (85, 144, 168)
}  # fmt: skip
MOMENTA: dict[str, Colour] = {"x": (111, 176, 162), "y": (224, 155, 106)}


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
        draw, y = imgui.get_window_draw_list(), low.y + 3.0
        with imgui_ctx.push_font(None, SMALL):
            right = low.x + size.x - 6.0 - imgui.calc_text_size(corners[1]).x
            draw.add_text((low.x + 6.0, y), rgba(TEXT_SOFT), corners[0])
            draw.add_text((right, y), rgba(TEXT_SOFT), corners[1])
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
    spec = implot.Spec()
    spec.line_color, spec.line_weight = vec(colour), weight
    implot.plot_line(f"##{name}", at, values, spec)


def build(session: Session, gui: Gui) -> None:
    """Build the panel at the right, folded or not, if the window is wide enough."""
    widths = layout(session, *imgui.get_io().display_size)
    if not widths.statistics:
        return
    height = widths.height if session.view_options.statistics else TAB
    place = widths.width - widths.statistics, 0.0
    with ui.side_panel("statistics", place, (widths.statistics, height)):
        _head(session, gui)
        if session.view_options.statistics:
            build_sections(session, gui, (widths.height - TEXT_LINES) / 3)


def build_sections(session: Session, gui: Gui, height: float = 80.0) -> None:
    """Build the sections alone, with plots of about a height."""
    session.traces.refresh(session.frame, session.messages.now)
    height = min(max(height, LEAST_PLOT), MOST_PLOT)
    for title, contents in SECTIONS.items():
        if contents is _times and not session.shows_times:
            continue
        ui.section(gui, title, partial(contents, session, gui, height))


def _head(session: Session, gui: Gui) -> None:
    """Build the heading, which folds the panel."""
    mean = session.traces.frame_mean
    words = f"{1e3 / mean:,.0f} FPS" if mean > 0 else "\u2013"
    words = words if session.shows_times else ""
    with ui.colours(header=vec(RAISED, 0.0), header_hovered=vec(RAISED, 0.5)):
        if imgui.selectable("##fold", False, imgui.SelectableFlags_.allow_overlap)[0]:
            session.toggle("statistics")
    gui.mark("statistics")
    imgui.same_line(imgui.get_style().window_padding.x)
    imgui.text_unformatted("Statistics")
    ui.at_right(words, quiet=True)


def _swatch(name: str, colour: Colour, value: str, across: float = 0.0) -> None:
    """Draw an entry of a legend: a dot, a name, a number; as wide as the panel, or less."""
    across = across or ui.width()
    at, size = imgui.get_cursor_screen_pos(), imgui.get_font_size()
    middle = at.y + size / 2 + 1
    draw = imgui.get_window_draw_list()
    draw.add_rect_filled((at.x, middle - 4), (at.x + 8, middle + 4), rgba(colour), 2.0)
    draw.add_text((at.x + 16, at.y), rgba(TEXT_SOFT), name)
    draw.add_text((at.x + across - imgui.calc_text_size(value).x, at.y), rgba(TEXT), value)
    imgui.dummy((across, size))


def _times(session: Session, gui: Gui, height: float) -> None:
    traces, stages = session.traces, session.runner.statistics.stages
    tints = [STAGES.get(stage, TEXT_SOFT) for stage in stages]
    corner = f"{traces.top:g} ms", f"last {SPAN:g} s"
    top = traces.top * height / (height - TEXT_HEIGHT)  # no bar is behind the text
    with plot("times", height, (-SPAN, 0.0), (0.0, top), corner) as seen:
        if seen:
            stack(traces.ages, traces.stacked, tints, traces.top * UNSEEN / height)
            line("frame", traces.ages, traces.frames, TOTAL, 1.0)
    gui.mark("plot times")
    means = {stage: traces.means.get(stage, 0.0) for stage in stages}
    entries = [
        *zip(stages, tints, means.values(), strict=True),
        ("total", TOTAL, traces.frame_mean),
    ]
    half = -(-len(entries) // 2)  # two columns
    across = (ui.width() - COLUMN_GAP) / 2
    for pair in zip_longest(entries[:half], entries[half:]):
        for k, (name, tint, milliseconds) in enumerate(filter(None, pair)):
            if k:
                imgui.same_line(0.0, COLUMN_GAP)
            _swatch(name, tint, f"{milliseconds:.2f}", across)


def _pairs(session: Session, gui: Gui, height: float) -> None:
    facts, every = session.traces.stats, pairs_of(session.traces.count)
    ui.row("tested", f"{facts.pairs_tested:,}")
    ui.row("of n(n\u22121)/2", f"{every:,}")
    ui.row("tested, % of all pairs", share(facts.pairs_tested, every))
    ui.row("touching", f"{facts.touching:,}")
    ui.row("asleep", f"{facts.asleep:,}")
    ui.row("sub-steps", f"{facts.substeps:,}")
    ui.hint("Of the last step. A step takes more than the setting where contacts need them.")
    tree = f"{plural(facts.nodes, 'node')}, {facts.depth:,} deep" if facts.nodes else "\u2013"
    ui.row("tree", tree)


def _energy(session: Session, gui: Gui, height: float) -> None:
    _lines(gui, "energy", height, session.traces.energies, ENERGIES)
    change = ui.signed(100 * session.traces.energy_drift, "+,.2f") + " %"
    ui.row("change since start", change_text(session, change))
    ui.hint(
        "Change of the total energy since the reference, relative to the kinetic energy then or "
        "the range of the potential energy. Only restitution, friction and drag change it. "
        f"{RESETS} The potential energy is 0 at the left end."
    )


def _momentum(session: Session, gui: Gui, height: float) -> None:
    _lines(gui, "momentum", height, session.traces.momenta, MOMENTA)
    ui.row("external impulse", change_text(session, f"{100 * session.traces.momentum_drift:.2f} %"))
    ui.hint(
        "Change of momentum since the reference, relative to that of all particles moving one way: "
        "by walls, immovable particles and forces. Collisions of particles conserve momentum. "
        f"{RESETS}"
    )
    reset = session.runner.statistics.reset_reference
    ui.buttons(gui, ui.Button("measure drift", "Reset reference", reset))


def _lines(gui: Gui, name: str, height: float, table: Floats, tints: dict[str, Colour]) -> None:
    """Plot the columns after the simulated time, with a legend of their last values."""
    time, values = table[0], table[1:]
    if not len(time):
        return
    low, high = float(values.min()), float(values.max())
    margin = MARGIN * (high - low) or abs(high) or 1.0
    across = float(time[0]), max(float(time[-1]), float(time[0]) + 1.0)
    corners = _sum(high), f"{across[1] - across[0]:,.0f} s"
    # No line crosses the text in the corners.
    above = (high - low) * TEXT_HEIGHT / (height - TEXT_HEIGHT)
    columns = list(zip(tints.items(), values, strict=True))
    with plot(name, height, across, (low - margin, high + margin + above), corners) as seen:
        if seen:
            for (word, tint), column in columns:
                line(word, time, column, tint, THICK if word == "total" else THIN)
    gui.mark(f"plot {name}")
    for (word, tint), column in columns:
        _swatch(word, tint, _sum(float(column[-1])))


def change_text(session: Session, change: str) -> str:
    """Return a change and its duration, or why there is none."""
    if not session.traces.changing:
        return f"{change} in {session.traces.measured:,.0f} s"
    merging = session.engine.effective_settings.on_touch == "merge"
    return "particles merge" if merging else "particles are added and removed"


def _sum(value: float) -> str:
    return (
        ui.signed(value, ",.1f") if abs(value) < LONG else scientific(value).replace("-", "\u2212")
    )


SECTIONS = {"Frame time": _times, "Pairs": _pairs, "Energy": _energy, "Momentum": _momentum}
