"""Ten thousand balls fall into a box and jostle; the mouse is a big ball that ploughs through."""

import numpy as np
import pygame

import jostle
import show

rng = np.random.default_rng(2)
n = 10_000
radii = rng.uniform(1.5, 3.0, n)
world = jostle.World(
    rng.uniform((4, 4), (796, 496), (n, 2)),
    rng.normal(0, 40, (n, 2)),
    radii,
    gravity=(0, 200),
    restitution=0.6,
    container=jostle.Box(0, 0, *show.SIZE),
)
plough = world.add([(-100, -100)], [(0, 0)], 45, movable=False)

# Draw each colour once, and stamp it: much faster than ten thousand circles.
stamps = []
for color, radius in zip(show.RAMP, np.linspace(1.5, 3.0, len(show.RAMP))):
    stamp = pygame.Surface((8, 8), pygame.SRCALPHA)
    pygame.draw.aacircle(stamp, color, (4, 4), radius)
    stamps.append(stamp)
stamp_of = [stamps[k] for k in np.digitize(radii, np.linspace(1.5, 3.0, len(stamps) + 1)[1:-1])]

for screen in show.frames("Ten thousand balls", until=240):
    mouse = pygame.mouse.get_pos()
    world.set(plough, positions=[mouse])
    world.step(1 / 60)
    corners = (world.positions[:n] - 4).tolist()
    screen.fblits(list(zip(stamp_of, corners)))
    pygame.draw.aacircle(screen, show.TEXT, mouse, 45, 2)
    show.caption(screen, f"{n:,} balls, {len(world.contacts.pairs):,} contacts")
