"""Collisions in the order of time against rounds over the contacts, in one run.

    python benchmarks/collisions.py [--rounds 5]

A world of elastic discs takes the order of time. With a coefficient of restitution just below 1 the
same world takes rounds, so that both can be measured side by side: one thread, one sub-step,
interleaved, medians. The second table is the energy of a gas in a harmonic trap after 30 seconds.
docs/physics.md shows both tables.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np

import jostle
from jostle.bench.machine import describe

NEARLY_ELASTIC = float(np.nextafter(np.float32(1), np.float32(0)))
STEP = 1 / 60
SCENES = {
    "gas": (5_000, 10_000, 100_000),
    "clusters": (5_000,),
    "mixed": (5_000,),
    "thermostat": (5_000,),
    "billiards": (2_000,),
    "orbit": (2_000,),
    "shots": (2_000,),
    "brownian": (2_000,),
}
STEPS_OF = 400_000  # particle steps of one timing


def create(scene: str, count: int, restitution: float) -> jostle.World:
    """Return the scene on one thread, after twenty steps in the order of time."""
    world = jostle.scenes.create(scene, count)
    world.threads, world.substeps = 1, 1
    world.restitution = 1.0
    world.step(STEP, steps=20)
    world.restitution = restitution
    return world


def measure(scene: str, count: int, rounds: int) -> str:
    """Return a row of the first table: nanoseconds a particle and step."""
    worlds = [create(scene, count, restitution) for restitution in (NEARLY_ELASTIC, 1.0)]
    steps = max(3, STEPS_OF // count)
    times: list[list[float]] = [[], []]
    for _ in range(rounds):
        for world, found in zip(worlds, times, strict=True):
            begin = time.perf_counter()
            world.step(STEP, steps=steps)
            found.append((time.perf_counter() - begin) / steps / len(world) * 1e9)
    old, new = (statistics.median(found) for found in times)
    return f"| {scene}, {count:,} | {old:,.0f} | {new:,.0f} | {new / old:.2f} |"


def energy_in_a_trap(substeps: int, restitution: float) -> float:
    """Return the energy of 300 discs after 30 seconds, as a share of that at the beginning."""
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(np.arange(18), np.arange(18)), -1).reshape(-1, 2)[:300]
    trap = jostle.Attractor((0, 0), strength=0.5)
    world = jostle.World(
        3.0 * grid - 25,
        10 * rng.normal(size=(300, 2)),
        1.0,
        forces=[trap],
        substeps=substeps,
        restitution=restitution,
    )

    def energy() -> float:
        speeds, distances = (np.asarray(v, float) for v in (world.velocities, world.positions))
        return float((0.5 * speeds**2 + 0.25 * distances**2).sum())

    before = energy()
    world.step(STEP, steps=1800)
    return energy() / before


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, help="how often each is timed")
    options = parser.parse_args()
    print(describe())
    print("| scene | ns a particle, rounds | ns a particle, order of time | ratio |")
    print("|---|---:|---:|---:|")
    for scene, counts in SCENES.items():
        for count in counts:
            print(measure(scene, count, options.rounds), flush=True)
    print("\n| energy in a trap | rounds | order of time |\n|---|---:|---:|")
    for substeps in (1, 4):
        both = (energy_in_a_trap(substeps, e) for e in (NEARLY_ELASTIC, 1.0))
        print(f"| {substeps} sub-steps | {' | '.join(f'{energy:.4f}' for energy in both)} |")


if __name__ == "__main__":
    main()
