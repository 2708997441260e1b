"""The picture of maps: milliseconds over leaf capacity and maximum depth."""

import io
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import Patch, Rectangle

from jostle.writing import write

from .measure import ARTICLE, TOO_SLOW, Map

INK, FAINT = "#22282f", "#e4e8ed"
MARKS = {"fastest": "#c2453f", "default": INK, "article of 2015": "#d98a2b"}
# Pale where it is fast, dark where it is slow; grey where it was not timed.
SLOWNESS = LinearSegmentedColormap.from_list(
    "slowness", ["#f6f4ec", "#cfe3d6", "#8fc0bd", "#5590a8", "#4f6d9e", "#4a4580", "#38244f"]
).with_extremes(bad=FAINT)
TICKS = (1, 1.5, 2, 3, 5, 10, 20)
CLOSE, DARK = 1.05, 3.6  # times the fastest: up to here bold, above white text
NOTE = (
    "Bold: at most 5 % slower than the fastest. Grey: not timed, more than 20 times the default. "
    "A depth that no branch reaches is no limit."
)


def draw(maps: Sequence[Map], path: Path) -> None:
    """Draw one map, or several with two in a row."""
    columns = min(len(maps), 2)
    rows = -(-len(maps) // columns)
    width, height = (9.6, 5.9) if columns == 1 else (12.6, 3.9 * rows + 1.3)
    figure = Figure(figsize=(width, height), dpi=144, layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    images = [_draw_map(axes, each) for axes, each in zip(grid.flat, maps, strict=False)]
    for axes in grid.flat[len(maps) :]:
        axes.set_axis_off()
    for axes in grid[-1, :]:
        axes.set_xlabel("leaf capacity: particles that a leaf may hold before it splits")
    figure.supylabel("maximum depth: subdivisions", fontsize=10)
    label = "time, relative to the fastest"
    bar = figure.colorbar(images[0], ax=grid, label=label, ticks=TICKS, format="%g", aspect=32)
    bar.ax.set_yticks([], minor=True)
    threads = "one thread" if maps[0].threads == 1 else "several threads"
    figure.suptitle(
        "Milliseconds over leaf capacity and depth\n"
        f"{maps[0].n:,} particles: build the tree and find all pairs, {threads}",
        fontsize=12,
    )
    frames = [
        Patch(facecolor="none", edgecolor=colour, linewidth=2, label=name)
        for name, colour in MARKS.items()
    ]
    figure.legend(
        handles=frames, loc="outside lower center", ncols=len(frames), frameon=False, title=NOTE,
        title_fontsize=8.5,
    )  # fmt: skip
    data = io.BytesIO()
    figure.savefig(data, format=path.suffix[1:].lower())
    write(path, data.getvalue())


def in_ms(seconds: float) -> str:
    """Return milliseconds with three significant digits."""
    value = float(f"{1e3 * seconds:.3g}")
    return f"{value:,.{max(2 - math.floor(math.log10(value)), 0)}f}"


def _draw_map(axes: Axes, shown: Map) -> AxesImage:
    """Draw a cell for each setting, with its milliseconds, and frame the special ones."""
    capacities, depths = sorted(shown.depths), shown.rows()
    cells = [[shown.same_tree(capacity, depth) for capacity in capacities] for depth in depths]
    times = np.array([[shown.over_best(setting) for setting in row] for row in cells])
    image = axes.imshow(
        np.ma.masked_invalid(times), SLOWNESS, LogNorm(1.0, TOO_SLOW, clip=True), aspect="auto"
    )
    for (row, column), time in np.ndenumerate(times):
        if np.isfinite(time):
            axes.text(
                *(column, row, in_ms(shown.seconds(cells[row][column]))),
                ha="center",
                va="center",
                fontsize=8,
                color="white" if time > DARK else INK,
                fontweight="bold" if time <= CLOSE else "normal",
            )
    frames = dict(zip(MARKS, (shown.best, shown.default, ARTICLE), strict=True))
    for number, (name, (capacity, depth)) in enumerate(frames.items()):
        row = depths.index(depth) if depth in depths else len(depths) - 1
        column, side = capacities.index(capacity), 0.96 - 0.08 * number
        corner, colour = (column - side / 2, row - side / 2), MARKS[name]
        axes.add_patch(Rectangle(corner, side, side, fill=False, edgecolor=colour, linewidth=2))
    axes.set_xticks(range(len(capacities)), [f"{capacity}" for capacity in capacities])
    axes.set_yticks(range(len(depths)), [*(f"{depth}" for depth in depths[:-1]), "no limit"])
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    axes.set_title(shown.scene, loc="left", fontsize=11, fontweight="bold")
    return image
