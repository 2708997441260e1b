"""Look at the boxes of a quadtree: fine where there is much, coarse where there is little."""

import numpy as np
from matplotlib.collections import PolyCollection

import jostle
import show

# A galaxy of two arms.
rng = np.random.default_rng(7)
turn = rng.exponential(1.6, 4000)
angle = turn * 1.5 + np.pi * rng.integers(0, 2, 4000)
spread = rng.normal(0, 1, (4000, 2)) * (4 + 5 * turn[:, None])
stars = (400, 250) + np.stack([np.cos(angle), 0.6 * np.sin(angle)], 1) * 70 * turn[:, None] + spread

tree = jostle.Quadtree(stars, leaf_capacity=8)
nodes = tree.nodes()
min_x, min_y, max_x, max_y = nodes.boxes.T
corners = np.stack([min_x, min_y, max_x, min_y, max_x, max_y, min_x, max_y], 1).reshape(-1, 4, 2)

with show.axes(f"{len(stars):,} stars, {len(corners):,} boxes, {tree.stats.depth} deep") as axes:
    for depth in range(tree.stats.depth, -1, -1):
        boxes = corners[nodes.depths == depth]
        axes.add_collection(PolyCollection(boxes, facecolors="none", edgecolors=show.BLUE))
    axes.scatter(*stars.T, s=2, color=show.YELLOW, linewidths=0)
