"""Words on the screen: one face, three sizes, and pictures of words kept between frames."""

from __future__ import annotations

from functools import lru_cache

import pygame

from jostle.app.draw.palette import PANEL, PANEL_EDGE, TEXT, Colour

TITLE, BODY, SMALL = 20, 14, 12

# Regular faces that read well small, best first; pygame's own is bold, and the last resort.
FACES = "inter,segoeui,helveticaneue,notosans,dejavusans,liberationsans,arial"

Place = tuple[int, int]


@lru_cache(maxsize=8)
def font(size: int) -> pygame.font.Font:
    """Return the face at a size in pixels."""
    pygame.font.init()  # harmless when done already; film and tests open no window
    return pygame.font.SysFont(FACES, size)


@lru_cache(maxsize=512)
def word(text: str, colour: Colour = TEXT, size: int = BODY) -> pygame.Surface:
    """Return the picture of a text."""
    return font(size).render(text, True, colour)


def write(
    target: pygame.Surface,
    place: Place,
    text: str,
    colour: Colour = TEXT,
    size: int = BODY,
    *,
    flush_right: bool = False,
) -> int:
    """Write at a top-left corner, or up to a top-right one; return the width."""
    picture = word(text, colour, size)
    x = place[0] - picture.get_width() if flush_right else place[0]
    target.blit(picture, (x, place[1]))
    return picture.get_width()


def panel(size: tuple[int, int]) -> pygame.Surface:
    """Return a translucent sheet to write on."""
    sheet = pygame.Surface(size, pygame.SRCALPHA, 32)
    pygame.draw.rect(sheet, PANEL, sheet.get_rect(), border_radius=8)
    pygame.draw.rect(sheet, PANEL_EDGE, sheet.get_rect(), 1, border_radius=8)
    return sheet
