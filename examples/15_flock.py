"""A flock of two thousand: each bird keeps its distance, and flies where its neighbours fly."""

import numpy as np
import pygame

import jostle
import show

n = 2000
rng = np.random.default_rng(15)
birds = jostle.Flocking(
    cutoff=26.0, separation=300.0, alignment=2.0, cohesion=4.0, max_speed=120.0, min_speed=60.0
)
places, velocities = rng.uniform((0, 0), show.SIZE, (n, 2)), rng.normal(0, 50, (n, 2))
world = jostle.World(
    places, 1.0, velocities=velocities, period=show.SIZE, on_touch="ignore", forces=[birds]
)

for screen in show.frames("A flock", until=600):
    world.step(1 / 60)
    heads, velocities = world.positions.astype(float), world.velocities.astype(float)
    speeds = np.linalg.norm(velocities, axis=1, keepdims=True)
    tails = heads - 7 * velocities / speeds
    angles = np.arctan2(velocities[:, 1], velocities[:, 0]) / np.pi  # from -1 to 1
    shades = np.rint(np.abs(angles) * (len(show.RAMP) - 1)).astype(int)
    for head, tail, shade in zip(heads, tails, shades):
        pygame.draw.aaline(screen, show.RAMP[shade], tail, head, 2)
    show.caption(screen, f"{n:,} birds")
