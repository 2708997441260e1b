"""Draw the boxes of a quadtree: small in dense regions, large in sparse ones."""

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap

import jostle
import show

# A galaxy of two arms.
rng = np.random.default_rng(7)
far = 12 + rng.exponential(95, 4000)
angle = 2.4 * np.log(far / 12) + np.pi * rng.integers(0, 2, 4000) + rng.normal(0, 0.4, 4000)
stars = (400, 250) + far[:, None] * np.stack([np.cos(angle), 0.7 * np.sin(angle)], axis=1)

tree = jostle.Quadtree(stars, leaf_capacity=12)
nodes = tree.nodes()
min_x, min_y, max_x, max_y = nodes.boxes[nodes.is_leaf].T
corners = np.stack([min_x, min_y, max_x, min_y, max_x, max_y, min_x, max_y], axis=1)

deeper = LinearSegmentedColormap.from_list("deeper", [show.GROUND, show.BLUE])
with show.axes(f"{len(stars):,} stars in {len(corners):,} leaves") as axes:
    boxes = PolyCollection(list(corners.reshape(-1, 4, 2)), cmap=deeper, edgecolors=show.GROUND)
    boxes.set_array(nodes.levels[nodes.is_leaf])
    axes.add_collection(boxes)
    axes.scatter(*stars.T, s=3, color=show.YELLOW, linewidths=0)
