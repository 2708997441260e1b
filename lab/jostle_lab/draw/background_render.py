"""Background rendering of slow frames on a worker thread.

Meanwhile the last finished frame is shown, moved and scaled to the present view of the camera. So
very many particles reduce the rate of new frames, but the mouse and the panels stay responsive.
"""

import copy
import time
from collections.abc import Callable
from concurrent.futures import Future

import pygame

from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import GROUND
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.simulate.engine import Worker

Draw = Callable[[Painter, Camera], None]

LONG = 0.040  # seconds; slower frames are drawn on the worker thread
FEW = 20_000  # particles; fewer are always drawn on the UI thread
MANY = 150_000  # particles; of more, the first frame is drawn on the worker thread
PAUSE, LONGEST_PAUSE = 4, 512
LARGEST_ZOOM = 16.0  # a frame scaled further is not shown


class BackgroundRenderer:
    """Draws frames on the UI thread or on a worker thread, depending on their time."""

    def __init__(self) -> None:
        self._seconds = 0.0  # of the last frame
        self._count = 0
        self._pause = PAUSE  # frames on the worker before the UI thread is tried again
        self._rest = 0  # of them, those to come
        self._worker = Worker("jostle-draw")
        self._job: Future[None] | None = None
        self._free, self._done = SoftwarePainter((1, 1)), SoftwarePainter((1, 1))
        self._shown_camera: Camera | None = None  # of the finished frame
        self._job_camera: Camera | None = None  # of the frame in progress

    @property
    def in_background(self) -> bool:
        """Whether frames are drawn on the worker thread."""
        slow = self._seconds > LONG or self._rest > 0
        return self._job is not None or (slow and self._count > FEW)

    def draw(self, painter: Painter, camera: Camera, count: int, draw: Draw) -> None:
        """Draw a scene of `count` particles, or show its last finished frame."""
        if count > max(2 * self._count, MANY):
            self._seconds = max(self._seconds, 2 * LONG)
        self._count = count
        self._collect()
        if not self.in_background:
            start = time.perf_counter()
            draw(painter, camera)
            self._seconds = time.perf_counter() - start
            self._shown_camera = None
            if self._seconds > LONG:  # the painter of the window may be slower than the worker's
                self._rest = self._pause
                self._pause = min(2 * self._pause, LONGEST_PAUSE)
            return
        if self._job is None:
            self._start(painter, camera, draw)
        self._show(painter, camera)

    def wait(self) -> None:
        if self._job is not None:
            self._job.result()

    def close(self) -> None:
        self._worker.close()
        self._job = None

    def _start(self, painter: Painter, camera: Camera, draw: Draw) -> None:
        if self._free.size != painter.size:
            self._free.resize(painter.size)
        canvas, self._job_camera = self._free, copy.copy(camera)
        shown_to = self._job_camera

        def work() -> None:
            start = time.perf_counter()
            draw(canvas, shown_to)
            self._seconds = time.perf_counter() - start

        self._job = self._worker.submit(work)

    def _collect(self) -> None:
        """Take a finished frame, or raise its exception."""
        if self._job is not None and self._job.done():
            job, self._job = self._job, None
            job.result()
            self._rest -= self._rest > 0
            self._free, self._done = self._done, self._free
            self._shown_camera = self._job_camera

    def _show(self, painter: Painter, camera: Camera) -> None:
        """Show the finished frame, moved and scaled to the present view of the camera."""
        canvas, then = self._done.canvas(), self._shown_camera
        if then is None:
            painter.fill(GROUND)
            return
        before = (*then.to_world((0.0, 0.0)), *then.to_world(then.size))
        x0, y0, x1, y1 = (round(edge, 6) for edge in camera.rect_to_screen(before))
        if (x0, y0) == (0.0, 0.0) and then.size == painter.size and x1 == then.size[0]:
            painter.sheet(canvas, (0, 0))
            return
        painter.fill(GROUND)
        zoom = camera.scale / then.scale
        if not 1 / LARGEST_ZOOM < zoom < LARGEST_ZOOM:
            return
        # Only the visible part is scaled.
        shown = pygame.Rect(x0, y0, x1 - x0, y1 - y0).clip(pygame.Rect((0, 0), painter.size))
        corner = (shown.x - x0) / zoom, (shown.y - y0) / zoom
        size = shown.width / zoom, shown.height / zoom
        part = pygame.Rect(corner, size).clip(canvas.get_rect())
        if 0 not in (*part.size, *shown.size):
            picture = pygame.transform.scale(canvas.subsurface(part), shown.size)
            painter.sheet(picture, shown.topleft)
