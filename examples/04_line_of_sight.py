"""Line of sight from the mouse: rays in all directions, and the distance of each hit."""

import numpy as np
import pygame

import jostle
import show

rng = np.random.default_rng(12)
centers = np.array([(x, y) for x in range(45, 800, 79) for y in range(45, 500, 82)], float)
n = len(centers)
centers += rng.integers(-18, 19, (n, 2))
half_sizes = rng.integers(6, 22, (n, 2)) * rng.integers(0, 2, (n, 1))  # the others are circles
radii = np.where(half_sizes[:, 0] > 0, 0, rng.integers(7, 18, n))
tree = jostle.Quadtree(centers, radii, half_sizes)

angles = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
REACH = 380
fade = np.clip(1 - np.hypot(*np.mgrid[-REACH:REACH, -REACH:REACH]) / REACH, 0, 1) ** 1.6
glow = pygame.surfarray.make_surface((fade[:, :, None] * (110, 95, 62)).astype(np.uint8))

for screen in show.frames("Line of sight"):
    eye = np.array(pygame.mouse.get_pos())
    hits = tree.raycast(eye, directions, max_distance=REACH)  # no hit: id -1, distance inf
    seen = np.isin(np.arange(n), hits.ids)
    ends = eye + directions * np.minimum(hits.distances, REACH)[:, None]

    light = pygame.Surface(show.SIZE)
    pygame.draw.polygon(
        light, "white", eye + directions * np.minimum(hits.distances, REACH)[:, None]
    )
    light.blit(glow, eye - REACH, special_flags=pygame.BLEND_MULT)
    screen.blit(light, (0, 0), special_flags=pygame.BLEND_ADD)
    for center, radius, half, lit in zip(centers, radii, half_sizes, seen):
        color = show.TEAL if lit else show.DIM
        pygame.draw.rect(screen, color, (*(center - half), *(2 * half)))
        pygame.draw.aacircle(screen, color, center, radius)
    pygame.draw.aacircle(screen, show.TEXT, eye, 6)
    show.caption(screen, f"{len(directions):,} rays, {seen.sum()} of {n} obstacles in sight")
