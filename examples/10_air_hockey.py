"""Air hockey against the computer: mallets that nothing pushes, and goals that report the puck."""

import numpy as np
import pygame

import jostle
import show

PUCK, MALLET, GOAL = 1, 2, 4
world = jostle.World(
    [(400, 250)], 18.0, velocities=(-420, 150), restitution=0.95, categories=PUCK,
    container=jostle.Box(0, 0, *show.SIZE), track_events=True,
)  # fmt: skip
world.walls.add([[(2, 180), (2, 320)], [(798, 180), (798, 320)]], sensors=True, categories=GOAL)
mallets = world.add([(150, 250), (650, 250)], 30.0, movable=False, categories=MALLET)
score, trail = [0, 0], [(400.0, 250.0)]

for screen in show.frames("Air hockey", until=400):
    puck = world.positions[0].tolist()
    wishes = [pygame.mouse.get_pos(), puck if puck[0] > 420 else (690, puck[1])]
    aims = np.clip(wishes, [(30, 30), (430, 30)], [(370, 470), (770, 470)])
    world.set(mallets, velocities=np.clip(15 * (aims - world.get(mallets).positions), -400, 400))
    world.step(1 / 60)
    for goal in world.wall_events.between(PUCK, GOAL).entered[:, 1]:
        score[1 - goal] += 1
        world.set(0, positions=(400, 250), velocities=(300 - 600 * goal, 140))

    pygame.draw.aaline(screen, show.DIM, (400, 0), (400, 500), 3)
    pygame.draw.aacircle(screen, show.DIM, (400, 250), 70, 3)
    for start, end in world.walls.segments.tolist():
        pygame.draw.line(screen, show.YELLOW, start, end, 6)
    trail = [*trail[-30:], puck]
    for k, place in enumerate(trail):
        faded = pygame.Color(show.GROUND).lerp(show.RED, (k + 1) ** 3 / len(trail) ** 3)
        pygame.draw.aacircle(screen, faded, place, 18 * (k + 1) / len(trail))
    for mallet, color in zip(world.get(mallets).positions.tolist(), (show.TEAL, show.BLUE)):
        pygame.draw.aacircle(screen, color, mallet, 30)
    show.caption(screen, f"{score[0]} : {score[1]}")
