"""The window: handles events, advances the session and draws a frame, 60 times per second."""

import time
from contextlib import ExitStack

import pygame

from jostle_lab import interrupt, panels
from jostle_lab.act.view import draw_explanation, draw_preview, draw_selection
from jostle_lab.draw.camera import Size
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.screen import Screen
from jostle_lab.gui.host import Gui
from jostle_lab.gui.input import Input
from jostle_lab.gui.style import arrange
from jostle_lab.session import Session
from jostle_lab.simulate.simulation import Simulation

SIZE = (1280, 720)
FRAME_RATE = 60  # frames per second
HIDDEN_FRAME_RATE = 10  # frames per second while the window is minimised and nothing is drawn
PANEL_INTERVAL = 0.03  # seconds between two builds of the panels without events
LIVELY = 3  # frames after an event in which panels are built: ImGui reacts in the next one
LONGEST_FRAME = 0.25  # seconds; longer if the machine was suspended, or the window was dragged


class Window:
    """A resizable window with one session.

    `run` loops until the user quits, or for a number of steps; tests call `frame`. The size is in
    points.
    """

    def __init__(
        self,
        simulation: Simulation,
        size: Size = SIZE,
        steps: int | None = None,
        *,
        synchronous: bool = False,
    ) -> None:
        self.screen = Screen(size)
        self.session = Session(simulation, self.painter.size, synchronous=synchronous)
        self.builders: list[panels.Builder] = [panels.build]  # of panels and menus, in order
        self.session.view_options.panels = False  # so that the scene fills the window at first
        arrange(self.session, *self.screen.size, self.screen.scale)
        self.gui = Gui(self.screen.opengl)
        self.session.engine.last_step = self._last_step = steps
        self.input = Input(self.session)
        self._seen = True
        self._lively = LIVELY  # frames in which panels are built
        self._since_panels = 0.0

    @property
    def painter(self) -> Painter:
        return self.screen.painter

    def run(self) -> None:
        """Show frames until the window is closed."""
        clock, last = pygame.time.Clock(), time.perf_counter()
        self.session.files.mention_autosave()
        try:
            while self.session.open:
                interrupt.check()
                clock.tick(FRAME_RATE if self._seen else HIDDEN_FRAME_RATE)
                now = time.perf_counter()  # more precise than the clock
                self.frame(now - last)
                last = now
        except KeyboardInterrupt:
            self.session.engine.abandon()  # a step may take many seconds
            raise
        finally:
            self.close()

    def close(self) -> None:
        with ExitStack() as closing:  # after an exception, the rest is closed, too
            closing.callback(self.screen.close)
            closing.callback(self.gui.close)
            closing.callback(self.session.close)

    def frame(self, elapsed: float) -> None:
        """Run one frame, `elapsed` seconds after the last."""
        elapsed = min(elapsed, LONGEST_FRAME)
        self.session.messages.now += elapsed
        self.take_events()
        self.input.hold(elapsed)
        self.session.advance(elapsed)
        if self._last_step is not None and self.session.engine.steps >= self._last_step:
            self.session.quit()
        caption = f"jostle · {self.session.engine.scene}"
        if pygame.display.get_caption()[0] != caption:
            pygame.display.set_caption(caption)
        if self.screen.full != self.session.full_screen:
            self.screen.toggle_full()
            self._resize()
        if self._seen:
            self._draw(elapsed)

    # Events

    def take_events(self) -> None:
        for event in pygame.event.get():
            self._handle(event)

    def _handle(self, event: pygame.event.Event) -> None:
        taken = self.gui.handle(event)
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

    # Drawing

    def _resize(self) -> None:
        if self.screen.fit():
            self.session.camera.resize(self.painter.size)

    def _draw(self, elapsed: float) -> None:
        start = time.perf_counter()
        self.session.draw(self.painter)
        self._draw_overlays()
        self.screen.end_scene()
        drawn = time.perf_counter()
        self._draw_panels(elapsed)
        panel_time = time.perf_counter() - drawn
        self.session.runner.statistics.measure(draw=(drawn - start) * 1e3, panels=panel_time * 1e3)
        self.screen.show()

    def _draw_overlays(self) -> None:
        """Draw the selection, the current drag, and the shapes of an explanation."""
        session, interaction, camera = self.session, self.session.interaction, self.session.camera
        draw_selection(self.painter, session.frame, interaction.selection, camera)
        if interaction.preview is not None:
            draw_preview(self.painter, interaction.preview, camera)
        if session.explanation is not None:
            draw_explanation(self.painter, session.explanation, camera)

    def _draw_panels(self, elapsed: float) -> None:
        """Draw panels and menus; without events they are not built in every frame."""
        if not self.builders:
            return
        self._since_panels += elapsed
        if not self._lively and self._since_panels < PANEL_INTERVAL:
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
    x, y = event.pos
    return pygame.event.Event(event.type, {**event.dict, "pos": (x * scale, y * scale)})
