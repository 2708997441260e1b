"""Look at the boxes of a quadtree: fine where there is much, coarse where there is little."""

import numpy as np
from matplotlib.collections import PolyCollection

import jostle
import show

# A galaxy of two arms.
rng = np.random.default_rng(7)
far = 12 + rng.exponential(85, 5000)
angle = 2.4 * np.log(far / 12) + np.pi * rng.integers(0, 2, 5000) + rng.normal(0, 0.35, 5000)
stars = (400, 250) + far[:, None] * np.stack([np.cos(angle), 0.7 * np.sin(angle)], axis=1)
stars = stars[(stars > 0).all(axis=1) & (stars < show.SIZE).all(axis=1)]

tree = jostle.Quadtree(stars, leaf_capacity=8)
nodes = tree.nodes()
min_x, min_y, max_x, max_y = nodes.boxes.T
corners = np.stack([min_x, min_y, max_x, min_y, max_x, max_y, min_x, max_y], axis=1)
corners = corners.reshape(-1, 4, 2)

with show.axes(f"{len(stars):,} stars, {len(corners):,} boxes") as axes:
    for depth in range(tree.stats.depth + 1):
        boxes = corners[nodes.is_leaf & (nodes.depths == depth)]
        style = {"edgecolors": show.VIOLET, "facecolors": show.VIOLET, "linewidths": 0.5}
        axes.add_collection(PolyCollection(boxes, alpha=0.02 + 0.035 * depth, **style))
    axes.scatter(*stars.T, s=2.2, color=show.YELLOW, linewidths=0)
