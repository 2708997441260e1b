"""The view options: what is drawn beside the particles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from enum import Enum
from typing import TYPE_CHECKING, Any

from jostle_lab.simulate.settings import TRUTH
from jostle_lab.simulate.validation import Rule, one_of

if TYPE_CHECKING:  # Python has it from 3.11 on
    from typing import Self


class _Cycle(Enum):
    """Options that a key cycles through."""

    @property
    def label(self) -> str:
        """Return the name in the user interface."""
        value: str = self.value
        return _LABELS.get(value, value)

    def next(self) -> Self:
        """Return the next option; the first after the last."""
        options = list(type(self))
        return options[(options.index(self) + 1) % len(options)]


_LABELS = {"what differs": "automatic", "each its own": "random", "velocity": "speed"}


class TreeView(_Cycle):
    """How the tree is drawn."""

    OFF = "off"
    OUTLINE = "outline"
    FILLED = "filled by level"
    HEAT = "filled by occupancy"


class ColourBy(_Cycle):
    """The quantity that colours show."""

    AUTO = "what differs"  # values are those of scene files
    VELOCITY = "velocity"
    MASS = "mass"
    DENSITY = "density"
    AGE = "age"
    ENERGY = "kinetic energy"
    RANDOM = "each its own"
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


def option_rules(spell: Callable[[Enum], str]) -> dict[str, Rule]:
    """Return the rule of each view option in a file, in which `spell` writes a choice."""
    return {
        option.name: _choice(type(option.default), spell)
        if isinstance(option.default, Enum)
        else TRUTH
        for option in fields(ViewOptions)
    }


def _choice(kind: type[Enum], spell: Callable[[Enum], str]) -> Rule:
    choices = {spell(choice): choice for choice in kind}
    return replace(one_of(*choices), read=choices.__getitem__)
