"""From settings, or from a saved state, to a simulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jostle.app.simulate.article_simulation import ArticleSimulation
from jostle.app.simulate.chance import directions
from jostle.app.simulate.room import free_places
from jostle.app.simulate.settings import Group, Settings
from jostle.app.simulate.simulation import Simulation
from jostle.app.simulate.world_simulation import WorldSimulation


def start(settings: Settings) -> Simulation:
    """Return the simulation that the settings describe, in its first state."""
    simulation: Simulation
    if settings.by_article:
        simulation = ArticleSimulation(settings)
    else:
        simulation = WorldSimulation.of_scene(settings)
    for number, group in enumerate(settings.particles):
        _scatter(simulation, group, np.random.default_rng([settings.seed, number]))
    return simulation


def resume(settings: Settings, state: bytes) -> Simulation:
    """Return the simulation that goes on from a state of one with these settings."""
    empty = start(replace(settings, n=0, particles=()))  # the state brings its own
    empty.load(state)
    return empty


def _scatter(simulation: Simulation, group: Group, chance: np.random.Generator) -> None:
    """Add the particles of a group where there is room; those of one seed are always the same."""
    count, frame = group.count, simulation.frame()
    region = group.region or simulation.view
    radii = chance.uniform(*group.radius, count)
    free, found = free_places(
        frame.positions, frame.radii, radii, frame.container, region, int(chance.integers(2**31))
    )
    places = chance.uniform(region[:2], region[2:], (count, 2))
    places[found] = free  # the others lie where they may, and the first steps part them
    spread = chance.uniform(*group.speed, count)[:, None] * directions(chance, count)
    densities = chance.uniform(*group.density, count)
    velocities = np.array(group.velocity) + spread
    simulation.add(places, velocities, radii, densities, group.movable)
