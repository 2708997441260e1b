"""All mouse actions in the scene: tools of the left button, context menu; the shown message."""

import math
from collections import deque
from dataclasses import dataclass
from enum import Enum

from jostle_lab.act.attractors import STRENGTH, Attractors, Gravity
from jostle_lab.act.commands import Brush, Commands
from jostle_lab.act.selection import Selection, inside, pick
from jostle_lab.draw.camera import Camera
from jostle_lab.simulate.containers import diagonal
from jostle_lab.simulate.engine import Engine
from jostle_lab.simulate.frame import Point, Rect, Tags
from jostle_lab.simulate.simulation import Held, Inputs

DURATION = 3.0  # seconds that a message is shown


class Messages:
    """Shows one message at a time."""

    def __init__(self) -> None:
        self.now = 0.0  # seconds since the session began
        self._message = "", 0.0  # and when it ends; replaced by threads, never changed

    def say(self, message: str | None, duration: float = DURATION) -> None:
        if message:
            self._message = message, self.now + duration

    @property
    def current(self) -> str:
        """Return the message to show now, or an empty string."""
        message, end = self._message
        return message if self.now < end else ""


THROW_WINDOW = 0.1  # seconds over which the cursor's velocity is averaged for a throw
DRAG_WINDOW = 0.035  # seconds, for a held particle; it overshoots if they are more


class DragTool:
    """The cursor's position and velocity, and the tag of the held particle.

    `state` is immutable, because the worker thread reads it.
    """

    def __init__(self) -> None:
        self.held: int | None = None
        self._drags = 0
        self.state: Held | None = None  # the present drag; None if no particle is held
        self._path: deque[tuple[float, Point]] = deque([(0.0, (0.0, 0.0))])

    def grab(self, tag: int | None, point: Point, now: float) -> None:
        """Begin to hold a particle, or none."""
        self.held, self._drags = tag, self._drags + 1
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

    def release(self) -> Held | None:
        """Release the particle; return what is thrown, with the velocity of the cursor."""
        thrown = self._state(THROW_WINDOW)
        self.drop()
        return thrown

    def _state(self, span: float) -> Held | None:
        """Return the drag, with the mean velocity of the cursor over a number of seconds."""
        if self.held is None:
            return None
        return Held(self.held, self._path[-1][1], self._velocity(span), self._drags)

    def _velocity(self, span: float) -> Point:
        end, last = self._path[-1]
        begin, first = self._path[0]
        for moment, point in self._path:
            if moment <= end - span:
                begin, first = moment, point
        if end <= begin:
            return 0.0, 0.0
        return (last[0] - first[0]) / (end - begin), (last[1] - first[1]) / (end - begin)


CLICK = 4.0  # pixels; a shorter drag is a click
REACH = 4.0  # pixels around the cursor within which a particle is picked
STRETCH = 0.1  # diagonals of the view: a drag of this length gives the default strength
LEAST, MOST = 0.1, 10.0  # times the default strength of an attractor


class Tool(Enum):
    """The tool of the left mouse button."""

    POINTER = "pointer"
    WALL = "wall"
    ATTRACTOR = "attractor"
    BRUSH = "brush"


@dataclass
class Drag:
    """A drag of the left button, in world units."""

    tool: Tool
    start: Point
    end: Point
    tag: int | None = None  # the particle under the cursor
    slack: float = 0.0  # a shorter drag is a click
    add: bool = False  # to the selection
    reach: float = 0.0  # the radius of the brush
    kind: int | None = None  # the kind that the brush adds

    @property
    def length(self) -> float:
        return math.dist(self.start, self.end)

    @property
    def is_click(self) -> bool:
        """Whether it is too short for a drag."""
        return self.length <= self.slack

    @property
    def box(self) -> Rect:
        (x0, y0), (x1, y1) = self.start, self.end
        return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)


@dataclass
class Menu:
    """The open context menu: of a particle, or of the background."""

    point: Point
    tag: int | None
    tags: Tags  # the particle, or the selection that contains it
    shown: bool = False  # whether it has been drawn


