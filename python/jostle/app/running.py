"""What runs: the part of a session that begins scenes, and changes settings, methods and rivals."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import jostle
from jostle.app.act.hands import Hands
from jostle.app.draw.camera import Camera
from jostle.app.draw.picture import Picture
from jostle.app.draw.shown import Shown
from jostle.app.draw.words import method_name
from jostle.app.keep.history import History
from jostle.app.measure.statistics import Statistics
from jostle.app.race import Race, refusal
from jostle.app.simulate import engine as stepping
from jostle.app.simulate.article_simulation import NO_WALLS
from jostle.app.simulate.carry import carry_over
from jostle.app.simulate.engine import REFUSALS, Engine, Then
from jostle.app.simulate.making import Create, Made, Maker, expected, is_long, made
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Simulation, Wants
from jostle.app.simulate.start import start

_OTHER_METHOD = {
    "quadtree": "brute",
    "brute": "quadtree",
    "article-quadtree": "article-brute",
    "article-brute": "article-quadtree",
}

# Settings whose change does work on the particles, or shifts the zero of their energy.
WORK = {"n", "gravity", "world_size", "container"}


class Running(Hands):
    """A session has all of this, and its time, looks and files beside it.

    Attributes
    ----------
    history, statistics, picture
        What belongs to one run; another simulation begins them anew.
    race
        The other method beside this one, while there is a race.
    """

    def __init__(self, engine: Engine, camera: Camera, shown: Shown) -> None:
        super().__init__(engine, camera, shown)
        self._maker = Maker()
        self._begin_history(engine.simulation)
        self.picture = Picture()
        self.race: Race | None = None
        self.statistics = Statistics()

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
                then=lambda: self._carry_over(settings),
                key="rules",
            )

    def _carry_over(self, settings: Settings) -> None:
        """Go on under other rules with the same particles."""
        if settings.by_article and len(self.frame.walls):
            self.say(f"{NO_WALLS} They are removed.")
        self._take(partial(carry_over, settings, self.frame, self.engine.view))

    def switch_method(self) -> None:
        """Swap brute force and tree, under the same rules."""
        if self.race:
            self.say("Both run side by side already: Q ends the race.")
            return
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

    def _begin_history(self, simulation: Simulation, state: bytes | None = None) -> None:
        """Begin a history of its own: a step that was abandoned keeps to the old one."""
        self.history = history = History()
        history.restart(simulation, state)

        def act_before(simulation: Simulation) -> None:
            if self.act_on(simulation):
                history.touch()

        engine = self.engine
        engine.before, engine.after, engine.touched = [act_before], [history.after], [history.touch]
