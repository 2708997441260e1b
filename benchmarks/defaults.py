"""Compare the defaults with the best settings.

    python benchmarks/defaults.py [--scenes gas pile ...] [--counts 10000 100000] [--document]

For every scene and number of particles `jostle_lab.tune` times the search for pairs over leaf
capacity and depth. The fastest settings are compared with the default in new rounds, because the
minimum of many noisy times is too small. The default passes if
it takes at most a tenth longer, and fails if it takes more. If the confidence interval of the ratio
contains both, the result is open. Further tables: one leaf capacity for all scenes; the number of
shapes from which the tree is faster than brute force; the gain by threads; time and effect of
sub-steps.

With --document the tables and the picture of docs/defaults.md are written again, too.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from machine import Results, Row, describe, slug
from ratios import Ratio, compare, crossing
from timing import Timing, interleaved

import jostle
from jostle_lab.tune.measure import Map, Search, Setting, measure
from jostle_lab.tune.picture import draw, in_ms

Rows = list[Row]

RESULTS = Path(__file__).parent / "results"
DOCUMENT = Path(__file__).parents[1] / "docs" / "defaults.md"
PICTURE = DOCUMENT.parent / "pictures" / "defaults.png"
SHOWN = ("gas", "pile", "mixed", "clusters")  # in the picture
TOLERATED = 1.10
FINALISTS = 2  # of the fastest, with and without a limit of the depth
FINAL_ROUNDS = 5  # times those of the map
EQUAL = 1.02  # times the fastest; up to here a setting without a depth limit is preferred
FEW = (40, 57, 80, 113, 160, 226, 320, 453, 640, 905)  # shapes, around the limit of brute force
SUBSTEPS = (1, 2, 4, 8)
TIME_STEP = 1 / 60
PILE_SECONDS = 10


@dataclass(frozen=True)
class Tuning:
    """The map of a scene, and the times of its fastest settings and the default in new rounds."""

    map: Map
    finals: dict[Setting, Timing]

    def best(self) -> Setting:
        """Return the fastest setting.

        Among those that are not significantly slower, one without a depth limit is preferred: the
        best limit depends on the number of particles.
        """
        ranked = sorted(self.finals, key=lambda setting: self.finals[setting].median)
        for setting in ranked:
            behind = compare(self.finals[setting], self.finals[ranked[0]])
            close = behind.within_noise and behind.median <= EQUAL
            if close and setting.max_depth == self.map.default.max_depth:
                return setting
        return ranked[0]

    def gain(self) -> Ratio:
        """Return the time of the default over that of the best."""
        return compare(self.finals[self.map.default], self.finals[self.best()])


def tune(scene: str, n: int, rounds: int, threads: int | None) -> Tuning:
    """Time leaf capacity × depth, then compare the best with the default again."""
    found = measure(scene, n, threads=threads, rounds=rounds)
    ranked = sorted(found.rounds, key=found.seconds)
    unlimited = [setting for setting in ranked if setting.max_depth == found.default.max_depth]
    chosen = dict.fromkeys([found.default, *ranked[:FINALISTS], *unlimited[:FINALISTS]])
    search = Search.of(scene, n, threads)
    calls = [partial(search.pairs, setting) for setting in chosen]
    timings = interleaved(calls, FINAL_ROUNDS * rounds)
    return Tuning(found, dict(zip(chosen, timings, strict=True)))


def verdicts(tunings: list[Tuning]) -> Rows:
    """Return a row for each: the best setting, and the time of the default relative to it."""
    rows: Rows = []
    for tuning in tunings:
        best, gain = tuning.best(), tuning.gain()
        unlimited = best.max_depth == tuning.map.default.max_depth
        rows.append(
            {
                "scene": tuning.map.scene,
                "n": tuning.map.n,
                "best_leaf_capacity": best.leaf_capacity,
                "best_max_depth": "none" if unlimited else best.max_depth,
                "best_s": f"{tuning.finals[best].median:.6g}",
                "default_s": f"{tuning.finals[tuning.map.default].median:.6g}",
                "default_over_best": f"{gain.median:.3f}",
                "low": f"{gain.low:.3f}",
                "high": f"{gain.high:.3f}",
                "verdict": judge(gain),
                "rounds": len(tuning.finals[best].rounds),
                "threads": tuning.map.threads or "all",
                "version": jostle.__version__,
            }
        )
    return rows


def judge(gain: Ratio) -> str:
    """Return whether the default is within a tenth of the best: yes, no or open."""
    if gain.high <= TOLERATED:
        return "pass"
    return "fail" if gain.low > TOLERATED else "open"


def capacities(tunings: list[Tuning]) -> Rows:
    """Return, for each leaf capacity without a depth limit, its time over the best of a scene."""
    rows: Rows = []
    maps = [tuning.map for tuning in tunings]
    for capacity in sorted(maps[0].depths):
        unlimited = Setting(capacity, maps[0].default.max_depth)
        times = [one.over_best(unlimited) for one in maps if unlimited in one.rounds]
        if times:
            rows.append(
                {
                    "leaf_capacity": capacity,
                    "mean_over_best": f"{float(np.exp(np.log(times).mean())):.3f}",
                    "worst_over_best": f"{max(times):.3f}",
                    "within_10_percent": sum(time <= TOLERATED for time in times),
                    "scenes": len(tunings),
                    "version": jostle.__version__,
                }
            )
    return rows


def brute_limit(scenes: list[str], rounds: int) -> Rows:
    """Return, for each scene, the number of shapes from which the tree is faster."""
    rows: Rows = []
    for scene in scenes:
        ratios = []
        for search in (Search.of(scene, n) for n in FEW):
            calls = partial(search.pairs, search.default), partial(brute, search)
            tree, other = interleaved(calls, rounds)
            ratios.append(tree.median / other.median)
        found = crossing(FEW, ratios)
        rows.append(
            {
                "scene": scene,
                "tree_is_faster_from": "" if found is None else two_digits(found),
                "rounds": rounds,
                "version": jostle.__version__,
            }
        )
    return rows


def brute(search: Search) -> object:
    """Find the pairs by testing all."""
    return jostle.find_pairs(search.positions, search.radii, method="brute", threads=1)


def two_digits(value: float) -> int:
    """Return a number with two significant digits."""
    return int(round(value, 1 - math.floor(math.log10(value))))


def threads(rounds: int) -> Rows:
    """Time the pairs of the gas on one thread and on all."""
    rows: Rows = []
    for n in (1_000, 10_000, 100_000, 1_000_000):
        search = Search.of("gas", n)
        few = rounds if n < 1_000_000 else max(rounds // 5, 3)
        searches = search, replace(search, threads=None)
        calls = [partial(one.pairs, one.default) for one in searches]
        for many, timing in zip(("1", "all"), interleaved(calls, few), strict=True):
            rows.append({"n": n, "threads": many, "rounds": few, **timing.columns()})
    return rows


def substeps() -> Rows:
    """Return the time of a step of a pile at rest, and its deepest overlap in smaller radii."""
    worlds = []
    for count in SUBSTEPS:
        world = jostle.scenes.create("pile")
        world.substeps, world.threads, world.sleeping = count, 1, False
        world.step(TIME_STEP, round(PILE_SECONDS / TIME_STEP))
        worlds.append(world)
    overlaps = [deepest(world) for world in worlds]
    timings = interleaved([lambda world=world: world.step(TIME_STEP) for world in worlds], 60)
    return [
        {
            "substeps": count,
            "overlap_percent": f"{100 * overlap:.2f}",
            "rms_speed": f"{float(np.sqrt((world.velocities**2).sum(axis=1).mean())):.2f}",
            **timing.columns(),
        }
        for count, overlap, world, timing in zip(SUBSTEPS, overlaps, worlds, timings, strict=True)
    ]


def deepest(world: jostle.World) -> float:
    """Return the deepest overlap as a fraction of the smaller radius."""
    touching = jostle.Quadtree(world.positions, world.radii).contacts()
    smaller = world.radii[touching.pairs].min(axis=1)
    return float((touching.depths / smaller).max(initial=0.0))


# ---- the tables, as Markdown ---------------------------------------------------------------------


def table(head: list[str], rows: list[list[object]]) -> str:
    """Return a Markdown table whose first column is the name of its row."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def ms(seconds: float) -> str:
    """Return milliseconds with their unit."""
    return f"{in_ms(seconds)} ms"


