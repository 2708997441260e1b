"""What the picture shows beside the particles: the switches behind keys and panels."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class TreeView(Enum):
    """How the tree is shown."""

    OFF = "off"
    OUTLINE = "outline"
    FILLED = "filled by level"
    HEAT = "filled by occupancy"

    def next(self) -> TreeView:
        """Return the view after this one, in a circle."""
        views = list(TreeView)
        return views[(views.index(self) + 1) % len(views)]


class ColourBy(Enum):
    """What the colour of a particle tells."""

    AUTO = "what differs"
    VELOCITY = "velocity"
    MASS = "mass"
    DENSITY = "density"
    AGE = "age"
    ENERGY = "kinetic energy"
    RANDOM = "each its own"

    def next(self) -> ColourBy:
        """Return the colouring after this one, in a circle."""
        ways = list(ColourBy)
        return ways[(ways.index(self) + 1) % len(ways)]


@dataclass
class Shown:
    """The switches; a session has one, and a film another."""

    tree: TreeView = TreeView.OFF
    colour_by: ColourBy = ColourBy.AUTO
    contacts: bool = False
    velocities: bool = False
    trails: bool = False
    labels: bool = False
    panels: bool = True
    statistics: bool = True
    help: bool = False
