"""The compared simulations of discs, each made from the same initial state."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from timing import clock

import jostle
from jostle_lab.article import Simulation

__all__ = [
    "FRAME",
    "InitialState",
    "RunningSimulation",
    "article",
    "box2d_world",
    "gas",
    "jostle_world",
    "pile",
    "pymunk_space",
]

FRAME = 1 / 60
"""Simulated seconds per frame."""

SETTLED = 3.0
"""Pixels per second: a pile is at rest below this root mean square speed."""

LONGEST_FALL = 15 * 60
"""Frames after which a pile is used in any state."""

Column = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class InitialState:
    """The initial state: discs in a box, as columns."""

    positions: Column
    velocities: Column
    radii: Column
    masses: Column
    box: tuple[float, float, float, float]
    gravity: tuple[float, float]
    restitution: float
    substeps: int

    def __len__(self) -> int:
        return len(self.positions)


@dataclass(frozen=True)
class RunningSimulation:
    """A simulation; each function of `frames` advances it by one frame and reads all positions."""

    frames: dict[str, Callable[[], object]]
    state: Callable[[], tuple[Column, Column]]
    """Positions and velocities, in the order of the initial state."""
    close: Callable[[], object] = lambda: None
    """Called when the simulation is no longer needed."""


def state_of(world: jostle.World) -> InitialState:
    """Return the present state of a world."""
    box = world.container
    assert isinstance(box, jostle.Box)
    return InitialState(
        world.positions,
        world.velocities,
        world.radii,
        world.masses,
        (box.min_x, box.min_y, box.max_x, box.max_y),
        tuple(world.gravity.tolist()),
        float(world.restitution[0]),  # the same for all
        world.last_step.substeps,
    )


@cache
def gas(count: int) -> InitialState:
    """Return elastic discs that cover 40 % of a box, after one second."""
    world = jostle.scenes.create("gas", n=count)
    world.step(FRAME, 60)
    return state_of(world)


@cache
def pile(count: int, patience: float = math.inf) -> InitialState | None:
    """Return discs of radius 5 to 10 that fell and came to rest.

    None if the first frames of the fall take more than `patience` seconds.
    """
    world = jostle.scenes.create("pile", n=count)
    world.sleeping = False
    slow = 0
    for passed in range(0, LONGEST_FALL, 10):
        slow += clock(lambda: world.step(FRAME, 10)) > 10 * patience
        if slow == 3 and passed < 50:  # another process may cause one
            return None
        if passed >= 60 and speed(world.velocities) < SETTLED:
            break
    return state_of(world)


def speed(velocities: Column) -> float:
    """Return the root mean square of the speeds."""
    return float(np.sqrt(np.mean(np.einsum("ij,ij->i", velocities, velocities))))


def resumed(start: InitialState, threads: int) -> jostle.World:
    """Return a world that continues from an initial state."""
    return jostle.World(
        start.positions,
        start.radii,
        velocities=start.velocities,
        masses=start.masses,
        gravity=start.gravity,
        restitution=start.restitution,
        container=jostle.Box(*start.box),
        substeps=start.substeps,
        threads=threads,
        sleeping=False,
    )


def jostle_world(start: InitialState, threads: int, method: str = "quadtree") -> RunningSimulation:
    """Build jostle's world; all positions are read as one array."""
    world = resumed(start, threads)
    world.method = "brute" if method == "brute" else "quadtree"

    def frame() -> Column:
        world.step(FRAME)
        return world.positions

    return RunningSimulation({"positions": frame}, lambda: (world.positions, world.velocities))


