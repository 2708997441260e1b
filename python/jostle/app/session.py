"""What a person has before them: a simulation under way, how it is looked at, what is held.

Keys, mouse, menus and panels all end here, in a method; so do the tests. Nothing in this file
knows of a window.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import jostle
from jostle.app.camera import Camera, Size
from jostle.app.carry import carry_over
from jostle.app.deeds import Deeds
from jostle.app.engine import Engine
from jostle.app.files import Files
from jostle.app.gravity import Gravity
from jostle.app.hand import Hand
from jostle.app.history import History
from jostle.app.menu import Menu
from jostle.app.painter import Painter
from jostle.app.picking import pick, pick_first
from jostle.app.picture import Picture
from jostle.app.pulls import Pulls
from jostle.app.race import Race, refusal
from jostle.app.selection import NOBODY, Selection
from jostle.app.settings import Settings
from jostle.app.shown import Shown, TreeView
from jostle.app.simulation import Frame, Point, Simulation, Tags
from jostle.app.start import start
from jostle.app.statistics import Statistics
from jostle.app.tools import Tool, Tools
from jostle.app.traces import Traces
from jostle.app.words import method_name

NOTICE_TIME = 3.0  # seconds
CLICK = 4.0  # pixels: a button that moves less while it is down was a click
SLOWEST, FASTEST = 1 / 32, 8.0  # of real time
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
    selection, tools, deeds, pulls, gravity
        What a person chooses, and does to particles, attractions and gravity.
    menu
        The one that is open.
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
        self.history = History()
        self.history.restart(simulation)
        self.engine.after.append(self.history.after)
        self.engine.touched.append(self.history.touch)
        self.files = Files(self)
        self.first = simulation.settings  # what restart goes back to
        self.camera = Camera(size, simulation.view, left=left)
        self.shown = Shown(tree=TreeView.OUTLINE)
        self.picture = Picture()
        self.race: Race | None = None
        self.hand = Hand()
        self.selection = Selection()
        self.pulls = Pulls(self.engine)
        self.deeds = Deeds(self.engine, self.say)
        self.gravity = Gravity(self.engine, self.say)
        self.tools = Tools(self.engine, self.hand, self.selection, self.deeds, self.pulls, self.say)
        self.menu: Menu | None = None
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
        if self.paused:
            self._hold_in_pause()
        else:
            steps = engine.advance(elapsed * engine.settings.time_scale)
            if self.race:
                self.race.advance(elapsed * engine.settings.time_scale, wants)
        if changed and not steps:
            engine.look()
        self.camera.follow(engine.view)
        self._keep_up()
        statistics.follow(
            self.frame, self.now, elapsed, at_work=not self.paused, step_seconds=engine.step_seconds
        )
        self.files.follow()
        return steps

    def _act_before(self, simulation: Simulation) -> None:
        """Before each step: what a person is doing to the simulation at the moment."""
        if self.hand.held is not None or self.pulls.to_cursor:
            self.history.touch()
        self.pulls.apply(simulation)
        self.hand.drag(simulation)

    def scale_time(self, factor: float) -> None:
        """Let time go faster or slower."""
        scale = min(max(self.settings.time_scale * factor, SLOWEST), FASTEST)
        self.adjust("time_scale", scale)
        self.say(f"Time × {scale:.4g}")

    def toggle_pause(self) -> None:
        """Pause, or go on."""
        self.paused = not self.paused

    def single_step(self) -> None:
        """Make one step, and pause."""
        self.paused = True
        self.engine.step()
        if self.race:
            self.race.engine.step()

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
        self._take(lambda: start(settings))

    def _take(self, create: Callable[[], Simulation]) -> None:
        """Go on with another simulation, if it can be made."""
        try:
            simulation = create()
        except (ValueError, OverflowError, MemoryError) as error:
            self.say(str(error) or "There is not enough memory for that.")
            return
        moved = simulation.view != self.engine.view
        rival = self.race.method if self.race else None
        self.take(simulation)
        if rival:
            self._start_race(rival)
        if moved:
            self.camera.look_at(simulation.view)

    def take(self, simulation: Simulation) -> None:
        """Go on with another simulation."""
        self._end_race()
        self.tools.cancel()
        self.selection.clear()
        self.deeds.forget()
        self.menu = None
        self.engine.take(simulation)
        self.history.restart(simulation)
        self.pulls.take_over(self.frame)
        self.picture.restart()
        self.statistics.restart()

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
        live = name in self.engine.adjustable and (name == "time_scale" or not self.race)
        if live:
            self.engine.edit(lambda simulation: self.say(simulation.adjust(name, value)))
            if name in WORK:
                self.statistics.begin_again()
        else:
            self.begin(replace(self.settings, **{name: value}))

    def choose_method(self, method: str) -> None:
        """Go on with another method; where the rules change too, with the same particles."""
        settings = replace(self.settings, method=method)
        if self.race or settings.by_article == self.settings.by_article:
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

    def toggle_race(self, method: str) -> None:
        """Begin anew side by side with another method on the same scene, or end that."""
        if self.race:
            self._end_race()
        else:
            self.begin(self.settings)
            self._start_race(method)

    def _start_race(self, method: str) -> None:
        reason = refusal(self.settings.method, method, len(self.frame))
        if reason:
            self.say(reason)
        else:
            self.race = Race(self.engine, method)
            self.camera.divide(2)

    def _end_race(self) -> None:
        if self.race:
            self.race.close()
            self.race = None
            self.camera.divide(1)

    # Hands

    def at_cursor(self) -> Point:
        """Return the world point under the cursor."""
        return self.camera.to_world(self.cursor)

    def under_cursor(self) -> int | None:
        """Return the tag of the particle under the cursor; the article's rules have their own."""
        if self.settings.by_article:
            return pick_first(self.frame, self.at_cursor())
        return pick(self.frame, self.at_cursor(), REACH / self.camera.scale)

    def targets(self) -> Tags:
        """Return what a key acts on: the selection, or else what is under the cursor."""
        if len(self.selection):
            return self.selection.tags
        tag = self.under_cursor()
        return NOBODY if tag is None else self.selection.around(tag)

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
        if self.paused:
            self.hand.drop()
        self.engine.edit(self.hand.throw)

    def open_menu(self) -> None:
        """Open the menu of what is under the cursor."""
        tag = self.under_cursor()
        tags = None if tag is None else self.selection.around(tag)
        self.menu = Menu(self.at_cursor(), self.cursor, tag, tags)

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

    def _hold_in_pause(self) -> None:
        """In a pause, put what is held where the hand is."""
        if self.hand.held is not None:
            self.engine.edit(self.hand.carry)

    def _keep_up(self) -> None:
        """Let go of what is no longer in the world."""
        self.selection.follow(self.frame)
        self.pulls.follow(self.frame)
        if self.hand.held is not None and not len(self.frame.rows(self.hand.held)):
            self.hand.drop()

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
        self.picture.clear_trails()

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
        self._end_race()
        self.engine.close()
        self.files.close()
