"""The state of a world as bytes, with the additional data of the app."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

import jostle
from jostle.app.simulate.containers import InitialRegion
from jostle.app.simulate.emitters import Emitters
from jostle.app.simulate.forces import AttractorForces
from jostle.app.simulate.packing import (
    ATTRACTORS,
    COUNT,
    blob,
    bytes_of,
    pack,
    particles_of,
    unpack,
)
from jostle.app.simulate.particle_table import ParticleTable
from jostle.app.simulate.settings import PARTICLES, SETTINGS, Settings
from jostle.app.simulate.simulation import Attractor, Rect, Tags
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
        for name, there in (("own_forces", len(world.forces)), ("own_walls", len(world.walls))):
            if facts[name] > there:
                what = name.removeprefix("own_")
                raise ValueError(f"{name} is {facts[name]}; its world has {there} {what}")
        tags, born = particles_of(arrays, len(world), facts["next_tag"])
        columns = ParticleTable(world, born, facts["next_tag"])
        attractors = _renamed(facts["pulls"], tags, columns.tags)
        return cls(
            settings=settings,
            view=facts["view"],
            home=home,
            world=world,
            columns=columns,
            segments=WallSegments(world, facts["own_walls"]),
            attractions=AttractorForces(world, columns, facts["own_forces"], attractors),
            emitters=_emitters(facts["emitters"], home, settings),
        )


def _renamed(attractors: tuple[Attractor, ...], old: Tags, new: Tags) -> tuple[Attractor, ...]:
    """Return attractors with the new tags of their particles: in older files tags are not ids."""
    if np.array_equal(old, new):
        return attractors
    names = dict(zip(old.tolist(), new.tolist(), strict=True))
    return tuple(
        attractor
        if attractor.tag is None
        else replace(attractor, tag=names.get(attractor.tag, attractor.tag))
        for attractor in attractors
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
