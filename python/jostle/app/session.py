"""What a person has before them: a simulation under way, how it is looked at, what is held.

Keys, mouse, menus and panels all end here, in a method; so do the tests. Nothing in this file
knows of a window.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from jostle.app.act.explain import Question, Why
from jostle.app.draw.camera import Camera, Size
from jostle.app.draw.painter import Painter
from jostle.app.draw.picture import Picture
from jostle.app.draw.shown import Shown, TreeView
from jostle.app.keep.files import Files
from jostle.app.measure.traces import Traces
from jostle.app.running import Running
from jostle.app.simulate import engine as stepping
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.simulation import Simulation

WHY_EVERY = 1.0  # seconds between two answers on very many particles, each of which takes long
SLOWEST, FASTEST = 1 / 32, 8.0  # of real time


class Session(Running):
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
    engine, camera, shown, traces
        The parts; everybody may look at them. Those of `Running` and `Hands` belong to them.
    files, question
        What is saved, recorded, exported; why two particles touch or not.
    """

    def __init__(self, simulation: Simulation, size: Size, left: int = 0) -> None:
        camera = Camera(size, simulation.view, left=left)
        super().__init__(Engine(simulation), camera, Shown(tree=TreeView.OUTLINE))
        self.files = Files(self)
        self.question = Question()
        self.traces = Traces(self.statistics)
        self._why_frame, self._why_due = self.frame, 0.0

    # Time

    def advance(self, elapsed: float) -> int:
        """Let the world go on by `elapsed` seconds of real time; return the steps done."""
        self.hand.follow(self.at_cursor(), self.now)
        self._take_made()
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
            if self.race:
                self.race.engine.settle()
        else:
            steps = engine.advance(elapsed * engine.settings.time_scale)
            if self.race:
                self.race.advance(elapsed * engine.settings.time_scale, wants)
        if changed and not steps:
            engine.look(at_once=False)
        self._heed_refusals()
        self.camera.follow(engine.view)
        self.keep_up()
        statistics.follow(
            self.frame, self.now, elapsed, at_work=not self.paused, step_seconds=engine.step_seconds
        )
        self.files.follow()
        return steps

    def _heed_refusals(self) -> None:
        """Pause and say why, where a step was refused; another setting or moment may go on."""
        for engine in [self.engine, *([self.race.engine] if self.race else [])]:
            if refused := engine.take_error():
                self.paused = True
                self.say(refused)

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
        self.engine.step_soon()
        if self.race:
            self.race.engine.step_soon()
        self._heed_refusals()

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
        history, seconds = self.history, self.engine.last_seconds

        def show(simulation: Simulation) -> None:
            history.hold(simulation)
            history.show(simulation, which(), seconds)

        self.engine.edit(show, changes=False, then=self._show_past)

    def _show_past(self) -> None:
        """In the window, when the frame is one of the past: nothing remembers what came after."""
        self.picture = Picture()
        self.pulls.take_over(self.frame)

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

    @property
    def notice(self) -> str:
        """Return the sentence to show now, or nothing."""
        return self._maker.notice or super().notice

    # Questions

    def ask_why(self) -> None:
        """Ask why the two selected particles touch or do not; once more takes it back."""
        self.say(self.question.ask(self.selection.tags))

    @property
    def why(self) -> Why | None:
        """Return the answer for the last state, or of very many particles for one shortly before.

        None if nothing is asked.
        """
        if len(self.frame) <= stepping.FEW or self.now >= self._why_due:
            self._why_frame, self._why_due = self.frame, self.now + WHY_EVERY
        return self.question.answer(self._why_frame, self.settings)

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

    def close(self) -> None:
        """Let go of everything that must be ended in an orderly way."""
        with ExitStack() as closing:  # the last first: files must be whole, whatever else fails
            closing.callback(self.engine.close)
            closing.callback(self._end_race)
            closing.callback(self._maker.give_up)
            closing.callback(self.files.close)
