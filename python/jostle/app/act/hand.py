"""Dragging and throwing of one particle with the cursor."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from jostle.app.simulate.simulation import Point, Simulation

MEMORY = 0.1  # seconds of the hand's way that make the speed of a throw
LATELY = 0.035  # seconds that make the speed which a held particle takes up, or it overshoots


@dataclass(frozen=True)
class Grip:
    """What a step feels of a hand that holds something; it never changes, so threads share it."""

    tag: int
    point: Point
    velocity: Point

    def drag(self, simulation: Simulation) -> None:
        """Before a step: draw the held particle to the hand."""
        simulation.drag(self.tag, self.point, self.velocity)

    def carry(self, simulation: Simulation) -> None:
        """In a pause: put the held particle where the hand is."""
        simulation.change([self.tag], positions=[self.point])

    def throw(self, simulation: Simulation) -> None:
        """Let go; the particle takes the hand's velocity, or by the article keeps its own."""
        if not simulation.settings.by_article:
            simulation.change([self.tag], velocities=[self.velocity])


class Hand:
    """Where the hand is, how fast it moves, and the tag of what it holds.

    Only the window uses it; the thread that steps sees `grip`.

    Attributes
    ----------
    grip
        What holds at the moment; None while the hand is empty.
    """

    def __init__(self) -> None:
        self.held: int | None = None
        self.grip: Grip | None = None
        self._way: deque[tuple[float, Point]] = deque([(0.0, (0.0, 0.0))])

    def grab(self, tag: int | None, point: Point, now: float) -> None:
        """Close on a particle, or on nothing."""
        self.held = tag
        self._way.clear()
        self.follow(point, now)

    def follow(self, point: Point, now: float) -> None:
        """Note where the hand is; call it every frame, also when the hand rests."""
        self._way.append((now, point))
        while len(self._way) > 2 and now - self._way[1][0] >= MEMORY:
            self._way.popleft()
        self.grip = self._grip(LATELY)

    def drop(self) -> None:
        """Forget the particle without touching it."""
        self.held = self.grip = None

    def release(self) -> Grip | None:
        """Let go; return what shall be thrown, with the speed of the hand."""
        thrown = self._grip(MEMORY)
        self.drop()
        return thrown

    def _grip(self, span: float) -> Grip | None:
        return None if self.held is None else Grip(self.held, self.point, self._velocity(span))

    @property
    def point(self) -> Point:
        """Return where the hand is."""
        return self._way[-1][1]

    @property
    def velocity(self) -> Point:
        """Return the hand's mean velocity over the last moments, world units a second."""
        return self._velocity(MEMORY)

    def _velocity(self, span: float) -> Point:
        """Return the mean velocity over about so many seconds."""
        end, last = self._way[-1]
        begin, first = self._way[0]
        for moment, point in self._way:
            if moment <= end - span:
                begin, first = moment, point
        if end <= begin:
            return 0.0, 0.0
        return (last[0] - first[0]) / (end - begin), (last[1] - first[1]) / (end - begin)
