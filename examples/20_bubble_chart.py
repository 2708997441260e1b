"""Pack bubbles of any size around a few centres, as in a chart of companies by branch."""

import numpy as np

import jostle
import show

rng = np.random.default_rng(17)
middles = np.array([(170, 150), (400, 250), (640, 150), (190, 370), (620, 360)])
branch = rng.choice(5, 420, p=[0.2, 0.35, 0.18, 0.12, 0.15])
radii = 3 * rng.pareto(2.2, 420).clip(0, 9) + 3

centers = middles[branch] + rng.normal(0, 1, (420, 2))
for _ in range(60):  # towards the middles, and apart again
    centers += 0.06 * (middles[branch] - centers)
    apart = jostle.separate(centers, radii, gap=1, weights=radii**2, max_rounds=20)
    centers[:] = apart.positions
chart = jostle.separate(centers, radii, gap=1, bounds=(0, 0, 800, 450))

colors = np.array([show.BLUE, show.TEAL, show.GREEN, show.YELLOW, show.RED])
with show.axes(f"420 bubbles by size and branch, {chart.overlaps} overlaps") as plot:
    show.discs(plot, chart.positions, radii, colors[branch], linewidths=0)
