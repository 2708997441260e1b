"""The view options: what is drawn beside the particles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from enum import Enum
from typing import TYPE_CHECKING, Any

from jostle_lab.simulate.settings import TRUTH
from jostle_lab.simulate.validation import Rule, one_of

if TYPE_CHECKING:  # Python has it from 3.11 on
    from typing import Self


class _Cycle(Enum):
    """Options that a key cycles through; values are their names in the user interface."""

    def next(self) -> Self:
        """Return the next option; the first after the last."""
        options = list(type(self))
        return options[(options.index(self) + 1) % len(options)]


class TreeView(_Cycle):
    """How the tree is drawn."""

    OFF = "off"
    OUTLINE = "outline"
    FILLED = "filled by level"
    HEAT = "filled by occupancy"


class ColourBy(_Cycle):
    """The quantity that colours show."""

    AUTO = "automatic"
    VELOCITY = "speed"
    MASS = "mass"
    DENSITY = "density"
    AGE = "age"
    ENERGY = "kinetic energy"
    RANDOM = "random"
    KIND = "kind"


@dataclass
class ViewOptions:
    """The switches of a session or of a video."""

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

    def update(self, values: Mapping[str, Any]) -> None:
        """Set options by name."""
        for name, value in values.items():
            setattr(self, name, value)


def spelling(choice: Enum) -> str:
    """Return the name of an option in a file."""
    return choice.name.lower()


def _choice(kind: type[Enum]) -> Rule:
    choices = {spelling(choice): choice for choice in kind}
    return replace(one_of(*choices), read=choices.__getitem__)


# The rule of each view option in a file.
OPTION_RULES: dict[str, Rule] = {
    option.name: _choice(type(option.default)) if isinstance(option.default, Enum) else TRUTH
    for option in fields(ViewOptions)
}