def pymunk_space(
    start: InitialState, threads: int, hashed: bool = False, substeps: int | None = None
) -> RunningSimulation:
    """Build pymunk's world: no rotation, no friction, no sleeping, the same number of sub-steps.

    `hashed` chooses its spatial hash, which is recommended for many objects of one size.
    """
    import pymunk
    import pymunk.batch

    space = pymunk.Space(threaded=threads > 1)
    space.threads = threads
    space.gravity = start.gravity
    if hashed:
        space.use_spatial_hash(2 * float(np.mean(start.radii)), 10 * len(start))
    # It multiplies the elasticities of the two that touch.
    elasticity = math.sqrt(start.restitution)
    bodies = []
    columns = (start.positions, start.velocities, start.radii, start.masses)
    for place, velocity, radius, mass in zip(*(c.tolist() for c in columns), strict=True):
        body = pymunk.Body(mass, math.inf)
        body.position, body.velocity = tuple(place), tuple(velocity)
        disc = pymunk.Circle(body, radius)
        disc.elasticity, disc.friction = elasticity, 0.0
        bodies.append(body)
        space.add(body, disc)
    for wall in walls(start.box):
        segment = pymunk.Segment(space.static_body, *wall, 100.0)
        segment.elasticity, segment.friction = elasticity, 0.0
        space.add(segment)
    pieces = substeps or start.substeps

    def step() -> None:
        for _ in range(pieces):
            space.step(FRAME / pieces)

    buffer = pymunk.batch.Buffer()

    def read(field: pymunk.batch.BodyFields) -> Column:
        buffer.clear()
        pymunk.batch.get_space_bodies(space, field, buffer)
        # The body of the walls comes last.
        return np.frombuffer(buffer.float_buf()).reshape(-1, 2)[: len(start)].copy()

    def frame_by_body() -> Column:
        step()
        return np.array([body.position for body in bodies])

    def frame_by_batch() -> Column:
        step()
        return read(pymunk.batch.BodyFields.POSITION)

    def state() -> tuple[Column, Column]:
        return (
            np.array([body.position for body in bodies]),
            np.array([body.velocity for body in bodies]),
        )

    def close() -> None:
        # Its destructor visits all contacts for each body: minutes for 200,000. So the memory is
        # released at the end of the program.
        from pymunk._chipmunk_cffi import ffi

        shapes = [shape for body in bodies for shape in body.shapes]
        handles = [body._body for body in bodies] + [shape._shape for shape in shapes]
        for handle in (space._space, *handles):
            ffi.gc(handle, None)

    return RunningSimulation({"body by body": frame_by_body, "batch": frame_by_batch}, state, close)


def box2d_world(
    start: InitialState, threads: int, pixels: float = 10.0, substeps: int | None = None
) -> RunningSimulation:
    """Build the world of pyb2d3, which is Box2D v3: no rotation, no friction, no sleeping.

    The margins and tolerances of Box2D are lengths in metres. `pixels` is the number of pixels per
    metre; a frame converts the positions that it reads. Continuous collision, here only with walls,
    is off: the walls are thick.
    """
    import pyb2d3

    # Without a pool it steps on the calling thread.
    pool = pyb2d3.ThreadPool(threads) if threads > 1 else None
    # Slower collisions are inelastic; the default is 1 m/s.
    rules = {"restitution_threshold": 0.0} if start.restitution == 1 else {}
    gravity = (start.gravity[0] / pixels, start.gravity[1] / pixels)
    world = pyb2d3.World(thread_pool=pool, gravity=gravity, **rules)
    world.sleeping_enabled = world.continuous_enabled = False
    # It takes the larger restitution of the two that touch.
    material = pyb2d3.surface_material(friction=0.0, restitution=start.restitution)
    shape = pyb2d3.shape_def(material=material)
    ground = world.create_static_body()
    for ends in walls(start.box):
        capsule = [tuple(part / pixels for part in end) for end in ends]
        ground.create_capsule_shape(shape, pyb2d3.capsule(*capsule, 100.0 / pixels))
    body_def = pyb2d3.dynamic_body_def(fixed_rotation=True)
    bodies = pyb2d3.Bodies()
    columns = (start.positions, start.velocities, start.radii)
    scaled = ((column / pixels).tolist() for column in columns)
    for place, velocity, radius, mass in zip(*scaled, start.masses.tolist(), strict=True):
        body_def.position, body_def.linear_velocity = tuple(place), tuple(velocity)
        body = world.create_body_from_def(body_def)
        shape.density = mass / (math.pi * radius**2)
        body.create_circle_shape(shape, pyb2d3.circle(radius=radius))
        bodies.append(body)
    pieces = substeps or start.substeps

    def frame() -> Column:
        world.step(FRAME, pieces)
        positions: Column = bodies.get_positions()
        positions *= pixels
        return positions

    def state() -> tuple[Column, Column]:
        return bodies.get_positions() * pixels, bodies.get_linear_velocities() * pixels

    return RunningSimulation({"batch": frame}, state)


def walls(
    box: tuple[float, float, float, float],
) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Return the centre lines of four walls, 200 thick, around a box."""
    low_x, low_y, high_x, high_y = box[0] - 100, box[1] - 100, box[2] + 100, box[3] + 100
    corners = [(low_x, low_y), (high_x, low_y), (high_x, high_y), (low_x, high_y)]
    return list(zip(corners, corners[1:] + corners[:1], strict=True))


def article(count: int, method: str) -> Callable[[], object]:
    """Return one frame of the article's program on its own particles, at its own density."""
    scale = max(1.0, math.sqrt(count / 500))
    simulation = Simulation(count, method, width=int(800 * scale), height=int(500 * scale))

    def frame() -> object:
        simulation.frame()
        return [(particle.x, particle.y) for particle in simulation.particles]

    return frame
