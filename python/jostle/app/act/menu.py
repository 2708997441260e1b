"""A context menu: its place, and what it is about."""

from __future__ import annotations

import math
from dataclasses import dataclass

from jostle.app.simulate.simulation import Frame, Point, Tags


@dataclass
class Menu:
    """A menu of a particle, or of the background."""

    point: Point
    tag: int | None
    tags: Tags | None = None  # the particle, or the selection that contains it
    shown: bool = False  # whether it has been drawn

    def title(self, frame: Frame) -> str:
        """Return the title."""
        if self.tag is None or self.tags is None:
            x, y = self.point
            return f"at {x:,.0f}, {y:,.0f}"
        n = len(frame.rows(self.tags))
        return f"particle {self.tag}" if n <= 1 else f"particle {self.tag} of {n:,} selected"

    def numbers(self, frame: Frame) -> list[tuple[str, str]]:
        """Return the present numbers of its particle."""
        if self.tag is None or self.is_over(frame):
            return []
        row = frame.rows(self.tag)[0]
        (x, y), velocity = frame.positions[row].tolist(), frame.velocities[row].tolist()
        return [
            ("speed", f"{math.hypot(*velocity):,.1f}"),
            ("position", f"{x:,.1f}, {y:,.1f}"),
            ("mass", f"{frame.densities[row] * frame.radii[row] ** 2:,.4g}"),
            ("radius", f"{frame.radii[row]:,.4g}"),
        ]

    def is_over(self, frame: Frame) -> bool:
        """Return whether its particle no longer exists."""
        return self.tag is not None and len(frame.rows(self.tag)) == 0
