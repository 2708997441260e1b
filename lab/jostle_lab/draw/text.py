"""Names and numbers as text; text as pictures: one font in three sizes, and a cache; cards."""

import importlib.util
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import pygame

from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import PANEL, PANEL_EDGE, TEXT, TEXT_SOFT, Colour

TITLE, BODY, SMALL = 20, 14, 12

# Fonts of imgui_bundle, so text is alike on all machines.
FONT = "assets/fonts/Roboto/Roboto-Regular.ttf"
ICONS = "assets/fonts/Font_Awesome_6_Free-Solid-900.otf"

Place = tuple[int, int]


def pairs_of(n: int) -> int:
    """Return n(n-1)/2, the tests of plain brute force."""
    return n * (n - 1) // 2


def plural(count: int, noun: str) -> str:
    """Return a number of things."""
    return f"{count:,} {noun}" if count == 1 else f"{count:,} {noun}s"


def scientific(value: float) -> str:
    """Return four digits, and a power of ten if the number is large."""
    value += 0.0  # no negative zero
    mantissa, _, power = f"{value:.3e}".partition("e")
    return f"{value:,.1f}" if abs(value) < 1e5 else f"{mantissa} e{int(power)}"


def share(part: int, whole: int) -> str:
    """Return a ratio in per cent, with two significant digits."""
    if whole == 0:
        return "–"
    return f"{100 * part / whole:.2g} %" if part < whole else f"{100 * part / whole:,.0f} %"


@lru_cache(maxsize=2)
def font_file(font: str = FONT) -> str | None:
    """Return the path of a font; None without imgui_bundle, for the default font of pygame."""
    found = importlib.util.find_spec("imgui_bundle")
    return str(Path(found.origin).parent / font) if found and found.origin else None


@lru_cache(maxsize=8)
def font(size: int) -> pygame.font.Font:
    """Return the font at a size in pixels."""
    pygame.font.init()  # videos and tests open no window
    return pygame.font.Font(font_file(), size)


@lru_cache(maxsize=512)
def word(text: str, colour: Colour = TEXT, size: int = BODY) -> pygame.Surface:
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


# Cards below the scene: legends of colours, and notes on what is omitted

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
