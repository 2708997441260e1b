"""The forces of a world: between kinds of particles, on walls, and towards attractors."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle import life
from jostle_lab.schema import Polyline
from jostle_lab.simulate.frame import Attractor, Forces, pair_force

# The arguments of a motor, and of a pump.
MOTOR = ("ids", "walls", "pivot", "angular_velocity", "velocity", "cycle")
PUMP = ("drain", "position", "velocity", "rate", "width", "spread", "seed")


def kind_count(world: jostle.World) -> int | None:
    """Return the number of kinds; None if the world has no force between kinds."""
    counts = [f.table.shape[0] for f in world.forces if isinstance(f, jostle.PairForce)]
    return min(counts, default=None)


def set_matrix(world: jostle.World, matrix: str | Sequence[Sequence[float]]) -> None:
    """Set the matrix of particle life, by name or as numbers.

    If the number of kinds changes, the particles get all kinds in turn.
    """
    old = pair_force(world.forces)
    if old is None or life.matrix_of(old) is None:
        raise ValueError("Only particle life has a matrix: choose the scene life.")
    values = np.asarray(life.MATRICES[matrix] if isinstance(matrix, str) else matrix)
    core, strength = life.core_of(old), float(old.table[0, 0, 0])
    new = jostle.PairForce.particle_life(values, old.cutoff, core, strength=strength)
    forces = tuple(new if force == old else force for force in world.forces)
    if len(values) != len(old.table):
        world.forces = ()  # so that no table refuses a kind
        world.kinds = np.arange(len(world)) % len(values)
    world.forces = forces


def shifted(forces: Forces, by: NDArray[np.floating]) -> Forces:
    """Return forces whose motors have shifted pivots, and whose pumps have shifted."""
    return tuple(_shifted(force, by) for force in forces)


def _shifted(force: Any, by: NDArray[np.floating]) -> Any:
    if isinstance(force, jostle.Motor):
        return _with(force, MOTOR, pivot=np.array(force.pivot) + by)
    if isinstance(force, jostle.Pump):
        drain = np.array(force.drain) + np.tile(by, 2)
        return _with(force, PUMP, drain=drain, position=np.array(force.position) + by)
    return force


def _with(force: Any, arguments: tuple[str, ...], **changes: Any) -> Any:
    """Return a force with some other arguments."""
    return type(force)(**{name: getattr(force, name) for name in arguments} | changes)


def force_of(attractor: Attractor) -> jostle.Attractor:
    if attractor.point is None:
        return jostle.Attractor(strength=attractor.strength, particle=attractor.tag)
    return jostle.Attractor(attractor.point, attractor.strength)


def add_walls(world: jostle.World, line: Polyline) -> int:
    """Add the sides of a polyline, with their motor or temperature; return their number."""
    new = jostle.polyline(np.asarray(line.points, np.float32), closed=line.closed)
    ids = world.walls.add(
        new, restitution=line.restitution, friction=line.friction,
        one_way=line.one_way, categories=line.categories, masks=line.masks,
    )  # fmt: skip
    if any(line.velocity) and len(new):
        motor = jostle.Motor(walls=ids, velocity=line.velocity, cycle=line.cycle)
        world.forces = (*world.forces, motor)
    if line.temperature is not None and len(new):
        world.forces = (*world.forces, jostle.ThermalWalls(line.temperature, walls=ids))
    return len(new)
