"""See as the mouse sees: rays in all directions, and how far each gets."""

import numpy as np
import pygame

import jostle
import show

rng = np.random.default_rng(12)
centers = rng.uniform((0, 0), show.SIZE, (70, 2)).round()
boxes = np.arange(70) < 35  # the others are circles
half_sizes = np.where(boxes[:, None], rng.integers(6, 24, (70, 2)), 0)
radii = np.where(boxes, 0, rng.integers(6, 18, 70))
tree = jostle.Quadtree(centers, radii, half_sizes)

angles = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
REACH = 380

for screen in show.frames("Line of sight"):
    eye = np.array(pygame.mouse.get_pos())
    ids, distances = tree.raycast(eye, directions, max_distance=REACH)  # -1 and inf: nothing hit
    seen = np.isin(np.arange(70), ids)

    for reach in range(REACH, 0, -10):  # the light fades with the distance
        light = pygame.Color(show.GROUND).lerp(show.YELLOW, 0.45 * (1 - reach / REACH) ** 1.5)
        ends = eye + directions * np.minimum(distances, reach)[:, None]
        pygame.draw.polygon(screen, light, ends)
    for k, center in enumerate(centers):
        color = show.TEAL if seen[k] else show.DIM
        if boxes[k]:
            pygame.draw.rect(screen, color, (*(center - half_sizes[k]), *(2 * half_sizes[k])))
        else:
            pygame.draw.aacircle(screen, color, center, radii[k])
    pygame.draw.aacircle(screen, show.TEXT, eye, 6)
    show.caption(screen, f"{len(directions):,} rays, {seen.sum()} of 70 obstacles in sight")
