"""Bullets hit ships and nothing else: filters say who may pair, events say who just met."""

import numpy as np
import pygame

import jostle
import show

SHIP, BULLET = 1, 2
MIDDLE = np.array([400.0, 250.0])
space = jostle.Space()
rng = np.random.default_rng(3)

for screen in show.frames("Bullets and ships"):
    angle = rng.uniform(0, 2 * np.pi)
    ship = MIDDLE + 480 * np.array([np.cos(angle), np.sin(angle)])
    space.add(ship, rng.uniform(8, 20), categories=SHIP, masks=BULLET)
    aim = np.array(pygame.mouse.get_pos()) - MIDDLE
    turn = np.arctan2(aim[1], aim[0]) + np.linspace(0, 2 * np.pi, 6)[:-1]
    shots = MIDDLE + 24 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    space.add(shots, 2, categories=BULLET, masks=SHIP)

    centers, is_ship = space.centers(), space.categories() == SHIP
    out = (centers - MIDDLE) / np.linalg.norm(centers - MIDDLE, axis=1, keepdims=True)
    around = out[:, ::-1] * (1, -1)
    space.move(space.ids, centers + np.where(is_ship[:, None], 2 * around - out, 5 * out))

    met = np.unique(space.update().entered)  # every bullet that met a ship, and every such ship
    ship_was_hit = space.categories(met) == SHIP
    space.remove(met[~ship_was_hit])
    space.resize(met[ship_was_hit], 0.8 * space.radii(met[ship_was_hit]))
    far = np.linalg.norm(space.centers() - MIDDLE, axis=1) > 500
    space.remove(space.ids[far | (space.radii() < 5) & (space.categories() == SHIP)])

    for center, radius, kind in zip(space.centers(), space.radii(), space.categories()):
        color = show.YELLOW if kind == BULLET else show.RED if radius < 8 else show.TEAL
        pygame.draw.aacircle(screen, color, center, radius)
    show.caption(screen, f"{is_ship.sum()} ships, {(~is_ship).sum()} bullets, {len(met)} met")
