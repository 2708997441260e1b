"""Play pinball with the left and right arrow keys: two motors swing flippers of immovable discs."""

import numpy as np
import pygame

import jostle
import show

table = [(250, 330), (250, 90), (310, 20), (490, 20), (550, 90), (550, 330), (470, 395)]
table += [(470, 440), (330, 440), (330, 395), (250, 330)]
bumpers = [(340, 130), (460, 130), (400, 200)]
left, right = ([(400 + side * (70 - 5 * k), 400 + 3 * k) for k in range(12)] for side in (-1, 1))
places = [(380, 60), (420, 80), (400, 100), *bumpers, *left, *right]
radii = np.array([8.0] * 3 + [24] * 3 + [5] * 24)
world = jostle.World(
    places, radii, movable=radii == 8, walls=jostle.polyline(table), gravity=(0, 300),
    restitution=0.9,
)  # fmt: skip
paddles = np.split(world.ids[6:], 2)
angles = np.zeros(2)

for screen in show.frames("Pinball", until=240):
    keys = pygame.key.get_pressed()
    goals = np.array([keys[pygame.K_LEFT], keys[pygame.K_RIGHT]], float)
    if pygame.display.get_driver() == "dummy":  # without a display there is no input
        goals[:] = np.sin(12 * world.time) > 0
    speeds = np.clip(60 * (goals - angles), -10, 10)  # radians per second
    angles += speeds / 60
    world.forces = [
        jostle.Motor(ids, pivot=pivot, angular_velocity=speed)
        for ids, pivot, speed in zip(paddles, (left[0], right[0]), speeds * (-1, 1))
    ]
    world.step(1 / 60)
    for a, b in world.walls.segments:
        pygame.draw.aaline(screen, show.SOFT, a.tolist(), b.tolist(), 3)
    for place, radius in zip(world.positions.tolist(), radii):
        color = show.YELLOW if radius == 8 else show.TEAL if radius == 24 else show.ORANGE
        pygame.draw.aacircle(screen, color, place, radius)
    show.caption(screen, "Left and right arrow keys")
