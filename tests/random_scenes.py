"""Search random scenes under gravity for discs that hang in the air or whose motion is not that of
their velocity. Scenes in which discs have too many collisions are counted too.

    make search              a thousand scenes
    make search ARGS=10000   as many as asked
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import jostle

Floats = NDArray[np.float64]

STEPS = 150
# Steps over which the displacement of a disc is compared with the mean of its velocities at the
# beginning and at the end of each. During a step the velocity differs from that mean by at most
# half of all changes, by impulses and gravity: a disc between two others may bounce several times
# in a step.
SPAN = 20
# The difference allowed for each step beside that, in radii: position correction moves without
# velocity.
CORRECTION = 0.05


@dataclass(frozen=True)
class Fault:
    """What was found in a scene, and in which one."""

    seed: int
    kind: str
    step: int
    disc: int
    size: float

    def __str__(self) -> str:
        return (
            f"seed {self.seed}: disc {self.disc} {self.kind} at step {self.step} ({self.size:.3g})"
        )


def grid(rng: np.random.Generator, columns: int, rows: int, spacing: float) -> Floats:
    """Return points on a lattice, moved a little."""
    points = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), -1).reshape(-1, 2)
    return spacing * (points + 0.5 + rng.uniform(-0.01, 0.01, points.shape))


def scene(seed: int) -> tuple[jostle.World, float]:
    """Return a shaft, a funnel or a dense box with random discs, and the step."""
    rng = np.random.default_rng(seed)
    kind = ("shaft", "funnel", "box")[seed % 3]
    ratio = rng.choice([1.0, 1.0, 2.0, 4.0])
    spacing = rng.uniform(2.05, 2.2 if kind == "box" else 3.0) * ratio
    columns = int(rng.integers(1, 6) if kind == "shaft" else rng.integers(5, 11))
    rows = min(int(rng.integers(5, 30)), 100 // columns)
    positions = grid(rng, columns, rows, spacing)
    radii = rng.uniform(1.0, ratio, len(positions))
    width, height = columns * spacing, rows * spacing
    movable = np.ones(len(positions), bool)
    if kind == "funnel":
        # Immovable beads along both slopes, with an opening for a few discs.
        opening = rng.uniform(1.0, 4.0) * ratio
        along = np.arange(0.0, max(width / 2 - opening, 1.0), 0.7)
        slope = rng.uniform(0.5, 1.5)
        left = np.stack([along, slope * (width / 2 - along)], 1)
        beads = np.concatenate([left, [width, 0] + [-1, 1] * left])
        bottom = np.array([0.0, slope * width / 2 + 2 * ratio])
        positions = np.concatenate([positions + bottom, beads])
        height += bottom[1]
        radii = np.concatenate([radii, np.full(len(beads), 0.5)])
        movable = np.arange(len(positions)) < len(movable)
    dt = float(1 / rng.choice([30, 60, 120, 240]))
    substeps = (None, 1, 4)[rng.integers(3)]
    # What gravity adds to a displacement in a sub-step, at most a tenth of the smallest radius.
    fall = 10 ** rng.uniform(-3.5, -1.0)
    world = jostle.World(
        positions,
        radii,
        movable=movable,
        gravity=(0.0, -float(fall / (dt / (substeps or 4)) ** 2)),
        restitution=float(rng.choice([0.0, 0.3, 0.6, 0.9])),
        friction=float(rng.choice([0.0, 0.0, 0.3, 1.0])),
        substeps=substeps,
        container=jostle.Box(-1.0, -1.0, width + 1.0, height + spacing),
    )
    return world, dt


def find_faults(seed: int) -> tuple[list[Fault], bool]:
    """Return the first fault of each kind in a random scene, and whether a disc was unresolved."""
    world, dt = scene(seed)
    movable, radii = world.movable, world.radii
    gravity = np.array(world.gravity)
    pull = float(np.hypot(*gravity))
    # Surfaces that are nearer may support a disc in a step.
    near = 6 * pull * dt * dt
    errors, allowances = [], []
    found: dict[str, Fault] = {}
    is_unresolved = False
    for step in range(STEPS):
        before, old = world.positions.astype(float), world.velocities.astype(float)
        world.step(dt)
        after, new = world.positions.astype(float), world.velocities.astype(float)
        is_unresolved |= world.last_step.unresolved > 0
        changes = impulses(world) / world.masses + pull * dt
        errors.append(after - before - 0.5 * (old + new) * dt)
        allowances.append(0.505 * changes * dt + CORRECTION * radii)
        if len(errors) > SPAN:
            del errors[0], allowances[0]
        excess = np.hypot(*np.sum(errors, axis=0).T) - np.sum(allowances, axis=0)
        floats = is_free(world, before, np.hypot(*old.T).max() * dt + near)
        weightless = np.hypot(*(new - old - gravity * dt).T) / (pull * dt)
        for kind, sizes, limit in (
            ("does not move with its velocity", excess / radii, 0.0),
            ("does not fall", np.where(floats, weightless, 0.0), 0.01),
        ):
            disc = int(np.argmax(np.where(movable, sizes, -np.inf)))
            if sizes[disc] > limit and movable[disc]:
                found.setdefault(kind, Fault(seed, kind, step, disc, float(sizes[disc])))
    return list(found.values()), is_unresolved


def impulses(world: jostle.World) -> Floats:
    """Return the sum of the magnitudes of all impulses on each disc in the last step."""
    sums = np.zeros(len(world))
    contacts, at_walls = world.last_step.contacts, world.last_step.wall_contacts
    for ids, all_of in ((contacts.pairs[:, 0], contacts), (contacts.pairs[:, 1], contacts)):
        np.add.at(sums, ids, all_of.normal_impulses + np.abs(all_of.friction_impulses))
    np.add.at(sums, at_walls.ids, at_walls.normal_impulses + np.abs(at_walls.friction_impulses))
    return sums


def is_free(world: jostle.World, positions: Floats, distance: float) -> NDArray[np.bool_]:
    """Return which discs cannot reach a wall or another disc if both move by `distance`."""
    radii, box = world.radii, world.container
    assert isinstance(box, jostle.Box)
    gaps = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1))
    gaps -= radii + radii[:, None]
    np.fill_diagonal(gaps, np.inf)
    x, y = positions.T
    walls = np.minimum.reduce([x - box.min_x, box.max_x - x, y - box.min_y, box.max_y - y])
    free: NDArray[np.bool_] = np.minimum(gaps.min(axis=1), 2 * (walls - radii)) > 2 * distance
    return free


def main() -> int:
    """Search as many scenes as the command line gives; return 1 if there are faults."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    with ProcessPoolExecutor() as pool:
        results = list(pool.map(find_faults, range(count), chunksize=16))
    with_faults = [faults for faults, _ in results if faults]
    for fault in [fault for faults in with_faults for fault in faults]:
        print(fault)
    unresolved = sum(is_unresolved for _, is_unresolved in results)
    print(f"{count} scenes: {len(with_faults)} with faults, {unresolved} with unresolved discs")
    return bool(with_faults)


if __name__ == "__main__":
    sys.exit(main())
