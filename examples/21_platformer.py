"""A platformer: runners jump over walls, onto ledges and on a lift; one call moves all of them."""

import numpy as np
import pygame

import jostle
import show

LEVEL = """
................ .............--- ...--.......---. .........--.....
.#..--.........# ##..........--## ##...#........## ###..##...#..### ################
"""
WALL, LEDGE, RUNNER = 1, 2, 4
level = np.array([list(row) for row in LEVEL.split()])
solid, ledges = (jostle.tiles(level == kind, 50) for kind in "#-")
ledges[:, 3] -= 42  # thin
rng = np.random.default_rng(18)
space = jostle.Space()
space.add(boxes=np.vstack([solid, (-9, -999, 0, 450), (800, -999, 809, 450)]), categories=WALL)
space.add(boxes=ledges, categories=LEDGE)
lift = space.add((385, 200), 0.0, (35, 4), categories=LEDGE)
ids = space.add([(20 + 19 * k, 20) for k in range(40)], 2.0, (4, 7), categories=RUNNER)
velocities, speeds = np.zeros((40, 2)), rng.choice([-1, 1], 40) * rng.uniform(1, 3, 40)

for frame, screen in enumerate(show.frames("A platformer", until=170)):
    space.set(lift, positions=(385, 240 + 110 * np.cos(frame / 40)))  # it carries the runners on it
    velocities[:, 0] = speeds
    velocities[:, 1] += 0.5
    slides = space.move_and_slide(ids, velocities, mask=WALL | LEDGE, one_way=LEDGE)
    velocities[:] = slides.remaining
    jumps = slides.on_floor & (slides.on_wall | (rng.random(40) < 0.02))
    velocities[jumps, 1] = -rng.uniform(7, 12, jumps.sum())
    speeds[slides.on_wall & (rng.random(40) < 0.1)] *= -1

    colors = [show.DIM] * len(solid) + [show.GREEN] * len(ledges) + [show.YELLOW]
    for box, color in zip(np.vstack([solid, ledges, space.get(lift).boxes]), colors):
        pygame.draw.rect(screen, color, (*box[:2], *(box[2:] - box[:2])), border_radius=3)
    for x, y in space.get(ids).positions:
        pygame.draw.rect(screen, show.ORANGE, (x - 6, y - 9, 12, 18), border_radius=5)
    show.caption(screen, f"{(level == '#').sum()} tiles in {len(solid)} boxes, {len(ids)} runners")
