"""The colours of the app.

A dark background, a muted ramp for discs, and a ramp from periwinkle to plum for the tree. The
lightness of the ramp for discs rises evenly, so that its order is also visible in grey and to
colour-blind people.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Colour = tuple[int, int, int]

GROUND: Colour = (16, 20, 26)
STAGE: Colour = (22, 27, 35)  # inside the container
WALL: Colour = (72, 84, 101)
PANEL: tuple[int, int, int, int] = (12, 15, 20, 228)
PANEL_EDGE: Colour = (42, 50, 62)
TEXT: Colour = (220, 227, 236)
TEXT_SOFT: Colour = (142, 154, 171)
ACCENT: Colour = (126, 178, 184)
RECORDING: Colour = (214, 92, 92)
FIXED: Colour = (104, 113, 126)  # immovable particles
ARROW: Colour = (232, 238, 246)
CHAIN_STOPS = ((58, 70, 88), (190, 120, 70), (255, 210, 110), (255, 250, 235))  # by force
CONTACT_STOPS = ((238, 243, 249), (255, 214, 120), (255, 96, 84))  # by depth
SPRING: Colour = (108, 124, 148)
SENSOR: Colour = (92, 132, 128)
TOUCHED_SENSOR: Colour = (140, 232, 214)
ATTRACTOR: Colour = (198, 160, 220)

SHADES = 24
FIXED_SHADE = SHADES  # one more than the ramp
FIRST_KIND = SHADES + 1  # the shades after that are those of the kinds

_DISC_STOPS = ("#2f679b", "#297ea2", "#43939d", "#74a780", "#b0b368", "#e9c074", "#ffd5a7")
_KINDS = (
    *("#ee5d5d", "#f2b450", "#62cf7a", "#4cc6dc", "#6688f5", "#be74f2"),
    *("#f48fb8", "#dfe4ea"),
)
_LEVEL_STOPS = ("#8f98e6", "#8379d2", "#8763b6", "#8e5296", "#934a78")
_HEAT_STOPS = ("#1b2230", "#2c2f52", "#4d3a6c", "#70406c", "#914c64")


def interpolated(stops: Sequence[Colour], share: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Return colours, (n, 3), between evenly spaced stops: shares from 0 to 1."""
    table, at = np.array(stops, np.float64), np.linspace(0, 1, len(stops))
    columns = [np.interp(share, at, table[:, channel]) for channel in range(3)]
    colours: NDArray[np.uint8] = np.rint(np.column_stack(columns)).astype(np.uint8)
    return colours


def _ramp(stops: tuple[str, ...], count: int) -> list[Colour]:
    rgb = [(int(stop[1:3], 16), int(stop[3:5], 16), int(stop[5:7], 16)) for stop in stops]
    return [(r, g, b) for r, g, b in interpolated(rgb, np.linspace(0, 1, count)).tolist()]


KINDS: list[Colour] = _ramp(_KINDS, len(_KINDS))  # repeated if there are more kinds
DISCS: list[Colour] = [*_ramp(_DISC_STOPS, SHADES), FIXED, *KINDS]
_LEVELS: list[Colour] = _ramp(_LEVEL_STOPS, 25)
HEAT: list[Colour] = _ramp(_HEAT_STOPS, 12)  # of leaves, by occupancy


def level_colour(level: int, depth: int) -> Colour:
    """Return the colour of a level, 0 for the root, in a tree of a depth, which the ramp spans."""
    return _LEVELS[round(24 * level / max(depth, 3, level))]


def blend(back: Colour, front: Colour, share: float) -> Colour:
    """Return `share` of `front` over `back`."""
    mixed = [round(b + (f - b) * share) for b, f in zip(back, front, strict=True)]
    return (mixed[0], mixed[1], mixed[2])
