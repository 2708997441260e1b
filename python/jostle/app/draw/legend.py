"""Cards below the scene: legends of colours, and notes on what is omitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import pygame

from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import TEXT, TEXT_SOFT, Colour
from jostle.app.draw.text import SMALL, panel, word

HEIGHT = 24  # pixels
PAD, GAP = 10, 8  # inside a card, and between its parts; between two cards
RAMP = 120, 8  # pixels, the size of a ramp
EDGE = 10  # pixels to the lower edge of the canvas
HINT = 64  # pixels at the right that are left free, for the hint of the window
NARROW = 180  # pixels; in less there are no cards


@dataclass(frozen=True)
class Legend:
    """A quantity and its ramp of colours, lowest first."""

    name: str
    low: str
    high: str
    ramp: tuple[Colour, ...]


Card = Legend | str


def draw_cards(painter: Painter, cards: Sequence[Card], left: float, right: float) -> None:
    """Draw legends and sentences in rows from left to right, the first row at the bottom."""
    x, y = left, painter.size[1] - EDGE - HEIGHT
    right -= HINT
    for card in cards if right - left >= NARROW else ():
        sheet = _sheet(card)
        if x > left and x + sheet.get_width() > right:
            x, y = left, y - HEIGHT - GAP
        painter.sheet(sheet, (x, y))
        x += sheet.get_width() + GAP


@lru_cache(maxsize=16)
def _sheet(card: Card) -> pygame.Surface:
    parts = [word(card, TEXT_SOFT, SMALL)] if isinstance(card, str) else _parts(card)
    width = 2 * PAD + sum(part.get_width() for part in parts) + GAP * (len(parts) - 1)
    sheet, x = panel((width, HEIGHT)), PAD
    for part in parts:
        sheet.blit(part, (x, (HEIGHT - part.get_height()) // 2))
        x += part.get_width() + GAP
    return sheet


def _parts(card: Legend) -> list[pygame.Surface]:
    ramp, (width, height) = pygame.Surface(RAMP), RAMP
    for k, colour in enumerate(card.ramp):
        x0, x1 = width * k // len(card.ramp), width * (k + 1) // len(card.ramp)
        ramp.fill(colour, (x0, 0, x1 - x0, height))
    low, high = word(card.low, TEXT_SOFT, SMALL), word(card.high, TEXT_SOFT, SMALL)
    return [word(card.name, TEXT, SMALL), low, ramp, high]
