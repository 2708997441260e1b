"""Making a simulation from settings, from a saved state, or from one with other rules."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from jostle_lab.simulate.article_simulation import ArticleSimulation, Simulation
from jostle_lab.simulate.containers import bounds, directions, free_positions
from jostle_lab.simulate.settings import Group, Settings, too_slow
from jostle_lab.simulate.simulation import Container, Frame, Rect
from jostle_lab.simulate.world_simulation import WorldSimulation


def start(settings: Settings) -> Simulation:
    """Return the simulation that the settings describe, in its first state.

    A setting that is refused, or a group of particles that does not fit between the walls, raises a
    ValueError.
    """
    simulation: Simulation
    if settings.by_article:
        simulation = ArticleSimulation(settings)
    else:
        simulation = WorldSimulation.of_scene(settings)
        simulation.add_own_walls(settings.walls)
    for number, group in enumerate(settings.particles):
        name = f"particles[{number}]"
        _require_space(name, group, simulation.frame().container)
        try:
            _scatter(simulation, group, np.random.default_rng([settings.seed, number]))
        except ValueError as error:
            raise ValueError(f"{name} cannot be added: {error}") from error
    return simulation


def resume(settings: Settings, state: bytes) -> Simulation:
    """Return the simulation that continues from a state of one with these settings."""
    # The state contains its own particles and walls.
    empty = start(replace(settings, n=0, particles=(), walls=()))
    empty.load(state)
    return empty


def _require_space(name: str, group: Group, container: Container) -> None:
    """Raise a ValueError if a group is too large for the walls, or outside them."""
    walls = bounds(container)
    if walls is None or not group.count:
        return
    x0, y0, x1, y1 = walls
    words = f"the walls, from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g})"
    smallest, largest = group.radius
    if 2 * largest > min(x1 - x0, y1 - y0):
        raise ValueError(f"{name}.radius is {largest:g}; a disc must fit between {words}")
    if group.region is not None:
        left, top, right, bottom = group.region
        if right < x0 or left > x1 or bottom < y0 or top > y1:
            region = ", ".join(f"{side:g}" for side in group.region)
            raise ValueError(f"{name}.region is [{region}]; it must overlap {words}")
    if group.count * math.pi * smallest**2 > (x1 - x0) * (y1 - y0):
        why = f"discs of radius {smallest:g} at least need more area than there is between {words}"
        raise ValueError(f"{name}.count is {group.count}; {why}")


def _scatter(simulation: Simulation, group: Group, rng: np.random.Generator) -> None:
    """Add the particles of a group at free positions, which depend only on the seed."""
    count, frame = group.count, simulation.frame()
    region = group.region or simulation.view
    radii = rng.uniform(*group.radius, count)
    free, found = free_positions(
        frame.positions, frame.radii, radii, frame.container, region,
        int(rng.integers(2**31)), frame.walls,
    )  # fmt: skip
    places = rng.uniform(region[:2], region[2:], (count, 2))
    places[found] = free  # the others overlap, and the first steps separate them
    spread = rng.uniform(*group.speed, count)[:, None] * directions(rng, count)
    densities = rng.uniform(*group.density, count)
    velocities = np.array(group.velocity) + spread
    simulation.add(
        places, velocities, radii, densities, movable=group.movable, sensors=group.sensor,
        categories=group.categories, masks=group.masks,
    )  # fmt: skip


def switch_rules(
    settings: Settings, frame: Frame, view: Rect, before: Frame | None = None
) -> Simulation:
    """Return the simulation of other settings, in the state of a frame if possible.

    If particles were added or removed, the scene begins anew. The article's display is at the
    origin, so positions are shifted by the corner of the view. The article's particles are all
    movable and have no collision filter, so those of a world are those of `before`, its last frame,
    if there is one. Too many particles for the method raise a ValueError.
    """
    if reason := too_slow(settings.method, len(frame)):
        raise ValueError(reason)
    simulation = start(settings)
    own = simulation.frame()
    if np.array_equal(own.tags, frame.tags):
        if before is not None and np.array_equal(before.tags, own.tags):
            own = before
        corner = np.array(simulation.view[:2]) - np.array(view[:2])
        simulation.change(
            frame.tags,
            positions=frame.positions + corner,
            velocities=np.where(own.movable[:, None], frame.velocities, own.velocities),
            movable=own.movable,
            categories=own.categories,
            masks=own.masks,
        )
    return simulation
