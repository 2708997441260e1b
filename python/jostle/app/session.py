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
from jostle.app.act.explain import Question, Why
from jostle.app.act.hands import Hands
from jostle.app.draw.camera import Camera, Size
from jostle.app.draw.painter import Painter
from jostle.app.draw.picture import Picture
from jostle.app.draw.shown import Shown, TreeView
from jostle.app.draw.words import method_name
from jostle.app.keep.files import Files
from jostle.app.keep.history import History
from jostle.app.measure.statistics import Statistics
from jostle.app.measure.traces import Traces
from jostle.app.race import Race, refusal
from jostle.app.simulate.carry import carry_over
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Simulation
from jostle.app.simulate.start import start

NOTICE_TIME = 3.0  # seconds
SLOWEST, FASTEST = 1 / 32, 8.0  # of real time

_OTHER_METHOD = {
    "quadtree": "brute",
    "brute": "quadtree",
    "article-quadtree": "article-brute",
    "article-brute": "article-quadtree",
}

# Settings whose change does work on the particles, or shifts the zero of their energy.
WORK = {"n", "gravity", "world_size", "container"}


class Session(Hands):
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
    engine, camera, shown, picture, statistics, traces
        The parts; everybody may look at them. Those of `Hands` belong to them.
    history, files, question
        The last half minute; what is saved, recorded, exported; why two particles touch or not.
    race
        The other method beside this one, while there is a race.
    now
        Seconds since the session began.
    """

    def __init__(self, simulation: Simulation, size: Size, left: int = 0) -> None:
        camera = Camera(size, simulation.view, left=left)
        super().__init__(Engine(simulation), camera, Shown(tree=TreeView.OUTLINE))
        self.engine.before.append(self._act_before)
        self.history = History()
        self.history.restart(simulation)
        self.engine.after.append(self.history.after)
        self.engine.touched.append(self.history.touch)
        self.files = Files(self)
        self.question = Question()
        self.first = simulation.settings  # what restart goes back to
        self.picture = Picture()
        self.race: Race | None = None
        self.statistics = Statistics()
        self.traces = Traces(self.statistics)
        self.paused = False
        self.open = True
        self.now = 0.0
        self._notice, self._notice_until = "", 0.0

    # Time

    def advance(self, elapsed: float) -> int:
        """Let the world go on by `elapsed` seconds of real time; return the steps done."""
        self.hand.follow(self.at_cursor(), self.now)
        engine, statistics, wants = self.engine, self.statistics, self.picture.wants(self.shown)
        wants = replace(wants, tree=wants.tree or self.question.pair is not None)
        changed = replace(engine.wants, energies=wants.energies) != wants
        energies = wants.energies or statistics.wants_energies(self.now)
        engine.wants = replace(wants, energies=energies)
        if statistics.beginning is None and (self.paused or not len(statistics.sums)):
            # Drift begins with this state, not with the next one.
            if self.frame.energies is None:
                engine.look(at_once=False)
            statistics.sum_up(self.frame)
        steps = 0
        if self.paused:
            self.hold_in_pause()
            engine.settle()
        else:
            steps = engine.advance(elapsed * engine.settings.time_scale)
            if self.race:
                self.race.advance(elapsed * engine.settings.time_scale, wants)
        if changed and not steps:
            engine.look(at_once=False)
        self.camera.follow(engine.view)
        self.keep_up()
        statistics.follow(
            self.frame, self.now, elapsed, at_work=not self.paused, step_seconds=engine.step_seconds
        )
        self.files.follow()
        return steps

    def _act_before(self, simulation: Simulation) -> None:
        """Before each step: what a person is doing to the simulation at the moment."""
        if self.hands_on:
            self.history.touch()
        self.act_on(simulation)

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
        self._end_race()

        def show(simulation: Simulation) -> None:
            self.history.hold(simulation)
            self.history.show(simulation, which(), self.engine.last_seconds)
            self.picture.restart()

        self.engine.edit(show, changes=False)
        self.pulls.take_over(self.frame)

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
        self.let_go()
        self.statistics.remember(self._run_name())
        self.engine.wants = replace(self.engine.wants, energies=True)  # drift begins here
        self.engine.take(simulation)
        self.history.restart(simulation)
        self.pulls.take_over(self.frame)
        self.picture.restart()
        self.statistics.restart()
        self.statistics.sum_up(self.frame)

    def _run_name(self, *, other: bool = False) -> str:
        return f"{self.engine.scene} {self.settings.by_article != other}"

    @property
    def other_drift(self) -> float | None:
        """Return how far energy had drifted by now under the other rules, if they ran before."""
        return self.statistics.drift_of(self._run_name(other=True))

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
        if live and name == "n":
            self._take_number(value)
        elif live:
            acts = name != "time_scale"  # which is no part of what happens, but how fast we look
            self.engine.edit(
                lambda simulation: self.say(simulation.adjust(name, value)), changes=acts
            )
            if name in WORK:
                self.statistics.begin_again()
        else:
            self.begin(replace(self.settings, **{name: value}))

    def _take_number(self, n: int) -> None:
        """Add or remove particles; where there is no room, begin anew in a world that has it."""
        refusals: list[str | None] = []
        self.engine.edit(lambda simulation: refusals.append(simulation.adjust("n", n)))
        self.engine.wait()
        if refusals[0]:
            self.begin(replace(self.settings, n=n))
            self.say(f"{refusals[0]} So the scene begins anew.")

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

    def toggle_race(self, method: str | None = None) -> None:
        """Begin anew side by side with another method on the same scene, or end that."""
        if self.race:
            self._end_race()
        else:
            self.begin(self.settings)
            self._start_race(method or _OTHER_METHOD[self.settings.method])

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

    # Questions

    def ask_why(self) -> None:
        """Ask why the two selected particles touch or do not; once more takes it back."""
        self.say(self.question.ask(self.selection.tags))

    @property
    def why(self) -> Why | None:
        """Return the answer for the last state; None if nothing is asked."""
        return self.question.answer(self.frame, self.settings)

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
