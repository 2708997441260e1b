"""Label the places of a map so that no label covers a place or another label."""

import numpy as np
import pygame

import jostle
import show

rng = np.random.default_rng(16)
parts = ["ar", "bel", "cor", "dun", "el", "fen", "gal", "kel", "lor", "mar", "nor", "ros", "tor"]
n = 130
towns = rng.normal((400, 225), (165, 85), (n, 2)).clip((12, 12), (788, 430))
names = ["".join(rng.choice(parts, rng.integers(2, 4))).title() for _ in range(n)]
pygame.font.init()
font = pygame.font.SysFont("dejavusans,arial", 10)
halves = np.array([font.size(name) for name in names]) / 2

# The towns are fixed discs; each label begins above its town.
centers = np.concatenate([towns, towns - (0, 11)])
apart = jostle.separate(
    centers,
    np.repeat([2.5, 0.0], n),
    np.concatenate([np.zeros((n, 2)), halves]),
    movable=np.arange(2 * n) >= n,
    bounds=(4, 4, 796, 452),
    gap=1,
)
labels = apart.positions[n:]

for screen in show.frames("Labels on a map", until=2):
    for town, label, half, name in zip(towns, labels, halves, names):
        near = np.clip(town, label - half, label + half)
        pygame.draw.aaline(screen, show.SOFT, town, near)
        pygame.draw.circle(screen, show.ORANGE, town, 2.5)
        screen.blit(font.render(name, True, show.TEXT), label - half)
    show.caption(screen, f"{n} labels, {apart.overlaps} overlaps")
