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
from jostle_lab.simulate.engine import Create, Engine, Scene, expected
from jostle_lab.simulate.frame import FrameRequest
from jostle_lab.simulate.history import History
from jostle_lab.simulate.simulation import ADJUSTABLE, Simulation
from jostle_lab.simulate.start import start

# Settings whose change does work on the particles, or shifts the zero of their energy.
CHANGES_ENERGY = {"n", "gravity", "world_size", "container"}
SLOWEST, FASTEST = 1 / 32, 8.0  # times real time
RESTARTED = (
    "The scene starts again with its settings; drawn walls, attractors and added particles are "
    "gone. Ctrl+Z brings them back."
)


class Runner:
    """Runs a simulation, and replaces it by others."""

    def __init__(
        self, engine: Engine, camera: Camera, interaction: Interaction, messages: Messages
    ) -> None:
        self.engine = engine
        self._camera, self._interaction, self._messages = camera, interaction, messages
        self.picture, self.statistics = Picture(), Statistics()  # of the present simulation
        self.race: Race | None = None  # the comparison with another method
        # They return when the race ends.
        self._before_race: Scene | None = None
        self._undo_before = engine.undo
        self.paused = False
        self._time = 0.0  # of the last frame
        self._count: int | None = None  # the number of particles that was set last
        self._saved = engine.undo.edits
        self.history = engine.history = History(engine.simulation)
        self._own = self.history.moments[0].state or b""  # the initial state of a user's world

    # Scenes

    def begin(self, settings: Settings, rival: str | None = None) -> None:
        """Begin a scene with other settings; an error becomes a message. Undo brings this back.

        It is compared with `rival`, a method, or with that of the present comparison, if any.
        """
        rival = rival or (self.race.method if self.race else "")
        message = f"Preparing {expected(settings):,} particles …"
        self.replace(partial(start, settings), message, settings, rival)

    def replace(
        self, create: Create, message: str, settings: Settings | None = None, rival: str = ""
    ) -> None:
        """Replace the simulation, if the new one can be made.

        It is made on a worker thread; meanwhile the present one and `message` are shown.
        """
        if not (rival or self.race):
            self.engine.edit(lambda simulation: None)  # which records the present state
        self.engine.load(create, self._first_request, message, settings, rival)
        if self.engine.synchronous:
            self._take_loaded()

    def restart(self) -> None:
        """Return to the initial state, with the present settings."""
        self._messages.say(RESTARTED)
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
        names, scene = jostle.scenes.names(), self._next_settings.scene
        at = names.index(scene) if scene in names else -max(by, 0)
        self.choose_scene(names[(at + by) % len(names)])

    @property
    def _next_settings(self) -> Settings:
        """Return the settings of the simulation that is being made, or of the present one."""
        loading = self.engine.loading
        return (loading and loading.settings) or self.engine.settings

    @property
    def _first_request(self) -> FrameRequest:
        """Return the request for a first frame, which is the reference of the energy."""
        return replace(self.engine.request, energies=True)

    def _take_loaded(self) -> None:
        """Continue with a new scene, if there is one."""
        engine = self.engine
        if engine.loading and engine.loading.name and not self.race:
            engine.poll()
            if not engine.idle:
                return  # the scene before a race is kept, so no thread may use it
        loaded = engine.take_loaded()
        if loaded is None:
            return
        scene, rival = loaded
        if isinstance(scene, str):
            self._messages.say(scene)
            return
        before = self._before_race
        if rival and before is None:
            before = Scene(engine.simulation, engine.frame, engine.history)
            self._undo_before, engine.undo = engine.undo, engine.undo.copy()
        self._show(scene)
        if rival:
            self._before_race = before
            self._start_race(rival)
        else:
            self._own = self.history.moments[0].state or b""
            self.note_saved()

    def _show(self, scene: Scene) -> None:
        """Continue with another scene, without a race."""
        moved = scene.simulation.view != self.engine.view
        self._close_race()
        self._before_race = None
        self._interaction.reset()
        self.engine.request = self._first_request
        self.engine.take(scene)
        self.history = self.engine.history = scene.history or History(scene.simulation)
        self.picture = Picture()  # the worker thread may still use the previous one
        self.statistics.restart()
        self.statistics.sum_up(self.engine.frame)
        if moved:
            self._camera.look_at(scene.simulation.view)

    # Settings

    def adjust(self, name: str, value: Any) -> None:
        """Change a setting: while the scene runs if possible, else by beginning it again."""
        if why := wrong(name, value):
            self._messages.say(why)
        elif name in ADJUSTABLE and (name == "time_scale" or not self.race):
            self._count = value if name == "n" else self._count
            self.engine.edit(
                partial(Simulation.adjust, name=name, value=value),
                name, changes=name != "time_scale", latest=True,
            )  # fmt: skip
            self.collect()
        else:
            self.begin(replace(self._next_settings, **{name: value}))

    def collect(self) -> None:
        """Show the messages of finished edits, and react to changes of the energy."""
        for key, result in self.engine.take_finished():
            if key in CHANGES_ENERGY:
                self.statistics.reset_reference()
            if isinstance(result, str):
                no_room = key == "n"
                self._messages.say(f"{result} So the scene begins anew." if no_room else result)
                if no_room:
                    self.begin(replace(self.engine.settings, n=self._count))

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

    # Undo

    def undo(self) -> None:
        """Restore the state before the last edit; of a comparison, that before it."""
        if self.race:
            self.end_race()
        else:
            self._restore(partial(self.engine.undo.undo, history=self.history))

    def redo(self) -> None:
        """Restore the state that the last undo has left."""
        self.end_race()
        self._restore(partial(self.engine.undo.redo, history=self.history))

    def _restore(self, work: Callable[[Simulation], object]) -> None:
        self._interaction.drag_tool.drop()
        self.engine.edit(work, changes=False)
        self.collect()

    @property
    def unsaved(self) -> bool:
        """Whether there are edits since the scene began or was saved."""
        return self.engine.undo.edits != self._saved

    def note_saved(self) -> None:
        self._saved = self.engine.undo.edits

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
        reason = refusal(self.engine.settings.method, method, len(self.engine.frame))
        if reason:
            self._messages.say(reason)
            self.end_race()
        else:
            self.race = Race(self.engine, method)
            self.engine.history = None  # so that both sides only make steps
            self._camera.divide(2)

    def end_race(self) -> None:
        """End the comparison; the scene before it returns as it was."""
        self._close_race()
        if self._before_race:
            self._show(self._before_race)
            self.engine.undo = self._undo_before

    def _close_race(self) -> None:
        if self.race:
            self.race.close()
            self.race = None
            self._camera.divide(1)

    @property
    def _engines(self) -> list[Engine]:
        return [self.engine, *([self.race.engine] if self.race else [])]

    # Time

    def prepare(self, request: FrameRequest) -> None:
        """Take a new scene, and request what the next frames must contain for drawing."""
        self._take_loaded()
        engine, statistics = self.engine, self.statistics
        changed = replace(engine.request, energies=request.energies) != request
        energies = request.energies or statistics.energies_due(self._messages.now)
        engine.request = replace(request, energies=energies)
        if statistics.reference is None and (self.paused or not len(statistics.sums)):
            # The reference is this state, not the next one.
            if engine.frame.energies is None:
                engine.refresh()
            statistics.sum_up(engine.frame)
        if changed:
            engine.refresh()

    def follow(self, elapsed: float) -> None:
        """Update everything else after the engine has advanced."""
        if self.race:
            self.race.advance(0.0 if self.paused else elapsed, self.engine.request)
        self.collect()
        self._show_errors()
        time = self.engine.frame.stats.time
        if time < self._time:
            self.picture = Picture()  # trails of a later time
        self._time = time
        self._camera.follow(self.engine.view)
        self._interaction.follow()
        self.statistics.follow(
            self.engine.frame, self._messages.now, elapsed,
            running=not self.paused, step_seconds=self.engine.whole_seconds,
        )  # fmt: skip

    def _show_errors(self) -> None:
        """Pause after an error of a step, and show its message."""
        for engine in self._engines:
            if error := engine.take_error():
                self.paused = True
                self._messages.say(error)

    def scale_time(self, factor: float) -> None:
        scale = min(max(self.engine.settings.time_scale * factor, SLOWEST), FASTEST)
        self.adjust("time_scale", scale)
        self._messages.say(f"Speed × {scale:.4g}")

    def toggle_pause(self) -> None:
        self.paused = not self.paused

    def single_step(self) -> None:
        """Make one step, and pause."""
        self.paused = True
        for engine in self._engines:
            engine.request_step()
        self._show_errors()

    def step_back(self) -> None:
        """Restore the moment before, and pause; this reverts a last edit first."""
        self._pause_at(lambda: self.history.at - 1)

    def rewind(self, seconds_ago: float) -> None:
        """Restore the moment `seconds_ago` before the latest, and pause."""
        self._pause_at(lambda: self.history.index_of(seconds_ago))

    def _pause_at(self, index: Callable[[], int]) -> None:
        self.paused = True
        self.end_race()
        history, seconds = self.history, self.engine.last_seconds

        def restore(simulation: Simulation) -> None:
            history.hold(simulation)
            history.show(simulation, index(), seconds)

        self._restore(restore)

    # Drawing

    def draw(self, painter: Painter, options: ViewOptions) -> None:
        if self.race:
            self.race.draw(painter, self.picture, self._camera, options, self._messages.now)
        else:
            self.picture.draw(painter, self.engine.frame, self._camera, options)
