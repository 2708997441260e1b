"""The tools of the left mouse button: drag and select, draw a wall, place an attractor."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from jostle.app.act.attractors import STRENGTH, Attractors
from jostle.app.act.commands import Commands
from jostle.app.act.drag_tool import DragTool
from jostle.app.act.picking import inside
from jostle.app.act.selection import Selection
from jostle.app.simulate.containers import diagonal
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.simulation import Point

STRETCH = 0.1  # diagonals of the view: a drag of this length gives the default strength
LEAST, MOST = 0.1, 10.0  # times the default strength


class Tool(Enum):
    """The tool of the left mouse button."""

    POINTER = "pointer"
    WALL = "wall"
    ATTRACTOR = "attractor"


@dataclass
class Drag:
    """A drag of the left button, in world units."""

    tool: Tool
    start: Point
    end: Point
    tag: int | None = None  # the particle under the cursor
    slack: float = 0.0  # a shorter drag is a click
    add: bool = False

    @property
    def is_click(self) -> bool:
        """Whether it is too short for a drag."""
        return math.dist(self.start, self.end) <= self.slack


class Tools:
    """The current tool, and the current drag.

    Attributes
    ----------
    tool
        The current tool.
    """

    def __init__(
        self,
        engine: Engine,
        drag_tool: DragTool,
        selection: Selection,
        commands: Commands,
        attractors: Attractors,
        say: Callable[[str | None], None],
    ) -> None:
        self.tool = Tool.POINTER
        self._engine, self._drag_tool, self._selection = engine, drag_tool, selection
        self._commands, self._attractors, self._say = commands, attractors, say
        self._drag: Drag | None = None
        self._cursor: Point | None = None

    def choose(self, tool: Tool) -> None:
        """Choose a tool; the current drag is cancelled."""
        self.cancel()
        self.tool = tool
        self._say(f"Tool: {tool.value}")

    # A drag

    def press(
        self, point: Point, now: float, tag: int | None, slack: float, *, add: bool = False
    ) -> None:
        """Begin a drag at a point and its particle; `add` extends the selection."""
        self._drag = Drag(self.tool, point, point, tag, slack, add)
        if self.tool is Tool.POINTER:
            frame = self._engine.frame
            free = tag is not None and bool(frame.movable[frame.rows(tag)].all())
            self._drag_tool.grab(tag if free else None, point, now)

    def move(self, point: Point) -> None:
        """Continue the drag to a point."""
        self._cursor = point
        if self._drag is not None:
            self._drag.end = point

    def release(self, point: Point) -> None:
        """End the drag at a point, and apply the tool."""
        drag, self._drag = self._drag, None
        if drag is None:
            return
        drag.end = point
        if drag.tool is Tool.WALL:
            self._wall(drag)
        elif drag.tool is Tool.ATTRACTOR:
            self._place(drag)
        elif drag.is_click:
            self._click(drag)
        elif drag.tag is None:
            box = _box(drag)
            self._selection.take(inside(self._engine.frame, box), add=drag.add)

    def cancel(self) -> bool:
        """Cancel the current drag; return whether there was one."""
        under_way, self._drag = self._drag is not None, None
        self._drag_tool.drop()
        return under_way

    @property
    def preview(self) -> Drag | None:
        """Return the current drag, or that of a click, if it is to be drawn."""
        if self._drag is None:
            if self.tool is Tool.POINTER or self._cursor is None:
                return None
            return Drag(self.tool, self._cursor, self._cursor)
        if self._drag.tool is Tool.POINTER and (self._drag.tag is not None or self._drag.is_click):
            return None  # the particle itself is visible
        return self._drag

    def _click(self, drag: Drag) -> None:
        """Select the particle; on the background, deselect all."""
        if drag.tag is None:
            if not drag.add:
                self._selection.clear()
        elif drag.add:
            self._selection.toggle(drag.tag)
        else:
            self._selection.take([drag.tag])

    def _wall(self, drag: Drag) -> None:
        """Add a wall; a click on one removes it."""
        if drag.is_click:
            self._commands.erase_wall(drag.start, 2 * drag.slack)
        else:
            self._commands.wall(drag.start, drag.end)

    def _place(self, drag: Drag) -> None:
        """Place an attractor; a click on one removes it."""
        there = self._attractors.near(drag.start, 2 * drag.slack) if drag.is_click else None
        if there is not None:
            self._attractors.remove(there)
        else:
            self._attractors.place(drag.start, self._strength(drag))

    def _strength(self, drag: Drag) -> float:
        if drag.is_click:
            return STRENGTH
        default = STRETCH * diagonal(self._engine.view)
        return STRENGTH * min(max(math.dist(drag.start, drag.end) / default, LEAST), MOST)


def _box(drag: Drag) -> tuple[float, float, float, float]:
    (x0, y0), (x1, y1) = drag.start, drag.end
    return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)
