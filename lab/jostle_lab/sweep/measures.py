"""What is measured in a run: functions of the world after a step, of which the mean is taken."""

from collections.abc import Callable

import numpy as np

import jostle


def _energy(world: jostle.World, dt: float) -> float:
    """Mean kinetic energy of a movable particle."""
    return world.kinetic_energy() / max(int(world.movable.sum()), 1)


def _height(world: jostle.World, dt: float) -> float:
    """Mean of y of the movable particles, weighted by mass."""
    moving = world.movable
    if not moving.any():
        return float("nan")
    return float(np.average(world.positions[moving, 1], weights=world.masses[moving]))


def _hexatic(world: jostle.World, dt: float) -> float:
    """Global hexatic order |⟨exp(6iθ)⟩| over the directions to the six nearest neighbours."""
    positions = world.positions[world.movable].astype(np.float64)
    count = min(7, len(positions))
    if count < 2:
        return float("nan")
    tree = jostle.Quadtree(positions, period=world.period)
    near = tree.nearest(positions, count).ids[:, 1:]
    offsets = positions[near] - positions[:, None]
    if world.period is not None:
        offsets -= world.period * np.round(offsets / world.period)
    x, y = np.moveaxis(offsets, -1, 0)
    return float(np.abs(np.exp(6j * np.arctan2(y, x)).mean()))


def _cluster(world: jostle.World, dt: float) -> float:
    """Share of the movable particles in the largest group of touching ones."""
    positions, radii = world.positions[world.movable], world.radii[world.movable]
    parents = np.arange(len(positions))
    for a, b in jostle.find_pairs(positions, radii * 1.001, period=world.period):
        a, b = _root(parents, a), _root(parents, b)
        parents[max(a, b)] = min(a, b)
    roots = [_root(parents, row) for row in range(len(parents))]
    return float(np.bincount(roots).max() / len(roots)) if roots else float("nan")


def _root(parents: np.ndarray, row: int) -> int:
    while parents[row] != row:
        parents[row] = row = parents[parents[row]]
    return int(row)


def _pressure(world: jostle.World, dt: float) -> float:
    """Impulses on the sides of the container in a step, over their length and the time."""
    touched = world.last_step.wall_contacts
    impulses = touched.normal_impulses[touched.walls < 0].sum(dtype=np.float64)
    return float(impulses / (_perimeter(world.container) * dt))


def _perimeter(container: jostle.Box | jostle.Circle | None) -> float:
    """Length of the sides; NaN without sides."""
    if isinstance(container, jostle.Circle):
        return 2 * np.pi * container.radius
    if container is None:
        return float("nan")
    min_x, min_y, max_x, max_y = container.bounds.tolist()
    return float(2 * (max_x - min_x + max_y - min_y))


def _collisions(world: jostle.World, dt: float) -> float:
    """Collisions of a particle with others in a second."""
    return 2 * world.last_call.collisions / max(len(world), 1) / dt


#: Each measure, and the number of steps from one look to the next: what happens in a step is seen
#: in each of them, the state in every tenth.
MEASURES: dict[str, tuple[Callable[[jostle.World, float], float], int]] = {
    "energy": (_energy, 10),
    "pressure": (_pressure, 1),
    "height": (_height, 10),
    "hexatic": (_hexatic, 10),
    "cluster": (_cluster, 10),
    "collisions": (_collisions, 1),
}
