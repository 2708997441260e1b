"""A platformer: the hero runs to the mouse and jumps if it is above, and collects the coins."""

import numpy as np
import pygame

import jostle
import show

LEVEL = """
.............o.. ............---. ...o....o....... ..---..---....o. .............---
........o..---.. #o.....##.o...o. ##..#..##..#..## ##..#..##..##.## ################
"""
WALL, LEDGE, LIFT, COIN, HERO = 1, 2, 4, 8, 16
COLORS = {WALL: show.DIM, LEDGE: show.GREEN, LIFT: show.TEAL, COIN: show.YELLOW, HERO: show.ORANGE}
level = np.array([list(row) for row in LEVEL.split()])
solid, ledges = jostle.tiles(level == "#", 50), jostle.tiles(level == "-", 50)
ledges[:, 3] -= 40  # thin
space = jostle.Space()
space.add(boxes=solid, categories=WALL)
space.add(boxes=ledges, categories=LEDGE)
lift = space.add((500, 300), 0.0, (40, 5), categories=LIFT)
spots = np.argwhere(level == "o")[:, ::-1] * 50 + 25
space.add(spots, 8.0, categories=COIN, masks=HERO)
hero = space.add((50, 300), 0.0, (9, 15), categories=HERO)
fall = 0.0

for frame, screen in enumerate(show.frames("A platformer", until=360)):
    space.set(lift, positions=(500, 270 + 100 * np.cos(frame / 40)))  # it carries the hero
    away = pygame.mouse.get_pos() - space.get(hero).positions
    step = (np.clip(away[0] / 5, -4, 4), fall)
    slide = space.move_and_slide(hero, step, mask=WALL | LEDGE | LIFT, one_way=LEDGE | LIFT, snap=8)
    fall = -14 if slide.on_floor and away[1] < -30 else slide.remaining[1] + 0.6
    space.remove(space.update().between(COIN, HERO).entered[:, 0])

    left = (space.categories == COIN).sum()
    for (x, y, right, bottom), category in zip(space.bounds(), space.categories.tolist()):
        area = (x, y, right - x, bottom - y)
        pygame.draw.rect(screen, COLORS[category], area, border_radius=8 * (category != WALL))
    show.caption(screen, f"{len(spots) - left} of {len(spots)} coins")
