"""Merge two surveys of the same stars: `pairs(other)` finds which sightings are one star."""

import numpy as np
from matplotlib.collections import LineCollection

import jostle
import show

TOLERANCE = 6.0
rng = np.random.default_rng(9)
stars = rng.uniform((20, 20), (780, 480), (420, 2))
first = stars[:330] + rng.normal(0, 2.5, (330, 2))
second = stars[90:] + rng.normal(0, 2.5, (330, 2))

one = jostle.Quadtree(first, radii=TOLERANCE / 2)
two = jostle.Quadtree(second, radii=TOLERANCE / 2)
i, j = one.pairs(two).T  # rows of the first, rows of the second

same = (first[i] + second[j]) / 2
merged = np.concatenate([same, np.delete(first, i, axis=0), np.delete(second, j, axis=0)])

with show.axes(f"{len(first)} + {len(second)} sightings, {len(merged)} stars") as axes:
    show.discs(axes, first, np.full(330, 5.0), show.BLUE)
    show.discs(axes, second, np.full(330, 5.0), show.RED)
    show.discs(axes, same, np.full(len(same), 7.0), show.YELLOW)
