"""The two programs of the article of 2015 in plain Python, with all their faults.

`Simulation` runs the article's brute force or its quadtree with the article's own formulas, for
comparison with `jostle.World`; examples/article opens a window on each. Units are pixels and
frames, and y grows downwards. An angle of 0 is up, and positive angles are clockwise.

examples/article/README.md demonstrates each of its eleven faults.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import combinations

Vector = tuple[float, float]  # angle, length
Box = tuple[int, int, int, int]  # x, y, width, height
Leaf = tuple[int, int, int, int, int]  # x, y, width, height, level

WIDTH, HEIGHT = 800, 500  # of the window
FRAME_RATE = 30  # frames per second
GRAVITY: Vector = (math.pi, 0.5)
AIR_MASS = 0.2
ELASTICITY = 0.75
MAX_PER_BOX = 3
MAX_LEVEL = 4  # the whole display is level 0
SMALLEST_SIDE = 32  # of a display; a smaller one would be halved to no pixels


# Particles


@dataclass(slots=True, eq=False)
class Particle:
    """A ball with gravity, air drag and walls; its mass is density × radius².

    >>> ball = Particle(50.9, 40.0, radius=5, density=2)
    >>> ball.mass, ball.rectangle
    (50, (45, 35, 10, 10))
    >>> ball.move()
    >>> ball.y, round(ball.speed, 2)
    (40.5, 0.49)
    """

    x: float
    y: float
    radius: int
    density: int
    speed: float = 0.0  # pixels per frame
    angle: float = 0.0
    mass: int = field(init=False)
    drag: float = field(init=False)  # factor of the speed in each frame
    rectangle: Box = field(init=False)  # as the tree was built with, in whole pixels

    def __post_init__(self) -> None:
        self.mass = self.density * self.radius**2
        self.drag = (self.mass / (self.mass + AIR_MASS)) ** self.radius
        self.update_rectangle()

    def move(self) -> None:
        """Add gravity to the velocity and the velocity to the position, then apply drag."""
        self.angle, self.speed = add_vectors((self.angle, self.speed), GRAVITY)
        self.x += math.sin(self.angle) * self.speed
        self.y -= math.cos(self.angle) * self.speed
        self.speed *= self.drag

    def bounce(self, width: int, height: int) -> None:
        """Reflect off the walls of the display, once along each axis; right and bottom come first.

        The whole velocity loses a quarter, not only its part towards the wall.
        """
        near, right, bottom = self.radius, width - self.radius, height - self.radius
        if self.x > right:
            self._reflect(2 * right - self.x, self.y, -self.angle)
        elif self.x < near:
            self._reflect(2 * near - self.x, self.y, -self.angle)
        if self.y > bottom:
            self._reflect(self.x, 2 * bottom - self.y, math.pi - self.angle)
        elif self.y < near:
            self._reflect(self.x, 2 * near - self.y, math.pi - self.angle)

    def _reflect(self, x: float, y: float, angle: float) -> None:
        self.x, self.y, self.angle = x, y, angle
        self.speed *= ELASTICITY

    def update_rectangle(self) -> None:
        """Compute the rectangle that the tree uses from the position (fault 2: truncated)."""
        side = 2 * self.radius
        self.rectangle = int(self.x - self.radius), int(self.y - self.radius), side, side


def random_particle(rng: random.Random, width: int, height: int) -> Particle:
    """Return a random particle within the display."""
    radius, density = rng.randint(5, 10), rng.randint(1, 20)
    x, y = rng.uniform(radius, width - radius), rng.uniform(radius, height - radius)
    return Particle(x, y, radius, density, rng.random(), rng.uniform(0, 2 * math.pi))


def collide(first: Particle, second: Particle, elasticity: float = ELASTICITY) -> bool:
    """Change the velocities of two particles that overlap; return whether they do.

    They are also moved apart, to a gap of one pixel. Coincident ones are moved apart along x, the
    first to the right. The result depends on the order of the two (faults 1 and 7).

    >>> first, second = Particle(50, 50, 10, 1), Particle(60, 50, 10, 1)
    >>> collide(first, second), first.x, second.x
    (True, 44.5, 65.5)
    """
    dx, dy = first.x - second.x, first.y - second.y
    reach, distance = first.radius + second.radius, math.hypot(dx, dy)
    if distance >= reach:
        return False
    normal, total = _direction(dx, dy), first.mass + second.mass
    kept = (first.mass - second.mass) / total
    first.angle, first.speed = add_vectors(
        (first.angle, kept * first.speed), (normal, 2 * second.mass / total * second.speed)
    )
    # Fault 1: the speed of the first is the new one here.
    second.angle, second.speed = add_vectors(
        (second.angle, -kept * second.speed), (normal, -2 * first.mass / total * first.speed)
    )
    first.speed *= elasticity
    second.speed *= elasticity
    push = (reach - distance + 1) / 2
    first.x += math.sin(normal) * push
    first.y -= math.cos(normal) * push
    second.x -= math.sin(normal) * push
    second.y += math.cos(normal) * push
    return True


def add_vectors(first: Vector, second: Vector) -> Vector:
    """Return the sum of two vectors, each an angle and a length.

    >>> angle, length = add_vectors((0, 3), (math.pi / 2, 4))
    >>> round(math.degrees(angle), 1), length
    (53.1, 5.0)
    """
    (angle1, length1), (angle2, length2) = first, second
    x = length1 * math.sin(angle1) + length2 * math.sin(angle2)
    y = length1 * math.cos(angle1) + length2 * math.cos(angle2)
    return math.pi / 2 - math.atan2(y, x), math.hypot(x, y)


def _direction(dx: float, dy: float) -> float:
    """Return the angle of a vector, clockwise from up; y grows downwards."""
    return math.pi / 2 + math.atan2(dy, dx)


# The two programs


class Simulation:
    """One of the article's two programs, without its window.

    `method` is "brute" or "quadtree", and may be changed between frames. The same seed and display
    give the same particles for both.

    >>> simulation = Simulation(10, "brute", seed=1)
    >>> simulation.frame()
    >>> simulation.tests, simulation.repeats
    (45, 0)
    """

    def __init__(
        self, n: int, method: str = "brute", seed: int = 0, width: int = WIDTH, height: int = HEIGHT
    ) -> None:
        self.method, self.width, self.height = method, width, height
        rng = random.Random(seed)
        self.particles = [random_particle(rng, width, height) for _ in range(n)]
        self._clear_counters()

    @classmethod
    def of(
        cls,
        particles: Iterable[Particle],
        method: str = "brute",
        width: int = WIDTH,
        height: int = HEIGHT,
    ) -> Simulation:
        """Return a simulation of given particles, without copying them."""
        simulation = cls(0, method, 0, width, height)
        simulation.particles = list(particles)
        return simulation

    def frame(self) -> None:
        """Advance by one frame."""
        self._clear_counters()
        if self.method == "brute":
            self._brute_frame()
        else:
            self._quadtree_frame()

    def _clear_counters(self) -> None:
        """Forget the numbers of the last frame."""
        self.tests = self.repeats = self.hits = 0  # tests of pairs, repeated ones, overlaps
        self.leaves: list[Leaf] = []  # of the tree
        self.tested: set[tuple[int, int]] = set()  # the pairs of list indices, with the tree

    def _brute_frame(self) -> None:
        for i, particle in enumerate(self.particles):
            particle.move()
            particle.bounce(self.width, self.height)
            others = self.particles[i + 1 :]
            self.tests += len(others)
            self.hits += sum(collide(particle, other) for other in others)
        for particle in self.particles:
            particle.update_rectangle()  # used only if the method is changed

    def _quadtree_frame(self) -> None:
        # Fault 7: the tree is built over the rectangles of the last frame.
        self._build((0, 0, self.width, self.height), 0, list(range(len(self.particles))))
        self.repeats = self.tests - len(self.tested)
        for particle in self.particles:
            particle.move()
            particle.bounce(self.width, self.height)
            particle.update_rectangle()

    def _build(self, box: Box, level: int, members: list[int]) -> None:
        """Split the box into quarters, or collide all pairs in it."""
        particles = self.particles
        if len(members) > MAX_PER_BOX and level <= MAX_LEVEL:  # fault 4: one level too many
            for quarter in quarters(box):
                inside = [i for i in members if _boxes_overlap(quarter, particles[i].rectangle)]
                self._build(quarter, level + 1, inside)
            return
        pairs = list(combinations(members, 2))
        self.leaves.append((*box, level))
        self.tests += len(pairs)
        self.tested.update(pairs)
        self.hits += sum(collide(particles[i], particles[j]) for i, j in pairs)


def quarters(box: Box) -> list[Box]:
    """Split a box into four of half its sides, truncated to whole pixels (fault 2), row by row.

    >>> quarters((0, 0, 10, 5))
    [(0, 0, 5, 2), (5, 0, 5, 2), (0, 2, 5, 2), (5, 2, 5, 2)]
    """
    x, y, width, height = box[0], box[1], box[2] // 2, box[3] // 2
    return [(x + i * width, y + j * height, width, height) for j in (0, 1) for i in (0, 1)]


def _boxes_overlap(first: Box, second: Box) -> bool:
    x1, y1, width1, height1 = first
    x2, y2, width2, height2 = second
    return x1 < x2 + width2 and x2 < x1 + width1 and y1 < y2 + height2 and y2 < y1 + height1


def overlaps(particles: Iterable[Particle]) -> dict[tuple[int, int], float]:
    """Return the depth of every overlap by list indices, also of those that the tree misses.

    >>> overlaps([Particle(50, 50, 10, 1), Particle(90, 50, 10, 1), Particle(60, 50, 10, 1)])
    {(0, 2): 10.0}
    """
    depths = {}
    for (i, first), (j, second) in combinations(enumerate(particles), 2):
        distance = math.hypot(first.x - second.x, first.y - second.y)
        if distance < first.radius + second.radius:
            depths[i, j] = first.radius + second.radius - distance
    return depths
