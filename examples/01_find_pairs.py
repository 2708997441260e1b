"""Find every pair of overlapping discs in two arrays, in one call."""

import numpy as np
from matplotlib.collections import LineCollection

import jostle
import show

rng = np.random.default_rng(4)
centers = rng.uniform((0, 0), show.SIZE, (320, 2))
radii = rng.uniform(5, 19, 320)

pairs = jostle.find_pairs(centers, radii)  # (m, 2): two rows, every pair once

touching = np.unique(pairs)
with show.axes(f"{len(centers)} discs, {len(pairs)} pairs") as axes:
    show.discs(axes, centers, radii, show.BLUE, alpha=0.55)
    show.discs(axes, centers[touching], radii[touching], show.TEAL)
    axes.add_collection(LineCollection(list(centers[pairs]), colors=show.GROUND, linewidths=2))
