"""Find the neighbours of every star on a torus: lines join those near, across the edges too."""

import numpy as np
import pygame

import jostle
import show

n, reach = 700, 30.0
rng = np.random.default_rng(14)
places = rng.uniform((0, 0), show.SIZE, (n, 2))
steps = rng.normal(0, 0.5, (n, 2))

for screen in show.frames("Neighbours across the edges", until=90):
    places = (places + steps) % show.SIZE
    tree = jostle.Quadtree(places, period=show.SIZE)
    near = tree.neighbors(reach)

    counts = near.counts
    first = np.repeat(np.arange(n), counts)
    between = places[near.ids] - places[first]
    wrapped = between - np.round(between / show.SIZE) * show.SIZE  # the minimum image
    crosses = (wrapped != between).any(axis=1)
    for start, offset, cross in zip(places[first], wrapped, crosses):
        color = show.ORANGE if cross else show.DIM
        pygame.draw.aaline(screen, color, start, start + offset)
    shades = np.minimum(counts, len(show.RAMP) - 1)
    for place, shade in zip(places, shades):
        pygame.draw.circle(screen, show.RAMP[shade], place, 3)
    crossing = int(crosses.sum()) // 2
    show.caption(screen, f"{len(near.ids) // 2} pairs, {crossing} of them across an edge (orange)")
