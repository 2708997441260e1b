"""Making a simulation from settings: the scene, and the walls and particles of a file."""

import math

import numpy as np

from jostle_lab.schema import Group, Settings
from jostle_lab.simulate.containers import bounds, directions, free_positions
from jostle_lab.simulate.region import Container
from jostle_lab.simulate.simulation import Simulation


def start(settings: Settings) -> Simulation:
    """Return the simulation that the settings describe, in its first state.

    A setting that is refused, or a group of particles that does not fit between the walls, raises a
    ValueError.
    """
    simulation = Simulation.of_scene(settings)
    simulation.add_own_walls(settings.walls)
    for number, group in enumerate(settings.particles):
        name = f"particles[{number}]"
        _require_space(name, group, simulation.frame().container)
        try:
            _scatter(simulation, group, np.random.default_rng([settings.seed, number]))
        except ValueError as error:
            raise ValueError(f"{name} cannot be added: {error}") from error
    return simulation


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
