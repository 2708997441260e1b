"""A platformer: everyone runs after the mouse over tiles, ledges and a lift, and jumps at walls."""

import numpy as np
import pygame

import jostle
import show

LEVEL = """................................ ................................ ..........------................
................................ .#...................------...#. .#............................#.
.######...--L--............######. .#....................##......#. .......####............####.....#
........#..#.........#####..#..# ###...###..######...############ ################################"""
ROWS = [row.ljust(32, ".")[:32] for row in LEVEL.split()]
WALL, LEDGE, WALKER = 1, 2, 4
level = np.array([list(row) for row in ROWS])
solid, ledges = (jostle.tiles(level == kind, (25, 38), (0, 60)) for kind in "#-")
ledges[:, 3] -= 28
space = jostle.Space()
space.add(boxes=solid, categories=WALL)
space.add(boxes=ledges, categories=LEDGE)
lift = space.add(boxes=(480, 300, 560, 308), categories=LEDGE)
ids = space.add([(40 + 18 * k, 20) for k in range(40)], 2.0, (4, 7), categories=WALKER)
velocities = np.zeros((40, 2))
speeds = np.random.default_rng(18).uniform(2, 5, 40)

for frame, screen in enumerate(show.frames("A platformer", until=150)):
    space.move(lift, (520, 320 + 90 * np.cos(frame / 40)))  # whoever stands on it is carried
    away = pygame.mouse.get_pos()[0] - space.centers(ids)[:, 0]
    velocities[:, 0] = speeds * np.clip(away / 40, -1, 1)
    velocities[:, 1] += 0.5
    slides = space.move_and_slide(ids, velocities, mask=WALL | LEDGE, one_way=LEDGE)
    velocities = slides.remaining.copy()
    velocities[slides.on_floor & slides.on_wall, 1] = -11

    for (left, top, right, bottom), color in [*((b, show.DIM) for b in solid), *((b, show.GREEN) for b in ledges), (space.boxes(lift), show.YELLOW)]:
        pygame.draw.rect(screen, color, (left, top, right - left, bottom - top))
    for center in space.centers(ids):
        pygame.draw.rect(screen, show.ORANGE, pygame.Rect(0, 0, 12, 18).move(center - (6, 9)), border_radius=4)
    show.caption(screen, f"{len(solid)} boxes for {(level == '#').sum()} tiles")
