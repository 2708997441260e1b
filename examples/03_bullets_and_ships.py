"""Bullets hit ships and nothing else: filters select the pairs, events report the new ones."""

import numpy as np
import pygame

import jostle
import show

SHIP, BULLET = 1, 2
MIDDLE = np.array([400.0, 250.0])
rng = np.random.default_rng(3)
space = jostle.Space()


def ring(angles, distance):
    return MIDDLE + distance * np.stack([np.cos(angles), np.sin(angles)], axis=-1)


for screen in show.frames("Bullets and ships", until=220):
    space.add(ring(rng.uniform(0, 6.28), 480), rng.uniform(12, 18), categories=SHIP, masks=BULLET)
    aim = pygame.mouse.get_pos() - MIDDLE
    turn = np.arctan2(aim[1], aim[0]) + np.arange(5) * 2 * np.pi / 5
    space.add(ring(turn, 24), radii=2.5, categories=BULLET, masks=SHIP)

    places, is_ship = space.positions - MIDDLE, space.categories == SHIP
    out = places / np.linalg.norm(places, axis=1, keepdims=True)
    around = out[:, ::-1] * (-1, 1)
    space.positions = space.positions + np.where(is_ship[:, None], 2 * around - out, 6 * out)

    met = np.unique(space.update().entered)  # bullets and ships that begin to overlap
    hit = met[space.get(met).categories == SHIP]
    space.set(hit, radii=space.get(hit).radii - 3)
    over = np.where(is_ship, space.radii < 5, np.linalg.norm(places, axis=1) > 480)
    space.remove(np.union1d(np.setdiff1d(met, hit), space.ids[over]))  # also of bullets that hit

    for center, radius in zip(space.positions, space.radii):
        color = show.YELLOW if radius < 3 else show.RED if radius < 12 else show.TEAL
        pygame.draw.aacircle(screen, color, center, radius)
    pygame.draw.aacircle(screen, show.TEXT, MIDDLE, 14)
    show.caption(screen, f"{is_ship.sum()} ships, {(~is_ship).sum()} bullets, {len(hit)} hits")
