"""The files of a session: scenes, screenshots, videos, tables and trajectories.

New files are in one folder, each with a new name, which a message shows. An error becomes a
message, too, and does not change the session.
"""

import contextlib
import copy
import itertools
import os
import re
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

import jostle
from jostle.record import write_png, write_states
from jostle.writing import NewFile
from jostle.writing import write as write_file
from jostle_lab.act.interaction import Messages
from jostle_lab.draw.camera import Camera, Size
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.runner import Runner
from jostle_lab.simulate.engine import Worker, message_of
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.storage.config import config_text
from jostle_lab.storage.recording import Recording, pixels
from jostle_lab.storage.scene_file import SUFFIX, SavedScene, read_scene, scene_bytes

Write = Callable[[Path], object]

OUT = Path("out")
GSD_RATE = 10  # frames per simulated second
MANY = 50_000  # particles; screenshots of more are drawn on a worker thread


@dataclass
class RecordingOptions:
    """The options of the next recording."""

    suffix: str = ".mp4"
    size: Size | None = None  # the window's, if None
    seconds: float | None = None  # until it is stopped, if None


class Files:
    """Reads and writes the files of a session."""

    def __init__(
        self, runner: Runner, camera: Camera, view_options: ViewOptions, messages: Messages
    ) -> None:
        self._runner, self._camera = runner, camera
        self._view_options, self._messages = view_options, messages
        self.folder = OUT  # the folder of new files
        self.recording: Recording | None = None  # the present recording, or None
        self.options = RecordingOptions()  # those of the next recording
        self._exporter = Worker("jostle-export", synchronous=runner.engine.synchronous)
        self._exports: list[Future[str]] = []
        self._listed: tuple[float, list[Path]] | None = None  # time and result of the last search
        self._loaded: tuple[Path, list[SavedScene]] = OUT, []  # the file that is being loaded
        # Suffixes of files, their states, which the engine collects, and what writes them.
        self._collecting: list[tuple[str, Future[object], Callable[..., object]]] = []

    def follow(self) -> None:
        """Queue the frame for the recording, and show messages about finished files."""
        recording, messages = self.recording, self._messages
        if recording is not None:
            recording.offer(
                self._runner.engine.frame, self._camera, self._view_options, messages.now
            )
            if recording.done:
                self.recording = None
                messages.say(_summary(recording))
        self._aim()
        self._export_collected()
        for export in [export for export in self._exports if export.done()]:
            self._exports.remove(export)
            messages.say(export.result())

    def close(self) -> None:
        if self.recording is not None:
            self.recording.close()
        self._exporter.close()

    # Scenes

    def scenes(self) -> list[Path]:
        """Return the saved scenes of the folder, newest first; the result is kept for a second."""
        now = self._messages.now
        if self._listed is None or not 0 <= now - self._listed[0] < 1:
            self._listed = now, _newest_first(self.folder)
        return self._listed[1]

    def save(self) -> None:
        """Save the state, the settings and the view."""
        self._save(partial(self._written, SUFFIX))
        self._listed = None

    def autosave(self) -> Future[object]:
        """Save as `save` does, in a place that the next session knows; return the message."""

        def write(content: Write) -> str:
            path = autosave_path()
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                content(path)
            except OSError as error:
                return _reason(error, path)
            return f"Unsaved edits are in {path}; Ctrl+O opens them."

        return self._save(write)

    def _save(self, written: Callable[[Write], str]) -> Future[object]:
        """Let the engine save the state; `written` returns the message."""
        camera, options = copy.copy(self._camera), copy.copy(self._view_options)

        def save(simulation: Simulation) -> str:
            return written(lambda to: write_file(to, scene_bytes(simulation, camera, options)))

        self._runner.note_saved()
        saved = self._runner.engine.edit(save, changes=False)
        self._runner.collect()
        return saved

    def mention_autosave(self) -> None:
        """Say once where the edits are that the last session has saved when it was closed."""
        path = autosave_path()
        if path.exists():
            with contextlib.suppress(OSError):
                path = path.replace(path.with_name("recovered" + SUFFIX))
                self._messages.say(f"Unsaved edits of the last session are in {path}: Ctrl+O", 10)

    def load(self, path: Path) -> None:
        """Load a saved scene; an error changes nothing."""
        scenes = list[SavedScene]()

        def read() -> Simulation:
            try:
                scenes[:] = [read_scene(path)]
            except OSError as error:
                raise ValueError(_reason(error, path)) from error
            except MemoryError as error:
                raise ValueError(f"There is not enough memory for {path.name}.") from error
            return scenes[0].simulation

        self._loaded = path, scenes
        self._runner.replace(read, f"Loading {path.name} …")
        self._aim()

    def _aim(self) -> None:
        """Show a scene as it was saved, once it has been loaded."""
        path, scenes = self._loaded
        if scenes and scenes[0].simulation is self._runner.engine.simulation:
            scenes[0].show(self._camera, self._view_options)
            self._messages.say(f"Loaded {path.name}")
            self._loaded = path, []

    def save_settings(self) -> None:
        """Write the settings and the view options as TOML, for `jostle run FILE`."""
        settings, options = self._runner.engine.settings, self._view_options
        self._write(".toml", lambda path: write_file(path, config_text(settings, options).encode()))

    # Screenshots and videos

    def screenshot(self) -> None:
        """Save a screenshot as PNG, at the size of the window.

        With very many particles it is drawn on a worker thread, and without trails.
        """
        frame, options = self._runner.engine.frame, copy.copy(self._view_options)
        camera, many = copy.copy(self._camera), len(frame) > MANY

        def write(path: Path) -> None:
            painter = SoftwarePainter(camera.size)
            if many:
                Picture().draw(painter, frame, camera, options)
            else:
                self._runner.draw(painter, options)
            write_png(path, pixels(painter.canvas()))

        (self._export if many else self._write)(".png", write)

    def toggle_recording(self) -> None:
        """Begin a recording, or end it."""
        if self.recording is not None:
            self.recording.stop()
            return
        options = self.options
        size = options.size or self._camera.size

        def begin(path: Path) -> None:
            self.recording = Recording(path, size, options.seconds)

        self._write(options.suffix, begin, done="Recording {}")

    # Tables and trajectories

    def export_csv(self) -> None:
        """Write the present particles, and the sums over time, as CSV."""
        sums = self._runner.statistics.sums
        header, rows = ",".join(sums.names), sums.table.T.copy()

        def write(path: Path, states: list[bytes]) -> None:
            _write_states(path, states)
            with NewFile(path.with_name(path.stem + "-energies.csv")) as new:
                np.savetxt(new.path, rows, "%.17g", ",", header=header, comments="")

        self._export_states(".csv", lambda simulation: [simulation.save()], write)

    def export_gsd(self) -> None:
        """Write the last 30 s, ten frames per second, as GSD."""
        history = self._runner.history

        def collect(simulation: Simulation) -> list[bytes]:
            history.hold(simulation)
            moments = [(m.time, m.state) for m in history.moments[: history.at + 1] if m.state]
            return _thinned(moments, 1 / GSD_RATE)

        self._export_states(".gsd", collect, _write_states)

    def _export_states(
        self,
        suffix: str,
        collect: Callable[[Simulation], list[bytes]],
        write: Callable[[Path, list[bytes]], object],
    ) -> None:
        """Collect states of the simulation where it is stepped; write them on a worker thread."""
        states = self._runner.engine.edit(collect, changes=False)
        self._collecting.append((suffix, states, write))
        self._export_collected()

    def _export_collected(self) -> None:
        """Write the states that were collected."""
        for waiting in [waiting for waiting in self._collecting if waiting[1].done()]:
            self._collecting.remove(waiting)
            suffix, states, write = waiting
            collected = states.result()
            if isinstance(collected, list):
                self._export(suffix, partial(write, states=collected))
            else:
                self._messages.say(str(collected))

    def _export(self, suffix: str, write: Write) -> None:
        """Write a file on a worker thread; `follow` shows the result."""
        self._exports.append(self._exporter.submit(partial(self._written, suffix, write)))

    def _write(self, suffix: str, write: Write, done: str = "Saved {}") -> None:
        """Write a file, and show its path or an error."""
        self._messages.say(self._written(suffix, write, done))

    def _written(self, suffix: str, write: Write, done: str = "Saved {}") -> str:
        """Write a file with a new name; return its path or an error."""
        path = self.folder
        try:
            path = new_path(path, self._runner.engine.scene, suffix)
            write(path)
        except OSError as error:
            return _reason(error, path)
        except (ValueError, RuntimeError, MemoryError) as error:  # of pygame
            return f"{path}: {message_of(error)}"
        return done.format(path)


