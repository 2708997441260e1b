"""What a person has before them: a simulation under way, how it is looked at, what is held.

Keys, mouse, menus and panels all end here, in a method; so do the tests. Nothing in this file
knows of a window.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
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
from jostle.app.simulate import engine as stepping
from jostle.app.simulate.carry import carry_over
from jostle.app.simulate.engine import REFUSALS, Engine, Then
from jostle.app.simulate.making import Create, Made, Maker, expected, is_long, made
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Simulation, Wants
from jostle.app.simulate.start import start

NOTICE_TIME = 3.0  # seconds
WHY_EVERY = 1.0  # seconds between two answers on very many particles, each of which takes long
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
        self._maker = Maker()
        self._begin_history(simulation)
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
        self._notice = "", 0.0  # a sentence, and until when it is shown; threads may replace it
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

    def _begin_history(self, simulation: Simulation, state: bytes | None = None) -> None:
        """Begin a history of its own: a step that was abandoned keeps to the old one."""
        self.history = history = History()
        history.restart(simulation, state)

        def act_before(simulation: Simulation) -> None:
            if self.act_on(simulation):
                history.touch()

        engine = self.engine
        engine.before, engine.after, engine.touched = [act_before], [history.after], [history.touch]

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
        self.begin(self._next_settings)

    @property
    def _next_settings(self) -> Settings:
        """Return the settings of the simulation that is being made, or of this one."""
        return self._maker.settings or self.settings

    @property
    def _first_wants(self) -> Wants:
        """Return what a first frame must hold: drift begins there."""
        return replace(self.engine.wants, energies=True)

    def begin(self, settings: Settings) -> None:
        """Begin anew with other settings; what the library refuses becomes a notice.

        Very many particles are made beside the window, and the old ones shown meanwhile.
        """
        create, notice = partial(start, settings), f"Preparing {expected(settings):,} particles …"
        if is_long(settings):
            self._maker.start(create, self._first_wants, notice, settings)
        else:
            self._take(create)

    def bring(self, create: Create, notice: str, *, long: bool, then: Then) -> None:
        """Go on with another simulation, if it can be made; what takes `long`, beside the window.

        `notice` is shown meanwhile, and `then` called when the simulation is there.
        """
        if long:
            self._maker.start(create, self._first_wants, notice, then=then)
        else:
            self._take(create, then)

    def _take(self, create: Create, then: Then | None = None) -> None:
        """Go on with another simulation, if it can be made."""
        self._maker.give_up()
        try:
            new = made(create, self._first_wants)
        except REFUSALS as error:
            self.say(stepping.sentence(error))
            return
        self._go_on(new, then)

    def _take_made(self) -> None:
        """Go on with the simulation that was made beside the window, if it is there."""
        new = self._maker.take()
        if isinstance(new, str):
            self.say(new)
        elif new is not None:
            self._go_on(*new)

    def _go_on(self, new: Made, then: Then | None) -> None:
        moved = new.simulation.view != self.engine.view
        # What was brought from elsewhere has no beginning that a rival could share.
        rival = self.race.method if self.race and then is None else None
        self._end_race()
        self.let_go()
        self.statistics.remember(self._run_name())
        self.engine.wants = self._first_wants
        self.engine.take(new.simulation, new.frame)
        self._begin_history(new.simulation, new.state)
        self.pulls.take_over(self.frame)
        self.picture = Picture()  # the thread that draws may still be at work with the old one
        self.statistics.restart()
        self.statistics.sum_up(self.frame)
        if rival:
            self._start_race(rival)
        if moved:
            self.camera.look_at(new.simulation.view)
        if then is not None:
            then()

    def _run_name(self, *, other: bool = False) -> str:
        return f"{self.engine.scene} {self.settings.by_article != other}"

    @property
    def other_drift(self) -> float | None:
        """Return how far energy had drifted by now under the other rules, if they ran before."""
        return self.statistics.drift_of(self._run_name(other=True))

    def choose_scene(self, name: str) -> None:
        """Begin another scene with its own rules; how it is computed and paced stays."""
        now = self._next_settings
        self.begin(
            Settings(name, method=now.method, threads=now.threads, time_scale=now.time_scale)
        )

    def next_scene(self, by: int = 1) -> None:
        """Begin the scene after this one in the list, in a circle."""
        names = jostle.scenes.names()
        coming = self._maker.settings
        scene = coming.scene if coming else self.engine.scene
        at = names.index(scene) if scene in names else -max(by, 0)
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
                lambda simulation: self.say(simulation.adjust(name, value)),
                changes=acts,
                then=self.statistics.begin_again if name in WORK else None,
            )
        else:
            self.begin(replace(self._next_settings, **{name: value}))

    def _take_number(self, n: int) -> None:
        """Add or remove particles; where there is no room, begin anew in a world that has it."""
        refusals: list[str | None] = []

        def then() -> None:
            if refusals[0]:
                self.begin(replace(self.settings, n=n))
                self.say(f"{refusals[0]} So the scene begins anew.")

        self.engine.edit(
            lambda simulation: refusals.append(simulation.adjust("n", n)),
            then=then,
            key="n",
            many=n > stepping.FEW,
        )

    def choose_method(self, method: str) -> None:
        """Go on with another method; where the rules change too, with the same particles."""
        settings = replace(self.settings, method=method)
        if self.race or settings.by_article == self.settings.by_article:
            self.adjust("method", method)
        else:
            # When the step under way is done, so that nothing of it is lost.
            self.engine.edit(
                lambda simulation: None,
                changes=False,
                then=lambda: self._take(
                    partial(carry_over, settings, self.frame, self.engine.view)
                ),
                key="rules",
            )

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
            method = method or _OTHER_METHOD[self.settings.method]
            count = max(len(self.frame), expected(self._next_settings))
            if reason := refusal(self.settings.method, method, count):
                self.say(reason)
            else:
                self.begin(self._next_settings)
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
            self._notice = notice, self.now + NOTICE_TIME

    @property
    def notice(self) -> str:
        """Return the sentence to show now, or nothing."""
        if self._maker.notice:
            return self._maker.notice
        notice, until = self._notice
        return notice if self.now < until else ""

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

    def quit(self) -> None:
        """Leave the loop after this frame."""
        self.open = False

    def close(self) -> None:
        """Let go of everything that must be ended in an orderly way."""
        with ExitStack() as closing:  # the last first: files must be whole, whatever else fails
            closing.callback(self.engine.close)
            closing.callback(self._end_race)
            closing.callback(self._maker.give_up)
            closing.callback(self.files.close)
