"""Cool a gas of inelastic discs with several restitutions and seeds, a process for each core.

    python examples/sweep.py

`jostle sweep` does the same for any scene, and continues an interrupted table.
"""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from itertools import product

import numpy as np

import jostle

RESTITUTIONS, SEEDS = (0.8, 0.9, 0.95, 1.0), range(5)
SECONDS = 5


def energy_left(restitution: float, seed: int) -> float:
    """Return the share of the kinetic energy that a gas of 500 discs has after some seconds."""
    world = jostle.scenes.create("gas", n=500, seed=seed)
    world.restitution = restitution
    world.threads = 1  # the other cores have runs of their own
    before = world.kinetic_energy()
    world.step(1 / 60, SECONDS * 60)
    return world.kinetic_energy() / before


if __name__ == "__main__":
    runs = list(product(RESTITUTIONS, SEEDS))
    # A forked process would not have the threads of its parent.
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(mp_context=spawn) as pool:
        left = np.array(list(pool.map(energy_left, *zip(*runs))))
    print(f"restitution  energy left after {SECONDS} s")
    for restitution, shares in zip(RESTITUTIONS, left.reshape(len(RESTITUTIONS), -1)):
        print(f"{restitution:11.2f}  {shares.mean():.4f} ± {shares.std(ddof=1):.4f}")
