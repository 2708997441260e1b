"""An event-driven reference for `jostle.World`: hard discs in plain Python and float64.

Between two collisions the path of a disc is known exactly, so the program has no time step: it
computes the next collision, moves on to it, and computes the next ones of the discs involved.

- The path of a disc since its last collision is a + b t + g t²/2, with t the time since the start
  of the simulation. It is advanced only when it is read.
- Each disc has one entry in a heap: its earliest collision with a disc or a wall. An entry holds
  the numbers of collisions that its discs had when it was computed; if they differ later, it is
  out of date. If only the partner has collided, the disc is predicted again. The partner's own
  prediction covers the new path of the pair.
- Friction acts at the moment of impact: the tangential impulse makes the surfaces stick, if that
  takes at most the coefficient of friction times the normal impulse. Otherwise it is that large,
  against the sliding. The moment of inertia is m r²/2.
- On a torus a prediction uses minimum images. It holds until a pair has moved half a period
  relative to each other; then the disc is predicted again.

Not covered: discs in resting contact, inelastic collapse, and discs at the same place at the same
time as two others, whose collisions are executed one after the other.

References
----------
D. C. Rapaport, The Event Scheduling Problem in Molecular Dynamic Simulation, Journal of
Computational Physics 34 (1980). B. D. Lubachevsky, How to Simulate Billiards and Similar Systems,
Journal of Computational Physics 94 (1991).
"""

import heapq
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from jostle import Box, Circle

Floats = NDArray[np.float64]
NOTHING = -1  # the partner in an entry whose disc is only predicted again
# Discs that touch do not collide if they approach each other more slowly than this share of their
# relative speed: that is the rounding error of an inelastic collision.
PARALLEL = 1e-12


class Result(NamedTuple):
    """The state at the end."""

    positions: Floats  # (n, 2), inside the torus if there is one
    velocities: Floats  # (n, 2)
    displacements: Floats  # (n, 2): end minus start, not wrapped
    collisions: NDArray[np.int64]  # (n,): collisions of each disc with discs and walls
    angular_velocities: Floats  # (n,)
    angles: Floats  # (n,): by which each disc has turned, not wrapped


def simulate(
    positions: ArrayLike,
    velocities: ArrayLike,
    radii: ArrayLike,
    masses: ArrayLike,
    time: float,
    *,
    restitution: float = 1.0,
    gravity: tuple[float, float] = (0.0, 0.0),
    container: Box | Circle | None = None,
    period: ArrayLike | None = None,
    movable: ArrayLike = True,
    friction: ArrayLike = 0.0,
    angular_velocities: ArrayLike = 0.0,
    max_collisions: int = 10_000_000,
) -> Result:
    """Return the state of discs after `time`; the arguments are those of `jostle.World`.

    Raises
    ------
    ValueError
        If the torus is too small for minimum images, or has gravity and static discs.
    RuntimeError
        If there are more than `max_collisions` collisions.
    """
    bodies = (positions, velocities, radii, masses)
    simulation = _Simulation(*bodies, restitution, gravity, container, period, movable)
    simulation.spin(friction, angular_velocities)
    simulation.run(float(time), max_collisions)
    return simulation.result(float(time))


