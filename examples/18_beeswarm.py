"""Draw ten thousand measurements as a swarm: every point at its value, and none on another."""

import time

import numpy as np

import jostle
import show

rng = np.random.default_rng(15)
groups = {
    show.TEAL: rng.normal(330, 80, 3000),
    show.YELLOW: np.concatenate([rng.normal(230, 45, 1500), rng.normal(540, 60, 2000)]),
    show.RED: 770 - rng.gamma(4, 45, 3500),
}
radius = 1.35

with show.axes("Ten thousand points, each at its value along x") as plot:
    seconds = 0.0
    for middle, (color, values) in zip((100, 232, 360), groups.items()):
        points = np.column_stack([values, np.full(len(values), middle)])
        start = time.perf_counter()
        swarm = jostle.separate(points, radius, axis=1)  # only y may change
        seconds += time.perf_counter() - start
        assert swarm.overlaps == 0
        show.discs(plot, swarm.positions, np.full(len(values), radius), color, linewidths=0)
    print(f"{sum(map(len, groups.values())):,} points in {seconds * 1000:.0f} ms")
