"""Every benchmark, one results file each.

    python benchmarks/run.py                     all of it, about twenty minutes on two cores
    python benchmarks/run.py pairs plot          some of it
    python benchmarks/run.py pairs step --largest 100000 --patience 0.3    in two minutes
    python benchmarks/run.py --patience 20       waits longer for the slower rivals
    python benchmarks/run.py --largest 10000 --rounds 3 --out out/trial

Each row is written when it is measured, so a run that is stopped has the previous rows.
"""

from __future__ import annotations

import argparse
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import bandwidth
import growth
import hard_cases
import held
import neighbors
import pair_forces
import pairs
import plot
import queries
import separate
import share
import small
import space
import sprites
import stage_times
import steps
import tables
from machine import Results, Row, describe, slug, version_of
from pair_rivals import RIVALS
from rich.console import Console
from rich.table import Table
from timing import Effort

# The packages of the rivals, whose versions are printed first.
OTHERS = sorted({rival.package for rival in RIVALS} - {"jostle"} | {"pymunk", "pyb2d3"})

PAIR_SCENES = ("discs", "mixed", "clusters", "rectangles")
PAIR_COUNTS = (100, 1_000, 10_000, 100_000, 1_000_000)
STEP_COUNTS = (1_000, 10_000, 50_000, 200_000)

# SciPy's own test: a million points of the unit square and a distance of 0.002. Settings are chosen
# with the smaller scene.
POINT_COUNTS = (10_000, 1_000_000)
POINT_RIVALS = ("jostle", "jostle, float32", "SciPy cKDTree", "matscipy")
POINT_PATIENCE = 5

Options = argparse.Namespace
Rows = Iterator[list[Row]]


def told(text: str) -> None:
    """Print the progress."""
    print(f"  {time.strftime('%H:%M:%S')}  {text}", flush=True)


def effort_of(options: Options) -> Effort:
    return Effort(options.rounds, options.patience, told)


def run_pairs(options: Options) -> Rows:
    """All overlapping pairs, compared with other libraries."""
    counts = [count for count in PAIR_COUNTS if count <= options.largest]
    for scene in PAIR_SCENES:
        yield from pairs.compare(scene, counts, effort_of(options))
    counts = [count for count in POINT_COUNTS if count <= options.largest]
    rivals = [rival for rival in pairs.installed() if rival.name in POINT_RIVALS]
    effort = replace(effort_of(options), patience=POINT_PATIENCE * options.patience)
    yield from pairs.compare("points", counts, effort, rivals)


def run_step(options: Options) -> Rows:
    """One frame of a simulation, compared with pymunk, Box2D and the article."""
    counts = [count for count in STEP_COUNTS if count <= options.largest]
    for scene in steps.SCENES:
        yield from steps.compare(scene, counts, effort_of(options))


def run_held(options: Options) -> Rows:
    """The number of discs held at 60 steps per second."""
    for row in held.searches(report=told):
        yield [row]


PARTS: dict[str, Callable[[Options], Rows]] = {
    "pairs": run_pairs,
    "step": run_step,
    "held": run_held,
    "small": lambda options: small.race(options.rounds, options.largest),
    "growth": lambda options: growth.race(options.rounds, 10 * options.largest, told),
    "bandwidth": lambda options: bandwidth.race(options.rounds, 10 * options.largest, told),
    "share": lambda options: share.race(options.rounds, options.largest),
    "stage-times": lambda options: stage_times.race(options.rounds, options.largest, told),
    "hard-cases": lambda options: hard_cases.race(options.rounds, options.largest),
    "queries": lambda options: queries.race(options.rounds, options.largest),
    "space": lambda options: space.race(options.rounds, options.largest),
    "separate": lambda options: separate.race(options.rounds, options.largest, options.patience),
    "neighbors": lambda options: neighbors.race(options.rounds, options.largest),
    "pair-forces": lambda options: pair_forces.race(options.largest),
    "sprites": lambda options: sprites.race(options.rounds, options.largest),
}


def main() -> None:
    """Run the requested parts, and the plots of all results."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parts", nargs="*", help=f"{', '.join(PARTS)}, plot; all if none is given")
    parser.add_argument("--rounds", type=int, default=9, help="how often each is timed")
    parser.add_argument(
        "--patience", type=float, default=1.0, help="seconds that one answer may take"
    )
    parser.add_argument("--largest", type=int, default=1_000_000, help="most shapes in a scene")
    parser.add_argument("--out", type=Path, default=plot.RESULTS, help="folder of the results")
    options = parser.parse_args()
    parts = options.parts or [*PARTS, "plot"]
    if unknown := set(parts) - {*PARTS, "plot"}:
        parser.error(f"there is no {', '.join(sorted(unknown))}")
    print(describe())
    print(libraries())
    failed = [part for part in parts if part in PARTS and not run(part, options)]
    if "plot" in parts:
        if options.out == plot.RESULTS:
            plot.draw_all(plot.RESULTS, plot.PICTURES)
            tables.write_all(plot.RESULTS)
        else:  # a trial: the documents stay as they are
            plot.draw_all(options.out, options.out)
    if failed:
        raise SystemExit(f"failed: {', '.join(failed)}")


def run(part: str, options: Options) -> bool:
    """Run one part; print its error, so that the other parts run."""
    results = Results(options.out / f"{part}-{slug()}.csv")
    began = time.perf_counter()
    print(f"\n== {part} ==", flush=True)
    scenes: dict[str, list[Row]] = {}
    try:
        for rows in PARTS[part](options):
            results.add(rows)
            for row in rows:
                print("  " + "  ".join(str(value) for value in row.values() if value != ""))
                scenes.setdefault(str(row.get("scene")), []).append(row)
    except Exception:
        traceback.print_exc()
        return False
    finally:
        if part in ("pairs", "step"):
            for own in scenes.values():  # wide, so that a narrow console cuts no figures
                Console(width=160).print(summary(own), highlight=False)
    print(f"  {time.perf_counter() - began:.0f} s, {results.path.name}")
    return True


def libraries() -> str:
    """Return the compared libraries, and those that are not installed."""
    versions = {package: version_of(package) for package in OTHERS}
    there = ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    missing = ", ".join(name for name, version in versions.items() if not version)
    return f"compared with {there or 'nothing'}" + (f"; without {missing}" if missing else "")


def summary(rows: list[Row]) -> Table:
    """Return the times of one scene per shape, and their ratios to the first row."""
    counts = list(dict.fromkeys(int(str(row["count"])) for row in rows if row["rounds"]))
    lines: dict[str, dict[int, float]] = {}
    for row in rows:
        if row["rounds"]:
            seconds, count = float(str(row["median_s"])), int(str(row["count"]))
            lines.setdefault(tables.named(row), {})[count] = 1e9 * seconds / count
    title = f"{rows[0]['scene']}, ns per shape (× {next(iter(lines), '')})"
    shown = Table(title=title, title_justify="left", box=None, padding=(0, 2, 0, 0))
    shown.add_column("", no_wrap=True)
    for count in counts:
        shown.add_column(f"{count:,}", justify="right", no_wrap=True)
    first = next(iter(lines.values()), {})
    for name, times in lines.items():
        shown.add_row(name, *(cell(times.get(count), first.get(count)) for count in counts))
    return shown


def cell(nanoseconds: float | None, base: float | None) -> str:
    """Return a time and its ratio."""
    if nanoseconds is None or base is None:
        return "–"
    ratio = nanoseconds / base
    times = f"{ratio:,.0f}" if ratio >= 10 else f"{ratio:.2g}"
    return f"{nanoseconds:,.0f} (×{times})"


if __name__ == "__main__":
    main()
