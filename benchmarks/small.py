"""Small scenes: `find_pairs` by itself against brute force, from 2 shapes on."""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from functools import partial

import shapes
from machine import Row
from timing import interleaved

import jostle

COUNTS = (2, 4, 8, 16, 32, 64, 96, 128, 160, 192, 256, 384, 512, 768, 1_000, 1_400, 2_000)

# A ratio of two times of microseconds needs more rounds than a time of milliseconds.
ROUNDS_TIMES = 5


def race(rounds: int, largest: int) -> Iterator[list[Row]]:
    """Yield a row for each size; the ratio is the median of the ratios of the rounds."""
    for count in (count for count in COUNTS if count <= largest):
        scene = shapes.create("discs", count)
        call = partial(jostle.find_pairs, scene.centers, scene.radii, threads=1)
        methods = ("auto", "brute", "quadtree")
        timings = dict(
            zip(
                methods,
                interleaved(
                    [partial(call, method=method) for method in methods], ROUNDS_TIMES * rounds
                ),
                strict=True,
            )
        )
        paired = zip(timings["auto"].rounds, timings["brute"].rounds, strict=True)
        ratio = statistics.median(auto / brute for auto, brute in paired)
        yield [
            {
                "count": count,
                "version": jostle.__version__,
                "rounds": ROUNDS_TIMES * rounds,
                **{f"{method}_s": f"{timings[method].median:.4g}" for method in methods},
                "auto_to_brute": f"{ratio:.3f}",
            }
        ]
