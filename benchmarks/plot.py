"""Draw the pictures of docs/benchmarks.md from the results.

    python benchmarks/plot.py [--results FOLDER] [--pictures FOLDER] [--machine SLUG]

The results of this kind of machine are drawn; if there are none, those of another one.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
from machine import slug

RESULTS = Path(__file__).parent / "results"
PICTURES = Path(__file__).parents[1] / "docs" / "pictures"

Row = dict[str, str]
Line = tuple[list[int], list[float]]

INK, FAINT, GRID = "#2b2b33", "#7a7a85", "#e6e6ea"

# A library has the same colour in every picture; jostle has the brightest, brute force is grey.
COLOURS = {
    "jostle": "#d1495b",
    "SciPy": "#00798c",
    "matscipy": "#3d5a98",
    "vesin": "#7b9acc",
    "shapely": "#2e8b57",
    "fastquadtree": "#b58900",
    "pyqtree": "#8d6cab",
    "pymunk": "#00798c",
    "pyb2d3": "#d98a2b",
    "the article": "#6b4f3a",
    "NumPy": "#a0a0a8",
}
BRUTE = "#a0a0a8"

# The stages of a step in the order of work, in the colours of the app's panels.
STAGES = {
    "forces": "#8379d2",
    "bounds": "#4f6d9e",
    "build": "#5590a8",
    "pairs": "#6fb0a2",
    "contacts": "#a7c58c",
    "resting": "#c6cd82",
    "events": "#e2c67c",
    "correction": "#daac6e",
    "store": "#969eac",
}
BEFORE = "before-"
"""Prefix of the results file of an earlier version, to be drawn beside the present one."""


def read(folder: Path, part: str, machine: str) -> list[Row]:
    """Return the rows of one part; none if there is no file."""
    own = folder / f"{part}-{machine}.csv"
    files = [own] if own.exists() else sorted(folder.glob(f"{part}-*.csv"))
    if not files:
        return []
    with files[0].open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def timed(rows: Iterable[Row]) -> list[Row]:
    """Return the rows that have a time."""
    return [row for row in rows if row["median_s"]]


def best(rows: Iterable[Row], unit: float) -> Line:
    """Return the fastest of some rows for each count, in a unit per shape."""
    least: dict[int, float] = {}
    for row in timed(rows):
        count = int(row["count"])
        each = float(row["median_s"]) / unit
        least[count] = min(each, least.get(count, np.inf))
    counts = sorted(least)
    return counts, [least[count] for count in counts]


def slope(rows: Iterable[Row]) -> float:
    """Return the exponent of the growth of time with the count, from ten thousand on."""
    counts, times = best([row for row in rows if int(row["count"]) >= 10_000], 1.0)
    return float(np.polyfit(np.log(counts), np.log(times), 1)[0]) if len(counts) > 1 else np.nan


# ---- style of all pictures -----------------------------------------------------------------------


def figure(columns: int, width: float, height: float, rows: int = 1, same: bool = False):
    """Return a figure and its panels."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update(
        {
            "font.family": "DejaVu Sans",
            "font.size": 9.5,
            "text.color": INK,
            "axes.labelcolor": INK,
            "axes.edgecolor": FAINT,
            "axes.titlesize": 10.5,
            "axes.titleweight": "bold",
            "axes.titlelocation": "left",
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.grid": True,
            "axes.axisbelow": True,
            "grid.color": GRID,
            "xtick.color": FAINT,
            "ytick.color": FAINT,
            "lines.linewidth": 1.6,
            "lines.markersize": 4,
            "legend.frameon": False,
            "savefig.dpi": 150,
        }
    )
    return plt.subplots(
        rows, columns, figsize=(width, height), layout="constrained", squeeze=False, sharey=same
    )


def save(drawing, path: Path, rows: list[Row], title: str) -> None:
    """Save a picture, with its title above and the machine below."""
    drawing.suptitle(title, x=0.01, ha="left", fontsize=12, fontweight="bold")
    drawing.supxlabel(rows[0]["machine"], x=0.01, ha="left", fontsize=7.5, color=FAINT)
    path.parent.mkdir(parents=True, exist_ok=True)
    drawing.savefig(path)
    print(f"  drawn: {path.name}")


def short(count: float, _position: object = None) -> str:
    """Write a number as 100, 1k or 1M."""
    for size, letter in ((1e6, "M"), (1e3, "k")):
        if count >= size:
            return f"{count / size:g}{letter}"
    return f"{count:g}"


