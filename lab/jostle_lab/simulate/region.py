"""The region of the particles of a world: a container, a periodic plane or the whole plane."""

from dataclasses import dataclass

import jostle


@dataclass(frozen=True)
class Torus:
    """A periodic plane from the origin: `World.period` as a container."""

    width: float
    height: float


Container = jostle.Box | jostle.Circle | Torus | None
Sides = tuple[float, float, float, float]  # at min x, max x, min y and max y


def container_of(world: jostle.World) -> Container:
    """Return the container of a world, or its period."""
    period = world.period
    return world.container if period is None else Torus(*period.tolist())


def area_of(container: jostle.Box | jostle.Circle | Torus) -> float:
    """Return the area inside a container."""
    if isinstance(container, Torus):
        return container.width * container.height
    return container.area


def set_container(world: jostle.World, container: Container) -> None:
    """Set the container of a world, or its period; if that is refused, nothing changes."""
    if isinstance(container, Torus):
        before, world.container = world.container, None
        try:
            world.period = container.width, container.height
        except ValueError:
            world.container = before
            raise
    else:
        period, world.period = world.period, None
        try:
            world.container = container
        except ValueError:
            world.period = period
            raise


def with_restitution(container: Container, restitution: float | Sides | None) -> Container:
    """Return a container whose sides have a restitution; if None, that of the particle."""
    if isinstance(container, jostle.Box):
        return jostle.Box(*container.bounds.tolist(), restitution=restitution)
    if isinstance(container, jostle.Circle):
        if isinstance(restitution, tuple):
            if len(set(restitution)) > 1:
                values = ", ".join(f"{value:g}" for value in restitution)
                raise ValueError(f"container_restitution is [{values}]; a circle has one side")
            restitution = restitution[0]
        return jostle.Circle(container.center, container.radius, restitution=restitution)
    return container
