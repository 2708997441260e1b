"""All mouse actions in the scene."""

from __future__ import annotations

from jostle.app.act.attractors import Attractors
from jostle.app.act.commands import Commands
from jostle.app.act.drag_tool import DragTool
from jostle.app.act.gravity import Gravity
from jostle.app.act.menu import Menu
from jostle.app.act.messages import Messages
from jostle.app.act.picking import pick, pick_first
from jostle.app.act.selection import NO_TAGS, Selection
from jostle.app.act.tools import Tool, Tools
from jostle.app.draw.camera import Camera
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.simulation import Point, Simulation, Tags

CLICK = 4.0  # pixels; a shorter drag is a click
REACH = 4.0  # pixels around the cursor within which a particle is picked


class Interaction:
    """The cursor, and the tools and commands that act at it.

    Attributes
    ----------
    cursor
        In pixels.
    drag_tool, tools, selection
        The held particle; the tools of the left button; the selected particles.
    commands, attractors, gravity
        Commands on particles and walls, attractors of the user, changes of gravity.
    menu
        The open context menu, or None.
    """

    def __init__(self, engine: Engine, camera: Camera, messages: Messages) -> None:
        self._engine, self._camera, self._messages = engine, camera, messages
        self.cursor: Point = (camera.size[0] / 2, camera.size[1] / 2)
        self.drag_tool = DragTool()
        self.selection = Selection()
        self.attractors = Attractors(engine)
        self.commands = Commands(engine, messages.say)
        self.gravity = Gravity(engine, messages.say)
        self.tools = Tools(
            engine, self.drag_tool, self.selection, self.commands, self.attractors, messages.say
        )
        self.menu: Menu | None = None

    # Cursor

    def at_cursor(self) -> Point:
        """Return the world point under the cursor."""
        return self._camera.to_world(self.cursor)

    def under_cursor(self) -> int | None:
        """Return the tag of the particle under the cursor; the article has its own rule."""
        if self._engine.settings.by_article:
            return pick_first(self._engine.frame, self.at_cursor())
        return pick(self._engine.frame, self.at_cursor(), REACH / self._camera.scale)

    def targets(self) -> Tags:
        """Return the selection, or else the particle under the cursor."""
        if len(self.selection):
            return self.selection.tags
        tag = self.under_cursor()
        return NO_TAGS if tag is None else self.selection.around(tag)

    # Buttons

    def press(self, *, add: bool = False) -> None:
        """Begin to use the tool at the cursor; `add` extends the selection."""
        slack = CLICK / self._camera.scale
        now = self._messages.now
        self.tools.press(self.at_cursor(), now, self.under_cursor(), slack, add=add)

    def drag_on(self) -> None:
        """Continue with the tool to the cursor."""
        self.tools.move(self.at_cursor())

    def release(self, *, throw: bool = True) -> None:
        """End the use of the tool; `throw` gives a held particle the velocity of the cursor."""
        self.track_cursor()
        self.tools.release(self.at_cursor())
        thrown = self.drag_tool.release()
        if thrown is not None and throw:
            self._engine.edit(thrown.throw)

    def open_menu(self) -> None:
        """Open the menu at the cursor."""
        tag = self.under_cursor()
        tags = None if tag is None else self.selection.around(tag)
        self.menu = Menu(self.at_cursor(), tag, tags)

    def cancel(self) -> bool:
        """Cancel the current drag; return whether there was one."""
        return self.tools.cancel()

    def dismiss(self) -> bool:
        """Choose the pointer, or else clear the selection; return whether anything changed."""
        if self.tools.tool is not Tool.POINTER:
            self.tools.choose(Tool.POINTER)
        elif len(self.selection):
            self.selection.clear()
        else:
            return False
        return True

    # Each frame

    def track_cursor(self) -> None:
        """Record the position of the cursor, for its velocity."""
        self.drag_tool.follow(self.at_cursor(), self._messages.now)

    def before_step(self, simulation: Simulation) -> bool:
        """Apply the drag and the attractors; return whether there is a drag or Space is held.

        The worker thread calls it. What it reads is immutable, and each is read once.
        """
        drag, attracting = self.drag_tool.state, self.attractors.update(simulation)
        if drag is not None:
            drag.drag(simulation)
        return drag is not None or attracting

    def place_held(self) -> None:
        """Move the held particle to the cursor, while the simulation is paused."""
        if self.drag_tool.state is not None:
            self._engine.edit(self.drag_tool.state.place, key="drag")

    def follow(self) -> None:
        """Update everything that refers to particles that no longer exist."""
        frame = self._engine.frame
        self.selection.follow(frame)
        self.attractors.follow(frame)
        if self.drag_tool.held is not None and not len(frame.rows(self.drag_tool.held)):
            self.drag_tool.drop()

    def reset(self) -> None:
        """Cancel the drag, clear the selection and close the menu, before another simulation."""
        self.cancel()
        self.selection.clear()
        self.menu = None
