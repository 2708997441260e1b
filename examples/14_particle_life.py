"""Particle life: six kinds attract and repel each other, and form chains that crawl and join."""

import numpy as np
import pygame

import jostle
import show

n = 3000
rng = np.random.default_rng(14)
kinds = np.arange(n) % 6
colours = [*show.RAMP[1:], show.TEXT]
world = jostle.World(
    rng.uniform((0, 0), show.SIZE, (n, 2)),
    2.0,
    masses=1.0,
    kinds=kinds,
    period=show.SIZE,
    on_touch="ignore",
    drag=10.0,
    forces=[
        jostle.PairForce.particle_life(jostle.life.MATRICES["dragons"], cutoff=36.0, strength=120.0)
    ],
)

for screen in show.frames("Particle life", until=900):
    world.step(1 / 60)
    for place, kind in zip(world.positions.tolist(), kinds):
        pygame.draw.circle(screen, colours[kind], place, 2.5)
    show.caption(screen, f"{n:,} particles of six kinds")
