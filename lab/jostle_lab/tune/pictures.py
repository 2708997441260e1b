"""The pictures: a map of leaf capacity × depth, and curves of time over particles and world size.

Only this file imports matplotlib; it draws into files and opens no window.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from jostle.writing import write
from jostle_lab.tune.candidates import Setting
from jostle_lab.tune.findings import FRAME, crossing, curve, size_gain, two_digits
from jostle_lab.tune.report import in_ms, title
from jostle_lab.tune.sweep import (
    ARTICLE_CAPACITY,
    ARTICLE_DEPTH,
    COUNT_METHODS,
    DEPTHS,
    TOO_SLOW,
    WORLD_SIZES,
    Tuning,
)
from jostle_lab.tune.timing import Outcome

End = tuple[float, float, str, str]  # of a curve: its last point, its name and its colour

INK, SOFT, FAINT, PAPER = "#22282f", "#6b7684", "#dde2e8", "#ffffff"
METHOD_COLOURS = dict(zip(COUNT_METHODS, ("#2f7f86", "#c77a3c", "#8a6aa8"), strict=True))
METHOD_NAMES = dict(
    zip(COUNT_METHODS, ("jostle's tree", "brute force", "the article's tree"), strict=True)
)
BEST = "#c2453f"
# Pale where it is fast, dark where it is slow.
SLOWNESS = LinearSegmentedColormap.from_list(
    "slowness", ["#f6f4ec", "#cfe3d6", "#8fc0bd", "#5590a8", "#4f6d9e", "#4a4580", "#38244f"]
)
TICKS = (1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0)
DARK = 3.6  # times the best; slower cells have white text
CAPACITY_LABEL = "leaf capacity: maximum number of particles in a leaf"
DEPTH_LABEL = "maximum depth: maximum number of subdivisions"
DOTS = 144  # per inch
AXES_HEIGHT = 260  # approximate height of the axes of curves, in points
BOX = {"boxstyle": "square,pad=0.1", "facecolor": PAPER, "edgecolor": "none"}
MAP_NOTE = (
    "Red frame: the best. Bold: not significantly slower. "
    "A depth that no branch reaches gives the tree of the row without a limit, timed once."
)
FEW_NOTE = "Red frame: the fastest, in too few rounds for a comparison."
CURVES_NOTE = (
    "Brute force runs in the same core as the tree; the article's time is that of a whole frame of "
    "its program, in Python."
)


def settings(tuning: Tuning, path: Path) -> bool:
    """Draw the map of leaf capacity × depth; return whether there are data."""
    if not any(outcome.rounds for outcome in tuning.settings.values()):
        return False
    figure = _figure(9.6, 6.2)
    axes = figure.add_subplot()
    draw_map(axes, tuning, both="default" if tuning.gain().too_few else "default = best")
    axes.set_xlabel(CAPACITY_LABEL, color=INK)
    axes.set_ylabel(DEPTH_LABEL, color=INK)
    best = min(outcome.median for outcome in tuning.settings.values())
    _colour_bar(figure, [axes], f"time, relative to the fastest ({in_ms(best)})")
    note = FEW_NOTE if tuning.too_few() else MAP_NOTE
    _frame_texts(figure, "Leaf capacity and depth", title(tuning), note)
    _save(figure, path)
    return True


def maps(tunings: Sequence[Tuning], columns: int, path: Path) -> None:
    """Draw the maps of several scenes into one picture."""
    rows = -(-len(tunings) // columns)
    figure = _figure(5.8 * columns + 1.0, 3.9 * rows + 1.2)
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes, tuning in zip(grid.flat, tunings, strict=False):
        draw_map(axes, tuning)
        axes.set_title(tuning.scene, loc="left", fontsize=11, fontweight="bold", color=INK)
    for axes in grid.flat[len(tunings) :]:
        axes.set_axis_off()
    for axes in grid[-1]:
        axes.set_xlabel(CAPACITY_LABEL, color=INK)
    for axes in grid[:, 0]:
        axes.set_ylabel(DEPTH_LABEL, color=INK)
    _colour_bar(figure, list(grid.flat), "time, relative to the fastest of the scene")
    details = title(tunings[0]).partition(", ")[2]
    _frame_texts(figure, "Leaf capacity and depth", details, MAP_NOTE)
    _save(figure, path)


def draw_map(axes: Axes, tuning: Tuning, both: str = "default") -> None:
    """Draw the cells, each with its time relative to the best, and mark special ones.

    `both` is the text in a cell that is the default and the best.
    """
    capacities, depths = sorted(tuning.tree_depths), map_depths(tuning)
    best = min(outcome.median for outcome in tuning.settings.values())
    norm, marks, tell = _norm(), _marks(tuning, both), not tuning.too_few()
    for row, depth in enumerate(depths):
        for column, capacity in enumerate(capacities):
            setting = tuning.cell(capacity, depth)
            outcome = tuning.settings.get(setting, Outcome())
            times = outcome.median / best
            dark = bool(outcome.rounds) and times > DARK
            colour = SLOWNESS(norm(min(times, TOO_SLOW))) if outcome.rounds else FAINT
            cell = Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor=colour, edgecolor=PAPER)
            cell.set_hatch("////" if outcome.too_slow else "")
            axes.add_patch(cell)
            marked = marks.get((capacity, depth))
            axes.text(
                *(column, row + (0.1 if marked else 0.0)),
                _multiple(times) if outcome.rounds else ">20" if outcome.too_slow else "–",
                ha="center",
                va="center",
                fontsize=8.5,
                color=PAPER if dark else INK,
                fontweight="bold" if tell and _is_as_good(tuning, setting) else "normal",
            )
            if marked:
                _mark(axes, (column, row), marked, dark=dark)
    axes.set_xlim(-0.5, len(capacities) - 0.5)
    axes.set_ylim(-0.5, len(depths) - 0.5)
    axes.set_xticks(range(len(capacities)), [f"{capacity}" for capacity in capacities])
    names = [f"{depth}" for depth in depths[:-1]]
    axes.set_yticks(range(len(depths)), [*names, "no limit"])
    axes.tick_params(length=0, colors=INK)
    axes.spines[:].set_visible(False)


def map_depths(tuning: Tuning) -> list[int]:
    """Return the rows of the map: the depths that limit some tree, and one without a limit."""
    deepest = max(tuning.tree_depths.values())
    return [*(depth for depth in DEPTHS if depth < deepest), tuning.default.max_depth]


def _is_as_good(tuning: Tuning, setting: Setting) -> bool:
    outcome = tuning.settings.get(setting, Outcome())
    return bool(outcome.rounds) and tuning.is_as_good(setting)


def _marks(tuning: Tuning, both: str) -> dict[tuple[int, int], tuple[str, str]]:
    """Return the cells to be framed: the text in each, and the colour of its frame."""
    best, default = tuning.best(), tuning.default
    marks = {
        (ARTICLE_CAPACITY, ARTICLE_DEPTH): ("article", METHOD_COLOURS["article's tree"]),
        (default.leaf_capacity, default.max_depth): (both if best == default else "default", INK),
    }
    cell = (best.leaf_capacity, best.max_depth)
    word, _ = marks.get(cell, ("best", BEST))
    return {**marks, cell: (word, BEST)}


def _mark(axes: Axes, place: tuple[int, int], mark: tuple[str, str], *, dark: bool) -> None:
    (column, row), (word, colour) = place, mark
    corner, side = (column - 0.44, row - 0.44), 0.88
    axes.add_patch(Rectangle(corner, side, side, fill=False, edgecolor=colour, linewidth=2.0))
    words = PAPER if dark else colour
    size = 7 if len(word) < 10 else 5.8
    axes.text(column, row - 0.40, word, ha="center", va="bottom", fontsize=size, color=words)


def _colour_bar(figure: Figure, axes: list[Axes], words: str) -> None:
    bar = figure.colorbar(ScalarMappable(_norm(), SLOWNESS), ax=axes, pad=0.02, aspect=32)
    bar.set_label(words, color=INK)
    bar.ax.yaxis.set_major_locator(FixedLocator(TICKS))
    bar.ax.yaxis.set_minor_locator(NullLocator())
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    bar.ax.tick_params(colors=INK, labelsize=9)
    bar.outline.set_visible(False)  # type: ignore[operator]


def curves(tuning: Tuning, path: Path) -> bool:
    """Draw time over particles and over world size; return whether there are data."""
    if not curve(tuning.counts, "quadtree"):
        return False
    figure = _figure(11.5, 5.4)
    left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
    _draw_counts(left, tuning)
    _draw_sizes(right, tuning)
    words = "Number of particles, and size of their world"
    _frame_texts(figure, words, title(tuning), CURVES_NOTE)
    _save(figure, path)
    return True


def _draw_counts(axes: Axes, tuning: Tuning) -> None:
    ends: list[End] = []
    for method in COUNT_METHODS:
        points = curve(tuning.counts, method)
        if not points:
            continue
        colour = METHOD_COLOURS[method]
        counts, seconds = zip(*points, strict=True)
        times = 1e3 * np.array(seconds)
        axes.plot(counts, times, "o-", color=colour, markersize=4, linewidth=1.8)
        if method != "article's tree":
            ends.append((counts[-1], times[-1], METHOD_NAMES[method], colour))
            continue
        axes.annotate(  # the uppermost and shortest
            METHOD_NAMES[method],
            (counts[max(len(points) - 2, 0)], times[max(len(points) - 2, 0)]),
            xytext=(-8, 6),
            textcoords="offset points",
            color=colour,
            va="bottom",
            ha="right",
            bbox=BOX,
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    _label_ends(axes, ends)
    axes.axhline(1e3 * FRAME, color=SOFT, linewidth=0.9, linestyle=(0, (4, 3)))
    axes.annotate(
        "1/60 s",
        (0, 1e3 * FRAME),
        xycoords=("axes fraction", "data"),
        xytext=(5, 3),
        textcoords="offset points",
        fontsize=8.5,
        color=SOFT,
        bbox=BOX,
    )
    if (n := crossing(tuning.counts)) is not None:
        axes.axvline(n, color=FAINT, linewidth=1.2, zorder=0)
        axes.annotate(
            f"the tree is faster\nfrom about {two_digits(n):,}",
            (n, 0),
            xycoords=("data", "axes fraction"),
            xytext=(5, 6),
            textcoords="offset points",
            fontsize=8.5,
            color=SOFT,
            bbox=BOX,
        )
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,g}"))
    axes.set_xlabel("particles")
    axes.set_ylabel("time, ms")
    _calm(axes)


def _draw_sizes(axes: Axes, tuning: Tuning) -> None:
    """Draw a line for the smallest leaf capacity, the default, and the best at the scene's size."""
    ends: list[End] = []
    for capacity, (word, colour) in _shown_sizes(tuning).items():
        points = sorted(
            (setting.world_size, 1e3 * outcome.median)
            for setting, outcome in tuning.sizes.items()
            if setting.leaf_capacity == capacity and outcome.rounds
        )
        if not points:
            continue
        axes.plot(*zip(*points, strict=True), "o-", color=colour, markersize=4, linewidth=1.8)
        ends.append((*points[-1], f"{capacity}{word}", colour))
    if not axes.lines:
        axes.set_axis_off()
        return
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(FixedLocator(WORLD_SIZES))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"×{value:g}"))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,g}"))
    axes.yaxis.set_minor_formatter(FuncFormatter(lambda value, _: f"{value:,g}"))
    axes.set_xlabel("width and height of the world")
    axes.set_ylabel("time, ms")
    axes.set_title("by leaf capacity", loc="left", fontsize=9, color=SOFT)
    _label_ends(axes, ends)
    _calm(axes)


