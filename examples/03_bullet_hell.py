"""A bullet hell: hundreds of bullets, and one call in each frame tells which hit whom."""

import numpy as np
import pygame

import jostle
import show

PLAYER, SHOT, ENEMY, BULLET = 1, 2, 4, 8
COLORS = {PLAYER: show.TEXT, SHOT: show.TEAL, ENEMY: show.YELLOW, BULLET: show.RED}
enemies, spins = np.array([(150, 90), (400, 60), (650, 90)]), np.array([0.021, -0.013, -0.021])
space = jostle.Space()
player = space.add((400, 420), 7.0, categories=PLAYER, masks=BULLET)
space.add(enemies, 22.0, categories=ENEMY, masks=SHOT)
velocities = np.zeros((4, 2))  # a row for each shape, in the order of adding
score = lost = 0

for frame, screen in enumerate(show.frames("Bullet hell", until=220)):
    if frame % 4 == 0:  # seven arms of a spiral around each enemy, and a shot
        turns = np.add.outer(frame * spins, np.arange(7) * 2 * np.pi / 7).ravel()
        arms = np.stack([np.cos(turns), np.sin(turns)], axis=1)
        starts = np.repeat(enemies, 7, axis=0) + 22 * arms
        space.add(starts, 4.5, categories=BULLET, masks=PLAYER)
        space.add(space.get(player).positions, 3.0, categories=SHOT, masks=ENEMY)
        velocities = np.vstack([velocities, 2.2 * arms, (0, -9)])
    space.positions = space.positions + velocities
    space.set(player, positions=np.add(pygame.mouse.get_pos(), (0, 90)))

    events = space.update(swept=True)  # also what met on the way from the last frame
    hits, shots = events.between(BULLET, PLAYER).entered, events.between(SHOT, ENEMY).entered
    lost, score = lost + len(hits), score + len(shots)
    outside = (abs(space.positions - (400, 250)) > (420, 270)).any(axis=1)
    gone = outside | np.isin(space.ids, [*hits[:, 0], *shots[:, 0]])
    space.remove(space.ids[gone])
    velocities = velocities[~gone]

    for center, radius, category in zip(space.positions, space.radii, space.categories.tolist()):
        pygame.draw.aacircle(screen, COLORS[category], center, radius)
    show.caption(screen, f"{len(space):,} shapes, {score} shots hit, {lost} bullets hit you")
