"""Merge two surveys of the same stars: `pairs(other)` finds which sightings are one star."""

import numpy as np

import jostle
import show

RADIUS = 9.0  # two sightings nearer than twice this are one star
rng = np.random.default_rng(9)
stars = rng.uniform((30, 30), (770, 470), (220, 2))
first = stars[:160] + rng.normal(0, 4, (160, 2))
second = stars[60:] + rng.normal(0, 4, (160, 2))

one, two = jostle.Quadtree(first, RADIUS), jostle.Quadtree(second, RADIUS)
i, j = one.pairs(two).T  # rows of the first, rows of the second

both = (first[i] + second[j]) / 2
merged = np.concatenate([both, np.delete(first, i, axis=0), np.delete(second, j, axis=0)])

with show.axes(f"{len(first)} + {len(second)} sightings are {len(merged)} stars") as axes:
    for group, color in ((first, show.BLUE), (second, show.RED)):
        show.discs(axes, group, np.full(160, RADIUS), color, alpha=0.45)
        show.discs(axes, group, np.full(160, 2.5), color)
    show.discs(axes, both, np.full(len(both), 4.0), show.YELLOW)
