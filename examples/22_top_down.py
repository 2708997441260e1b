"""Seen from above: run to the mouse, push crates, and shoot; nothing passes through a wall."""

import numpy as np
import pygame

import jostle
import show

WALL, CRATE, PLAYER, SHOT = 1, 2, 4, 8
grid = np.pad(np.zeros((10, 18), int), 1, constant_values=1)
grid[4, 3:9] = grid[2:6, 13] = grid[8, 11:16] = 1
walls = jostle.tiles(grid, 40)
space = jostle.Space()
space.add(boxes=walls, categories=WALL)
spots = [(x, y) for x in range(200, 420, 54) for y in range(235, 420, 54)]
crates = space.add(spots, 2.0, 13.0, categories=CRATE)
player = space.add((100, 380), 14.0, categories=PLAYER)
shots, flights, no_floor = np.empty(0, int), np.empty((0, 2)), (0, 0)

for frame, screen in enumerate(show.frames("Crates", until=150)):
    away = np.array(pygame.mouse.get_pos()) - space.get(player).positions
    step = 3.5 * away / max(np.linalg.norm(away), 3.5)
    met = space.move_and_slide(player, step, mask=WALL | CRATE, up=no_floor)
    for crate in np.intersect1d(met.hits, crates):  # a crate moves by what it took from the player
        space.move_and_slide(int(crate), step - met.remaining, mask=WALL | CRATE, up=no_floor)
    space.move_and_slide(player, step - met.displacement, mask=WALL | CRATE, up=no_floor)
    if frame % 6 == 0:
        shots = np.append(shots, space.add(space.get(player).positions, 3.0, categories=SHOT))
        flights = np.vstack([flights, 9 * away / np.linalg.norm(away)])
    flown = space.move_and_slide(shots, flights, mask=WALL | CRATE, max_slides=1, up=no_floor)
    space.remove(shots[flown.on_wall])
    shots, flights = shots[~flown.on_wall], flights[~flown.on_wall]

    for left, top, right, bottom in [*walls, *space.get(crates).boxes]:
        size = (right - left, bottom - top)
        pygame.draw.rect(screen, show.YELLOW if size[0] < 30 else show.DIM, (left, top, *size))
    for center in space.get(shots).positions:
        pygame.draw.circle(screen, show.RED, center, 3)
    pygame.draw.circle(screen, show.TEAL, space.get(player).positions, 14)
    show.caption(screen, f"{len(crates)} crates, {len(shots)} shots in the air")
