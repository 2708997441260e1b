"""The view options: what is drawn beside the particles."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import TYPE_CHECKING, Any

from pydantic import Field
from pydantic.dataclasses import dataclass

from jostle_lab.schema import FORBID, Truth

if TYPE_CHECKING:  # Python has it from 3.11 on
    from typing import Self


class _Cycle(Enum):
    """Options that a key cycles through: the value in files, and the label in the window."""

    label: str

    def __new__(cls, value: str, label: str) -> Self:
        option = object.__new__(cls)
        option._value_, option.label = value, label
        return option

    def next(self) -> Self:
        """Return the next option; the first after the last."""
        options = list(type(self))
        return options[(options.index(self) + 1) % len(options)]


class TreeView(_Cycle):
    """How the tree is drawn."""

    OFF = "off", "off"
    OUTLINE = "outline", "outline"
    FILLED = "filled", "filled by level"
    HEAT = "heat", "filled by occupancy"


class ColourBy(_Cycle):
    """The quantity that colours show."""

    AUTO = "auto", "automatic"
    VELOCITY = "velocity", "speed"
    MASS = "mass", "mass"
    DENSITY = "density", "density"
    AGE = "age", "age"
    ENERGY = "energy", "kinetic energy"
    RANDOM = "random", "random"
    KIND = "kind", "kind"


@dataclass(config=FORBID)
class ViewOptions:
    """The switches of a session or of a video."""

    tree: TreeView = Field(default=TreeView.OFF, description="how the quadtree is drawn")
    colour_by: ColourBy = Field(default=ColourBy.AUTO, description="the quantity that colours show")
    contacts: Truth = Field(default=False, description="contacts and their impulses")
    forces: Truth = Field(default=False, description="forces between particles")
    velocities: Truth = Field(default=False, description="velocities, as arrows")
    trails: Truth = Field(default=False, description="where the particles were a moment ago")
    labels: Truth = Field(default=False, description="number and speed of each particle")
    panels: Truth = Field(default=True, description="the panels of the window")
    statistics: Truth = Field(default=True, description="the statistics at the right")
    help: Truth = Field(default=False, description="the list of keys and mouse actions")

    def update(self, values: Mapping[str, Any]) -> None:
        """Set options by name."""
        for name, value in values.items():
            setattr(self, name, value)
