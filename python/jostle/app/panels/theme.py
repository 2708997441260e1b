"""The colours of the panels, in the formats of ImGui."""

from __future__ import annotations

from functools import lru_cache

from imgui_bundle import imgui

from jostle.app.draw.palette import ACCENT, PANEL, TEXT, TEXT_SOFT, Colour, blend
from jostle.app.gui.style import FIELD, RAISED

__all__ = ["ACCENT", "CHOSEN", "FIELD", "FILLED", "RAISED", "TEXT", "TEXT_SOFT", "rgba", "vec"]

CHOSEN: Colour = blend(PANEL[:3], ACCENT, 0.34)  # of a widget that is on
FILLED: Colour = blend(PANEL[:3], ACCENT, 0.7)  # of the filled part of a slider

# Stages in the order of work, from cool to warm; then drawing.
STAGES: dict[str, Colour] = {
    "bounds": (79, 109, 158),
    "build": (85, 144, 168),
    "pairs": (111, 176, 162),
    "contacts": (167, 197, 140),
    "resting": (198, 205, 130),
    "events": (226, 198, 124),
    "correction": (218, 172, 110),
    "store": (150, 158, 172),
    "forces": (131, 121, 210),
    "frame": (111, 176, 162),
    "draw": (224, 155, 106),
    "panels": (201, 104, 106),
}
KINETIC: Colour = (226, 198, 124)
POTENTIAL: Colour = (85, 144, 168)
TOTAL: Colour = (220, 227, 236)
ACROSS: Colour = (111, 176, 162)
DOWN: Colour = (224, 155, 106)


@lru_cache(maxsize=256)
def rgba(colour: Colour, alpha: float = 1.0) -> int:
    """Return a colour as an integer, for draw lists."""
    red, green, blue = colour
    return round(255 * alpha) << 24 | blue << 16 | green << 8 | red


@lru_cache(maxsize=256)
def vec(colour: Colour, alpha: float = 1.0) -> imgui.ImVec4:
    """Return a colour as a vector, for styles."""
    red, green, blue = (channel / 255 for channel in colour)
    return imgui.ImVec4(red, green, blue, alpha)
