"""Pick the disc under the mouse; drag to select all discs that overlap a rectangle."""

import numpy as np
import pygame

import jostle
import show

rng = np.random.default_rng(18)
centers = rng.uniform((0, 0), show.SIZE, (300, 2))
radii = rng.uniform(8, 24, 300)
tree = jostle.Quadtree(centers, radii)
corner = None  # start of the drag

for screen in show.frames("Mouse picking"):
    mouse = pygame.mouse.get_pos()
    for event in pygame.event.get((pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP)):
        corner = event.pos if event.type == pygame.MOUSEBUTTONDOWN else None

    rect = *np.minimum(corner or mouse, mouse), *np.maximum(corner or mouse, mouse)
    selected = set(tree.query_rect(rect).tolist()) if corner else set()
    under = tree.query_point(mouse)  # ascending, so the last one is drawn on top
    picked = under[-1] if len(under) else None

    for k in range(300):
        color = show.YELLOW if k == picked else show.TEAL if k in selected else show.BLUE
        pygame.draw.aacircle(screen, show.GROUND, centers[k], radii[k])
        pygame.draw.aacircle(screen, color, centers[k], radii[k] - 1)
    if corner:
        box = pygame.Rect(rect[:2], (rect[2] - rect[0], rect[3] - rect[1]))
        pygame.draw.rect(screen, show.TEXT, box, 1)
    show.caption(screen, f"{len(selected)} selected, {len(under)} under the mouse")