class _Simulation:
    """Discs, their paths, and the heap of their next collisions."""

    def __init__(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        masses: ArrayLike,
        restitution: float,
        gravity: tuple[float, float],
        container: Box | Circle | None,
        period: ArrayLike | None,
        movable: ArrayLike,
    ) -> None:
        self.start = np.array(positions, float).reshape(-1, 2)
        self.n = n = len(self.start)
        self.radii = np.broadcast_to(np.asarray(radii, float), n)
        self.movable = np.broadcast_to(np.asarray(movable, bool), n)
        masses = np.broadcast_to(np.asarray(masses, float), n)
        self.inverse_masses = np.where(self.movable, 1 / masses, 0.0)
        self.gravity = np.array(gravity, float)
        self.restitution = restitution
        self.container = container
        # Paths, one axis a row; nothing changes those of immovable discs.
        self.a = self.start.T.copy()
        self.b = np.array(velocities, float).reshape(-1, 2).T.copy()
        # Under gravity an immovable disc moves along a parabola relative to the others.
        self.parabolic = self.gravity.any() & ~self.movable
        self.parabolic_rows = np.flatnonzero(self.parabolic)
        self.period: Floats | None = None
        if period is not None:
            self.period = np.asarray(period, float)[:, None]
            self.reach = float(self.period.min()) / 2 - 2 * self.radii.max(initial=0.0)
            if self.reach <= 0:
                raise ValueError("the torus is less than four radii wide")
            if self.parabolic.any():
                raise ValueError("a torus with gravity and static discs is not covered")
        self.collisions = np.zeros(n, int)
        # Entries: time, disc, partner (a disc, n + k for wall k, NOTHING), collisions of both.
        self.heap: list[tuple[float, int, int, int, int]] = []

    def spin(self, friction: ArrayLike, angular_velocities: ArrayLike) -> None:
        """Set the coefficients of friction and the angular velocities."""
        self.friction = np.broadcast_to(np.asarray(friction, float), self.n)
        self.turning = np.broadcast_to(np.asarray(angular_velocities, float), self.n).copy()
        self.angles = np.zeros(self.n)  # as if the present angular velocities began at time 0

    def position(self, i: int, t: float) -> Floats:
        """Return where disc i is at time t, on a torus not wrapped."""
        fall = self.gravity * (t * t / 2) if self.movable[i] else 0.0
        at: Floats = self.a[:, i] + self.b[:, i] * t + fall
        return at

    def velocity(self, i: int, t: float) -> Floats:
        """Return the velocity of disc i at time t."""
        now: Floats = self.b[:, i] + (self.gravity * t if self.movable[i] else 0.0)
        return now

    def deflect(self, i: int, t: float, change: Floats) -> None:
        """Let disc i continue from where it is at time t with a changed velocity."""
        self.a[:, i] -= change * t
        self.b[:, i] += change
        self.collisions[i] += 1

    def predict(self, i: int, t: float, end: float) -> None:
        """Push the earliest collision of disc i from time t on, if it is before `end`."""
        if not self.movable[i]:
            return
        first, partner = math.inf, NOTHING
        w = self.b - self.b[:, i : i + 1]
        d = self.a - self.a[:, i : i + 1] + w * t
        ww = w[0] * w[0] + w[1] * w[1]
        if self.period is not None:
            d -= self.period * np.rint(d / self.period)
            fastest = math.sqrt(ww.max())
            first = t + self.reach / fastest if fastest > 0 else math.inf
        dw = d[0] * w[0] + d[1] * w[1]
        sums = self.radii + self.radii[i]
        gap = d[0] * d[0] + d[1] * d[1] - sums * sums
        square = dw * dw - ww * gap  # where it is negative, the paths do not touch
        rows = np.flatnonzero((dw < 0) & (square > 0))
        rows = rows[dw[rows] ** 2 > PARALLEL**2 * ww[rows] * sums[rows] ** 2]
        if len(rows):
            delays = np.maximum(gap[rows], 0) / (np.sqrt(square[rows]) - dw[rows])
            delays[self.parabolic[rows]] = math.inf
            nearest = int(delays.argmin())
            if t + delays[nearest] < first:
                first, partner = t + float(delays[nearest]), int(rows[nearest])
        for j in self.immovable_within_reach(i, t, min(first, end) - t):
            seen = (self.position(i, t) - self.position(j, t), self.velocity(i, t) - self.b[:, j])
            delay = self.until_distance(*seen, float(sums[j]), inwards=True)
            if t + delay < first:
                first, partner = t + delay, j
        for k, delay in enumerate(self.until_walls(i, t)):
            if t + delay < first:
                first, partner = t + delay, self.n + k
        if first <= end:
            other = int(self.collisions[partner]) if 0 <= partner < self.n else 0
            heapq.heappush(self.heap, (first, i, partner, int(self.collisions[i]), other))

    def until_walls(self, i: int, t: float) -> list[float]:
        """Return after which times disc i meets each wall of the container."""
        if isinstance(self.container, Circle):
            distance = self.container.radius - float(self.radii[i])
            center = np.array(self.container.center)
            seen = (self.position(i, t) - center, self.velocity(i, t))
            return [self.until_distance(*seen, distance, inwards=False)]
        if isinstance(self.container, Box):
            at, v, r = self.position(i, t), self.velocity(i, t), float(self.radii[i])
            walls = zip(*flat_walls(self.container), strict=True)
            return [
                until_zero(
                    sign * (float(at[axis]) - wall) - r,
                    sign * float(v[axis]),
                    sign * float(self.gravity[axis]),
                )
                for axis, sign, wall in walls
            ]
        return []

    def immovable_within_reach(self, i: int, t: float, duration: float) -> list[int]:
        """Return the immovable discs that disc i may meet within a duration, under gravity."""
        rows = self.parabolic_rows
        if len(rows) == 0:
            return []
        u, v = self.b[:, rows] - self.velocity(i, t)[:, None]
        reach = np.hypot(u, v) * duration + math.hypot(*self.gravity) * duration**2 / 2
        x, y = self.a[:, rows] + self.b[:, rows] * t - self.position(i, t)[:, None]
        near = np.hypot(x, y) <= reach + self.radii[rows] + self.radii[i]
        found: list[int] = rows[near].tolist()
        return found

    def until_distance(self, p: Floats, v: Floats, distance: float, *, inwards: bool) -> float:
        """Return when a falling centre crosses the circle around the origin from one side."""
        g = self.gravity
        squared = np.array([g @ g / 4, v @ g, v @ v + p @ g, 2 * (p @ v), p @ p - distance**2])
        return first_fall(squared if inwards else -squared)

    def collide(self, i: int, partner: int, t: float) -> None:
        """Change the velocities of disc i and of its partner, if they approach each other."""
        v, w = self.velocity(i, t), np.zeros(2)
        if partner >= self.n:
            normal, other = self.wall_normal(i, partner - self.n, t), None
            inverse, friction = self.inverse_masses[i], self.friction[i]
        else:
            apart = self.position(i, t) - self.position(partner, t)
            if self.period is not None:
                apart -= self.period[:, 0] * np.rint(apart / self.period[:, 0])
            normal, other, w = apart / math.hypot(*apart), partner, self.velocity(partner, t)
            inverse = self.inverse_masses[i] + self.inverse_masses[partner]
            friction = math.sqrt(self.friction[i] * self.friction[partner])
        tangent = np.array([-normal[1], normal[0]])
        impulse = -(1 + self.restitution) * min(float((v - w) @ normal), 0.0) / inverse
        # Each disc touches the other with the side that faces it.
        turning = self.turning[i] * self.radii[i]
        if other is not None:
            turning += self.turning[other] * self.radii[other]
        sliding = float((v - w) @ tangent) - turning
        most = friction * impulse
        along = min(max(-sliding / (3 * inverse), -most), most)
        total = impulse * normal + along * tangent
        self.deflect(i, t, total * self.inverse_masses[i])
        self.twist(i, t, along)
        if other is not None:
            self.deflect(other, t, -total * self.inverse_masses[other])
            self.twist(other, t, along)

    def twist(self, i: int, t: float, along: float) -> None:
        """Change the angular velocity of disc i by an impulse along its surface."""
        if self.radii[i] > 0:
            change = -2 * along * self.inverse_masses[i] / self.radii[i]
            self.angles[i] -= change * t
            self.turning[i] += change

    def wall_normal(self, i: int, wall: int, t: float) -> Floats:
        """Return the unit vector that points from a wall to disc i."""
        if isinstance(self.container, Box):
            axes, signs, _ = flat_walls(self.container)
            normal = np.zeros(2)
            normal[axes[wall]] = signs[wall]
            return normal
        assert isinstance(self.container, Circle)
        inwards: Floats = np.array(self.container.center) - self.position(i, t)
        return inwards / math.hypot(*inwards)

    def run(self, end: float, max_collisions: int) -> None:
        """Execute all collisions until `end`, in the order of their times."""
        for i in range(self.n):
            self.predict(i, 0.0, end)
        while self.heap:
            t, i, partner, own, other = heapq.heappop(self.heap)
            if own != self.collisions[i]:
                continue
            changed = [i]
            if partner >= self.n or (partner >= 0 and other == self.collisions[partner]):
                self.collide(i, partner, t)
                max_collisions -= 1
                if partner < self.n:
                    changed.append(partner)
            if max_collisions < 0:
                raise RuntimeError(f"too many collisions; the last at time {t}")
            for j in changed:
                self.predict(j, t, end)

    def result(self, t: float) -> Result:
        """Return the state at time t."""
        at = np.array([self.position(i, t) for i in range(self.n)]).reshape(-1, 2)
        velocities = np.array([self.velocity(i, t) for i in range(self.n)]).reshape(-1, 2)
        wrapped = at if self.period is None else at % self.period[:, 0]
        angles = self.angles + self.turning * t
        return Result(wrapped, velocities, at - self.start, self.collisions, self.turning, angles)


