"""The statistics: where the time goes, how many pairs are tested, what energy and momentum do."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui

from jostle.app.gui import Gui
from jostle.app.palette import Colour
from jostle.app.panels import plots
from jostle.app.panels.ink import (
    ACCENT,
    ACROSS,
    CHOSEN,
    DOWN,
    KINETIC,
    POTENTIAL,
    RAISED,
    STAGES,
    TEXT_SOFT,
    TOTAL,
    ink,
    vec,
)  # fmt: skip
from jostle.app.panels.layout import TAB, layout
from jostle.app.panels.widgets import at_right, colours, hint, row, section, soft
from jostle.app.session import Session
from jostle.app.traces import SPAN
from jostle.app.words import pairs_of, scientific, share

MARGIN = 0.08  # of the span of a plot, left free above and below
LEAST_PLOT, MOST_PLOT = 56.0, 150.0
TEXT_LINES = 520.0  # what everything but the three plots needs, in points

FLAGS = (
    imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_nav
    | imgui.WindowFlags_.no_bring_to_front_on_focus
)  # fmt: skip


def build(session: Session, gui: Gui) -> None:
    """Build the panel at the right, folded or not, if there is room for it."""
    room = layout(session)
    if not room.figures:
        return
    height = room.height if session.shown.statistics else TAB
    imgui.set_next_window_pos((room.width - room.figures, 0.0))
    imgui.set_next_window_size((room.figures, height))
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 0.0)
    imgui.push_style_var(imgui.StyleVar_.window_border_size, 0.0)
    imgui.begin("statistics", None, FLAGS)
    imgui.pop_style_var(2)
    imgui.push_style_var(imgui.StyleVar_.item_spacing, (8.0, 4.0))
    _head(session, gui)
    if session.shown.statistics:
        build_sections(session, gui, (room.height - TEXT_LINES) / 3)
    imgui.pop_style_var()
    imgui.end()


def build_sections(session: Session, gui: Gui, height: float = 80.0) -> None:
    """Build the sections alone, with plots of a height as far as they can be read."""
    session.traces.refresh(session.now)
    height = min(max(height, LEAST_PLOT), MOST_PLOT)
    for title, contents in (("Time", _times), ("Pairs", _pairs), ("Energy", _energy),
                            ("Momentum", _momentum)):  # fmt: skip
        if section(gui, title):
            contents(session, gui, height)


def _head(session: Session, gui: Gui) -> None:
    """Build the line that folds the panel."""
    mean = session.traces.frame_mean
    words = f"{1e3 / mean:,.0f} pictures a second" if mean > 0 else "\u2013"
    with colours(header=vec(RAISED, 0.0), header_hovered=vec(RAISED, 0.5)):
        if imgui.selectable("##fold", False, imgui.SelectableFlags_.allow_overlap)[0]:
            session.toggle("statistics")
    gui.mark("statistics")
    imgui.same_line(imgui.get_style().window_padding.x)
    imgui.text_unformatted("Statistics")
    at_right(words, quiet=True)


def _swatch(name: str, colour: Colour, value: str) -> None:
    """Write a line of a legend: a dot, a name, a number."""
    at, size = imgui.get_cursor_screen_pos(), imgui.get_font_size()
    middle = at.y + size / 2 + 1
    draw = imgui.get_window_draw_list()
    draw.add_rect_filled((at.x, middle - 4), (at.x + 8, middle + 4), ink(colour), 2.0)
    imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + 16)
    soft(name)
    if value:
        at_right(value)


def _times(session: Session, gui: Gui, height: float) -> None:
    traces, stages = session.traces, session.statistics.stages
    tints = [STAGES.get(stage, TEXT_SOFT) for stage in stages]
    corner = f"{traces.top:g} ms, last {SPAN:g} s"
    with plots.plot("times", height, (-SPAN, 0.0), (0.0, traces.top), corner) as seen:
        if seen:
            plots.areas(traces.ages, traces.stacked, tints)
            plots.line("frame", traces.ages, traces.frames, TOTAL, 1.0)
    gui.mark("plot times")
    for stage, tint in reversed(list(zip(stages, tints, strict=True))):
        _swatch(stage, tint, f"{traces.means.get(stage, 0.0):.2f} ms")
    _swatch("from picture to picture", TOTAL, f"{traces.frame_mean:.2f} ms")


def _pairs(session: Session, gui: Gui, height: float) -> None:
    facts, every = session.frame.facts, pairs_of(len(session.frame))
    row("tested", f"{facts.pairs_tested:,}")
    row("of n(n\u22121)/2", f"{every:,}")
    row("share", share(facts.pairs_tested, every))
    row("touching", f"{facts.touching:,}")
    row("nodes of the tree", f"{facts.nodes:,}")
    row("depth of the tree", f"{facts.depth:,}")


def _energy(session: Session, gui: Gui, height: float) -> None:
    lines = (("kinetic", KINETIC), ("potential", POTENTIAL), ("total", TOTAL))
    _lines(session, gui, "energy", lines, height)
    drift = 100 * session.statistics.energy_drift
    row("drift since the start", f"{drift:+.2f} %".replace("-", "\u2212"))
    hint(
        "How far the total energy is from where it began, compared with the energy in play. "
        "Right physics loses energy to restitution and drag alone; the article's rules lose and "
        "invent it."
    )


def _momentum(session: Session, gui: Gui, height: float) -> None:
    lines = (("momentum_x", ACROSS), ("momentum_y", DOWN))
    _lines(session, gui, "momentum", lines, height)
    row("drift since the start", f"{100 * session.statistics.momentum_drift:.2f} %")
    with colours(button=vec(RAISED, 0.7), button_hovered=vec(ACCENT, 0.25),
                 button_active=vec(CHOSEN)):  # fmt: skip
        if imgui.button("Measure drift from now on", (-1.0, 25.0)):
            session.statistics.begin_again()
    gui.mark("measure drift")


WORDS = {"momentum_x": "to the right", "momentum_y": "down"}


def _lines(
    session: Session, gui: Gui, name: str, lines: tuple[tuple[str, Colour], ...], height: float
) -> None:
    """Plot columns of the sums over simulated time, with a legend that tells the last values."""
    traces = session.traces
    time = traces.sum("time")
    columns = [traces.sum(column) for column, _ in lines]
    if not len(time):
        return
    low, high = (float(f([f(c) for c in columns])) for f in (np.min, np.max))
    room = MARGIN * (high - low) or abs(high) or 1.0
    across = float(time[0]), max(float(time[-1]), float(time[0]) + 1.0)
    corner = f"{scientific(high)}, {across[1] - across[0]:,.0f} s"
    with plots.plot(name, height, across, (low - room, high + room), corner) as seen:
        if seen:
            for (column, colour), values in zip(lines, columns, strict=True):
                plots.line(column, time, values, colour)
    gui.mark(f"plot {name}")
    for (column, colour), values in zip(lines, columns, strict=True):
        _swatch(WORDS.get(column, column), colour, scientific(float(values[-1])))
