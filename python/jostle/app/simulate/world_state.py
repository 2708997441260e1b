"""The state of a world in bytes, with all that the app knows beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import jostle
from jostle.app.simulate.attractions import Attractions
from jostle.app.simulate.checking import checked, count_of, particles_of, pulls_of, rect_of
from jostle.app.simulate.columns import Columns
from jostle.app.simulate.emitters import Emitters
from jostle.app.simulate.packing import blob, pack, unpack
from jostle.app.simulate.rules import one_of, real
from jostle.app.simulate.settings import CONTAINERS, MOST_PARTICLES, Settings, settings_of
from jostle.app.simulate.simulation import Rect
from jostle.app.simulate.walls import Home


@dataclass
class WorldState:
    """Everything that a simulation of a world goes on from."""

    settings: Settings
    view: Rect
    home: Home
    world: jostle.World
    columns: Columns
    attractions: Attractions
    emitters: Emitters | None

    def save(self) -> bytes:
        """Return it in bytes."""
        facts = {
            "settings": asdict(self.settings),
            "view": self.view,
            "next_tag": self.columns.next_tag,
            "own_forces": self.attractions.own,
            "pulls": [asdict(pull) for pull in self.attractions.pulls],
            "home": asdict(self.home),
            "emitters": self.emitters.state if self.emitters else None,
        }
        tags, born = self.columns.tags, self.columns.born
        snapshot = blob(self.world.snapshot())
        return pack("world", facts, {"tags": tags, "born": born, "world": snapshot})

    @classmethod
    def load(cls, state: bytes) -> WorldState:
        """Return it from bytes; a ValueError says what is wrong with others."""
        facts, arrays = unpack("world", state)
        world = jostle.World.restore(arrays["world"].tobytes())
        settings, home = settings_of(facts["settings"]), _home(facts["home"])
        next_tag = count_of("the number of tags", facts["next_tag"])
        tags, born = particles_of(arrays, len(world), next_tag)
        own = count_of("the number of forces", facts["own_forces"], len(world.forces))
        return cls(
            settings=settings,
            view=rect_of("the view", facts["view"]),
            home=home,
            world=world,
            columns=Columns.read(world, tags, born, next_tag),
            attractions=Attractions(own, pulls_of(facts["pulls"])),
            emitters=_emitters(facts["emitters"], home, settings.seed),
        )


def _home(facts: Mapping[str, Any]) -> Home:
    """Return the walls, the view and the number at the beginning."""
    home = Home.read(facts)
    rect_of("the first view", home.view)
    rect_of("the first walls", home.rect)
    checked("the first container", home.kind, one_of(*CONTAINERS))
    if home.n is not None:
        count_of("the first number", home.n, MOST_PARTICLES)
    return home


def _emitters(state: Any, home: Home, seed: int) -> Emitters | None:
    """Return the nozzles of the number that the scene began with, in their state."""
    if state is None:
        return None
    emitters, (cap, emitted, debt) = Emitters(home.n, seed), state
    emitters.cap = count_of("the cap", cap, MOST_PARTICLES)
    emitters.emitted = count_of("the number of drops", emitted)
    emitters.debt = float(checked("the part of a drop", debt, real(0, 1)))
    return emitters
