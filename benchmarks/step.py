"""One step of a world: ours with the tree, ours with brute force, the article's tree.

    python benchmarks/step.py [--counts 500 1000 2000 10000] [--rounds 9]

The scene is `gas` (equal elastic discs over 40 % of the area); the article's program
runs its own rules on as many of its own particles, in a window grown to match.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

from machine import describe, write
from measure import interleaved

import jostle
from jostle.article import Simulation

STEP = 1 / 60
ARTICLE_MOST = 4_000
BRUTE_MOST = 20_000


def world(count: int, method: str, threads: int) -> Callable[[], object]:
    """One step, with every position read, as a program that draws would."""
    gas = jostle.scenes.create("gas", n=count)
    gas.method, gas.threads = method, threads
    gas.step(STEP, 60)

    def call() -> object:
        gas.step(STEP)
        return gas.positions

    return call


def article(count: int, method: str) -> Callable[[], object]:
    """One frame of the article's program at the article's density."""
    scale = max(1.0, (count / 500) ** 0.5)
    simulation = Simulation(count, method, width=int(800 * scale), height=int(500 * scale))
    return simulation.frame


def contenders(count: int) -> dict[str, Callable[[], object]]:
    """Everything that can manage `count` particles."""
    calls = {
        "jostle, 1 thread": world(count, "quadtree", 1),
        "jostle, 2 threads": world(count, "quadtree", 2),
    }
    if count <= BRUTE_MOST:
        calls["jostle, brute force"] = world(count, "brute", 1)
    if count <= ARTICLE_MOST:
        calls["the article's tree"] = article(count, "quadtree")
    if count <= ARTICLE_MOST // 4:
        calls["the article's brute force"] = article(count, "brute")
    return calls


def run(count: int, rounds: int) -> list[dict[str, object]]:
    """Time one step of every contender, interleaved."""
    calls = contenders(count)
    timings = interleaved(list(calls.values()), rounds)
    print(f"\n{count:,} discs, {rounds} rounds")
    rows: list[dict[str, object]] = []
    for name, timing in zip(calls, timings, strict=True):
        rate = 1 / timing.median
        print(f"  {name:26} {1e3 * timing.median:10,.3f} ms a step   {rate:10,.0f} steps a second")
        rows.append(
            {
                "count": count,
                "contender": name,
                "version": jostle.__version__,
                "rounds": rounds,
                **timing.columns(),
            }
        )
    return rows


def main() -> None:
    """Run, print and write the results of this machine."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument(
        "--counts", type=int, nargs="+", default=[500, 1_000, 2_000, 10_000, 100_000]
    )
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()
    print(describe())
    rows = [row for count in options.counts for row in run(count, options.rounds)]
    write("step", rows)


if __name__ == "__main__":
    main()