def flat_walls(box: Box) -> tuple[list[int], list[int], list[float]]:
    """Return the axis of each wall of a box, the sign of its normal, and where it is."""
    return [0, 0, 1, 1], [1, -1, 1, -1], [box.min_x, box.max_x, box.min_y, box.max_y]


def until_zero(gap: float, speed: float, acceleration: float) -> float:
    """Return when gap + speed t + acceleration t²/2 falls through 0 first, or infinity."""
    square = speed * speed - 2 * acceleration * gap
    if speed < 0:
        if square < 0:
            return math.inf
        return max(0.0, 2 * gap / (math.sqrt(square) - speed))
    if acceleration >= 0:
        return math.inf
    return max(0.0, (speed + math.sqrt(max(square, 0.0))) / -acceleration)


def first_fall(polynomial: Floats) -> float:
    """Return the first t >= 0 at which a polynomial falls through 0, highest power first."""
    slope = np.polyder(polynomial)
    if polynomial[-1] <= 0 and slope[-1] < 0:
        return 0.0
    roots = np.roots(polynomial)
    times = roots.real[np.abs(roots.imag) <= 1e-9 * np.abs(roots)]
    times = times[(times > 0) & (np.polyval(slope, times) < 0)]
    return float(times.min(initial=math.inf))
