"""The interactive loop: events to acts, real time to steps, a picture a frame."""

from __future__ import annotations

import time

import pygame

from jostle.app.acts import ACTS
from jostle.app.camera import Size
from jostle.app.controls import PANNING, Action, action_of
from jostle.app.helping import draw_help
from jostle.app.notices import draw_hint, draw_notice
from jostle.app.readout import SPACE, Readout
from jostle.app.session import Session
from jostle.app.simulation import Simulation
from jostle.app.software import SoftwarePainter

SIZE = (1280, 720)
FRAMES_A_SECOND = 60
PAN_SPEED = 700.0  # pixels a second while an arrow key is down
ZOOM_STEP = 1.15  # for one notch of the wheel
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
        self._held_keys: set[Action] = set()
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
        self._pan(elapsed)
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
        elif event.type == pygame.KEYDOWN:
            self._act(action_of(event.key))
        elif event.type == pygame.KEYUP:
            self._held_keys.discard(action_of(event.key) or Action.QUIT)
        elif event.type == pygame.WINDOWFOCUSLOST:
            self._held_keys.clear()  # their KEYUP goes to another window
        elif event.type in (pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED):
            self._resize()
        else:
            self._handle_mouse(event)

    def _handle_mouse(self, event: pygame.event.Event) -> None:
        session = self.session
        if event.type == pygame.MOUSEMOTION:
            session.cursor = event.pos
        elif event.type == pygame.MOUSEWHEEL:
            turns = getattr(event, "precise_y", event.y)
            session.camera.zoom_at(session.cursor, ZOOM_STEP**turns)
        elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            session.cursor = event.pos
            session.grab()
        elif event.type == pygame.MOUSEBUTTONUP and event.button == 1:
            session.cursor = event.pos
            session.throw()

    def _act(self, action: Action | None) -> None:
        if action in PANNING:
            self._held_keys.add(action)
        elif action is not None:
            ACTS[action](self.session)

    # The picture

    def _pan(self, elapsed: float) -> None:
        for action in self._held_keys:
            x, y = PANNING[action]
            way = PAN_SPEED * elapsed
            self.session.camera.pan((x * way, y * way))

    def _resize(self) -> None:
        self.screen = pygame.display.get_surface() or self.screen
        if self.screen.get_size() != self.painter.size:
            self.painter.resize(self.screen.get_size())
            self.session.camera.resize(self.painter.size)

    def _draw(self) -> None:
        start = time.perf_counter()
        session, painter = self.session, self.painter
        session.draw(painter)
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
