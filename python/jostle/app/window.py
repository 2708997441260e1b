"""The interactive loop: events to acts, real time to steps, a picture a frame."""

from __future__ import annotations

import time

import pygame

from jostle.app.camera import Size
from jostle.app.helping import draw_help
from jostle.app.input import Input
from jostle.app.notices import draw_hint, draw_notice
from jostle.app.readout import SPACE, Readout
from jostle.app.session import Session
from jostle.app.simulation import Simulation
from jostle.app.software import SoftwarePainter
from jostle.app.tools_view import draw_hands

SIZE = (1280, 720)
FRAMES_A_SECOND = 60
LONGEST_FRAME = 0.25  # seconds; a longer one was a machine asleep, or a window being dragged


class Window:
    """A resizable window on one session.

    `run` loops until the user quits; a test calls `frame` with the seconds it likes.

    Parameters
    ----------
    simulation
        What to show.
    size
        Width and height in pixels.
    steps
        Close after so many steps; None to go on.
    """

    def __init__(self, simulation: Simulation, size: Size = SIZE, steps: int | None = None) -> None:
        pygame.display.init()
        pygame.display.set_caption(f"jostle · {simulation.scene}")
        self.screen = pygame.display.set_mode(size, pygame.RESIZABLE)
        self.session = Session(simulation, self.screen.get_size(), left=SPACE)
        self.painter = SoftwarePainter(self.screen.get_size())
        self.readout = Readout()
        self._steps_left = steps
        self.input = Input(self.session)
        self._rate: float | None = None

    def run(self) -> None:
        """Show frames until the window is closed."""
        clock, last = pygame.time.Clock(), time.perf_counter()
        try:
            while self.session.open:
                clock.tick(FRAMES_A_SECOND)
                self._rate = clock.get_fps() or None
                now = time.perf_counter()  # the clock's own answer is in whole milliseconds
                self.frame(now - last)
                last = now
        finally:
            self.session.close()
            pygame.display.quit()

    def frame(self, elapsed: float) -> None:
        """Do everything that belongs to one frame, `elapsed` seconds after the last."""
        elapsed = min(elapsed, LONGEST_FRAME)
        self.session.now += elapsed
        for event in pygame.event.get():
            self._handle(event)
        self.input.hold(elapsed)
        steps = self.session.advance(elapsed)
        if steps:
            self.readout.measure(**self.session.frame.facts.stage_times)
        if self._steps_left is not None and self.session.engine.steps >= self._steps_left:
            self.session.quit()
        self._draw()

    # Events

    def _handle(self, event: pygame.event.Event) -> None:
        if event.type == pygame.QUIT:
            self.session.quit()
        elif event.type in (pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED):
            self._resize()
        else:
            self.input.handle(event)

    # The picture

    def _resize(self) -> None:
        self.screen = pygame.display.get_surface() or self.screen
        if self.screen.get_size() != self.painter.size:
            self.painter.resize(self.screen.get_size())
            self.session.camera.resize(self.painter.size)

    def _draw(self) -> None:
        start = time.perf_counter()
        session, painter = self.session, self.painter
        session.draw(painter)
        draw_hands(painter, session.frame, session.selection, session.tools.preview, session.camera)
        if painter.size[0] >= 2 * SPACE:  # else it would hide the scene
            self.readout.draw(
                painter,
                session.engine,
                ("frames a second", self._rate),
                session.now,
                paused=session.paused,
            )
        if session.notice:
            draw_notice(painter, session.notice)
        if session.shown.help:
            draw_help(painter)
        draw_hint(painter)
        self.readout.measure(draw=(time.perf_counter() - start) * 1e3)
        self.screen.blit(painter.canvas(), (0, 0))
        pygame.display.flip()
