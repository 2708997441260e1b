"""What a person has before them: a simulation under way, how it is looked at, what is held.

Keys, mouse, menus and panels all end here, in a method; so do the tests. Nothing in this file
knows of a window.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from jostle.app.camera import Camera, Size
from jostle.app.engine import Engine
from jostle.app.hand import Hand
from jostle.app.painter import Painter
from jostle.app.picking import pick
from jostle.app.picture import Picture
from jostle.app.race import Race, refusal
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
    race
        The other method beside this one, while there is a race.
    now
        Seconds since the session began.
    """

    def __init__(self, simulation: Simulation, size: Size, left: int = 0) -> None:
        self.engine = Engine(simulation)
        self.engine.before.append(self._act_before)
        self.first = simulation.settings  # what restart goes back to
        self.camera = Camera(size, simulation.view, left=left)
        self.shown = Shown(tree=TreeView.OUTLINE)
        self.picture = Picture()
        self.race: Race | None = None
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
        if self.race:
            wants = replace(wants, energies=True)
        changed, self.engine.wants = wants != self.engine.wants, wants
        steps = 0
        if not self.paused:
            elapsed *= self.engine.settings.time_scale
            steps = self.engine.advance(elapsed)
            if self.race:
                self.race.advance(elapsed, wants)
        if changed and not steps:
            self.engine.look()
        return steps

    def _act_before(self, simulation: Simulation) -> None:
        """Before each step: what a person is doing to the simulation at the moment."""
        self.hand.drag(simulation)

    def toggle_pause(self) -> None:
        """Pause, or go on."""
        self.paused = not self.paused

    def single_step(self) -> None:
        """Make one step, and pause."""
        self.paused = True
        self.engine.step()
        if self.race:
            self.race.engine.step()

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
        self.hand.drop()
        self.engine.take(simulation)
        self.picture.restart()
        if self.race:
            self.race.begin(settings)
        if moved:
            self.camera.look_at(simulation.view)

    def adjust(self, name: str, value: Any) -> None:
        """Change one setting: while it runs where that is possible, else by beginning anew."""
        if name in self.engine.adjustable and not self.race:
            self.engine.edit(lambda simulation: self.say(simulation.adjust(name, value)))
        else:
            self.begin(replace(self.settings, **{name: value}))

    def switch_method(self) -> None:
        """Swap brute force and tree, under the same rules."""
        method = _OTHER_METHOD[self.settings.method]
        self.say(f"Now {method_name(method)}")  # before, so that a refusal stays
        self.adjust("method", method)

    def toggle_race(self, method: str) -> None:
        """Begin anew side by side with another method on the same scene, or end that."""
        if self.race:
            self.race.close()
            self.race = None
            self.camera.divide(1)
            return
        n = len(self.frame)
        reason = refusal(method, n) or refusal(self.settings.method, n)
        if reason or method == self.settings.method:
            self.say(reason or f"{method_name(method)} runs already; race it with another.")
            return
        self.begin(self.settings)
        self.race = Race(self.engine, method)
        self.camera.divide(2)

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

    def draw(self, painter: Painter) -> None:
        """Draw the scene, or both of a race."""
        if self.race:
            self.race.draw(painter, self.picture, self.camera, self.shown, self.now)
        else:
            self.picture.draw(painter, self.frame, self.camera, self.shown)

    def cycle_tree(self) -> None:
        """Show the tree in the next way."""
        self.shown.tree = self.shown.tree.next()
        self.say(f"Tree: {self.shown.tree.value}")

    def cycle_colours(self) -> None:
        """Colour the particles by the next quantity."""
        self.shown.colour_by = self.shown.colour_by.next()
        self.say(f"Colour: {self.shown.colour_by.value}")

    def clear_trails(self) -> None:
        """Forget where particles have been."""
        self.picture.trails.clear()

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

    def quit(self) -> None:
        """Leave the loop after this frame."""
        self.open = False

    def close(self) -> None:
        """Let go of everything that must be ended in an orderly way."""
        if self.race:
            self.race.close()
        self.engine.close()
