"""Pick up and throw: the one part of the app that writes to a simulation's particles."""

from __future__ import annotations

from collections import deque

from jostle.app.simulation import Point, Simulation

MEMORY = 0.1  # seconds of the hand's way that make the speed of a throw


class Hand:
    """A cursor in the world that may hold one particle."""

    def __init__(self) -> None:
        self.held: int | None = None
        self._way: deque[tuple[float, Point]] = deque()

    def grab(self, simulation: Simulation, point: Point, reach: float, now: float) -> None:
        """Pick up the particle under the point, if there is one."""
        self.held = simulation.pick(point, reach)
        self._way.clear()
        self.follow(point, now)

    def follow(self, point: Point, now: float) -> None:
        """Note where the hand is; call it every frame, also when the hand rests."""
        self._way.append((now, point))
        while len(self._way) > 2 and now - self._way[1][0] >= MEMORY:
            self._way.popleft()

    def pull(self, simulation: Simulation) -> None:
        """Before a step: draw the held particle to the hand."""
        if self.held is not None:
            simulation.pull(self.held, self._way[-1][1])

    def release(self, simulation: Simulation) -> None:
        """Let go; the particle keeps the hand's velocity."""
        if self.held is not None:
            simulation.release(self.held, self.velocity())
        self.held = None

    def drop(self) -> None:
        """Forget the particle without touching it: the simulation has started again."""
        self.held = None

    def velocity(self) -> Point:
        """Return the hand's mean velocity over the last moments, world units a second."""
        (begin, first), (end, last) = self._way[0], self._way[-1]
        if end <= begin:
            return 0.0, 0.0
        return (last[0] - first[0]) / (end - begin), (last[1] - first[1]) / (end - begin)
