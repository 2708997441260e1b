"""What a person has before them: a simulation under way, how it is looked at, what is held.

Keys, mouse, menus and panels all end here, in a method; so do the tests. Nothing in this file
knows of a window.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jostle
from jostle.app.camera import Camera, Size
from jostle.app.carry import carry_over
from jostle.app.engine import Engine
from jostle.app.hand import Hand
from jostle.app.picking import pick
from jostle.app.picture import Picture
from jostle.app.settings import Settings
from jostle.app.shown import Shown, TreeView
from jostle.app.simulation import Frame, Point, Simulation
from jostle.app.start import start
from jostle.app.statistics import Statistics
from jostle.app.traces import Traces
from jostle.app.words import method_name

NOTICE_TIME = 3.0  # seconds
REACH = 4.0  # pixels around the cursor in which a small particle can still be picked up

# What to change does work on the particles: drift begins again, for it is not theirs.
WORK = {"n", "gravity", "world_size", "container"}

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
    engine, camera, shown, picture, hand, statistics, traces
        The parts; everybody may look at them.
    cursor
        Where the mouse is, in pixels.
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
        self.hand = Hand()
        self.statistics = Statistics()
        self.traces = Traces(self.statistics)
        self.cursor: Point = (size[0] / 2, size[1] / 2)
        self.paused = False
        self.open = True
        self.now = 0.0
        self._notice, self._notice_until = "", 0.0

    # Time

    def advance(self, elapsed: float) -> int:
        """Let the world go on by `elapsed` seconds of real time; return the steps done."""
        self.hand.follow(self.at_cursor(), self.now)
        engine, statistics, wants = self.engine, self.statistics, self.picture.wants(self.shown)
        changed = replace(engine.wants, energies=wants.energies) != wants
        energies = wants.energies or statistics.wants_energies(self.now)
        engine.wants = replace(wants, energies=energies)
        if statistics.beginning is None:  # drift begins with the very first state
            engine.look()
            statistics.sum_up(self.frame)
        steps = 0
        if not self.paused:
            steps = engine.advance(elapsed * engine.settings.time_scale)
        if changed and not steps:
            engine.look()
        statistics.follow(
            self.frame, self.now, elapsed, at_work=not self.paused, step_seconds=engine.step_seconds
        )
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
        self._take(lambda: start(settings))

    def _take(self, create: Callable[[], Simulation]) -> None:
        """Go on with another simulation, if it can be made."""
        try:
            simulation = create()
        except (ValueError, OverflowError, MemoryError) as error:
            self.say(str(error) or "There is not enough memory for that.")
            return
        moved = simulation.view != self.engine.view
        self.hand.drop()
        self.engine.take(simulation)
        self.picture.restart()
        self.statistics.restart()
        if moved:
            self.camera.look_at(simulation.view)

    def choose_scene(self, name: str) -> None:
        """Begin another scene with its own rules; how it is computed and paced stays."""
        now = self.settings
        self.begin(
            Settings(name, method=now.method, threads=now.threads, time_scale=now.time_scale)
        )

    def next_scene(self, by: int = 1) -> None:
        """Begin the scene after this one in the list, in a circle."""
        names = jostle.scenes.names()
        at = names.index(self.engine.scene) if self.engine.scene in names else -max(by, 0)
        self.choose_scene(names[(at + by) % len(names)])

    def previous_scene(self) -> None:
        """Begin the scene before this one in the list, in a circle."""
        self.next_scene(-1)

    def adjust(self, name: str, value: Any) -> None:
        """Change one setting: while it runs where that is possible, else by beginning anew."""
        if name in self.engine.adjustable:
            self.engine.edit(lambda simulation: self.say(simulation.adjust(name, value)))
            if name in WORK:
                self.statistics.begin_again()
        else:
            self.begin(replace(self.settings, **{name: value}))

    def choose_method(self, method: str) -> None:
        """Go on with another method; where the rules change too, with the same particles."""
        settings = replace(self.settings, method=method)
        if settings.by_article == self.settings.by_article:
            self.adjust("method", method)
        else:
            self.engine.wait()
            frame, view = self.frame, self.engine.view
            self._take(lambda: carry_over(settings, frame, view))

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

    def quit(self) -> None:
        """Leave the loop after this frame."""
        self.open = False

    def close(self) -> None:
        """Let go of everything that must be ended in an orderly way."""
        self.engine.close()
