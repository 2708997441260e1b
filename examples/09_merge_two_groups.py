"""Merge two surveys of the same stars: `pairs(other)` finds the observations of the same star."""

import numpy as np

import jostle
import show

RADIUS = 13.0  # observations nearer than twice this are one star
rng = np.random.default_rng(9)
stars = np.array([(x, y) for x in range(44, 800, 79) for y in range(44, 450, 72)], float)
stars = rng.permutation(stars + rng.uniform(-15, 15, stars.shape))
first = stars[:42] + rng.normal(0, 5, (42, 2))
second = stars[18:] + rng.normal(0, 5, (42, 2))

one, two = jostle.Quadtree(first, RADIUS), jostle.Quadtree(second, RADIUS)
i, j = one.pairs(two).T  # rows of the first, rows of the second

both = (first[i] + second[j]) / 2
merged = np.concatenate([both, np.delete(first, i, axis=0), np.delete(second, j, axis=0)])

with show.axes(f"{len(first)} + {len(second)} sightings are {len(merged)} stars") as axes:
    for group, color in ((first, show.BLUE), (second, show.RED)):
        show.discs(axes, group, np.full(42, RADIUS), color, alpha=0.8)
    show.discs(axes, both, np.full(len(both), 6.0), show.YELLOW)