def _shown_sizes(tuning: Tuning) -> dict[int, tuple[str, str]]:
    """Return the leaf capacities to be drawn: a label of each, and its colour."""
    capacities = {setting.leaf_capacity for setting in tuning.sizes}
    default, found = tuning.default.leaf_capacity, size_gain(tuning, 1.0)
    shown = {min(capacities, default=default): ("", METHOD_COLOURS["quadtree"])}
    shown[default] = (" (default)", INK)
    if found is not None and not found[2].too_few:
        best = default if found[2].within_noise else found[1]
        shown[best] = (" (default = best)" if best == default else " (best at ×1)", BEST)
    return shown


def _label_ends(axes: Axes, ends: Sequence[End]) -> None:
    """Draw names to the right of the ends of curves, one above the other."""
    low, high = np.log(axes.get_ylim())
    least, last = 14 / AXES_HEIGHT, -np.inf
    for x, y, words, colour in sorted(ends, key=lambda end: end[1]):
        place = (np.log(y) - low) / (high - low)
        last = max(place, last + least)
        axes.annotate(
            words,
            (x, y),
            xytext=(8, (last - place) * AXES_HEIGHT),
            textcoords="offset points",
            color=colour,
            va="center",
            bbox=BOX,
        )


def _figure(width: float, height: float) -> Figure:
    """Return an empty figure with space for a heading and a note."""
    figure = Figure(figsize=(width, height), dpi=DOTS, facecolor=PAPER)
    head, foot = 0.78 / height, 0.4 / height
    figure.set_layout_engine("constrained", rect=(0.008, foot, 0.984, 1 - head - foot))
    return figure


def _save(figure: Figure, path: Path) -> None:
    data = io.BytesIO()
    figure.savefig(data, format="png")
    write(path, data.getvalue())


def _frame_texts(figure: Figure, words: str, details: str, note: str) -> None:
    """Draw the heading and the note."""
    width, height = figure.get_size_inches()
    left = 0.16 / width
    for text, y, size, colour, weight in (
        (words, height - 0.3, 14, INK, "bold"),
        (details, height - 0.57, 9.5, SOFT, "normal"),
        (note, 0.2, 8.5, SOFT, "normal"),
    ):
        figure.text(
            *(left, y / height, text),
            ha="left",
            va="center",
            fontsize=size,
            color=colour,
            fontweight=weight,
        )


def _calm(axes: Axes) -> None:
    axes.grid(True, which="major", color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(SOFT)
    axes.tick_params(colors=INK, which="both", labelsize=9)
    axes.xaxis.label.set_color(INK)
    axes.yaxis.label.set_color(INK)


def _norm() -> LogNorm:
    return LogNorm(1.0, TOO_SLOW)


def _multiple(times: float) -> str:
    return f"{times:.2f}" if times < 1.995 else f"{times:.1f}" if times < 9.95 else f"{times:.0f}"
