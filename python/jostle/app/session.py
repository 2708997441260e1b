"""What a person has before them: a simulation under way, how it is looked at, what is held.

Keys, mouse, menus and panels all end here, in a method; so do the tests. Nothing in this file
knows of a window.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from jostle.app.camera import Camera, Size
from jostle.app.engine import Engine
from jostle.app.files import Files
from jostle.app.hand import Hand
from jostle.app.history import History
from jostle.app.picking import pick
from jostle.app.picture import Picture
from jostle.app.settings import Settings
from jostle.app.shown import Shown, TreeView
from jostle.app.simulation import Frame, Point, Simulation
from jostle.app.start import start
from jostle.app.words import method_name

NOTICE_TIME = 3.0  # seconds
REACH = 4.0  # pixels around the cursor in which a small particle can still be picked up

_OTHER_METHOD = {
    "quadtree": "brute",
    "brute": "quadtree",
    "article-quadtree": "article-brute",
    "article-brute": "article-quadtree",
}


class Session:
    """One run of the program.

    Parameters
    ----------
    simulation
        What to show first.
    size
        Of the picture in pixels.
    left
        Pixels at the left edge that the scene keeps clear of.

    Attributes
    ----------
    engine, camera, shown, picture, hand
        The parts; everybody may look at them.
    cursor
        Where the mouse is, in pixels.
    now
        Seconds since the session began.
    """

    def __init__(self, simulation: Simulation, size: Size, left: int = 0) -> None:
        self.engine = Engine(simulation)
        self.engine.before.append(self._act_before)
        self.history = History()
        self.history.restart(simulation)
        self.engine.after.append(self.history.after)
        self.engine.touched.append(self.history.touch)
        self.files = Files(self)
        self.first = simulation.settings  # what restart goes back to
        self.camera = Camera(size, simulation.view, left=left)
        self.shown = Shown(tree=TreeView.OUTLINE)
        self.picture = Picture()
        self.hand = Hand()
        self.cursor: Point = (size[0] / 2, size[1] / 2)
        self.paused = False
        self.open = True
        self.now = 0.0
        self._notice, self._notice_until = "", 0.0

    # Time

    def advance(self, elapsed: float) -> int:
        """Let the world go on by `elapsed` seconds of real time; return the steps done."""
        self.hand.follow(self.at_cursor(), self.now)
        wants = self.picture.wants(self.shown)
        changed, self.engine.wants = wants != self.engine.wants, wants
        steps = 0
        if not self.paused:
            steps = self.engine.advance(elapsed * self.engine.settings.time_scale)
        if changed and not steps:
            self.engine.look()
        self.files.follow()
        return steps

    def _act_before(self, simulation: Simulation) -> None:
        """Before each step: what a person is doing to the simulation at the moment."""
        if self.hand.held is not None:
            self.history.touch()
        self.hand.drag(simulation)

    def toggle_pause(self) -> None:
        """Pause, or go on."""
        self.paused = not self.paused

    def single_step(self) -> None:
        """Make one step, and pause."""
        self.paused = True
        self.engine.step()

    def step_back(self) -> None:
        """Go back to the moment before, and pause; what a person did last is undone first."""
        self._show(lambda: self.history.at - 1)

    def scrub(self, seconds_ago: float) -> None:
        """Show what was so long before the youngest moment, and pause."""
        self._show(lambda: self.history.index_of(seconds_ago))

    def _show(self, which: Callable[[], int]) -> None:
        self.paused = True
        self.hand.drop()

        def show(simulation: Simulation) -> None:
            self.history.hold(simulation)
            self.history.show(simulation, which(), self.engine.last_seconds)
            self.picture.restart()

        self.engine.edit(show, changes=False)

    # What runs

    @property
    def frame(self) -> Frame:
        """Return the last state."""
        return self.engine.frame

    @property
    def settings(self) -> Settings:
        """Return the settings of the moment."""
        return self.engine.settings

    def restart(self) -> None:
        """Go back to the first state, with the settings of the moment."""
        self.begin(self.settings)

    def begin(self, settings: Settings) -> None:
        """Begin anew with other settings; what the library refuses becomes a notice."""
        try:
            simulation = start(settings)
        except (ValueError, OverflowError, MemoryError) as error:
            self.say(str(error) or "There is not enough memory for that.")
            return
        moved = simulation.view != self.engine.view
        self.take(simulation)
        if moved:
            self.camera.look_at(simulation.view)

    def take(self, simulation: Simulation) -> None:
        """Go on with another simulation."""
        self.hand.drop()
        self.engine.take(simulation)
        self.history.restart(simulation)
        self.picture.restart()

    def adjust(self, name: str, value: Any) -> None:
        """Change one setting: while it runs where that is possible, else by beginning anew."""
        if name in self.engine.adjustable:
            self.engine.edit(lambda simulation: self.say(simulation.adjust(name, value)))
        else:
            self.begin(replace(self.settings, **{name: value}))

    def switch_method(self) -> None:
        """Swap brute force and tree, under the same rules."""
        method = _OTHER_METHOD[self.settings.method]
        self.say(f"Now {method_name(method)}")  # before, so that a refusal stays
        self.adjust("method", method)

    # Hands

    def at_cursor(self) -> Point:
        """Return the world point under the cursor."""
        return self.camera.to_world(self.cursor)

    def under_cursor(self) -> int | None:
        """Return the tag of the particle under the cursor."""
        return pick(self.frame, self.at_cursor(), REACH / self.camera.scale)

    def grab(self) -> None:
        """Pick up the particle under the cursor, if it can move."""
        tag = self.under_cursor()
        if tag is not None and not self.frame.movable[self.frame.rows(tag)].all():
            tag = None
        self.hand.grab(tag, self.at_cursor(), self.now)

    def throw(self) -> None:
        """Let go of what is held; it keeps the hand's velocity."""
        self.hand.follow(self.at_cursor(), self.now)
        self.engine.edit(self.hand.throw)

    # Looks

    def cycle_tree(self) -> None:
        """Show the tree in the next way."""
        self.shown.tree = self.shown.tree.next()
        self.say(f"Tree: {self.shown.tree.value}")

    def toggle(self, name: str) -> None:
        """Switch one of the switches of `Shown`."""
        setattr(self.shown, name, not getattr(self.shown, name))

    def say(self, notice: str | None) -> None:
        """Show a sentence for a while."""
        if notice:
            self._notice, self._notice_until = notice, self.now + NOTICE_TIME

    @property
    def notice(self) -> str:
        """Return the sentence to show now, or nothing."""
        return self._notice if self.now < self._notice_until else ""

    # Files

    def save(self, path: Path | None = None) -> None:
        """Save the scene: its state, its settings, and how it is looked at."""
        self.files.save(path)

    def load(self, path: Path) -> None:
        """Go on with a saved scene; where that cannot be, nothing changes."""
        self.files.load(path)

    def screenshot(self) -> None:
        """Save the picture."""
        self.files.screenshot()

    def toggle_recording(self) -> None:
        """Begin a film, or end it."""
        self.files.toggle_recording()

    def quit(self) -> None:
        """Leave the loop after this frame."""
        self.open = False

    def close(self) -> None:
        """Let go of everything that must be ended in an orderly way."""
        self.engine.close()
        self.files.close()
