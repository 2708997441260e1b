"""Text: one font in three sizes, and a cache of rendered texts."""

from __future__ import annotations

from functools import lru_cache

import pygame

from jostle.app.draw.palette import PANEL, PANEL_EDGE, TEXT, Colour

TITLE, BODY, SMALL = 20, 14, 12

# Regular fonts that are legible when small, best first; pygame's own is bold and the last choice.
FACES = "inter,segoeui,helveticaneue,notosans,dejavusans,liberationsans,arial"

Place = tuple[int, int]


@lru_cache(maxsize=8)
def font(size: int) -> pygame.font.Font:
    """Return the font at a size in pixels."""
    pygame.font.init()  # videos and tests open no window
    return pygame.font.SysFont(FACES, size)


@lru_cache(maxsize=512)
def word(text: str, colour: Colour = TEXT, size: int = BODY) -> pygame.Surface:
    """Return a rendered text."""
    return font(size).render(text, True, colour)


def wrapped(text: str, width: float, size: int = BODY) -> list[str]:
    """Return lines of at most a width in pixels, except for longer words."""
    first, *words = text.split(" ")
    lines = [first]
    for word in words:
        longer = f"{lines[-1]} {word}"
        if font(size).size(longer)[0] <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def write(
    target: pygame.Surface,
    place: Place,
    text: str,
    colour: Colour = TEXT,
    size: int = BODY,
    *,
    flush_right: bool = False,
) -> int:
    """Draw a text at its top-left corner, or its top-right one; return the width."""
    picture = word(text, colour, size)
    x = place[0] - picture.get_width() if flush_right else place[0]
    target.blit(picture, (x, place[1]))
    return picture.get_width()


def panel(size: tuple[int, int]) -> pygame.Surface:
    """Return a translucent surface with a border."""
    sheet = pygame.Surface(size, pygame.SRCALPHA, 32)
    pygame.draw.rect(sheet, PANEL, sheet.get_rect(), border_radius=8)
    pygame.draw.rect(sheet, PANEL_EDGE, sheet.get_rect(), 1, border_radius=8)
    return sheet
