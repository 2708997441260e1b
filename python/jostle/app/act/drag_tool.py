"""Dragging and throwing of one particle with the cursor."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from jostle.app.simulate.simulation import Point, Simulation

THROW_WINDOW = 0.1  # seconds over which the cursor's velocity is averaged for a throw
DRAG_WINDOW = 0.035  # seconds, for a held particle; it overshoots if they are more


@dataclass(frozen=True)
class DragState:
    """The drag as a step uses it; immutable, so threads may share it."""

    tag: int
    point: Point
    velocity: Point

    def drag(self, simulation: Simulation) -> None:
        """Accelerate the held particle towards the cursor; called before a step."""
        simulation.drag(self.tag, self.point, self.velocity)

    def place(self, simulation: Simulation) -> None:
        """Move the held particle to the cursor, while the simulation is paused."""
        simulation.change([self.tag], positions=[self.point])

    def throw(self, simulation: Simulation) -> None:
        """Give the released particle the cursor's velocity, except under the article's rules."""
        if not simulation.settings.by_article:
            simulation.change([self.tag], velocities=[self.velocity])


class DragTool:
    """The cursor's position and velocity, and the tag of the held particle.

    Only the UI thread uses it; the worker thread reads `state`.
    """

    def __init__(self) -> None:
        self.held: int | None = None
        self.state: DragState | None = None  # the present drag; None if no particle is held
        self._path: deque[tuple[float, Point]] = deque([(0.0, (0.0, 0.0))])

    def grab(self, tag: int | None, point: Point, now: float) -> None:
        """Begin to hold a particle, or none."""
        self.held = tag
        self._path.clear()
        self.follow(point, now)

    def follow(self, point: Point, now: float) -> None:
        """Record the cursor's position; call it every frame."""
        self._path.append((now, point))
        while len(self._path) > 2 and now - self._path[1][0] >= THROW_WINDOW:
            self._path.popleft()
        self.state = self._state(DRAG_WINDOW)

    def drop(self) -> None:
        """Release the particle without changing it."""
        self.held = self.state = None

    def release(self) -> DragState | None:
        """Release the particle; return what is thrown, with the velocity of the cursor."""
        thrown = self._state(THROW_WINDOW)
        self.drop()
        return thrown

    def _state(self, span: float) -> DragState | None:
        """Return the drag, with the mean velocity of the cursor over a number of seconds."""
        if self.held is None:
            return None
        return DragState(self.held, self._path[-1][1], self._velocity(span))

    def _velocity(self, span: float) -> Point:
        end, last = self._path[-1]
        begin, first = self._path[0]
        for moment, point in self._path:
            if moment <= end - span:
                begin, first = moment, point
        if end <= begin:
            return 0.0, 0.0
        return (last[0] - first[0]) / (end - begin), (last[1] - first[1]) / (end - begin)