def logarithmic(axes, x: str, y: str, both: bool = True) -> None:
    """Give a panel two logarithmic scales with plain numbers."""
    axes.set_xscale("log")
    if both:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(short)
    axes.xaxis.set_major_formatter(short)
    axes.minorticks_off()
    axes.set_xlabel(x)
    axes.set_ylabel(y)


def legend(drawing, panels, order: Iterable[str]) -> None:
    """Draw one legend for the lines of all panels."""
    handles = {
        label: handle
        for axes in panels.flat
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    names = [label for label in order if label in handles]
    drawing.legend([handles[name] for name in names], names, loc="outside right center")


# ---- the pictures --------------------------------------------------------------------------------

PAIR_PANELS = {
    "discs": "equal discs",
    "mixed": "radii 1 to 100",
    "clusters": "clusters",
    "rectangles": "rectangles",
}


def family(name: str) -> str:
    """Return the library of a row, which determines its colour."""
    return next((known for known in COLOURS if name.startswith(known)), name)


def pair_lines(rows: list[Row]) -> Iterator[tuple[str, list[Row], dict[str, object]]]:
    """Yield the lines of a panel of pairs: the best of each library, jostle on 1 and 2 threads."""
    ours = [row for row in rows if row["name"].startswith("jostle") and "brute" not in row["name"]]
    yield (
        "jostle, 1 thread",
        [row for row in ours if row["threads"] == "1"],
        {"color": COLOURS["jostle"], "linewidth": 2.6, "zorder": 5},
    )
    yield (
        "jostle, 2 threads",
        [row for row in ours if row["threads"] == "2"],
        {"color": COLOURS["jostle"], "linewidth": 2.6, "zorder": 5, "linestyle": (0, (2, 1))},
    )
    for library, colour in COLOURS.items():
        if library != "jostle":
            yield (
                "NumPy, brute force"
                if library == "NumPy"
                else library + "'s tree" * (library == "the article"),
                [row for row in rows if family(row["name"]) == library],
                {"color": colour, "marker": "o"},
            )


def draw_pairs(rows: list[Row], path: Path) -> None:
    """Four scenes, nanoseconds per shape."""
    drawing, panels = figure(2, 9.5, 7.2, rows=2, same=True)
    for axes, (scene, title) in zip(panels.flat, PAIR_PANELS.items(), strict=True):
        for label, own, look in pair_lines([row for row in rows if row["scene"] == scene]):
            counts, each = best(own, 1e-9)
            if counts:
                each = [time / count for time, count in zip(each, counts, strict=True)]
                axes.plot(counts, each, label=label, **look)
        logarithmic(axes, "shapes", "ns per shape")
        axes.set_title(title)
        axes.set_ylim(10, 300_000)
    slowest_first = reversed([label for label, _, _ in pair_lines(rows)])
    legend(drawing, panels, slowest_first)
    save(drawing, path, rows, "All overlapping pairs, building included")


def draw_step(rows: list[Row], path: Path) -> None:
    """Two scenes, milliseconds per frame."""
    drawing, panels = figure(2, 9.5, 4.4, same=True)
    looks: dict[str, tuple[Callable[[Row], bool], dict[str, object]]] = {
        "jostle, 1 thread": (
            lambda row: row["name"] == "jostle" and row["threads"] == "1",
            {"color": COLOURS["jostle"], "linewidth": 2.6, "zorder": 5},
        ),
        "jostle, 2 threads": (
            lambda row: row["name"] == "jostle" and row["threads"] == "2",
            {"color": COLOURS["jostle"], "linewidth": 2.6, "linestyle": (0, (2, 1)), "zorder": 5},
        ),
        "pymunk, batch": (
            lambda row: row["name"] == "pymunk" and row["manner"] == "batch",
            {"color": COLOURS["pymunk"], "marker": "o"},
        ),
        "pymunk, body by body": (
            lambda row: row["name"] == "pymunk" and row["manner"] == "body by body",
            {"color": COLOURS["pymunk"], "marker": "o", "linestyle": (0, (4, 2))},
        ),
        "pymunk, batch, one sub-step": (
            lambda row: row["name"].startswith("pymunk, one") and row["manner"] == "batch",
            {"color": "#7fbcc6", "marker": "o"},
        ),
        "pyb2d3 (Box2D v3)": (
            lambda row: row["name"] == "pyb2d3",
            {"color": COLOURS["pyb2d3"], "marker": "o"},
        ),
        "pyb2d3, four sub-steps": (
            lambda row: row["name"] == "pyb2d3, four sub-steps",
            {"color": "#ecc48f", "marker": "o"},
        ),
        "the article's tree": (
            lambda row: row["name"] == "the article's tree",
            {"color": COLOURS["the article"], "marker": "o"},
        ),
        "the article's brute force": (
            lambda row: row["name"] == "the article's brute force",
            {"color": BRUTE, "marker": "s"},
        ),
    }
    titles = {"gas": "gas of elastic discs, 1 sub-step", "pile": "pile at rest, 4 sub-steps"}
    for axes, (scene, title) in zip(panels.flat, titles.items(), strict=True):
        for label, (wanted, look) in looks.items():
            own = [row for row in rows if row["scene"] == scene and wanted(row)]
            counts, milliseconds = best(own, 1e-3)
            if counts:
                axes.plot(counts, milliseconds, label=label, **look)
        axes.axhline(1000 / 60, color=FAINT, linewidth=0.9, linestyle=":")
        logarithmic(axes, "discs", "ms per frame")
        axes.set_title(title)
    panels[0, 1].annotate(
        "60 a second",
        (0, 1000 / 60),
        xycoords=("axes fraction", "data"),
        xytext=(4, 4),
        textcoords="offset points",
        ha="left",
        va="bottom",
        color=FAINT,
        fontsize=8,
    )
    legend(drawing, panels, reversed(looks))
    save(drawing, path, rows, "One frame of a simulation, all positions read")


def draw_held(rows: list[Row], path: Path) -> None:
    """Bars: discs held at 60 steps per second."""
    drawing, panels = figure(1, 7.5, 2.9)
    axes = panels[0, 0]
    names = {"gas": "jostle, gas", "pile": "jostle, pile at rest", "article": "the article's tree"}
    labels = [
        names[row["scene"]]
        + (
            ""
            if row["scene"] == "article"
            else f", {row['threads']} thread" + "s" * (row["threads"] != "1")
        )
        for row in rows
    ]
    held = [int(row["held"]) for row in rows]
    colours = [
        COLOURS["the article"] if row["scene"] == "article" else COLOURS["jostle"] for row in rows
    ]
    bars = axes.barh(labels, held, color=colours, height=0.62)
    texts = [
        f"{count:,}" + ("" if row["scene"] == "article" else f"   × {row['times_article']}")
        for count, row in zip(held, rows, strict=True)
    ]
    axes.bar_label(bars, texts, padding=4, color=INK)
    axes.invert_yaxis()
    axes.set_xlim(0, 1.25 * max([1, *held]))
    axes.xaxis.set_major_formatter(short)
    axes.grid(False, axis="y")
    axes.tick_params(axis="y", length=0, labelcolor=INK)
    axes.spines["left"].set_visible(False)
    axes.set_xlabel("discs")
    save(drawing, path, rows, "Discs held at 60 steps per second")


def draw_growth(rows: list[Row], path: Path) -> None:
    """Time and memory against the number of discs."""
    drawing, (panels,) = figure(2, 9.5, 4.2)
    for threads, style in (("1", "-"), ("2", (0, (2, 1)))):
        own = [row for row in timed(rows) if row["threads"] == threads]
        counts = np.array([int(row["count"]) for row in own])
        seconds = np.array([float(row["median_s"]) for row in own])
        memory = np.array([int(row["peak_bytes"]) for row in own]) / counts
        label = f"{threads} thread" + "s" * (threads != "1")
        label += f": grows as $n^{{{slope(own):.2f}}}$ from 10k on"
        look = {"color": COLOURS["jostle"], "linestyle": style, "marker": "o"}
        panels[0].plot(counts, 1e3 * seconds, label=label, **look)
        enough = counts >= 10_000  # below, pages of 4 KiB are too coarse
        panels[1].plot(counts[enough], memory[enough], label=label.split(":")[0], **look)
    logarithmic(panels[0], "discs", "ms")
    panels[0].set_title("time")
    panels[0].legend(loc="upper left")
    logarithmic(panels[1], "discs", "bytes per disc, answer included", both=False)
    panels[1].set_title("peak memory beyond the arrays")
    panels[1].set_ylim(bottom=0)
    panels[1].legend(loc="lower right")
    save(drawing, path, rows, "find_pairs against the number of discs (float32, 40 % of the area)")


def draw_small(rows: list[Row], path: Path) -> None:
    """Small scenes: the automatic choice of the method, and both methods."""
    drawing, panels = figure(1, 7.5, 4.0)
    axes = panels[0, 0]
    counts = [int(row["count"]) for row in rows]
    looks = {
        "quadtree": {"color": COLOURS["SciPy"], "label": 'method="quadtree"'},
        "brute": {"color": BRUTE, "label": 'method="brute"'},
        "auto": {"color": COLOURS["jostle"], "label": 'method="auto"', "linewidth": 2.6},
    }
    for method, look in looks.items():
        axes.plot(counts, [1e6 * float(row[f"{method}_s"]) for row in rows], **look)
    logarithmic(axes, "discs", "µs")
    axes.legend(loc="upper left")
    save(drawing, path, rows, "Small scenes: find_pairs chooses by itself")


Bars = dict[tuple[str, int], dict[str, float]]


def stage_bars(rows: list[Row]) -> Bars:
    """Return the nanoseconds per disc of each stage, for each scene and number of discs."""
    bars: Bars = {}
    for row in rows:
        count = int(row["count"])
        own = bars.setdefault((row["scene"], count), {})
        own[row["stage"]] = 1e9 * float(row["median_s"]) / count
    return bars


def stack(
    axes, places: Sequence[float], bars: list[dict[str, float]], height: float, pale: float = 0.0
) -> None:
    """Draw stacked horizontal bars, the stages in the order of work; `pale` is a share of white."""
    from matplotlib.colors import to_rgb

    left = np.zeros(len(bars))
    for stage, colour in STAGES.items():
        lengths = np.array([bar.get(stage, 0.0) for bar in bars])
        if lengths.any():
            mixed = pale + (1 - pale) * np.array(to_rgb(colour))
            label = None if pale else stage
            look = {"color": mixed, "edgecolor": "white", "linewidth": 0.6, "label": label}
            axes.barh(places, lengths, height, left, **look)
        left += lengths


def name_bars(axes, bars: Bars) -> None:
    """Name the scene of each bar, the first one at the top."""
    labels = [f"{scene}\n{count:,} discs" for scene, count in bars]
    axes.set_yticks(range(len(bars)), labels)
    axes.set_ylim(len(bars) - 0.45, -0.55)
    axes.grid(False, axis="y")
    axes.tick_params(axis="y", length=0, labelcolor=INK)
    axes.spines["left"].set_visible(False)


def draw_stage_times(rows: list[Row], path: Path, earlier: list[Row] | None = None) -> None:
    """Stacked bars: the time of each stage, and its share of the step."""
    drawing, panels = figure(1, 7.5, 6.2, rows=2)
    times, shares = panels[:, 0]
    bars = stage_bars(rows)
    draw_times(times, bars, stage_bars(earlier or []))
    draw_shares(shares, bars)
    for axes in (times, shares):
        name_bars(axes, bars)
    look = {"handlelength": 0.9, "handleheight": 0.9, "handletextpad": 0.4, "columnspacing": 1.0}
    corner = {"loc": "lower right", "bbox_to_anchor": (1.012, 1.08), "borderpad": 0}
    handles, names = shares.get_legend_handles_labels()
    times.legend(handles, names, ncols=len(names), **corner, **look)
    save(drawing, path, rows, "Where the time of a step goes, one thread")


def draw_times(axes, bars: Bars, before: Bars) -> None:
    """Draw nanoseconds per disc; those of an earlier version are thinner, paler and below."""
    old = {place: before[key] for place, key in enumerate(bars) if key in before}
    now = [place - 0.14 * bool(old) for place in range(len(bars))]
    then = [place + 0.25 for place in old]
    stack(axes, now, list(bars.values()), 0.4 if old else 0.6)
    stack(axes, then, list(old.values()), 0.2, pale=0.55)
    for place, bar in zip(now, bars.values(), strict=True):
        end_of_bar(axes, place, bar, "{:,.0f}", color=INK, fontweight="bold")
    for place, bar in zip(then, old.values(), strict=True):
        end_of_bar(axes, place, bar, "before: {:,.0f}", color=FAINT, fontsize=8)
    axes.set_xlim(0, 1.16 * max(sum(bar.values()) for bar in [*bars.values(), *old.values()]))
    axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.set_title("nanoseconds per disc")


def draw_shares(axes, bars: Bars) -> None:
    """Draw the shares of the stages, with percentages in the parts that are wide enough."""
    parts = [
        {stage: 100 * time / sum(bar.values()) for stage, time in bar.items()}
        for bar in bars.values()
    ]
    stack(axes, range(len(parts)), parts, 0.6)
    for place, part in enumerate(parts):
        left = 0.0
        for stage in STAGES:
            share = part.get(stage, 0.0)
            colour = "white" if stage in ("forces", "bounds", "build") else INK
            if share >= 3.5:
                look = {"ha": "center", "va": "center_baseline", "color": colour, "fontsize": 8.5}
                axes.text(left + share / 2, place, f"{share:.0f}", **look)
            left += share
    axes.set_xlim(0, 100)
    axes.set_xticks([])
    axes.spines["bottom"].set_visible(False)
    axes.set_title("share of the step, %")


def draw_bandwidth(rows: list[Row], path: Path) -> None:
    """Stacked bars: the stages of a search, and the limits of the memory bandwidth."""
    drawing, panels = figure(1, 7.5, 3.6)
    axes = panels[0, 0]
    counts = sorted({int(row["count"]) for row in rows})
    own = {
        count: {row["stage"]: row for row in rows if int(row["count"]) == count} for count in counts
    }
    bars = {
        ("", count): {
            "build" if stage == "tree" else stage: float(row["ns"]) for stage, row in stages.items()
        }
        for count, stages in own.items()
    }
    stack(axes, range(len(bars)), list(bars.values()), 0.5)
    for place, (stages, bar) in enumerate(zip(own.values(), bars.values(), strict=True)):
        end_of_bar(axes, place, bar, "{:,.1f}", color=INK, fontweight="bold")
        for kind, style in (("input_output_bytes", ":"), ("passes_bytes", "-")):
            limit = sum(
                1e9 * float(row[kind]) / float(row["bytes_per_s"]) for row in stages.values()
            )
            label = {"input_output_bytes": "input and output", "passes_bytes": "all passes"}[kind]
            label = f"limit of the memory: {label}" if place == 0 else None
            axes.plot([limit] * 2, [place - 0.36, place + 0.36], style, color=INK, label=label)
    rate = float(rows[0]["bytes_per_s"]) / 1e9
    axes.set_yticks(range(len(counts)), [f"{count:,}" for count in counts])
    axes.set_ylim(len(bars) - 0.45, -0.55)
    axes.grid(False, axis="y")
    axes.tick_params(axis="y", length=0, labelcolor=INK)
    axes.spines["left"].set_visible(False)
    axes.set_xlim(0, 1.14 * max(sum(bar.values()) for bar in bars.values()))
    axes.set_xlabel(f"nanoseconds per disc; copying moves {rate:.1f} GB/s")
    axes.set_ylabel("discs")
    handles, names = axes.get_legend_handles_labels()
    names = [{"build": "tree"}.get(name, name) for name in names]
    axes.legend(
        handles, names, ncols=4, loc="lower right", bbox_to_anchor=(1.012, 1.0), borderpad=0
    )
    save(drawing, path, rows, "Where the time of find_pairs goes, one thread, float32")


def end_of_bar(axes, place: float, bar: dict[str, float], words: str, **look) -> None:
    """Write the total of a bar at its end."""
    total = sum(bar.values())
    axes.annotate(
        words.format(total),
        (total, place),
        xytext=(5, 0),
        textcoords="offset points",
        va="center",
        **look,
    )


DRAWINGS: dict[str, Callable[[list[Row], Path], None]] = {
    "pairs": draw_pairs,
    "step": draw_step,
    "held": draw_held,
    "growth": draw_growth,
    "small": draw_small,
    "stage-times": draw_stage_times,
    "bandwidth": draw_bandwidth,
}


def draw_all(results: Path, pictures: Path, machine: str = "") -> None:
    """Draw every picture for which there are results."""
    for part, draw in DRAWINGS.items():
        if rows := read(results, part, machine or slug()):
            earlier = read(results, BEFORE + part, machine or slug())
            more = {"earlier": earlier} if earlier else {}
            draw(rows, pictures / f"bench-{part}.png", **more)


def main() -> None:
    """Draw every picture for which there are results."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--pictures", type=Path, default=PICTURES)
    parser.add_argument("--machine", default="")
    options = parser.parse_args()
    draw_all(options.results, options.pictures, options.machine)


if __name__ == "__main__":
    main()
