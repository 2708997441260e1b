"""Recording a session as a video on a worker thread; the UI thread never blocks on it.

The UI thread submits immutable frames. The worker thread draws them with its own painter, at the
size of the video, and feeds an encoder. When too many are waiting, or the window is slower than the
video, the last frame is repeated, so the video keeps real time.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, wait
from dataclasses import replace
from functools import partial
from pathlib import Path

from jostle_lab.draw.camera import Camera, Size
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.simulate.frame import Frame
from jostle_lab.simulate.worker import Worker
from jostle_lab.storage.encoder import PATIENCE, Encoder

RATES = {".mp4": 30, ".gif": 25}  # frames per second; a GIF has a resolution of 10 ms
MOST_QUEUED = 8  # frames


class Recording:
    """A recording in progress, .mp4 or .gif, of a size in pixels.

    It has a length in seconds, or lasts until it is stopped.
    """

    def __init__(self, path: Path, size: Size, seconds: float | None = None) -> None:
        self.path, self.size = path, size
        self.rate = RATES[path.suffix]
        self.total = None if seconds is None else max(round(seconds * self.rate), 1)
        self.written = self.repeated = 0  # frames so far, and those that repeat the one before
        self.error = ""  # why the recording ended early; empty if it did not
        self.stopped = False
        self._given = self._due = 0  # frames submitted, and frames due
        self._begin: float | None = None
        self._discard = False  # whether the frames that wait are dropped
        self._encoder = Encoder(path, size, self.rate)
        self._painter, self._picture = SoftwarePainter(size), Picture()
        self._pixels = b""  # of the last frame
        self._worker = Worker("jostle-film")
        self._jobs: list[Future[None]] = []  # those that are not done

    # On the UI thread

    def offer(self, frame: Frame, camera: Camera, options: ViewOptions, now: float) -> None:
        """Submit a frame, at a time in seconds, if one is due and not too many are waiting."""
        if self.stopped:
            return
        if self._begin is None:
            self._begin = now
        self._due = int((now - self._begin) * self.rate + 1e-6) + 1
        if self.total is not None:
            self._due = min(self._due, self.total)
        self._jobs = [job for job in self._jobs if not job.done()]
        times = self._due - self._given
        if times > 0 and len(self._jobs) <= MOST_QUEUED:  # one of them is in progress
            self._submit(partial(self._draw, frame, camera.on(self.size), replace(options), times))
        if self._due == self.total:
            self.stop()

    def stop(self) -> None:
        """Accept no more frames; those that wait are still written."""
        if not self.stopped:
            self.stopped = True
            self._submit(partial(self._finish, self._due - self._given))

    def _submit(self, work: Callable[[], None]) -> None:
        self._jobs.append(self._worker.submit(partial(self._try, work)))
        self._given = self._due

    @property
    def done(self) -> bool:
        return self.stopped and all(job.done() for job in self._jobs)

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
        """Stop, and wait for the file; after `patience` seconds waiting frames are dropped."""
        self.stop()
        wait(self._jobs, patience)
        if not self.done:
            self._discard = True
            wait(self._jobs, 2.0)
        if not self.done:
            self._encoder.kill()
        self._worker.close()

    # On the worker thread

    def _try(self, work: Callable[[], None]) -> None:
        """Do a part of the work, unless an error has ended it before."""
        if self.error:
            return
        try:
            work()
        except Exception as error:  # no error may end the UI thread
            self.error = str(error) or type(error).__name__
            self.stopped = True
            self._encoder.kill()

    def _draw(self, frame: Frame, camera: Camera, options: ViewOptions, times: int) -> None:
        """Draw a frame, and write it a number of times."""
        if not self._discard:
            self._picture.draw(self._painter, frame, camera, options)
            self._pixels = self._painter.canvas().get_buffer().raw
            self._write(times)
            self.repeated += times - 1

    def _finish(self, times: int) -> None:
        """Write the last frame until now, and close the file."""
        if self._pixels and not self._discard:
            self._write(times)
            self.repeated += times
        self._encoder.close()

    def _write(self, times: int) -> None:
        for _ in range(times):
            self._encoder.add(self._pixels)
            self.written += 1
