"""A horde of thousands runs at the mouse; one call in each frame keeps all of them apart."""

import numpy as np
import pygame

import jostle
import show

n = 2500
rng = np.random.default_rng(14)
places = rng.uniform((0, 0), show.SIZE, (n, 2))
radii = rng.choice([2.5, 3.5, 5.0, 8.0], n, p=[0.4, 0.4, 0.17, 0.03])
speeds = rng.uniform(0.4, 1.2, (n, 1))
is_player = np.arange(n + 1) == n
sizes = np.append(radii, 18.0)  # the player is the last disc: nothing pushes it
weights = sizes**2  # small discs move more than large ones

for screen in show.frames("A horde", until=240):
    player = np.array(pygame.mouse.get_pos(), float)
    away = player - places
    places += speeds * away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1)

    apart = jostle.separate(
        np.vstack([places, player]), sizes, weights=weights, movable=~is_player, max_rounds=12
    )
    places[:] = apart.positions[:-1]

    for place, radius in zip(places, radii):
        color = {2.5: show.BLUE, 3.5: show.TEAL, 5.0: show.YELLOW, 8.0: show.RED}[radius]
        pygame.draw.circle(screen, color, place, radius - 0.5)
    pygame.draw.circle(screen, show.TEXT, player, 17)
    show.caption(screen, f"{n:,} enemies, {apart.overlaps} pairs still overlap")
