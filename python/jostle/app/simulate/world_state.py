"""The state of a world as bytes, with the additional data of the app."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import jostle
from jostle.app.simulate.attractor_forces import AttractorForces
from jostle.app.simulate.containers import InitialRegion
from jostle.app.simulate.emitters import Emitters
from jostle.app.simulate.packing import blob, pack, unpack
from jostle.app.simulate.particle_table import ParticleTable
from jostle.app.simulate.settings import PARTICLES, SETTINGS, Settings
from jostle.app.simulate.simulation import Rect
from jostle.app.simulate.state_validation import ATTRACTORS, COUNT, bytes_of, particles_of
from jostle.app.simulate.validation import Fields, Rule, fields_of, or_none, read, real, rect, shown
from jostle.app.simulate.wall_segments import WallSegments

EMITTERS = Rule(
    "[cap, emitted, debt], two whole numbers and one from 0 to 1",
    lambda value: (
        isinstance(value, list)
        and len(value) == 3
        and all(
            rule.fits(one) for rule, one in zip((PARTICLES, COUNT, real(0, 1)), value, strict=True)
        )
    ),
)
STATE_FIELDS = Fields(
    {
        "settings": SETTINGS,
        "view": rect(),
        "next_tag": COUNT,
        "own_forces": COUNT,
        "pulls": ATTRACTORS,
        "home": fields_of(InitialRegion),
        "emitters": or_none(EMITTERS),
        "own_walls": COUNT,
    }
)


@dataclass
class WorldState:
    """The data from which a simulation of a world continues."""

    settings: Settings
    view: Rect
    home: InitialRegion
    world: jostle.World
    columns: ParticleTable
    segments: WallSegments
    attractions: AttractorForces
    emitters: Emitters | None

    def save(self) -> bytes:
        """Return it in bytes."""
        facts = {
            "settings": asdict(self.settings),
            "view": self.view,
            "next_tag": self.columns.next_tag,
            "own_forces": self.attractions.own,
            "pulls": [asdict(attractor) for attractor in self.attractions.attractors],
            "home": asdict(self.home),
            "emitters": self.emitters.state if self.emitters else None,
            "own_walls": self.segments.own,
        }
        tags, born = self.columns.tags, self.columns.born
        snapshot = blob(self.world.snapshot())
        return pack("world", facts, {"tags": tags, "born": born, "world": snapshot})

    @classmethod
    def load(cls, state: bytes) -> WorldState:
        """Return it from bytes; raise a ValueError if they are wrong."""
        facts, arrays = unpack("world", state)
        facts = read({"own_walls": 0, **facts}, STATE_FIELDS)  # older files have no walls
        world = jostle.World.restore(bytes_of(arrays, "world"))
        settings, home = facts["settings"], facts["home"]
        if world.method != settings.method:
            raise ValueError(f"settings.method is {settings.method!r}, but not in its world")
        tags, born = particles_of(arrays, len(world), facts["next_tag"])
        own = facts["own_forces"]
        if own > len(world.forces):
            raise ValueError(f"own_forces is {own}; its world has {len(world.forces)} forces")
        count, own_walls = len(world.walls), facts["own_walls"]
        if own_walls > count:
            raise ValueError(f"own_walls is {own_walls}; its world has {count} walls")
        return cls(
            settings=settings,
            view=facts["view"],
            home=home,
            world=world,
            columns=ParticleTable.read(world, tags, born, facts["next_tag"]),
            segments=WallSegments(own_walls),
            attractions=AttractorForces(own, facts["pulls"]),
            emitters=_emitters(facts["emitters"], home, settings),
        )


def _emitters(state: Any, home: InitialRegion, settings: Settings) -> Emitters | None:
    """Return the emitters in a state, for the scene's initial number of particles."""
    if (state is None) != (settings.scene != "emitters"):
        raise ValueError(f"emitters is {shown(state)} in the scene {shown(settings.scene)}")
    if state is None:
        return None
    emitters = Emitters(home.n, settings.seed)
    emitters.cap, emitters.emitted, emitters.debt = state
    return emitters
