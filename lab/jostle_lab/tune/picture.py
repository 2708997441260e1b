"""The picture of maps: milliseconds over leaf capacity and maximum depth."""

import io
import math
from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from jostle.writing import write

from .measure import ARTICLE, TOO_SLOW, Map

INK, SOFT, FAINT, PAPER = "#22282f", "#6b7684", "#e4e8ed", "#ffffff"
MARKS = {"fastest": "#c2453f", "default": INK, "article of 2015": "#d98a2b"}
# Pale where it is fast, dark where it is slow.
SLOWNESS = LinearSegmentedColormap.from_list(
    "slowness", ["#f6f4ec", "#cfe3d6", "#8fc0bd", "#5590a8", "#4f6d9e", "#4a4580", "#38244f"]
)
TICKS = (1, 1.5, 2, 3, 5, 10, 20)
CLOSE, DARK = 1.05, 3.6  # times the fastest: up to here bold, above white text
NOTE = (
    "Bold: at most 5 % slower than the fastest. Hatched: not timed, more than 20 times the "
    "default. A depth that no branch reaches is no limit."
)


def draw(maps: Sequence[Map], path: Path) -> None:
    """Draw one map, or several with two in a row."""
    columns = min(len(maps), 2)
    rows = -(-len(maps) // columns)
    width, height = (9.6, 5.9) if columns == 1 else (12.6, 3.9 * rows + 1.3)
    figure = Figure(figsize=(width, height), dpi=144, facecolor=PAPER)
    figure.set_layout_engine("constrained", rect=(0.008, 0.36 / height, 0.984, 1 - 1.16 / height))
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes, each in zip(grid.flat, maps, strict=False):
        _draw_map(axes, each)
        if columns > 1:
            axes.set_title(each.scene, loc="left", fontsize=11, fontweight="bold", color=INK)
    for axes in grid.flat[len(maps) :]:
        axes.set_axis_off()
    for axes in grid[-1, :]:
        axes.set_xlabel("leaf capacity: particles that a leaf may hold before it splits", color=INK)
    for axes in grid[:, 0]:
        axes.set_ylabel("maximum depth: subdivisions", color=INK)
    bar = figure.colorbar(
        ScalarMappable(LogNorm(1.0, TOO_SLOW), SLOWNESS), ax=grid, pad=0.02, aspect=32
    )
    bar.set_label("time, relative to the fastest", color=INK)
    bar.ax.set_yticks(TICKS, [f"{tick:g}" for tick in TICKS])
    bar.ax.set_yticks([], minor=True)
    bar.ax.tick_params(colors=INK, labelsize=9)
    bar.outline.set_visible(False)  # type: ignore[operator]
    _texts(figure, maps)
    data = io.BytesIO()
    figure.savefig(data, format=path.suffix[1:].lower())
    write(path, data.getvalue())


def in_ms(seconds: float) -> str:
    """Return milliseconds with three significant digits."""
    value = float(f"{1e3 * seconds:.3g}")
    return f"{value:,.{max(2 - math.floor(math.log10(value)), 0)}f}"


def _draw_map(axes: Axes, shown: Map) -> None:
    """Draw a cell for each setting, with its milliseconds, and frame the special ones."""
    capacities, depths = sorted(shown.depths), shown.rows()
    norm = LogNorm(1.0, TOO_SLOW)
    for row, depth in enumerate(depths):
        for column, capacity in enumerate(capacities):
            setting = shown.same_tree(capacity, depth)
            times, timed = shown.over_best(setting), setting in shown.rounds
            shade = SLOWNESS(norm(min(times, TOO_SLOW))) if timed else FAINT
            cell = Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor=shade, edgecolor=PAPER)
            cell.set_hatch("" if timed else "////")
            axes.add_patch(cell)
            axes.text(
                *(column, row - 0.02, in_ms(shown.seconds(setting)) if timed else ""),
                ha="center",
                va="center",
                fontsize=8,
                color=PAPER if times > DARK else INK,
                fontweight="bold" if times <= CLOSE else "normal",
            )
    frames = dict(zip(MARKS, (shown.best, shown.default, ARTICLE), strict=True))
    for number, (name, (capacity, depth)) in enumerate(frames.items()):
        row = depths.index(depth) if depth in depths else len(depths) - 1
        column, side = capacities.index(capacity), 0.96 - 0.08 * number
        corner, colour = (column - side / 2, row - side / 2), MARKS[name]
        axes.add_patch(Rectangle(corner, side, side, fill=False, edgecolor=colour, linewidth=2))
    axes.set_xlim(-0.5, len(capacities) - 0.5)
    axes.set_ylim(-0.5, len(depths) - 0.5)
    axes.set_xticks(range(len(capacities)), [f"{capacity}" for capacity in capacities])
    axes.set_yticks(range(len(depths)), [*(f"{depth}" for depth in depths[:-1]), "no limit"])
    axes.tick_params(length=0, colors=INK)
    axes.spines[:].set_visible(False)


def _texts(figure: Figure, maps: Sequence[Map]) -> None:
    """Draw the heading, the legend and the note."""
    width, height = figure.get_size_inches()
    scenes = f"{maps[0].scene}, " if len(maps) == 1 else ""
    threads = "one thread" if maps[0].threads == 1 else "several threads"
    details = f"{scenes}{maps[0].n:,} particles: build the tree and find all pairs, {threads}"
    for text, y, size, colour, weight in (
        ("Milliseconds over leaf capacity and depth", height - 0.3, 14, INK, "bold"),
        (details, height - 0.58, 9.5, SOFT, "normal"),
        (NOTE, 0.2, 8.5, SOFT, "normal"),
    ):
        figure.text(
            0.16 / width, y / height, text, va="center", size=size, color=colour, weight=weight
        )
    frames = [
        Patch(facecolor="none", edgecolor=colour, linewidth=2, label=name)
        for name, colour in MARKS.items()
    ]
    figure.legend(
        handles=frames,
        loc="upper right",
        bbox_to_anchor=(1 - 0.1 / width, 1 - 0.1 / height),
        ncols=len(frames),
        frameon=False,
        handlelength=1.2,
        handleheight=1.2,
        labelcolor=INK,
    )
