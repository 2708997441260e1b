"""Line of sight from the mouse, also in mirrors: each ray goes on from the mirror that it hits."""

import numpy as np
import pygame

import jostle
import show

pillars = [(120, 130), (290, 215), (430, 90), (640, 180), (420, 420), (660, 420), (200, 390)]
lines = [[(40, 430), (170, 470)], [(240, 40), (380, 20)], [(770, 170), (720, 320)]]
lines += [[(20, 210), (50, 320)], [(520, 480), (600, 470)], [(560, 60), (590, 20)]]
world = jostle.World(pillars, 20.0, walls=lines, container=jostle.Box(0, 0, *show.SIZE))
turns = np.linspace(0, 2 * np.pi, 2001)
fade = np.clip(1 - np.hypot(*np.mgrid[-800:800, -500:500]) / 800, 0, 1)[:, :, None] ** 1.6
glow = pygame.surfarray.make_surface((fade * (92, 80, 54)).astype(np.uint8))

for screen in show.frames("Line of sight"):
    eye = np.array(pygame.mouse.get_pos(), float)
    starts, ways = np.tile(eye, (2001, 1)), np.stack([np.cos(turns), np.sin(turns)], axis=1)
    last = np.full(2001, -1)  # the mirror that each ray comes from
    for _ in range(5):
        hits = world.raycast(starts, ways)
        beams = np.stack([starts[:-1], starts[1:], hits.points[1:], hits.points[:-1]], axis=1)
        sheet = pygame.Surface(show.SIZE)
        for beam in beams[last[1:] == last[:-1]].tolist():
            pygame.draw.polygon(sheet, "white", beam)
        sheet.blit(glow, eye - (800, 500), special_flags=pygame.BLEND_MULT)
        screen.blit(sheet, (0, 0), special_flags=pygame.BLEND_ADD)
        on, n = hits.walls >= 0, hits.normals  # the sides of the window are below 0
        starts, last = (hits.points + 0.01 * n)[on], hits.walls[on]  # just before the mirror
        ways = (ways - 2 * (ways * n).sum(axis=1, keepdims=True) * n)[on]
    for center in pillars:
        pygame.draw.aacircle(screen, show.DIM, center, 20)
    for a, b in lines:
        pygame.draw.aaline(screen, show.TEAL, a, b, 4)
    pygame.draw.aacircle(screen, show.TEXT, eye, 6)
    show.caption(screen, f"{len(turns):,} rays, {len(lines)} mirrors")
