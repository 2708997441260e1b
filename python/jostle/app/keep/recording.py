"""A film of a session, drawn and written by a worker thread; the UI thread never blocks on it.

The window hands over frames, which nobody changes any more; a thread draws them with a painter of
its own, so the film has its own size, and feeds an encoder. The queue between them is short. When
it is full, or when the window is slower than the film, the last picture is shown for longer: the
film keeps the time, and says how many pictures it repeats.
"""

from __future__ import annotations

import queue
import threading
from dataclasses import dataclass, replace
from pathlib import Path

from jostle.app.draw.camera import Camera, Size
from jostle.app.draw.picture import Picture
from jostle.app.draw.shown import Shown
from jostle.app.draw.software import SoftwarePainter
from jostle.app.keep.encoder import PATIENCE, Encoder
from jostle.app.simulate.simulation import Frame

RATES = {".mp4": 30, ".gif": 25}  # pictures a second; a GIF counts in hundredths of a second
MOST_QUEUED = 8  # pictures


@dataclass(frozen=True)
class _Job:
    """What to draw, and for how many pictures of the film it stands."""

    frame: Frame
    camera: Camera
    shown: Shown
    times: int


class Recording:
    """A film under way.

    Parameters
    ----------
    path
        The file, .mp4 or .gif.
    size
        Of the film in pixels.
    seconds
        How long it shall be; None until it is stopped.

    Attributes
    ----------
    written, repeated
        Pictures in the film so far, and those of them that are the picture before once more.
    error
        Why the film has ended early; empty while all is well.
    """

    def __init__(self, path: Path, size: Size, seconds: float | None = None) -> None:
        self.path, self.size = path, size
        self.rate = RATES[path.suffix]
        self.total = None if seconds is None else max(round(seconds * self.rate), 1)
        self.written = self.repeated = 0
        self.error = ""
        self.stopped = False
        self._given = self._due = 0  # pictures handed over, and those that the time asks for
        self._begin: float | None = None
        self._jobs: queue.Queue[_Job | int] = queue.Queue(MOST_QUEUED + 1)  # one for the end
        self._hurry = threading.Event()
        self._encoder = Encoder(path, size, self.rate)
        self._thread = threading.Thread(target=self._run, name="jostle-film", daemon=True)
        self._thread.start()

    # In the thread of the window

    def offer(self, frame: Frame, camera: Camera, shown: Shown, now: float) -> None:
        """Let the film have a frame, at a time in seconds, if it is due and there is room."""
        if self.stopped:
            return
        if self._begin is None:
            self._begin = now
        self._due = int((now - self._begin) * self.rate + 1e-6) + 1
        if self.total is not None:
            self._due = min(self._due, self.total)
        if self._due > self._given and self._jobs.qsize() < MOST_QUEUED:
            times = self._due - self._given
            self._jobs.put_nowait(_Job(frame, camera.on(self.size), replace(shown), times))
            self._given = self._due
        if self._due == self.total:
            self.stop()

    def stop(self) -> None:
        """Take no more frames; what is queued is still written."""
        if not self.stopped:
            self.stopped = True
            self._jobs.put_nowait(self._due - self._given)  # the last picture lasts till now
            self._given = self._due

    @property
    def done(self) -> bool:
        """Whether the file is closed."""
        return not self._thread.is_alive()

    @property
    def queued(self) -> int:
        """Return how many pictures are still to be written."""
        return self._given - self.written

    @property
    def seconds(self) -> float:
        """Return the length of the film so far."""
        return self._given / self.rate

    @property
    def progress(self) -> float | None:
        """Return the share that is written, where it is known how much there will be."""
        whole = self._given if self.stopped else self.total
        return None if whole is None else self.written / max(whole, 1)

    def close(self, patience: float = PATIENCE) -> None:
        """Stop, and wait until the file is whole; what takes too long is left out of it."""
        self.stop()
        self._thread.join(patience)
        if self._thread.is_alive():
            self._hurry.set()
            self._thread.join(2.0)
        if self._thread.is_alive():
            self._encoder.kill()
            self._thread.join()

    # In the thread of the film

    def _run(self) -> None:
        try:
            self._write()
            self._encoder.close()
        except Exception as error:  # whatever it is, it must not take the window along
            self.error = str(error) or type(error).__name__
            self.stopped = True
            self._encoder.kill()

    def _write(self) -> None:
        painter, picture = SoftwarePainter(self.size), Picture()
        pixels = b""
        while isinstance(job := self._jobs.get(), _Job) and not self._hurry.is_set():
            picture.draw(painter, job.frame, job.camera, job.shown)
            pixels = painter.canvas().get_buffer().raw
            self._add(pixels, job.times)
            self.repeated += job.times - 1
        if isinstance(job, int) and pixels:
            self._add(pixels, job)
            self.repeated += job

    def _add(self, pixels: bytes, times: int) -> None:
        for _ in range(times):
            self._encoder.add(pixels)
            self.written += 1