def verdict_table(rows: Rows) -> str:
    """Return the table of scenes: best setting, and the time of the default over the best."""
    head = ["scene", "discs", "best leaf capacity", "best depth", "default", "default over best"]
    return table(
        [*head, "within 10 %"],
        [
            [
                row["scene"],
                f"{row['n']:,}",
                row["best_leaf_capacity"],
                "no limit" if row["best_max_depth"] == "none" else row["best_max_depth"],
                ms(float(str(row["default_s"]))),
                f"{float(str(row['default_over_best'])):.2f} "
                f"({float(str(row['low'])):.2f} to {float(str(row['high'])):.2f})",
                {"pass": "yes", "fail": "**no**", "open": "the noise leaves it open"}[
                    str(row["verdict"])
                ],
            ]
            for row in rows
        ],
    )


def capacities_table(rows: Rows) -> str:
    """Return the table of leaf capacities, over all scenes and numbers of discs."""
    head = ["leaf capacity", "time over the best, mean", "worst", "within 10 % of the best"]
    return table(
        head,
        [
            [
                row["leaf_capacity"],
                f"{float(str(row['mean_over_best'])):.2f}",
                f"{float(str(row['worst_over_best'])):.2f}",
                f"{row['within_10_percent']} of {row['scenes']}",
            ]
            for row in rows
        ],
    )