def new_path(folder: Path, stem: str, suffix: str) -> Path:
    """Return the path of a new file, named after a scene and the time.

    The folder is made if it does not exist.
    """
    folder.mkdir(parents=True, exist_ok=True)
    stem = re.sub(r"[^\w-]+", "-", stem) + time.strftime("-%Y%m%d-%H%M%S")
    return folder / (free_name(folder, stem, suffix) + suffix)


def free_name(folder: Path, name: str, *suffixes: str) -> str:
    """Return the first of name, name-2, name-3, … without a file with one of the suffixes."""
    names = itertools.chain([name], (f"{name}-{number}" for number in itertools.count(2)))
    return next(
        new for new in names if not any((folder / (new + suffix)).exists() for suffix in suffixes)
    )


def _reason(error: OSError, path: Path) -> str:
    """Return a message about a file that could not be read or written."""
    return f"{path.name}: {error.strerror or error}"


def _write_states(path: Path, states: list[bytes]) -> None:
    write_states(path, map(jostle.World.restore, states))


def autosave_path() -> Path:
    """Return the file of edits that were not saved when a window was closed."""
    state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(state) / "jostle" / f"autosave{SUFFIX}"


def _newest_first(folder: Path) -> list[Path]:
    ages = {}
    for path in folder.glob("*" + SUFFIX):
        with contextlib.suppress(OSError):  # it may have been removed
            ages[path] = path.stat().st_mtime_ns, path.name
    return sorted(ages, key=lambda path: ages[path], reverse=True)


def _summary(recording: Recording) -> str:
    if recording.error:
        return f"The video {recording.path.name} ended early: {recording.error}"
    seconds, repeated = recording.written / recording.rate, recording.repeated
    slow = f", {repeated:,} repeated (computer too slow)" if repeated else ""
    return f"Saved {recording.path}: {seconds:.1f} s, {recording.written:,} frames{slow}"


def _thinned(moments: list[tuple[float, bytes]], spacing: float) -> list[bytes]:
    """Return states at least `spacing` apart, counted back from the last."""
    chosen: list[tuple[float, bytes]] = []
    for moment in reversed(moments):
        if not chosen or chosen[-1][0] - moment[0] >= spacing - 1e-9:
            chosen.append(moment)
    return [state for _, state in reversed(chosen)]
