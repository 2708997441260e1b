"""The runner: begins scenes, changes settings and methods, and controls the time."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import jostle
from jostle_lab.act.interaction import Interaction, Messages
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.measure import Statistics
from jostle_lab.race import Race, refusal
from jostle_lab.schema import METHODS, Settings, unknown_scene, wrong
from jostle_lab.simulate.engine import Create, Engine, LoadedScene, SceneLoader, Then, expected
from jostle_lab.simulate.frame import FrameRequest
from jostle_lab.simulate.history import History
from jostle_lab.simulate.simulation import ADJUSTABLE, Simulation
from jostle_lab.simulate.start import start

# Settings whose change does work on the particles, or shifts the zero of their energy.
CHANGES_ENERGY = {"n", "gravity", "world_size", "container"}
SLOWEST, FASTEST = 1 / 32, 8.0  # times real time


class Runner:
    """Runs a simulation, and replaces it by others."""

    def __init__(
        self, engine: Engine, camera: Camera, interaction: Interaction, messages: Messages
    ) -> None:
        self.engine = engine
        self._camera, self._interaction, self._messages = camera, interaction, messages
        self.loader = SceneLoader(synchronous=engine.synchronous)  # makes new simulations
        self.picture, self.statistics = Picture(), Statistics()  # of the present simulation
        self.race: Race | None = None  # the comparison with another method
        self.paused = False
        self.history = engine.history = History(engine.simulation)
        self._own = self.history.moments[0].state or b""  # the initial state of a user's world
        engine.act = interaction.before_step

    # Scenes

    def begin(self, settings: Settings, rival: str | None = None) -> None:
        """Begin a scene with other settings; an error becomes a message.

        It is compared with `rival`, a method, or with that of the present comparison, if any.
        """
        rival = rival or (self.race.method if self.race else None)
        then = partial(self._start_race, rival) if rival else None
        message = f"Preparing {expected(settings):,} particles …"
        self.replace(partial(start, settings), message, then, settings)

    def replace(
        self,
        create: Create,
        message: str,
        then: Then | None = None,
        settings: Settings | None = None,
    ) -> None:
        """Replace the simulation, if the new one can be made, and call `then`.

        It is made on a worker thread; meanwhile the present one and `message` are shown.
        """
        self.loader.start(create, self._first_request, message, settings, then)
        if self.engine.synchronous:
            self._take_loaded()

    def restart(self) -> None:
        """Return to the initial state, with the present settings."""
        if unknown_scene(self._next_settings.scene) is None:
            self.begin(self._next_settings)
        else:  # a world of the user
            self.replace(partial(Simulation.resume, self._own), "Restarting …")

    def choose_scene(self, name: str) -> None:
        """Begin another scene with its own settings; method, threads and speed are kept."""
        now = self._next_settings
        self.begin(
            Settings(name, method=now.method, threads=now.threads, time_scale=now.time_scale)
        )

    def next_scene(self, by: int = 1) -> None:
        """Begin the next scene of the list; the first after the last."""
        names = jostle.scenes.names()
        coming = self.loader.settings
        scene = coming.scene if coming else self.engine.scene
        at = names.index(scene) if scene in names else -max(by, 0)
        self.choose_scene(names[(at + by) % len(names)])

    @property
    def _next_settings(self) -> Settings:
        """Return the settings of the simulation that is being made, or of the present one."""
        return self.loader.settings or self.engine.settings

    @property
    def _first_request(self) -> FrameRequest:
        """Return the request for a first frame, which is the reference of the energy."""
        return replace(self.engine.request, energies=True)

    def _take_loaded(self) -> None:
        """Continue with a new simulation, if there is one."""
        new = self.loader.take()
        if isinstance(new, str):
            self._messages.say(new)
        elif new is not None:
            self._continue_with(*new)

    def _continue_with(self, new: LoadedScene, then: Then | None) -> None:
        moved = new.simulation.view != self.engine.view
        self.end_race()
        self._own = new.history.moments[0].state or b""
        self._interaction.reset()
        self.engine.request = self._first_request
        self.engine.take(new.simulation, new.frame)
        self.history = self.engine.history = new.history
        self.picture = Picture()  # the worker thread may still use the previous one
        self.statistics.restart()
        self.statistics.sum_up(self.engine.frame)
        if moved:
            self._camera.look_at(new.simulation.view)
        if then is not None:
            then()

    # Settings

    def adjust(self, name: str, value: Any) -> None:
        """Change a setting: while the scene runs if possible, else by beginning it again."""
        if why := wrong(name, value):
            self._messages.say(why)
            return
        live = name in ADJUSTABLE and (name == "time_scale" or not self.race)
        if live and name == "n":
            self._set_count(value)
        elif live:
            self.engine.edit(
                lambda simulation: self._messages.say(simulation.adjust(name, value)),
                changes=name != "time_scale",  # which has no effect on the state
                then=self.statistics.reset_reference if name in CHANGES_ENERGY else None,
            )
        else:
            self.begin(replace(self._next_settings, **{name: value}))

    def _set_count(self, n: int) -> None:
        """Add or remove particles; if there is no room, begin again with a suitable size."""
        refusals: list[str | None] = []

        def then() -> None:
            if refusals[0]:
                self._messages.say(f"{refusals[0]} So the scene begins anew.")
                self.begin(replace(self.engine.settings, n=n))

        self.engine.edit(
            lambda simulation: refusals.append(simulation.adjust("n", n)), then=then, key="n"
        )

    def switch_method(self) -> None:
        """Switch between brute force and quadtree."""
        if self.race:
            self._messages.say("Both methods run side by side; Q ends that.")
            return
        self._messages.say(f"Method: {METHODS[self._other_method]}")  # before an error message
        self.adjust("method", self._other_method)

    @property
    def _other_method(self) -> str:
        return "brute" if self.engine.settings.method == "quadtree" else "quadtree"

    # Comparison of two methods

    def toggle_race(self, method: str | None = None) -> None:
        """Begin the scene again together with another method, or end that."""
        if self.race:
            self.end_race()
            return
        method = method or self._other_method
        count = max(len(self.engine.frame), expected(self._next_settings))
        if reason := refusal(self.engine.settings.method, method, count):
            self._messages.say(reason)
        else:
            self.begin(self._next_settings, method)

    def _start_race(self, method: str) -> None:
        self.end_race()
        reason = refusal(self.engine.settings.method, method, len(self.engine.frame))
        if reason:
            self._messages.say(reason)
        else:
            self.race = Race(self.engine, method)
            self._camera.divide(2)

    def end_race(self) -> None:
        if self.race:
            self.race.close()
            self.race = None
            self._camera.divide(1)

    @property
    def _engines(self) -> list[Engine]:
        return [self.engine, *([self.race.engine] if self.race else [])]

    # Time

    def advance(self, elapsed: float, request: FrameRequest) -> int:
        """Advance by `elapsed` seconds of real time; return the number of finished steps.

        `request` is what the frames must contain for drawing.
        """
        self._take_loaded()
        engine, statistics, now = self.engine, self.statistics, self._messages.now
        changed = replace(engine.request, energies=request.energies) != request
        energies = request.energies or statistics.energies_due(now)
        engine.request = replace(request, energies=energies)
        if statistics.reference is None and (self.paused or not len(statistics.sums)):
            # The reference is this state, not the next one.
            if self.engine.frame.energies is None:
                engine.refresh()
            statistics.sum_up(self.engine.frame)
        steps = 0
        if self.paused:
            self._interaction.place_held()
            for each in self._engines:
                each.poll()
        else:
            steps = engine.advance(elapsed * engine.settings.time_scale)
            if self.race:
                self.race.advance(elapsed * engine.settings.time_scale, request)
        if changed and not steps:
            engine.refresh()
        self._show_errors()
        self._camera.follow(engine.view)
        self._interaction.follow()
        running, step_seconds = not self.paused, engine.whole_seconds
        statistics.follow(engine.frame, now, elapsed, running=running, step_seconds=step_seconds)
        return steps

    def _show_errors(self) -> None:
        """Pause after an error of a step, and show its message."""
        for engine in self._engines:
            if error := engine.take_error():
                self.paused = True
                self._messages.say(error)

    def scale_time(self, factor: float) -> None:
        scale = min(max(self.engine.settings.time_scale * factor, SLOWEST), FASTEST)
        self.adjust("time_scale", scale)
        self._messages.say(f"Time scale × {scale:.4g}")

    def toggle_pause(self) -> None:
        self.paused = not self.paused

    def single_step(self) -> None:
        """Make one step, and pause."""
        self.paused = True
        for engine in self._engines:
            engine.request_step()
        self._show_errors()

    def step_back(self) -> None:
        """Restore the moment before, and pause; this undoes a last edit first."""
        self._restore(lambda: self.history.at - 1)

    def rewind(self, seconds_ago: float) -> None:
        """Restore the moment `seconds_ago` before the latest, and pause."""
        self._restore(lambda: self.history.index_of(seconds_ago))

    def _restore(self, index: Callable[[], int]) -> None:
        self.paused = True
        self._interaction.drag_tool.drop()
        self.end_race()
        history, seconds = self.history, self.engine.last_seconds

        def restore(simulation: Simulation) -> None:
            history.hold(simulation)
            history.show(simulation, index(), seconds)

        def then() -> None:
            self.picture = Picture()

        self.engine.edit(restore, changes=False, then=then)

    # Drawing

    def draw(self, painter: Painter, options: ViewOptions) -> None:
        if self.race:
            self.race.draw(painter, self.picture, self._camera, options, self._messages.now)
        else:
            self.picture.draw(painter, self.engine.frame, self._camera, options)
