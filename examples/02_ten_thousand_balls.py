"""Ten thousand balls fall into a box and jostle; a heavy one follows the mouse through them."""

import numpy as np
import pygame

import jostle
import show

n = 10_000
rng = np.random.default_rng(2)
places = rng.uniform((4, 4), (796, 496), (n, 2))
world = jostle.World(
    places,
    rng.uniform(2, 3, n),
    gravity=(0, 200),
    restitution=0.5,
    container=jostle.Box(0, 0, *show.SIZE),
)
plough = world.add((180, 158), 36, masses=1e6)

# One ball of each colour is drawn once and copied: faster than drawing 10,000 circles.
stamps = [pygame.Surface((8, 8), pygame.SRCALPHA) for _ in show.RAMP]
for stamp, color in zip(stamps, show.RAMP):
    pygame.draw.aacircle(stamp, color, (4, 4), 2.5)
column = (places[:, 0] / show.WIDTH * len(stamps)).astype(int)  # coloured by the initial position
stamp_of = [stamps[k] for k in column]

for screen in show.frames("Ten thousand balls", until=200):
    world.forces = [jostle.Grab(plough, pygame.mouse.get_pos(), rate=20)]
    world.step(1 / 60)

    corners = (world.positions[:n] - 4).tolist()
    screen.fblits(list(zip(stamp_of, corners)))
    pygame.draw.aacircle(screen, show.TEXT, world.positions[n].tolist(), 36)
    show.caption(screen, f"{n:,} balls, {len(world.last_step.contacts.pairs):,} contacts")
