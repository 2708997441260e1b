"""Recording of a session as a film.

During a recording the UI thread submits immutable frames, and never blocks. A worker thread draws
them with its own painter, at the size of the film, and writes it. When too many are waiting, or the
window is slower than the film, the last frame is repeated, so the film keeps real time.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, wait
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pygame

from jostle.record import Film
from jostle.record.films import PATIENCE, Pixels
from jostle_lab.draw.camera import Camera, Size
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.simulate.engine import Worker
from jostle_lab.simulate.frame import Frame

RATES = {".mp4": 30, ".gif": 25}  # frames per second; a GIF has a resolution of 10 ms
MOST_QUEUED = 8  # frames


def pixels(canvas: pygame.Surface) -> Pixels:
    """Return red, green and blue of a canvas, (height, width, 3)."""
    width, height = canvas.get_size()
    return np.frombuffer(pygame.image.tobytes(canvas, "RGB"), np.uint8).reshape(height, width, 3)


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
        self._film = Film(path, size, self.rate)
        self._painter, self._picture = SoftwarePainter(size), Picture()
        self._pixels: Pixels | None = None  # of the last frame
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
            self._film.discard()
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
            self._film.discard()

    def _draw(self, frame: Frame, camera: Camera, options: ViewOptions, times: int) -> None:
        """Draw a frame, and write it a number of times."""
        if not self._discard:
            self._picture.draw(self._painter, frame, camera, options)
            self._pixels = pixels(self._painter.canvas())
            self._write(times)
            self.repeated += times - 1

    def _finish(self, times: int) -> None:
        """Write the last frame until now, and close the file."""
        if not self._discard and self._pixels is not None:
            self._write(times)
            self.repeated += times
        self._film.close()

    def _write(self, times: int) -> None:
        for _ in range(times):
            assert self._pixels is not None
            self._film.add(self._pixels)
            self.written += 1
