"""Write the tables of docs/benchmarks.md from the results.

    python benchmarks/tables.py [--results FOLDER] [--machine SLUG]

The text of that page between `<!-- table: NAME -->` and `<!-- end -->` is replaced.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from machine import slug
from plot import RESULTS, Row, read, short, slope

PAGE = Path(__file__).parents[1] / "docs" / "benchmarks.md"


def table(header: Iterable[str], lines: Iterable[Iterable[str]]) -> str:
    """Return a table in Markdown, its first column to the left and the others to the right."""
    head = list(header)
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, rule, *lines])


def named(row: Mapping[str, object]) -> str:
    """Return the name of a row, with how positions were read, and with its threads."""
    manner = f", {row['manner']}" if row["manner"] in ("batch", "body by body") else ""
    threads = "" if str(row["threads"]) == "1" else f", {row['threads']} threads"
    return f"{row['name']}{manner}{threads}"


def figure(value: float) -> str:
    """Write three digits."""
    return f"{value:,.0f}" if value >= 99.5 else f"{value:.3g}"


def by_count(rows: list[Row], value: Callable[[Row], float]) -> str:
    """Return one line for each name and one column for each count."""
    counts = sorted({int(row["count"]) for row in rows})
    lines: dict[str, dict[int, str]] = {}
    for row in rows:
        if row["median_s"]:
            once = "" if row["rounds"] != "1" else " ¹"
            lines.setdefault(named(row), {})[int(row["count"])] = figure(value(row)) + once
    return table(
        ["", *(f"{count:,}" for count in counts)],
        ([name, *(cells.get(count, "–") for count in counts)] for name, cells in lines.items()),
    )


def each(row: Row) -> float:
    """Return nanoseconds per shape."""
    return 1e9 * float(row["median_s"]) / int(row["count"])


def frame(row: Row) -> float:
    """Return milliseconds."""
    return 1e3 * float(row["median_s"])


def rivals(rows: list[Row]) -> str:
    """Return the libraries, their versions, and how they are called."""
    seen = {row["name"]: row for row in rows}
    lines = ([name, row["version"], row["manner"]] for name, row in seen.items())
    return table(["", "version", "how"], lines).replace("---:", "---")


def sameness(rows: list[Row]) -> str:
    """Return speeds and contacts after one second from the same state, at the middle size."""
    seen = {
        (row["scene"], f"{row['name']}, {row['threads']} threads".removesuffix(", 1 threads")): row
        for row in rows
        if row["count"] == "10000" and row["rms_speed"]
    }
    return table(
        ["", "version", "scene", "speed, px/s", "pairs that touch", "setting"],
        (
            [
                *(name, row["version"], scene),
                *(row["rms_speed"], f"{int(row['contacts']):,}", row["setting"]),
            ]
            for (scene, name), row in seen.items()
        ),
    )


def held(rows: list[Row]) -> str:
    """Return the numbers of discs held."""
    lines = (
        [row["scene"], row["threads"], f"{int(row['held']):,}", row["times_article"]]
        for row in rows
    )
    return table(["", "threads", "discs", "times the article's tree"], lines)


def small(rows: list[Row]) -> str:
    """Return the three methods side by side."""
    lines = (
        [
            f"{int(row['count']):,}",
            *(figure(1e6 * float(row[f"{method}_s"])) for method in ("auto", "brute", "quadtree")),
            row["auto_to_brute"],
        ]
        for row in rows
    )
    worst = max(rows, key=lambda row: float(row["auto_to_brute"]))
    return (
        table(["discs", "auto, µs", "brute, µs", "quadtree, µs", "auto / brute"], lines)
        + f"\n\nWorst ratio to brute force: {worst['auto_to_brute']}, at {worst['count']} discs."
    )


def growth(rows: list[Row]) -> str:
    """Return time and memory for each size."""
    pairs: dict[str, dict[str, Row]] = {}
    for row in rows:
        pairs.setdefault(row["count"], {})[row["threads"]] = row
    lines = (
        [
            short(int(count)),
            *(figure(each(row)) for row in own.values()),
            *(figure(int(row["peak_bytes"]) / int(count)) for row in own.values()),
            figure(int(own["1"]["answer_bytes"]) / int(count)),
        ]
        for count, own in pairs.items()
    )
    head = [
        "discs",
        "ns per disc, 1 thread",
        "2 threads",
        "peak bytes per disc, 1 thread",
        "2 threads",
    ]
    slopes = [slope([own[threads] for own in pairs.values()]) for threads in ("1", "2")]
    grows = (
        f"Time grows as n^{slopes[0]:.2f} from 10,000 discs on, n^{slopes[1]:.2f} on two threads."
    )
    return table([*head, "of these the answer"], lines) + f"\n\n{grows}"


def share(rows: list[Row]) -> str:
    """Return the share of Python."""
    lines = (
        [
            row["call"],
            f"{int(row['count']):,}",
            figure(1e6 * float(row["whole_s"])),
            figure(1e6 * float(row["python_s"])),
            f"{100 * float(row['share']):.1f} %",
        ]
        for row in sorted(rows, key=lambda row: row["call"])
    )
    return table(["", "discs", "whole, µs", "not the core, µs", "share"], lines)


def hard_cases(rows: list[Row]) -> str:
    """Return the time of each hard case, and its ratio to an ordinary one."""
    lines = (
        [
            row["case"],
            figure(frame(row)),
            f"× {row['ratio']}" if row["ratio"] else "",
            row["beside"],
        ]
        for row in rows
    )
    return table(["scene", "ms", "", "beside"], lines)


def dynamic(rows: list[Row]) -> str:
    """Return the time of each call of a frame."""
    lines = (
        [row["scene"], row["call"], *(figure(1e3 * float(row[at])) for at in ("low_s", "median_s"))]
        for row in rows
        if row["call"] != "entered and left"
    )
    return table(["", "", "ms, lower quartile", "ms, median"], lines).replace(
        "| --- | ---:", "| --- | ---", 1
    )


def sprites(rows: list[Row]) -> str:
    """Return one line for each task and library, one column for each size of a group."""
    counts = sorted({int(row["count"]) for row in rows})
    lines: dict[tuple[str, str], dict[int, str]] = {}
    for row in rows:
        times = "" if row["name"] == "jostle" else f" (× {row['times_jostle']})"
        cells = lines.setdefault((row["task"], row["name"]), {})
        cells[int(row["count"])] = figure(frame(row)) + times
    return table(
        ["", "", *(f"{count:,}" for count in counts)],
        ([*names, *(cells.get(count, "–") for count in counts)] for names, cells in lines.items()),
    ).replace("| --- | ---:", "| --- | ---", 1)


def apart(rows: list[Row]) -> str:
    """Return one line for each scene and library that moves shapes apart."""
    lines = (
        [
            row["scene"],
            f"{int(row['count']):,}",
            row["rival"],
            figure(frame(row)),
            f"{int(row['overlaps']):,}",
            row["mean_move"],
        ]
        for row in rows
        if row["scene"] != "walkers"
    )
    return table(
        ["scene", "shapes", "library", "ms", "overlaps left", "mean displacement"], lines
    ).replace("| --- | ---: | ---:", "| --- | ---: | ---", 1)


def neighbors(rows: list[Row]) -> str:
    """Return the time of each library that lists neighbours, and how many times that of jostle."""
    first = {row["task"]: row for row in reversed(rows)}
    lines = (
        [
            row["task"],
            row["rival"],
            row["version"],
            figure(frame(row)),
            f"{frame(row) / frame(first[row['task']]):.1f}",
        ]
        for row in rows
    )
    return table(["task", "library", "version", "ms", "times jostle"], lines).replace(
        "| --- | ---: | ---: | ---:", "| --- | --- | --- | ---:", 1
    )


def pair_forces(rows: list[Row]) -> str:
    """Return the time of a step of particle life for each number of particles."""
    lines = (
        [f"{int(row['count']):,}", row["jostle_ms"], row["numpy_ms"], row["ratio"]] for row in rows
    )
    return table(["particles", "jostle, ms", "NumPy + cKDTree, ms", "times jostle"], lines)


def scene(name: str) -> Callable[[list[Row]], list[Row]]:
    """Return a choice of the rows of one scene."""
    return lambda rows: [row for row in rows if row["scene"] == name]


TABLES: dict[str, tuple[str, Callable[[list[Row]], str]]] = {
    "machine": ("pairs", lambda rows: rows[0]["machine"] + "."),
    "rivals": ("pairs", rivals),
    **{
        name: ("pairs", lambda rows, name=name: by_count(scene(name)(rows), each))
        for name in ("discs", "mixed", "clusters", "rectangles", "points")
    },
    "gas": ("step", lambda rows: by_count(scene("gas")(rows), frame)),
    "pile": ("step", lambda rows: by_count(scene("pile")(rows), frame)),
    "sameness": ("step", sameness),
    "held": ("held", held),
    "small": ("small", small),
    "growth": ("growth", growth),
    "share": ("share", share),
    "hard-cases": ("hard-cases", hard_cases),
    **{
        name: ("queries", lambda rows, kind=kind: by_count(scene(kind)(rows), frame))
        for name, kind in (
            ("query-rectangles", "rectangles"),
            ("query-nearest-one", "nearest one"),
            ("query-nearest", "nearest"),
            ("query-rays", "rays"),
        )
    },
    "space": ("space", dynamic),
    "sprites": ("sprites", sprites),
    "separate": ("separate", apart),
    "neighbors": ("neighbors", neighbors),
    "pair-forces": ("pair-forces", pair_forces),
}


def write_all(results: Path, page: Path = PAGE, machine: str = "") -> None:
    """Replace every table of the page for which there are results."""

    def fresh(match: re.Match[str]) -> str:
        part, make = TABLES[match[1]]
        rows = read(results, part, machine or slug())
        return f"<!-- table: {match[1]} -->\n{make(rows)}\n<!-- end -->" if rows else match[0]

    text = page.read_text(encoding="utf-8")
    written = re.sub(r"<!-- table: ([\w-]+) -->\n.*?<!-- end -->", fresh, text, flags=re.DOTALL)
    page.write_text(written, encoding="utf-8")
    print(f"  tables of {page.name} written")


def main() -> None:
    """Replace every table of the page for which there are results."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--machine", default="")
    options = parser.parse_args()
    write_all(options.results, machine=options.machine)


if __name__ == "__main__":
    main()
