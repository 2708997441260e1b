"""The shapes of a scene after some steps, in a world of any size."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle_lab import article

TIME_STEP = 1 / 60
SETTLING = 60  # steps, fewer for many particles
SETTLING_WORK = 1_000_000  # particles times steps


@dataclass(frozen=True)
class Sample:
    """The particles of a scene.

    Attributes
    ----------
    scene
        Its name.
    world_size
        1 is that of the scene; 2 has the same particles in twice the width and height.
    origin
        The world of size 1.
    positions, velocities, radii
        Copies of its columns after settling.
    view
        min_x, min_y, max_x, max_y of a world of size 1.
    """

    scene: str
    world_size: float
    origin: jostle.World
    positions: NDArray[np.float32]
    velocities: NDArray[np.float32]
    radii: NDArray[np.float32]
    view: tuple[float, float, float, float]

    def __len__(self) -> int:
        return len(self.radii)

    @classmethod
    def of(cls, scene: str, n: int, seed: int = 0) -> Sample:
        """Make a scene of `n` particles, and run the settling steps."""
        world = jostle.scenes.create(scene, n=n, seed=seed)
        world.sleeping = False
        world.step(TIME_STEP, min(SETTLING, max(SETTLING_WORK // max(n, 1), 1)))
        view = jostle.scenes.view(scene, n)
        return cls(scene, 1.0, world, world.positions, world.velocities, world.radii, view)

    def resized(self, world_size: float) -> Sample:
        """Return the same particles in a world of another size.

        The radii do not change, so the density does.
        """
        scale = np.float32(world_size / self.world_size)
        return replace(self, world_size=world_size, positions=self.positions * scale)

    @cached_property
    def world(self) -> jostle.World:
        """The world of this size, with the settings of the first and a scaled container."""
        old = self.origin
        if self.world_size == 1.0:
            return old
        nothing = np.empty((0, 2))
        world = jostle.World(
            nothing,
            nothing,
            radii=1.0,
            gravity=old.gravity,
            drag=old.drag,
            restitution=old.restitution,
            container=_resized(old.container, self.world_size),
            substeps=old.substeps,
            sleeping=False,
        )
        columns = old.read(old.ids)._replace(
            positions=self.positions, velocities=self.velocities, radii=self.radii, kinds=None
        )
        world.add(**columns._asdict())
        return world

    def article_program(self) -> article.Simulation:
        """Return the article's program over these particles, in a display as large as the view.

        Radii become whole numbers of at least 1, as in the article.
        """
        min_x, min_y, max_x, max_y = self.view
        places = (self.positions - np.array([min_x, min_y], np.float32)).tolist()
        radii = np.maximum(np.rint(self.radii), 1).astype(int).tolist()
        particles = [
            article.Particle(x, y, radius, density=1)
            for (x, y), radius in zip(places, radii, strict=True)
        ]
        sides = (max(round(side), article.SMALLEST_SIDE) for side in (max_x - min_x, max_y - min_y))
        width, height = sides
        return article.Simulation.of(particles, "quadtree", width, height)


def _resized(
    container: jostle.Box | jostle.Circle | jostle.Torus | None, scale: float
) -> jostle.Box | jostle.Circle | jostle.Torus | None:
    match container:
        case jostle.Box(min_x, min_y, max_x, max_y):
            return jostle.Box(*(scale * side for side in (min_x, min_y, max_x, max_y)))
        case jostle.Circle((x, y), radius):
            return jostle.Circle((scale * x, scale * y), scale * radius)
        case jostle.Torus(width, height):
            return jostle.Torus(scale * width, scale * height)
    return None