class Interaction:
    """The cursor, and the tools and commands that act at it."""

    def __init__(self, engine: Engine, camera: Camera, messages: Messages) -> None:
        self._engine, self._camera, self._messages = engine, camera, messages
        self.cursor: Point = (camera.size[0] / 2, camera.size[1] / 2)  # in pixels
        self.tool = Tool.POINTER
        self.drag_tool = DragTool()
        self.selection = Selection()
        self.attractors = Attractors(engine)
        self.commands = Commands(engine)
        self.brush = Brush(engine, self.commands)
        self.gravity = Gravity(engine)
        self.menu: Menu | None = None
        self.thrown_at: float | None = None  # when the first particle was released
        self._drag: Drag | None = None
        self._moved = False  # whether the mouse has moved over the scene

    # Cursor

    def at_cursor(self) -> Point:
        return self._camera.to_world(self.cursor)

    def under_cursor(self) -> int | None:
        """Return the tag of the particle under the cursor."""
        return pick(self._engine.frame, self.at_cursor(), REACH / self._camera.scale)

    def targets(self) -> Tags:
        """Return the selection, or else the particle under the cursor."""
        selection = self.selection
        return selection.tags if len(selection) else selection.around(self.under_cursor())

    # Left button

    def choose(self, tool: Tool) -> None:
        """Choose a tool; the current drag is cancelled."""
        self.cancel()
        self.tool = tool
        self._messages.say(f"Tool: {tool.value}")

    def press(self, *, add: bool = False) -> None:
        """Begin to use the tool at the cursor; `add` extends the selection."""
        point, tag = self.at_cursor(), self.under_cursor()
        self._drag = Drag(self.tool, point, point, tag, CLICK / self._camera.scale, add)
        if self.tool is Tool.POINTER:
            frame = self._engine.frame
            free = tag is not None and bool(frame.movable[frame.rows(tag)].all())
            self.drag_tool.grab(tag if free else None, point, self._messages.now)
        elif self.tool is Tool.BRUSH:
            self.brush.begin(point)

    def drag_on(self) -> None:
        """Continue with the tool to the cursor."""
        self._moved = True
        if self._drag is not None:
            self._drag.end = self.at_cursor()
            if self._drag.tool is Tool.BRUSH:
                self.brush.stroke(self._drag.end)

    def release(self, *, throw: bool = True) -> None:
        """End the use of the tool; `throw` gives a held particle the velocity of the cursor."""
        self.track_cursor()
        self.drag_on()
        drag, self._drag = self._drag, None
        if drag is not None:
            self._apply(drag)
        thrown = self.drag_tool.release()
        if thrown is not None and self.thrown_at is None:
            self.thrown_at = self._messages.now
        if thrown is not None and throw:
            tags, velocities = [thrown.tag], [thrown.velocity]
            self._engine.edit(
                lambda simulation: simulation.change(tags, velocities=velocities),
                f"drag {thrown.drag}",
            )

    def cancel(self) -> bool:
        """Cancel the current drag; return whether there was one."""
        under_way, self._drag = self._drag is not None, None
        self.drag_tool.drop()
        return under_way

    @property
    def preview(self) -> Drag | None:
        """Return the current drag, or that of a click, if it is to be drawn."""
        point = self.at_cursor()
        if self.tool is Tool.BRUSH:
            kind = self.commands.new_kind
            return Drag(self.tool, point, point, reach=self.brush.radius, kind=kind)
        if self._drag is None:
            shown = self._moved and self.tool is not Tool.POINTER
            return Drag(self.tool, point, point) if shown else None
        if self._drag.tool is Tool.POINTER and (self._drag.tag is not None or self._drag.is_click):
            return None  # the particle itself is visible
        return self._drag

    def _apply(self, drag: Drag) -> None:
        if drag.tool is Tool.POINTER:
            self._select(drag)
        elif drag.tool is Tool.WALL:
            self._wall(drag)
        elif drag.tool is Tool.ATTRACTOR:
            self._place(drag)

    def _select(self, drag: Drag) -> None:
        """Select the clicked particle, or those in a box; a click on the background deselects."""
        selection = self.selection
        if not drag.is_click:
            if drag.tag is None:
                selection.take(inside(self._engine.frame, drag.box), add=drag.add)
        elif drag.tag is None:
            if not drag.add:
                selection.clear()
        elif drag.add:
            selection.toggle(drag.tag)
        else:
            selection.take([drag.tag])

    def _wall(self, drag: Drag) -> None:
        """Add a wall; a click on one removes it."""
        if drag.is_click:
            self.commands.erase_wall(drag.start, 2 * drag.slack)
        else:
            self.commands.wall(drag.start, drag.end)

    def _place(self, drag: Drag) -> None:
        """Place an attractor, as strong as the drag is long; a click on one removes it."""
        if not drag.is_click:
            share = drag.length / (STRETCH * diagonal(self._engine.view))
            self.attractors.place(drag.start, STRENGTH * min(max(share, LEAST), MOST))
        elif (there := self.attractors.near(drag.start, 2 * drag.slack)) is not None:
            self.attractors.remove(there)
        else:
            self.attractors.place(drag.start)

    # Menu and Esc

    def open_menu(self) -> None:
        tag = self.under_cursor()
        self.menu = Menu(self.at_cursor(), tag, self.selection.around(tag))

    def dismiss(self) -> bool:
        """Choose the pointer, or else clear the selection; return whether anything changed."""
        if self.tool is not Tool.POINTER:
            self.choose(Tool.POINTER)
        elif len(self.selection):
            self.selection.clear()
        else:
            return False
        return True

    # Each frame

    def track_cursor(self) -> None:
        """Record the position of the cursor, for its velocity."""
        self.drag_tool.follow(self.at_cursor(), self._messages.now)

    def inputs(self, *, paused: bool) -> Inputs:
        """Return what is held in the next steps; in a pause a held particle is moved instead."""
        self.track_cursor()
        held = self.drag_tool.state
        if held is not None and paused:
            tags, places = [held.tag], [held.point]
            self._engine.edit(
                lambda simulation: simulation.change(tags, positions=places),
                f"drag {held.drag}", latest=True,
            )  # fmt: skip
        return Inputs(held, self.attractors.cursor)

    def follow(self) -> None:
        """Update everything that refers to particles that no longer exist."""
        frame = self._engine.frame
        self.selection.follow(frame)
        if self.drag_tool.held is not None and not len(frame.rows(self.drag_tool.held)):
            self.drag_tool.drop()

    def reset(self) -> None:
        """Cancel the drag, clear the selection and close the menu, before another simulation."""
        self.cancel()
        self.selection.clear()
        self.menu = None
