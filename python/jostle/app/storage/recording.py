"""Recording a session as a video on a worker thread; the UI thread never blocks on it.

The UI thread puts immutable frames into a short queue. The worker thread draws them with its own
painter, at the size of the video, and feeds an encoder. When the queue is full, or the window is
slower than the video, the last frame is repeated, so the video keeps real time.
"""

from __future__ import annotations

import queue
import threading
from dataclasses import dataclass, replace
from pathlib import Path

from jostle.app.draw.camera import Camera, Size
from jostle.app.draw.picture import Picture
from jostle.app.draw.software import SoftwarePainter
from jostle.app.draw.view_options import ViewOptions
from jostle.app.simulate.simulation import Frame
from jostle.app.storage.encoder import PATIENCE, Encoder

RATES = {".mp4": 30, ".gif": 25}  # frames per second; a GIF has a resolution of 10 ms
MOST_QUEUED = 8  # frames


@dataclass(frozen=True)
class _Job:
    """A frame to draw, and its number of repetitions."""

    frame: Frame
    camera: Camera
    options: ViewOptions
    times: int


class Recording:
    """A recording in progress.

    Parameters
    ----------
    path
        The file, .mp4 or .gif.
    size
        Size of the video in pixels.
    seconds
        Its length; None until it is stopped.
    """

    def __init__(self, path: Path, size: Size, seconds: float | None = None) -> None:
        self.path, self.size = path, size
        self.rate = RATES[path.suffix]
        self.total = None if seconds is None else max(round(seconds * self.rate), 1)
        self.written = self.repeated = 0  # frames so far, and those that repeat the one before
        self.error = ""  # why the recording ended early; empty if it did not
        self.stopped = False
        self._given = self._due = 0  # frames queued, and frames due
        self._begin: float | None = None
        self._jobs: queue.Queue[_Job | int] = queue.Queue(MOST_QUEUED + 1)  # one for the end
        self._discard = threading.Event()
        self._encoder = Encoder(path, size, self.rate)
        self._thread = threading.Thread(target=self._run, name="jostle-film", daemon=True)
        self._thread.start()

    # On the UI thread

    def offer(self, frame: Frame, camera: Camera, options: ViewOptions, now: float) -> None:
        """Queue a frame, at a time in seconds, if one is due and the queue is not full."""
        if self.stopped:
            return
        if self._begin is None:
            self._begin = now
        self._due = int((now - self._begin) * self.rate + 1e-6) + 1
        if self.total is not None:
            self._due = min(self._due, self.total)
        if self._due > self._given and self._jobs.qsize() < MOST_QUEUED:
            times = self._due - self._given
            self._jobs.put_nowait(_Job(frame, camera.on(self.size), replace(options), times))
            self._given = self._due
        if self._due == self.total:
            self.stop()

    def stop(self) -> None:
        """Accept no more frames; queued ones are still written."""
        if not self.stopped:
            self.stopped = True
            self._jobs.put_nowait(self._due - self._given)  # the last frame lasts until now
            self._given = self._due

    @property
    def done(self) -> bool:
        return not self._thread.is_alive()

    @property
    def queued(self) -> int:
        """Return the number of frames to be written."""
        return self._given - self.written

    @property
    def seconds(self) -> float:
        """Return the length of the video so far."""
        return self._given / self.rate

    @property
    def progress(self) -> float | None:
        """Return the written fraction, or None if the length is not known."""
        whole = self._given if self.stopped else self.total
        return None if whole is None else self.written / max(whole, 1)

    def close(self, patience: float = PATIENCE) -> None:
        """Stop, and wait for the file; after `patience` seconds queued frames are dropped."""
        self.stop()
        self._thread.join(patience)
        if self._thread.is_alive():
            self._discard.set()
            self._thread.join(2.0)
        if self._thread.is_alive():
            self._encoder.kill()
            self._thread.join()

    # On the worker thread

    def _run(self) -> None:
        try:
            self._write()
            self._encoder.close()
        except Exception as error:  # no error may end the UI thread
            self.error = str(error) or type(error).__name__
            self.stopped = True
            self._encoder.kill()

    def _write(self) -> None:
        painter, picture = SoftwarePainter(self.size), Picture()
        pixels = b""
        while isinstance(job := self._jobs.get(), _Job) and not self._discard.is_set():
            picture.draw(painter, job.frame, job.camera, job.options)
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
