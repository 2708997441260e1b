"""Making a simulation from settings: the scene, and the walls and particles of a file."""

import math
import os

import numpy as np

from jostle_lab.schema import Group, Rect, Settings
from jostle_lab.simulate.containers import bounds, directions, free_positions
from jostle_lab.simulate.region import container_of
from jostle_lab.simulate.simulation import Simulation

# Bytes of memory that a particle needs in the first step and its frame, measured with a million.
BYTES = 350


def start(settings: Settings) -> Simulation:
    """Return the simulation that the settings describe, in its first state.

    A setting that is refused, or a group of particles that does not fit between the walls or into
    its region, raises a ValueError; so do more particles than the memory can have.
    """
    _require_memory(settings)
    simulation = Simulation.of_scene(settings)
    simulation.add_own_walls(settings.walls)
    for number, group in enumerate(settings.particles):
        name = f"particles[{number}]"
        _require_space(name, group, simulation)
        try:
            _scatter(simulation, group, np.random.default_rng([settings.seed, number]))
        except ValueError as error:
            raise ValueError(f"{name} cannot be added: {error}") from error
    return simulation


def _require_memory(settings: Settings) -> None:
    """Raise a ValueError if the particles need more memory than the machine has."""
    count = (settings.n or 0) + sum(group.count for group in settings.particles)
    need, there = count * BYTES, _memory()
    if there is not None and need > there:
        why = f"{need / 1e9:.0f} GB of memory, and there are {there / 1e9:.0f} GB"
        raise ValueError(f"{count:,} particles are too many: they need about {why}")


def _memory() -> int | None:
    """Return the bytes of memory of the machine, or None if it does not say."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return None


def _require_space(name: str, group: Group, simulation: Simulation) -> None:
    """Raise a ValueError if a group is too large for its region and the walls, or outside them."""
    walls, region = bounds(container_of(simulation.world)), group.region
    smallest, largest = group.radius
    if not group.count:
        return
    if walls is not None:
        x0, y0, x1, y1 = walls
        words = f"the walls, from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g})"
        if 2 * largest > min(x1 - x0, y1 - y0):
            raise ValueError(f"{name}.radius is {largest:g}; a disc must fit between {words}")
        if region is not None:
            left, top, right, bottom = region
            if right < x0 or left > x1 or bottom < y0 or top > y1:
                sides = ", ".join(f"{side:g}" for side in region)
                raise ValueError(f"{name}.region is [{sides}]; it must overlap {words}")
    area = group.count * math.pi * smallest**2
    why = f"discs of radius {smallest:g} at least need more area than there is"
    if walls is not None and area > _area(walls):
        raise ValueError(f"{name}.count is {group.count}; {why} between {words}")
    exclusive = simulation.world.on_touch == "bounce" and _excludes_itself(group)
    if region is not None and exclusive and area > _area(region, largest):
        raise ValueError(f"{name}.count is {group.count}; {why} in its region")


def _area(rect: Rect, margin: float = 0.0) -> float:
    """Return the area of a rectangle with a margin on each side."""
    return (rect[2] - rect[0] + 2 * margin) * (rect[3] - rect[1] + 2 * margin)


def _excludes_itself(group: Group) -> bool:
    """Return whether particles of a group push each other apart."""
    one = isinstance(group.categories, int) and isinstance(group.masks, int)
    return one and not group.sensor and bool(group.categories & group.masks)  # type: ignore[operator]


def _scatter(simulation: Simulation, group: Group, rng: np.random.Generator) -> None:
    """Add the particles of a group at free positions, which depend only on the seed."""
    count = group.count
    region = group.region or simulation.view
    radii = rng.uniform(*group.radius, count)
    free, found = free_positions(simulation.world, radii, region, int(rng.integers(2**31)))
    places = rng.uniform(region[:2], region[2:], (count, 2))
    places[found] = free  # the others overlap, and the first steps separate them
    spread = rng.uniform(*group.speed, count)[:, None] * directions(rng, count)
    densities = rng.uniform(*group.density, count)
    velocities = np.array(group.velocity) + spread
    simulation.add(
        places, velocities, radii, densities, movable=group.movable, sensors=group.sensor,
        categories=group.categories, masks=group.masks,
    )  # fmt: skip
