"""Grains run out of hoppers when the gates open, at rates that follow Beverloo's law."""

import numpy as np
import pygame

import jostle
import show

middles, widths = np.array([100, 300, 500, 700]), np.array([32, 42, 52, 62])
walls, places = [], []
for x, width in zip(middles, widths):
    walls += [[(x - width / 2, 400), (x + width / 2, 400)]]  # the gate: wall 0, 5, 10 or 15
    for side in (-1, 1):
        corners = [(x + side * 95, -500), (x + side * 95, 330), (x + side * width / 2, 400)]
        walls += jostle.polyline(corners).tolist()
    places += [(x + dx, y) for dx in range(-84, 85, 8) for y in range(-120, 320, 8)]
rng = np.random.default_rng(8)
n = len(places)
world = jostle.World(
    places + rng.uniform(-0.5, 0.5, (n, 2)), rng.uniform(2.6, 3.4, n), gravity=(0, 500),
    friction=0.4, restitution=0.2, walls=walls,
)  # fmt: skip
bands = (world.positions[:, 1] // 40).astype(int) % len(show.RAMP)
text = "The gates open"

for frame, screen in enumerate(show.frames("Hoppers", until=270)):
    if frame == 90:
        world.walls.remove([0, 5, 10, 15])
    world.step(1 / 60)
    x, y = world.positions.T
    if frame > 120:
        out = ((abs(x - middles[:, None]) < 100) & (y > 400)).sum(axis=1)
        slope, offset = np.polyfit(widths, out ** (2 / 3), 1)
        law = np.round((slope * widths + offset) ** 1.5).astype(int)
        text = f"out: {out} of {n:,} grains; law, (width - {-offset / slope:.1f})^1.5: {law}"
    for start, end in world.walls.segments.tolist():
        pygame.draw.aaline(screen, show.SOFT, start, end, 3)
    for k in np.flatnonzero(y < 500):
        pygame.draw.aacircle(screen, show.RAMP[bands[k]], (float(x[k]), float(y[k])), 3.2)
    show.caption(screen, text)
