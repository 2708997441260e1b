"""The icon of the window: two discs that touch, in two quadrants of a square."""

from __future__ import annotations

import pygame

from jostle.app.draw import palette

SIZE = 64
LARGE = 4 * SIZE  # drawn larger and reduced, so that all edges are smooth


def icon() -> pygame.Surface:
    """Return the icon, `SIZE` pixels wide and high."""
    surface = pygame.Surface((LARGE, LARGE), pygame.SRCALPHA)
    whole, middle = surface.get_rect(), LARGE // 2
    pygame.draw.rect(surface, palette.GROUND, whole, border_radius=LARGE // 6)
    for start, end in (((middle, 0), (middle, LARGE)), ((0, middle), (LARGE, middle))):
        pygame.draw.line(surface, palette.WALL, start, end, LARGE // 32)
    # The distance of the centres is the sum of the radii, 0.42 of the size.
    pygame.draw.circle(surface, palette.ACCENT, (0.355 * LARGE, 0.355 * LARGE), 0.24 * LARGE)
    lower = (0.355 + 0.42 / 2**0.5) * LARGE
    pygame.draw.circle(surface, palette.ATTRACTOR, (lower, lower), 0.18 * LARGE)
    return pygame.transform.smoothscale(surface, (SIZE, SIZE))
