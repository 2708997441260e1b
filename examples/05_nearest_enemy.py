"""Each tower aims at the nearest enemy within its range: one call for all towers."""

import numpy as np
import pygame

import jostle
import show

REACH = 60
rng = np.random.default_rng(5)
towers = np.array([(x, y) for x in range(67, 800, 133) for y in range(75, 430, 110)], float)
start = rng.uniform(0, 1000, 260)
lane = rng.normal(0, 26, 260)

for frame, screen in enumerate(show.frames("Nearest enemy")):
    x = (start + 1.2 * frame) % 1000 - 100
    enemies = np.stack([x, 240 + 130 * np.sin(x / 110) + lane], axis=1)

    tree = jostle.Quadtree(enemies, radii=5.0)
    aims = tree.nearest(towers, max_distance=REACH).ids[:, 0]  # none: -1

    for tower in towers:
        pygame.draw.aacircle(screen, show.DIM, tower, REACH, 1)
    for enemy in enemies:
        pygame.draw.aacircle(screen, show.BLUE, enemy, 5)
    for tower, aim in zip(towers, aims):
        if aim >= 0:
            pygame.draw.aaline(screen, show.YELLOW, tower, enemies[aim], 2)
            pygame.draw.aacircle(screen, show.RED, enemies[aim], 5)
        pygame.draw.aacircle(screen, show.YELLOW if aim >= 0 else show.SOFT, tower, 8)
    show.caption(screen, f"{(aims >= 0).sum()} of {len(towers)} towers have an enemy in reach")
