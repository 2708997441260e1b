"""The interactive loop: events to acts, real time to steps, a picture a frame."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable
from contextlib import ExitStack

import pygame

from jostle import interrupt
from jostle.app.act.input import Input
from jostle.app.draw.backdrop import Backdrop
from jostle.app.draw.camera import Camera, Size
from jostle.app.draw.helping import draw_help
from jostle.app.draw.notices import draw_hint, draw_notice, draw_recording
from jostle.app.draw.painter import Painter
from jostle.app.draw.readout import SPACE, Readout
from jostle.app.draw.renderers import FAILURES, Screen
from jostle.app.draw.tools_view import draw_hands
from jostle.app.draw.why_view import draw_why
from jostle.app.gui import host as gui
from jostle.app.gui.host import Gui
from jostle.app.gui.layout import arrange
from jostle.app.session import Session
from jostle.app.simulate.simulation import Simulation

SIZE = (1280, 720)
FRAMES_A_SECOND = 60
FRAMES_UNSEEN = 10  # a second, while the window is minimised: the world goes on, nothing is drawn
PANELS_EVERY = 0.03  # seconds: nobody reads numbers faster, and the panels cost as much as a scene
LIVELY = 3  # frames after an event in which panels are built at once: ImGui answers in the next one
LONGEST_FRAME = 0.25  # seconds; a longer one was a machine asleep, or a window being dragged


Builder = Callable[[Session, Gui], None]


class Window:
    """A resizable window on one session.

    `run` loops until the user quits; a test calls `frame` with the seconds it likes.

    Parameters
    ----------
    simulation
        What to show.
    size
        Width and height in points, what the mouse is measured in.
    steps
        Close after so many steps; None to go on.
    renderer
        One of `settings.RENDERERS`.

    Attributes
    ----------
    builders
        Build panels and menus each frame, in this order.
    """

    def __init__(
        self,
        simulation: Simulation,
        size: Size = SIZE,
        steps: int | None = None,
        renderer: str = "auto",
    ) -> None:
        self.screen = Screen(size, renderer)
        self.session = Session(simulation, self.painter.size, left=SPACE)
        self.readout = Readout()
        self.builders = _builders()
        if self.builders:
            arrange(self.session, *self.screen.size, self.screen.scale)
        self.gui = Gui(self.painter) if gui.available() else None
        self._backdrop = Backdrop()
        self.session.engine.last_step = self._last_step = steps
        self.input = Input(self.session)
        self._rate: float | None = None
        self._seen = True
        self._lively = LIVELY  # frames for which panels are built at once
        self._since_panels = 0.0

    @property
    def painter(self) -> Painter:
        """Return who draws."""
        return self.screen.painter

    def run(self) -> None:
        """Show frames until the window is closed."""
        clock, last = pygame.time.Clock(), time.perf_counter()
        try:
            while self.session.open:
                interrupt.check()
                clock.tick(FRAMES_A_SECOND if self._seen else FRAMES_UNSEEN)
                self._rate = clock.get_fps() or None
                now = time.perf_counter()  # the clock's own answer is in whole milliseconds
                self.frame(now - last)
                last = now
        except KeyboardInterrupt:
            self.session.engine.abandon()  # a step may take many seconds
            raise
        finally:
            self.close()

    def close(self) -> None:
        """End everything in an orderly way."""
        with ExitStack() as closing:  # whatever fails, the rest is closed as well
            closing.callback(self.screen.close)
            if self.gui is not None:
                closing.callback(self.gui.close)
            closing.callback(self._backdrop.close)
            closing.callback(self.session.close)

    def frame(self, elapsed: float) -> None:
        """Do everything that belongs to one frame, `elapsed` seconds after the last."""
        elapsed = min(elapsed, LONGEST_FRAME)
        self.session.now += elapsed
        self.take_events()
        self.input.hold(elapsed)
        steps = self.session.advance(elapsed)
        if steps:
            self.readout.measure(**self.session.frame.facts.stage_times)
        if self._last_step is not None and self.session.engine.steps >= self._last_step:
            self.session.quit()
        caption = f"jostle · {self.session.engine.scene}"
        if pygame.display.get_caption()[0] != caption:
            pygame.display.set_caption(caption)
        if self._seen:
            self._draw(elapsed)

    # Events

    def take_events(self) -> None:
        """Act on everything that has happened to the window."""
        for event in pygame.event.get():
            self._handle(event)

    def _handle(self, event: pygame.event.Event) -> None:
        taken = self.gui is not None and self.gui.handle(event)
        if taken or event.type != pygame.MOUSEMOTION:
            self._lively = LIVELY
        if taken:
            return
        if event.type == pygame.QUIT:
            self.session.quit()
        elif event.type in (pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED):
            self._resize()
        elif event.type in (pygame.WINDOWMINIMIZED, pygame.WINDOWHIDDEN):
            self._seen = False
        elif event.type in (pygame.WINDOWRESTORED, pygame.WINDOWSHOWN, pygame.WINDOWMAXIMIZED):
            self._seen = True
            self._resize()
        else:
            self.input.handle(_in_pixels(event, self.screen.scale))

    # The picture

    def _resize(self) -> None:
        if self.screen.fit():
            self.session.camera.resize(self.painter.size)

    def _draw(self, elapsed: float) -> None:
        try:
            self._draw_all(elapsed)
        except FAILURES:
            if self.painter.name == "software":
                raise
            self._fall_back()
            self._draw_all(elapsed)

    def _fall_back(self) -> None:
        """Go on without a graphics card that has failed; the simulation does not notice."""
        if self.gui is not None:
            self.gui.close()
        self.screen.fall_back()
        self.session.camera.resize(self.painter.size)
        if self.gui is not None:
            self.gui = Gui(self.painter)
        self._lively = LIVELY
        self.session.say("The graphics card has failed; drawing goes on without it.")

    def _draw_all(self, elapsed: float) -> None:
        start = time.perf_counter()
        self._draw_scene()
        self._draw_words()
        drawn = time.perf_counter()
        self.readout.measure(draw=(drawn - start) * 1e3)
        self._draw_panels(elapsed)
        panels = time.perf_counter() - drawn
        self.session.statistics.measure(draw=(drawn - start) * 1e3, panels=panels * 1e3)
        self.screen.show()

    def _draw_scene(self) -> None:
        session = self.session
        if session.race:  # of few particles
            session.draw(self.painter)
            return
        frame, shown, picture = session.frame, copy.copy(session.shown), session.picture

        def draw(painter: Painter, camera: Camera) -> None:
            picture.draw(painter, frame, camera, shown)

        self._backdrop.draw(self.painter, session.camera, len(frame), draw)

    def _draw_words(self) -> None:
        session, painter = self.session, self.painter
        draw_hands(painter, session.frame, session.selection, session.tools.preview, session.camera)
        if session.why is not None:
            draw_why(painter, session.why, session.camera)
        panels = self.gui is not None and self.builders and session.shown.panels
        if not panels and painter.size[0] >= 2 * SPACE:  # else it would hide the scene
            self.readout.draw(
                painter,
                session.engine,
                ("frames a second", self._rate),
                session.now,
                paused=session.paused,
            )
        if session.notice:
            camera = session.camera
            middle = (camera.left + painter.size[0] - camera.right) / 2
            draw_notice(painter, session.notice, middle)
        if session.shown.help:
            draw_help(painter)
        else:
            draw_hint(painter, session.camera.right)
        if session.files.recording is not None:
            draw_recording(painter, session.files.recording.seconds, session.camera.right)

    def _draw_panels(self, elapsed: float) -> None:
        """Draw panels and menus; without events they are built anew only every other frame."""
        if self.gui is None or not self.builders:
            return
        self._since_panels += elapsed
        if not self._lively and self._since_panels < PANELS_EVERY:
            self.gui.again()
            return
        with interrupt.held():  # an interrupted frame leaves ImGui in an invalid state
            self.gui.begin(self._since_panels, self.screen.size, self.screen.scale)
            for build in self.builders:
                build(self.session, self.gui)
            self.gui.end()
        self._lively, self._since_panels = max(self._lively - 1, 0), 0.0


def _in_pixels(event: pygame.event.Event, scale: float) -> pygame.event.Event:
    """Return a mouse event in pixels of the canvas."""
    if scale == 1.0 or not hasattr(event, "pos"):
        return event
    moved = {
        name: tuple(part * scale for part in getattr(event, name))
        for name in ("pos", "rel")
        if hasattr(event, name)
    }
    return pygame.event.Event(event.type, {**event.dict, **moved})


def _builders() -> list[Builder]:
    """Return what builds panels and menus, where ImGui is there."""
    if not gui.available():
        return []
    from jostle.app import panels  # they cannot do without it
    from jostle.app.panels import menus

    return [panels.build, menus.build]
