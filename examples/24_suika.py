"""Fruits fall where the mouse is, and two of a kind that touch become one of the next kind."""

import numpy as np
import pygame

import jostle
import show

RADII = [11, 16, 22, 29, 37, 46, 56, 67]
COLORS = [*show.RAMP, show.TEXT]
rng = np.random.default_rng(4)
glass = jostle.polyline([(200, 60), (200, 485), (600, 485), (600, 60)])
world = jostle.World(gravity=(0, 700), walls=glass)
score = 0

for frame, screen in enumerate(show.frames("Suika", until=1200)):
    x = np.clip(pygame.mouse.get_pos()[0], 240, 560)
    new = [((x, 30), int(rng.integers(0, 4)))] if frame % 20 == 0 else []  # places and kinds
    used: set[int] = set()
    for pair in world.last_step.contacts.pairs.tolist():
        one, other = world.rows(pair)
        kind = int(world.kinds[one])
        if kind == world.kinds[other] and kind < 7 and used.isdisjoint(pair):
            used.update(pair)
            new.append((world.positions[[one, other]].mean(axis=0), kind + 1))
            score += 2**kind
    world.remove(list(used))
    for place, kind in new:
        world.add(place, RADII[kind], kinds=kind, restitution=0.1, friction=0.3)
    world.step(1 / 60)

    for start, end in world.walls.segments.tolist():
        pygame.draw.aaline(screen, show.SOFT, start, end, 4)
    for place, radius, kind in zip(world.positions.tolist(), world.radii.tolist(), world.kinds):
        pygame.draw.aacircle(screen, COLORS[kind], place, radius - 1)
        shine = (place[0] - 0.35 * radius, place[1] - 0.4 * radius)
        pygame.draw.aacircle(screen, show.TEXT, shine, 0.14 * radius)
    show.caption(screen, f"{len(world.ids)} fruits, {score} points")
