"""Background rendering: a slow picture is drawn in a worker thread.

Meanwhile the last finished one is shown, moved and stretched to where the camera looks now. So a
million particles slow the picture, and neither the mouse nor the panels.
"""

from __future__ import annotations

import copy
import sys
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

import pygame

from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import GROUND
from jostle.app.draw.software import SoftwarePainter

Draw = Callable[[Painter, Camera], None]

LONG = 0.040  # seconds; pictures that take longer are drawn beside the window
FEW = 20_000  # particles that are always drawn in the window
MANY = 150_000  # particles whose first picture is not even tried in the window
SHORTEST_TURN = 0.001  # seconds a thread keeps the interpreter while another waits
PAUSE, LONGEST_PAUSE = 4, 512
LARGEST_STRETCH = 16.0  # a picture stretched further shows nothing


class Backdrop:
    """Draws scenes at once or beside the window, as their time has it."""

    def __init__(self) -> None:
        self._seconds = 0.0  # what the last picture took
        self._count = 0
        self._pause, self._rest = PAUSE, 0  # pictures beside, before the window is tried again
        self._worker: ThreadPoolExecutor | None = None
        self._job: Future[None] | None = None
        self._free, self._done = SoftwarePainter((1, 1)), SoftwarePainter((1, 1))
        self._seen_by: Camera | None = None  # who sees the finished picture
        self._drawn_for: Camera | None = None  # who will see the one under way

    @property
    def beside(self) -> bool:
        """Whether pictures are drawn beside the window at the moment."""
        slow = self._seconds > LONG or self._rest > 0
        return self._job is not None or (slow and self._count > FEW)

    def draw(self, painter: Painter, camera: Camera, count: int, draw: Draw) -> None:
        """Draw a scene of `count` particles, or show the last picture of it."""
        if count > max(2 * self._count, MANY):
            self._seconds = max(self._seconds, 2 * LONG)
        self._count = count
        self._collect()
        if not self.beside:
            start = time.perf_counter()
            draw(painter, camera)
            self._seconds = time.perf_counter() - start
            self._seen_by = None
            if self._seconds > LONG:  # not all painters are as fast as the one beside
                self._rest = self._pause
                self._pause = min(2 * self._pause, LONGEST_PAUSE)
            return
        if self._job is None:
            self._start(painter, camera, draw)
        self._show(painter, camera)

    def wait(self) -> None:
        """Wait for the picture under way."""
        if self._job is not None:
            self._job.result()

    def close(self) -> None:
        """Let the thread go."""
        if self._worker is not None:
            self._worker.shutdown()
            self._worker = self._job = None

    def _start(self, painter: Painter, camera: Camera, draw: Draw) -> None:
        if self._worker is None:
            # Who waits for the interpreter gets it sooner, and one frame waits several times.
            sys.setswitchinterval(SHORTEST_TURN)
            self._worker = ThreadPoolExecutor(1, "jostle-draw")
        if self._free.size != painter.size:
            self._free.resize(painter.size)
        canvas, self._drawn_for = self._free, copy.copy(camera)
        seer = self._drawn_for

        def work() -> None:
            start = time.perf_counter()
            draw(canvas, seer)
            self._seconds = time.perf_counter() - start

        self._job = self._worker.submit(work)

    def _collect(self) -> None:
        """Take a picture that is done; what went wrong in it is raised here."""
        if self._job is not None and self._job.done():
            job, self._job = self._job, None
            job.result()
            self._rest -= self._rest > 0
            self._free, self._done = self._done, self._free
            self._seen_by = self._drawn_for

    def _show(self, painter: Painter, camera: Camera) -> None:
        """Show the finished picture as the camera sees it now."""
        canvas, seer = self._done.canvas(), self._seen_by
        if seer is None:
            painter.fill(GROUND)
            return
        x0, y0 = _moved((0.0, 0.0), seer, camera)
        x1, y1 = _moved(seer.size, seer, camera)
        if (x0, y0) == (0.0, 0.0) and seer.size == painter.size and x1 == seer.size[0]:
            painter.sheet(canvas, (0, 0))
            return
        painter.fill(GROUND)
        stretch = camera.scale / seer.scale
        if not 1 / LARGEST_STRETCH < stretch < LARGEST_STRETCH:
            return
        # Only what the window shows of it is stretched.
        shown = pygame.Rect(x0, y0, x1 - x0, y1 - y0).clip(pygame.Rect((0, 0), painter.size))
        part = pygame.Rect(
            (shown.x - x0) / stretch,
            (shown.y - y0) / stretch,
            shown.width / stretch,
            shown.height / stretch,
        ).clip(canvas.get_rect())
        if 0 not in (*part.size, *shown.size):
            picture = pygame.transform.scale(canvas.subsurface(part), shown.size)
            painter.sheet(picture, shown.topleft)


def _moved(pixel: tuple[float, float], before: Camera, now: Camera) -> tuple[float, float]:
    """Return where now is what was at a pixel before."""
    x, y = before.to_world(pixel)
    return (
        round((x - now.center[0]) * now.scale + now.size[0] / 2, 6),
        round((y - now.center[1]) * now.scale + now.size[1] / 2, 6),
    )
