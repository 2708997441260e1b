"""Cards in the lower right corner: legends of colours, and notes on what is omitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import pygame

from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import TEXT, TEXT_SOFT, Colour
from jostle.app.draw.text import SMALL, font, panel, wrapped, write

WIDTH = 188
PAD = 10
BAR = 8  # pixels, the height of a ramp
EDGE = 12  # pixels to the edge of the canvas
FOOT = 44  # free pixels below, for the hint


@dataclass(frozen=True)
class Legend:
    """A quantity and its ramp of colours, lowest first."""

    name: str
    low: str
    high: str
    ramp: Sequence[Colour]


Card = Legend | str


def draw_cards(painter: Painter, cards: Sequence[Card], right: float) -> None:
    """Draw legends and sentences, one above the other, the first at the bottom.

    Their right edge is at `right`.
    """
    width, height = painter.size
    if width < 3 * WIDTH:
        return  # too narrow
    y = float(height - FOOT)
    for card in cards:
        sheet = _legend(card, tuple(card.ramp)) if isinstance(card, Legend) else _sentence(card)
        y -= sheet.get_height()
        painter.sheet(sheet, (right - EDGE - sheet.get_width(), y))
        y -= 8


@lru_cache(maxsize=16)
def _legend_sheet(name: str, low: str, high: str, ramp: tuple[Colour, ...]) -> pygame.Surface:
    line = font(SMALL).get_linesize()
    sheet = panel((WIDTH, 2 * PAD + 2 * line + BAR + 8))
    write(sheet, (PAD, PAD), name, TEXT, SMALL)
    y, inner = PAD + line + 4, WIDTH - 2 * PAD
    for k, colour in enumerate(ramp):
        x0, x1 = inner * k // len(ramp), inner * (k + 1) // len(ramp)
        sheet.fill(colour, (PAD + x0, y, x1 - x0, BAR))
    write(sheet, (PAD, y + BAR + 3), low, TEXT_SOFT, SMALL)
    write(sheet, (WIDTH - PAD, y + BAR + 3), high, TEXT_SOFT, SMALL, flush_right=True)
    return sheet


def _legend(card: Legend, ramp: tuple[Colour, ...]) -> pygame.Surface:
    return _legend_sheet(card.name, card.low, card.high, ramp)


@lru_cache(maxsize=16)
def _sentence(text: str) -> pygame.Surface:
    lines, line = wrapped(text, WIDTH - 2 * PAD, SMALL), font(SMALL).get_linesize()
    width = max(font(SMALL).size(words)[0] for words in lines)
    sheet = panel((width + 2 * PAD, len(lines) * line + PAD))
    for k, words in enumerate(lines):
        write(sheet, (PAD, PAD // 2 + k * line), words, TEXT_SOFT, SMALL)
    return sheet
