"""A crowd of thousands: each keeps its distance and follows its seven nearest neighbours."""

import numpy as np
import pygame

import jostle
import show

n = 4000
rng = np.random.default_rng(8)
places = rng.uniform((0, 0), show.SIZE, (n, 2))
steps = rng.normal(0, 1, (n, 2))
itself = np.arange(n)[:, None]

for screen in show.frames("A crowd that avoids itself", until=300):
    tree = jostle.Quadtree(places)
    near = tree.nearest(places, k=8, max_distance=24)  # the first is the disc itself
    ids = np.where(near.ids < 0, itself, near.ids)  # instead of a missing neighbour, itself

    away = places[:, None] - places[ids]
    too_close = np.maximum(1 - near.distances / 8, 0)[:, :, None]
    steps += 0.10 * (steps[ids].mean(axis=1) - steps)  # alignment
    steps -= 0.004 * away.mean(axis=1)  # cohesion
    steps += 0.12 * (away * too_close).sum(axis=1)  # separation
    flee = places - pygame.mouse.get_pos()
    far = np.linalg.norm(flee, axis=1, keepdims=True)
    steps += 0.5 * flee / far * (far < 60)
    steps *= 1.6 / np.linalg.norm(steps, axis=1, keepdims=True)
    places = (places + steps) % show.SIZE

    angles = np.arctan2(steps[:, 1], steps[:, 0]) / np.pi  # from -1 to 1
    shades = (np.abs(angles) * (len(show.RAMP) - 1)).round().astype(int)
    for head, tail, shade in zip(places, places - 4 * steps, shades):
        pygame.draw.aaline(screen, show.RAMP[shade], tail, head, 2)
    show.caption(screen, f"{n:,} in the crowd")
