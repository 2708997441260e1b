"""Discs bounce in a hall with two goals: sensors, which report discs and do not stop them."""

import numpy as np
import pygame

import jostle
import show

n = 60
rng = np.random.default_rng(10)
grid = np.stack(np.meshgrid(np.linspace(200, 600, 10), np.linspace(60, 440, 6)), -1)
world = jostle.World(
    grid.reshape(n, 2),
    9.0,
    velocities=rng.normal(0, 160, (n, 2)),
    container=jostle.Box(0, 0, *show.SIZE),
    track_events=True,
)
goals = world.add([(0, 250), (800, 250)], 80.0, movable=False, sensors=True)
scores, hits = np.zeros(2, int), 0

for screen in show.frames("Goal line", until=240):
    world.step(1 / 60)
    hits += world.last_call.collisions
    events = world.events  # pairs of ids, the smaller first
    for k, goal in enumerate(goals):
        scores[k] += (events.entered[:, 1] == goal).sum()

    touching = np.concatenate([events.entered, events.stayed])
    inside = set(touching[touching[:, 1] >= goals[0], 0].tolist())
    for goal, center in zip(goals, world.positions[goals]):
        is_lit = (touching[:, 1] == goal).any()
        pygame.draw.aacircle(screen, show.YELLOW if is_lit else show.DIM, center.tolist(), 80, 3)
    for id, center in enumerate(world.positions[:n]):
        pygame.draw.aacircle(screen, show.RED if id in inside else show.BLUE, center.tolist(), 9)
    show.caption(screen, f"{scores[0]} to {scores[1]} after {hits} collisions")
