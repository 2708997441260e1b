"""Compare the defaults with the best settings.

    python benchmarks/defaults.py [--scenes gas pile ...] [--counts 10000 100000] [--document]

For every scene and number of particles `jostle_lab.tune` searches the leaf capacity and depth that
find the pairs fastest, and compares the best with the default in new rounds. The default passes if
it takes at most a tenth longer, and fails if it takes more. If the confidence interval of the ratio
contains both, the result is open. Further tables: one leaf capacity for all scenes; the number of
shapes from which the tree is faster than brute force; the gain by threads; time and effect of
sub-steps.

With --document the tables and the picture of docs/defaults.md are written again, too.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from machine import Results, Row, describe, slug
from timing import interleaved

import jostle
from jostle_lab.tune import records
from jostle_lab.tune.candidates import Method, Setting, candidate, defaults
from jostle_lab.tune.findings import crossing, two_digits
from jostle_lab.tune.report import in_ms
from jostle_lab.tune.sample import TIME_STEP, Sample
from jostle_lab.tune.sweep import THOROUGH, Tuner, Tuning
from jostle_lab.tune.timing import InterleavedTiming, Ratio

Rows = list[Row]

RESULTS = Path(__file__).parent / "results"
DOCUMENT = Path(__file__).parents[1] / "docs" / "defaults.md"
PICTURE = DOCUMENT.parent / "pictures" / "defaults.png"
SHOWN = ("gas", "pile", "mixed", "clusters")  # in the picture
TOLERATED = 1.10
FEW = (40, 57, 80, 113, 160, 226, 320, 453)  # shapes, around the limit of brute force
SUBSTEPS = (1, 2, 4, 8)
PILE_SECONDS = 10


def tune(scene: str, n: int, rounds: int, threads: int | None) -> Tuning:
    """Sweep leaf capacity × depth, then compare the best with the default again."""
    effort = replace(THOROUGH, rounds=rounds)
    tuner = Tuner(scene, n, threads=threads, effort=effort)
    tuner.settings(lambda *_: None)
    tuner.final(lambda *_: None)
    return tuner.tuning


def verdicts(tunings: list[Tuning]) -> Rows:
    """Return a row for each: the best setting, and the time of the default relative to it."""
    rows: Rows = []
    for tuning in tunings:
        best, gain = tuning.best(), tuning.gain()
        unlimited = best.max_depth == tuning.default.max_depth
        rows.append(
            {
                "scene": tuning.scene,
                "n": tuning.n,
                "best_leaf_capacity": best.leaf_capacity,
                "best_max_depth": "none" if unlimited else best.max_depth,
                "best_s": f"{tuning.final[best].median:.6g}",
                "default_s": f"{tuning.final[tuning.default].median:.6g}",
                "default_over_best": f"{gain.median:.3f}",
                "low": f"{gain.low:.3f}",
                "high": f"{gain.high:.3f}",
                "verdict": judge(gain),
                "rounds": len(tuning.final[best].rounds),
                "threads": "all" if tuning.threads is None else tuning.threads,
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
    for capacity in sorted(tunings[0].tree_depths):
        times = []
        for tuning in tunings:
            outcomes = tuning.settings
            outcome = outcomes[tuning.cell(capacity, tuning.default.max_depth)]
            if outcome.rounds:
                best = min(other.median for other in outcomes.values())
                times.append(outcome.median / best)
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
    methods: tuple[Method, ...] = ("quadtree", "brute force")
    for scene in scenes:
        samples = {n: Sample.of(scene, n) for n in FEW}
        settings = [Setting(n, 1.0, *defaults(), method) for n in FEW for method in methods]
        race = InterleavedTiming({s: candidate(samples[s.n], s, "pairs", 1) for s in settings})
        race.run(rounds)
        found = crossing(race.outcomes)
        rows.append(
            {
                "scene": scene,
                "tree_is_faster_from": "" if found is None else two_digits(found),
                "rounds": rounds,
                "version": jostle.__version__,
            }
        )
    return rows


def threads(rounds: int) -> Rows:
    """Time the pairs of the gas on one thread and on all."""
    rows: Rows = []
    for n in (1_000, 10_000, 100_000, 1_000_000):
        sample = Sample.of("gas", n)
        few = rounds if n < 1_000_000 else max(rounds // 5, 3)
        calls = [
            lambda sample=sample, many=many: jostle.Quadtree(
                sample.positions, sample.radii, threads=many
            ).pairs()
            for many in (1, None)
        ]
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
                in_ms(float(str(row["default_s"]))),
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
                in_ms(by_key[n, "1"]),
                in_ms(by_key[n, "all"]),
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
                in_ms(float(str(row["median_s"]))),
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


def write(name: str, rows: Rows) -> None:
    """Write the rows of one table, in place of this machine's earlier ones."""
    results = Results(RESULTS / f"{name}-{slug()}.csv")
    results.add(rows)
    print(f"\nwritten to benchmarks/results/{results.path.name}")


def main() -> None:
    """Measure, print and write the results of this machine; return 1 if a scene failed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--scenes", nargs="+", default=jostle.scenes.names())
    parser.add_argument("--counts", type=int, nargs="+", default=[10_000, 100_000])
    parser.add_argument("--rounds", type=int, default=21)
    parser.add_argument("--threads", type=int, default=1)
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
    write("defaults-settings", [row for tuning in tunings for row in records.rows(tuning)])
    for name, (rows, as_table) in results.items():
        write(f"defaults-{name}", rows)
        print(as_table(rows))
        if options.document:
            put(name, as_table(rows))
    if options.document:
        draw(tunings, options.counts[0])
    found = [row["verdict"] for row in results["scenes"][0]]
    said = [f"{found.count(word)} {word}" for word in ("pass", "fail", "open")]
    print(f"\nthe default within {TOLERATED} times the best: {', '.join(said)}")


def draw(tunings: list[Tuning], n: int) -> None:
    """Draw the maps of a few scenes for the document."""
    from jostle_lab.tune import pictures

    shown = [tuning for tuning in tunings if tuning.scene in SHOWN and tuning.n == n]
    if shown:
        pictures.maps(sorted(shown, key=lambda tuning: SHOWN.index(tuning.scene)), 2, PICTURE)


if __name__ == "__main__":
    main()