def brute_table(rows: Rows) -> str:
    """Return the table of the numbers of shapes from which the tree is faster."""
    shown = [[row["scene"], row["tree_is_faster_from"] or "–"] for row in rows]
    return table(["scene", "the tree is faster from"], shown)


def threads_table(rows: Rows) -> str:
    """Return the table of times on one thread and on all."""
    by_key = {(row["n"], row["threads"]): float(str(row["median_s"])) for row in rows}
    return table(
        ["discs", "1 thread", "all cores", "gain"],
        [
            [
                f"{n:,}",
                ms(by_key[n, "1"]),
                ms(by_key[n, "all"]),
                f"{by_key[n, '1'] / by_key[n, 'all']:.2f}",
            ]
            for n in dict.fromkeys(row["n"] for row in rows)
        ],
    )


def substeps_table(rows: Rows) -> str:
    """Return the table of sub-steps."""
    return table(
        ["substeps", "a step", "deepest overlap, of the smaller radius", "root mean square speed"],
        [
            [
                row["substeps"],
                ms(float(str(row["median_s"]))),
                f"{row['overlap_percent']} %",
                f"{row['rms_speed']} px/s",
            ]
            for row in rows
        ],
    )


def put(name: str, text: str) -> None:
    """Write a table into the document, between the marks with its name."""
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    document = DOCUMENT.read_text(encoding="utf-8")
    head, _, rest = document.partition(begin)
    _, found, tail = rest.partition(end)
    if not found:
        raise SystemExit(f"{DOCUMENT.name} has no place for the table {name!r}")
    DOCUMENT.write_text(f"{head}{begin}\n{text}\n\n{end}{tail}", encoding="utf-8")


def settings(tuning: Tuning) -> Rows:
    """Return a row for each setting of a map."""
    return [
        {
            "scene": tuning.map.scene,
            "n": tuning.map.n,
            "leaf_capacity": setting.leaf_capacity,
            "max_depth": setting.max_depth,
            "threads": tuning.map.threads or "all",
            **Timing(tuple(rounds)).columns(),
            "version": jostle.__version__,
        }
        for setting, rounds in tuning.map.rounds.items()
    ]


def write(folder: Path, name: str, rows: Rows) -> None:
    """Write the rows of one table, in place of this machine's earlier ones."""
    results = Results(folder / f"{name}-{slug()}.csv")
    results.add(rows)
    print(f"\nwritten to {results.path}")


def main() -> None:
    """Measure, print and write the results of this machine; return 1 if a scene failed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--scenes", nargs="+", default=jostle.scenes.names())
    parser.add_argument("--counts", type=int, nargs="+", default=[10_000, 100_000])
    parser.add_argument("--rounds", type=int, default=21)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--out", type=Path, default=RESULTS, help="folder of the results")
    parser.add_argument("--document", action="store_true", help="write docs/defaults.md again")
    options = parser.parse_args()
    print(describe())

    tunings = []
    for n in options.counts:
        for scene in options.scenes:
            tuning = tune(scene, n, options.rounds, options.threads)
            tunings.append(tuning)
            (row,) = verdicts([tuning])
            print(
                f"  {scene:10}{n:9,}  best {row['best_leaf_capacity']:>4}, depth "
                f"{row['best_max_depth']:>4}   default over best {row['default_over_best']} "
                f"({row['low']} to {row['high']})   {row['verdict']}"
            )
    results = {
        "scenes": (verdicts(tunings), verdict_table),
        "capacities": (capacities(tunings), capacities_table),
        "brute": (brute_limit(options.scenes, options.rounds), brute_table),
        "threads": (threads(options.rounds), threads_table),
        "substeps": (substeps(), substeps_table),
    }
    write(options.out, "defaults-settings", [row for one in tunings for row in settings(one)])
    for name, (rows, as_table) in results.items():
        write(options.out, f"defaults-{name}", rows)
        print(as_table(rows))
        if options.document:
            put(name, as_table(rows))
    if options.document:
        maps = {
            tuning.map.scene: tuning.map for tuning in tunings if tuning.map.n == options.counts[0]
        }
        draw([maps[scene] for scene in SHOWN if scene in maps], PICTURE)
    found = [row["verdict"] for row in results["scenes"][0]]
    said = [f"{found.count(word)} {word}" for word in ("pass", "fail", "open")]
    print(f"\nthe default within {TOLERATED} times the best: {', '.join(said)}")


if __name__ == "__main__":
    main()
