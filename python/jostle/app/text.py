"""Words on the screen: one font, sizes by name, pictures of words kept between frames."""

from __future__ import annotations

from functools import lru_cache

import pygame

from jostle.app.palette import Colour

TITLE, BODY, SMALL = 19, 14, 12


@lru_cache(maxsize=16)
def font(size: int) -> pygame.font.Font:
    """Return pygame's own font, which every installation has."""
    if not pygame.font.get_init():
        pygame.font.init()
    return pygame.font.Font(None, size)


@lru_cache(maxsize=512)
def word(text: str, colour: Colour, size: int = BODY) -> pygame.Surface:
    """Return the picture of a text."""
    return font(size).render(text, True, colour)


def left(target: pygame.Surface, place: tuple[int, int], text: str, colour: Colour, size: int = BODY) -> int:
    """Write from a top-left corner; return the width."""
    picture = word(text, colour, size)
    target.blit(picture, place)
    return picture.get_width()


def right(target: pygame.Surface, place: tuple[int, int], text: str, colour: Colour, size: int = BODY) -> int:
    """Write up to a top-right corner; return the width."""
    picture = word(text, colour, size)
    target.blit(picture, (place[0] - picture.get_width(), place[1]))
    return picture.get_width()
