"""What a session writes and reads: scenes, pictures, films, tables and trajectories.

Everything new goes into one folder, under a name of its own, and a notice says where. What goes
wrong becomes a notice as well, and leaves the session as it was.
"""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from jostle.app.draw.camera import Size
from jostle.app.draw.picture import Picture
from jostle.app.draw.software import SoftwarePainter
from jostle.app.keep.exports import write_gsd, write_positions, write_series
from jostle.app.keep.paths import new_path, why_not, write_whole
from jostle.app.keep.recorder import save_png
from jostle.app.keep.recording import Recording
from jostle.app.keep.scene_file import SUFFIX, SavedScene, read_scene, scene_bytes
from jostle.app.simulate import engine
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Simulation, Wants
from jostle.app.simulate.start import resume

if TYPE_CHECKING:
    from jostle.app.session import Session

OUT = Path("out")
GSD_RATE = 10  # frames a simulated second
LARGE = 2**20  # bytes of a scene that is read beside the window: some ten thousand particles


@dataclass
class FilmWishes:
    """How the next film shall be."""

    suffix: str = ".mp4"
    size: Size | None = None  # the window's, if None
    seconds: float | None = None  # until it is stopped, if None


class Files:
    """The folder of a session.

    Attributes
    ----------
    folder
        Where new files go.
    recording
        The film under way, or None.
    film
        How the next film shall be; a panel changes it.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self.folder = OUT
        self.recording: Recording | None = None
        self.film = FilmWishes()
        self._exporter: ThreadPoolExecutor | None = None
        self._exports: list[Future[str]] = []
        self._listed: tuple[float, list[Path]] | None = None  # when, and what there was

    def follow(self) -> None:
        """Every frame: let the film have it, and say what has been finished."""
        session, film = self._session, self.recording
        if film is not None:
            film.offer(session.frame, session.camera, session.shown, session.now)
            if film.done:
                self.recording = None
                session.say(_summary(film))
        for export in [export for export in self._exports if export.done()]:
            self._exports.remove(export)
            session.say(export.result())

    def close(self) -> None:
        """Bring to an end what is under way, so that no file is left broken."""
        if self.recording is not None:
            self.recording.close()
        if self._exporter is not None:
            self._exporter.shutdown()

    # Scenes

    def scenes(self) -> list[Path]:
        """Return the saved scenes of the folder, the youngest first, as of a second ago."""
        now = self._session.now
        if self._listed is None or not 0 <= now - self._listed[0] < 1:
            self._listed = now, _youngest_first(self.folder)
        return self._listed[1]

    def save(self, path: Path | None = None) -> None:
        """Save the scene, under a new name unless one is given."""
        session = self._session
        camera, shown = copy.copy(session.camera), copy.copy(session.shown)

        def write(simulation: Simulation) -> None:
            self._try(SUFFIX, lambda new: write_whole(new, scene_bytes(
                simulation, camera, shown)), path)  # fmt: skip

        session.engine.edit(write, changes=False, then=self._list_anew)

    def _list_anew(self) -> None:
        self._listed = None

    def load(self, path: Path) -> None:
        """Go on with a saved scene."""
        session, scenes = self._session, list[SavedScene]()

        def read() -> Simulation:
            try:
                scenes[:] = [read_scene(path)]
            except OSError as error:
                raise ValueError(why_not(error, path)) from error
            except MemoryError as error:
                raise ValueError(f"There is not enough memory for {path.name}.") from error
            return scenes[0].simulation

        def look() -> None:
            scenes[0].look(session.camera)
            scenes[0].show(session.shown)
            session.say(f"Loaded {path.name}")

        session.bring(read, f"Loading {path.name} …", long=_is_long(path), then=look)

    # Pictures and films

    def screenshot(self, path: Path | None = None, size: Size | None = None) -> None:
        """Save the picture as PNG, at the window's size unless another is given.

        One of very many particles is drawn beside the window, and without trails.
        """
        session = self._session
        frame, shown = session.frame, copy.copy(session.shown)
        camera = copy.copy(session.camera) if size is None else session.camera.on(size)
        many = len(frame) > engine.FEW

        def write(new: Path) -> None:
            painter = SoftwarePainter(camera.size)
            if size is None and not many:
                session.draw(painter)
            else:
                Picture().draw(painter, frame, camera, shown)
            save_png(painter.canvas(), new)

        if many:
            self._export(".png", write, path)
        else:
            self._try(".png", write, path)

    def toggle_recording(self) -> None:
        """Begin a film, or end it."""
        if self.recording is None:
            self.record()
        else:
            self.recording.stop()

    def record(self, path: Path | None = None) -> None:
        """Begin a film as wished for."""
        wishes, session = self.film, self._session
        size = wishes.size or session.camera.size

        def begin(new: Path) -> None:
            self.recording = Recording(new, size, wishes.seconds)

        self._try(wishes.suffix, begin, path, done="Recording {}")

    # Tables and trajectories

    def export_csv(self) -> None:
        """Write the particles of this moment, and the sums over time, as CSV."""
        session = self._session
        frame, sums = session.frame, session.statistics.sums
        table = {name: sums[name].copy() for name in sums.names}

        def write(path: Path) -> None:
            write_positions(path, frame)
            write_series(path.with_name(path.stem + "-energies.csv"), table)

        self._export(".csv", write)

    def export_gsd(self) -> None:
        """Write the last half minute, ten frames a second, as GSD."""
        session, history = self._session, self._session.history
        writers: list[Callable[[Path], object]] = []

        def collect(simulation: Simulation) -> None:
            history.hold(simulation)
            moments = [(m.time, m.state) for m in history.moments[: history.at + 1] if m.state]
            view, time_step = simulation.view, simulation.time_step
            frames = _frames(simulation.settings, _thinned(moments, 1 / GSD_RATE))
            writers.append(lambda path: write_gsd(path, frames, view, time_step))

        session.engine.edit(collect, changes=False, then=lambda: self._export(".gsd", writers[0]))

    def _export(
        self, suffix: str, write: Callable[[Path], object], path: Path | None = None
    ) -> None:
        """Write beside the window; `follow` says how it went."""
        if self._exporter is None:
            self._exporter = ThreadPoolExecutor(1, "jostle-export")
        scene = self._session.engine.scene

        def work() -> str:
            try:
                new = path or new_path(self.folder, scene, suffix)
                write(new)
            except (OSError, RuntimeError, MemoryError) as error:  # pygame's is a RuntimeError
                return f"Nothing could be saved: {error}"
            return f"Saved {new}"

        self._exports.append(self._exporter.submit(work))

    def _try(
        self,
        suffix: str,
        write: Callable[[Path], None],
        path: Path | None,
        done: str = "Saved {}",
    ) -> None:
        """Write a file, and say where it is or why it is not."""
        session = self._session
        try:
            path = path or new_path(self.folder, session.engine.scene, suffix)
            write(path)
        except OSError as error:
            session.say(why_not(error, path or self.folder))
        except (ValueError, RuntimeError) as error:  # pygame's word is a RuntimeError
            session.say(f"{path}: {error}")
        else:
            session.say(done.format(path))


def _is_long(path: Path) -> bool:
    """Tell whether reading a scene would hold up the window."""
    try:
        return path.stat().st_size > LARGE
    except OSError:
        return False  # reading it will say why


def _youngest_first(folder: Path) -> list[Path]:
    ages = {}
    for path in folder.glob("*" + SUFFIX):
        with contextlib.suppress(OSError):  # it may have just been removed
            ages[path] = path.stat().st_mtime_ns, path.name
    return sorted(ages, key=lambda path: ages[path], reverse=True)


def _summary(film: Recording) -> str:
    """Return what came of a film, in a sentence."""
    if film.error:
        return f"The film {film.path.name} has ended early: {film.error}"
    seconds = film.written / film.rate
    repeated = f", {film.repeated:,} of them twice or more" if film.repeated else ""
    return f"Saved {film.path}: {seconds:.1f} s, {film.written:,} pictures{repeated}"


def _thinned(moments: list[tuple[float, bytes]], spacing: float) -> list[bytes]:
    """Return the states that are at least `spacing` apart, counted back from the last."""
    chosen: list[tuple[float, bytes]] = []
    for moment in reversed(moments):
        if not chosen or chosen[-1][0] - moment[0] >= spacing - 1e-9:
            chosen.append(moment)
    return [state for _, state in reversed(chosen)]


def _frames(settings: Settings, states: list[bytes]) -> Iterator[Frame]:
    """Look at states one after the other, in a simulation of our own."""
    simulation: Simulation | None = None
    for state in states:
        if simulation is None:
            simulation = resume(settings, state)
        else:
            simulation.load(state)
        yield simulation.frame(Wants())
