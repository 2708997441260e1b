"""The part of a session that handles the mouse in the scene."""

from __future__ import annotations

from jostle.app.act.deeds import Deeds
from jostle.app.act.gravity import Gravity
from jostle.app.act.hand import Hand
from jostle.app.act.menu import Menu
from jostle.app.act.picking import pick, pick_first
from jostle.app.act.pulls import Pulls
from jostle.app.act.selection import NOBODY, Selection
from jostle.app.act.tools import Tool, Tools
from jostle.app.draw.camera import Camera
from jostle.app.draw.shown import Shown
from jostle.app.gui import host as gui
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.simulation import Point, Simulation, Tags

NOTICE_TIME = 3.0  # seconds
CLICK = 4.0  # pixels: a button that moves less while it is down was a click
REACH = 4.0  # pixels around the cursor in which a small particle can still be picked up


class Hands:
    """What a hand has to do with; a session adds time, scenes and pictures.

    Attributes
    ----------
    cursor
        Where the mouse is, in pixels.
    hand, tools, selection
        What is held; what the left button does; what is chosen.
    deeds, pulls, gravity
        What is done to particles, attractions and gravity.
    menu
        The one that is open.
    paused, open
        Whether time stands still; False once the window shall close.
    now
        Seconds since the session began.
    """

    def __init__(self, engine: Engine, camera: Camera, shown: Shown) -> None:
        self.engine, self.camera, self.shown = engine, camera, shown
        self.cursor: Point = (camera.size[0] / 2, camera.size[1] / 2)
        self.hand = Hand()
        self.selection = Selection()
        self.pulls = Pulls(engine)
        self.deeds = Deeds(engine, self.say)
        self.gravity = Gravity(engine, self.say)
        self.tools = Tools(engine, self.hand, self.selection, self.deeds, self.pulls, self.say)
        self.menu: Menu | None = None
        self.paused = False
        self.open = True
        self.now = 0.0
        self._said = "", 0.0  # a sentence, and until when it is shown; threads may replace it

    def say(self, notice: str | None) -> None:
        """Show a sentence for a while."""
        if notice:
            self._said = notice, self.now + NOTICE_TIME

    @property
    def notice(self) -> str:
        """Return the sentence to show now, or nothing."""
        notice, until = self._said
        return notice if self.now < until else ""

    def quit(self) -> None:
        """Leave the loop after this frame."""
        self.open = False

    # What is under the cursor

    def at_cursor(self) -> Point:
        """Return the world point under the cursor."""
        return self.camera.to_world(self.cursor)

    def under_cursor(self) -> int | None:
        """Return the tag of the particle under the cursor; the article's rules have their own."""
        if self.engine.settings.by_article:
            return pick_first(self.engine.frame, self.at_cursor())
        return pick(self.engine.frame, self.at_cursor(), REACH / self.camera.scale)

    def targets(self) -> Tags:
        """Return what a key acts on: the selection, or else what is under the cursor."""
        if len(self.selection):
            return self.selection.tags
        tag = self.under_cursor()
        return NOBODY if tag is None else self.selection.around(tag)

    # The buttons of the mouse

    def press(self, *, add: bool = False) -> None:
        """Begin to use the tool at the cursor; `add` to the selection."""
        slack = CLICK / self.camera.scale
        self.tools.press(self.at_cursor(), self.now, self.under_cursor(), slack, add=add)

    def drag_on(self) -> None:
        """Go on with the tool to the cursor."""
        self.tools.move(self.at_cursor())

    def release(self) -> None:
        """End what the tool does; a particle that is held keeps the hand's velocity."""
        self.hand.follow(self.at_cursor(), self.now)
        self.tools.release(self.at_cursor())
        thrown = self.hand.release()
        if thrown is not None and not self.paused:
            self.engine.edit(thrown.throw)

    def open_menu(self) -> None:
        """Open the menu of what is under the cursor."""
        if not gui.available():
            self.say("The menus need imgui-bundle; H lists the keys that do without.")
            return
        tag = self.under_cursor()
        tags = None if tag is None else self.selection.around(tag)
        self.menu = Menu(self.at_cursor(), tag, tags)

    def escape(self) -> None:
        """Give up the drag under way; else close what is open, let go of what is chosen; quit."""
        if self.tools.cancel():
            return
        if self.menu is not None:
            self.menu = None
        elif self.shown.help:
            self.shown.help = False
        elif self.tools.tool is not Tool.POINTER:
            self.tools.choose(Tool.POINTER)
        elif len(self.selection):
            self.selection.clear()
        else:
            self.quit()

    # As time goes on

    def act_on(self, simulation: Simulation) -> bool:
        """Before a step: let the simulation feel what a person does; tell whether that is anything.

        The thread that steps calls it, so it reads what never changes, and each of it once.
        """
        grip, passing = self.hand.grip, self.pulls.pull(simulation)
        if grip is not None:
            grip.drag(simulation)
        return grip is not None or passing

    def hold_in_pause(self) -> None:
        """Once a frame of a pause: put what is held where the hand is."""
        if self.hand.grip is not None:
            self.engine.edit(self.hand.grip.carry, key="carry")

    def keep_up(self) -> None:
        """Once a frame: forget what is no longer in the world."""
        frame = self.engine.frame
        self.selection.follow(frame)
        self.pulls.follow(frame)
        if self.hand.held is not None and not len(frame.rows(self.hand.held)):
            self.hand.drop()

    def let_go(self) -> None:
        """Forget everything: another simulation comes."""
        self.tools.cancel()
        self.selection.clear()
        self.menu = None
