"""A platformer: everyone runs to the mouse over walls, ledges and a lift, and jumps at walls."""

import numpy as np
import pygame

import jostle
import show

LEVEL = """
................ .............--- ................ .......--.......
.#..--.........# ##..........--## ##...#........## ###..##...#..### ################
"""
WALL, LEDGE, WALKER = 1, 2, 4
level = np.array([list(row) for row in LEVEL.split()])
solid, ledges = (jostle.tiles(level == kind, 50) for kind in "#-")
ledges[:, 3] -= 42  # thin
space = jostle.Space()
space.add(boxes=solid, categories=WALL)
space.add(boxes=ledges, categories=LEDGE)
lift = space.add((485, 200), 0.0, (35, 4), categories=LEDGE)
ids = space.add([(20 + 19 * k, 20) for k in range(40)], 2.0, (4, 7), categories=WALKER)
velocities, speeds = np.zeros((40, 2)), np.random.default_rng(18).uniform(2, 5, 40)

for frame, screen in enumerate(show.frames("A platformer", until=170)):
    space.move(lift, (485, 240 + 110 * np.cos(frame / 40)))  # whoever stands on it is carried
    away = pygame.mouse.get_pos()[0] - space.centers(ids)[:, 0]
    velocities += (0, 0.5)
    velocities[:, 0] = speeds * np.clip(away / 40, -1, 1)
    slides = space.move_and_slide(ids, velocities, mask=WALL | LEDGE, one_way=LEDGE)
    velocities = slides.remaining.copy()
    velocities[slides.on_floor & slides.on_wall, 1] = -10

    colors = [show.DIM] * len(solid) + [show.GREEN] * len(ledges) + [show.YELLOW]
    for box, color in zip(np.vstack([solid, ledges, space.boxes(lift)]), colors):
        pygame.draw.rect(screen, color, (*box[:2], *(box[2:] - box[:2])), border_radius=3)
    for x, y in space.centers(ids):
        pygame.draw.rect(screen, show.ORANGE, (x - 6, y - 9, 12, 18), border_radius=5)
    show.caption(screen, f"{(level == '#').sum()} tiles in {len(solid)} boxes, {len(ids)} runners")
