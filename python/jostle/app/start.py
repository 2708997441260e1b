"""From the command's options to a running simulation."""

from __future__ import annotations

from dataclasses import dataclass

from jostle.app.article_simulation import ArticleSimulation
from jostle.app.simulation import Simulation
from jostle.app.world_simulation import WorldSimulation


@dataclass(frozen=True)
class Options:
    """What to simulate; None leaves a choice to the scene or the library."""

    scene: str
    n: int | None = None
    seed: int = 0
    method: str = "quadtree"
    leaf_capacity: int | None = None
    max_depth: int | None = None


def start(options: Options) -> Simulation:
    """Return the simulation the options describe, at its first state."""
    if options.method.startswith("article-"):
        return ArticleSimulation(options.scene, options.n, seed=options.seed, method=options.method)
    return WorldSimulation.of_scene(
        options.scene,
        options.n,
        seed=options.seed,
        method="brute" if options.method == "brute" else "quadtree",
        leaf_capacity=options.leaf_capacity,
        max_depth=options.max_depth,
    )
