"""What the picture shows beside the particles: the switches behind keys and panels."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # Python has it from 3.11 on
    from typing import Self


class _InTurn(Enum):
    """Ways that a key goes through, one after the other."""

    def next(self) -> Self:
        """Return the way after this one, in a circle."""
        ways = list(type(self))
        return ways[(ways.index(self) + 1) % len(ways)]


class TreeView(_InTurn):
    """How the tree is shown."""

    OFF = "off"
    OUTLINE = "outline"
    FILLED = "filled by level"
    HEAT = "filled by occupancy"


class ColourBy(_InTurn):
    """What the colour of a particle tells."""

    AUTO = "what differs"
    VELOCITY = "velocity"
    MASS = "mass"
    DENSITY = "density"
    AGE = "age"
    ENERGY = "kinetic energy"
    RANDOM = "each its own"


@dataclass
class Shown:
    """The switches; a session has one, and a film another."""

    tree: TreeView = TreeView.OFF
    colour_by: ColourBy = ColourBy.AUTO
    contacts: bool = False
    forces: bool = False
    velocities: bool = False
    trails: bool = False
    labels: bool = False
    panels: bool = True
    statistics: bool = True
    help: bool = False
