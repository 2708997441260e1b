"""The stages of a search for all pairs, beside the time that the memory needs for their data.

    python benchmarks/run.py bandwidth plot

Equal discs over 40 % of a square, float32, one thread, in memory that is kept between calls. The
example `pair_stages` of the core measures them; this needs cargo. The memory bandwidth is that of
copying a large array, bytes read and written. Two limits follow from it:

- *input and output*: each centre is read once, and each pair is written once;
- *all passes*: each pass over the discs reads and writes its data from and to memory; `PASSES`
  lists the bytes per disc. A pass takes less if its data fit into the cache.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

from machine import Row

import jostle

ROOT = Path(__file__).resolve().parent.parent
COUNTS = (10_000, 100_000, 1_000_000, 10_000_000)

CENTER, KEY, ROW, PAIR = 8, 4, 4, 8
"""Bytes in float32 and uint32."""
ITEM = KEY + ROW + CENTER
"""Bytes of a disc while it is sorted."""

PASSES: dict[str, dict[str, int]] = {
    "tree": {
        "extent: centres read": CENTER,
        "keys: centres read, keys written": CENTER + KEY,
        "partition by leading bits: keys and centres read, items written": KEY + CENTER + ITEM,
        "blocks sorted: items read and written": 2 * ITEM,
        "leaves: items read, columns written": ITEM + CENTER + ROW,
    },
    "pairs": {"columns read": CENTER + ROW},
}
"""Bytes per disc of each pass; the pairs are written in addition."""


def race(rounds: int, largest: int, told: Callable[[str], None]) -> Iterator[list[Row]]:
    """Yield a row for each stage and number of discs.

    Parameters
    ----------
    rounds : int
        How often each stage is timed.
    largest : int
        Largest number of discs.
    told : callable
        Is called with a description of the current measurement.
    """
    counts = [count for count in COUNTS if count <= largest]
    told(f"up to {max(counts):,}")
    command = ["cargo", "run", "--quiet", "--release", "--package", "jostle"]
    command += ["--example", "pair_stages", "--", str(rounds), *map(str, counts)]
    output = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    (_, rate), *lines = (line.split() for line in output.splitlines())
    for line in lines:
        yield rows([float(number) for number in line], float(rate), rounds)


def rows(measured: list[float], rate: float, rounds: int) -> list[Row]:
    """Return the rows of one number of discs."""
    count, *times, pairs = measured
    written = PAIR * pairs / count
    least = {"tree": float(CENTER), "pairs": written}
    passes = {stage: sum(parts.values()) for stage, parts in PASSES.items()}
    passes["pairs"] += written
    return [
        {
            "count": int(count),
            "version": jostle.__version__,
            "threads": 1,
            "stage": stage,
            "rounds": rounds,
            "ns": f"{time:.3g}",
            "input_output_bytes": f"{least[stage]:.3g}",
            "passes_bytes": f"{passes[stage]:.3g}",
            "bytes_per_s": f"{rate:.4g}",
        }
        for stage, time in zip(PASSES, times, strict=True)
    ]
