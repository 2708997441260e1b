"""The interactive loop: events to actions, real time to steps, a picture a frame."""

from __future__ import annotations

import time

import pygame

from jostle.app.camera import Size
from jostle.app.controls import PANNING, Action, action_of
from jostle.app.hand import Hand
from jostle.app.overlays import TreeView
from jostle.app.pace import Pace
from jostle.app.picture import Picture
from jostle.app.readout import method_name
from jostle.app.simulation import Point, Simulation

SIZE = (1280, 720)
FRAMES_A_SECOND = 60
PAN_SPEED = 700.0  # pixels a second while an arrow key is down
ZOOM_STEP = 1.15  # for one notch of the wheel
REACH = 4.0  # pixels around the cursor in which a small particle can still be picked up
NOTICE_TIME = 3.0  # seconds
LONGEST_FRAME = 0.25  # seconds; a longer one was a machine asleep, or a window being dragged


class Window:
    """A resizable window on one simulation.

    `run` loops until the user quits; a test calls `frame` with the seconds it likes.

    Parameters
    ----------
    simulation
        What to show; the window steps it.
    steps
        Close after so many steps; None to go on.
    """

    def __init__(self, simulation: Simulation, size: Size = SIZE, steps: int | None = None) -> None:
        pygame.display.init()
        pygame.display.set_caption(f"jostle · {simulation.scene}")
        self.screen = pygame.display.set_mode(size, pygame.RESIZABLE)
        self.simulation = simulation
        self.picture = Picture(self.screen.get_size(), simulation)
        self.picture.tree_view = TreeView.OUTLINE
        self.hand = Hand()
        self.cursor: Point = (size[0] / 2, size[1] / 2)
        self.paused = False
        self.open = True
        self._pace = Pace(simulation.time_step)
        self._steps_left = steps
        self._now = 0.0
        self._held_keys: set[Action] = set()
        self._notice, self._notice_until = "", 0.0
        self._rate: float | None = None

    def run(self) -> None:
        """Show frames until the window is closed."""
        clock, last = pygame.time.Clock(), time.perf_counter()
        try:
            while self.open:
                clock.tick(FRAMES_A_SECOND)
                self._rate = clock.get_fps() or None
                now = time.perf_counter()  # the clock's own answer is in whole milliseconds
                self.frame(now - last)
                last = now
        finally:
            pygame.display.quit()

    def frame(self, elapsed: float) -> None:
        """Do everything that belongs to one frame, `elapsed` seconds after the last."""
        elapsed = min(elapsed, LONGEST_FRAME)
        self._now += elapsed
        for event in pygame.event.get():
            self._handle(event)
        self._pan(elapsed)
        self.hand.follow(self._at_cursor(), self._now)
        if not self.paused:
            self._pace.advance(elapsed, self._step)
        self._draw()

    # Time

    def _step(self) -> None:
        if self._steps_left == 0:
            self.open = False
            return
        self.hand.pull(self.simulation)
        self.simulation.step()
        self.picture.readout.measure(**self.simulation.stage_times)
        if self._steps_left is not None:
            self._steps_left -= 1

    # Events

    def _handle(self, event: pygame.event.Event) -> None:
        if event.type == pygame.QUIT:
            self.open = False
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
        if event.type == pygame.MOUSEMOTION:
            self.cursor = event.pos
        elif event.type == pygame.MOUSEWHEEL:
            turns = getattr(event, "precise_y", event.y)
            self.picture.camera.zoom_at(self.cursor, ZOOM_STEP**turns)
        elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.cursor = event.pos
            reach = REACH / self.picture.camera.scale
            self.hand.grab(self.simulation, self._at_cursor(), reach, self._now)
        elif event.type == pygame.MOUSEBUTTONUP and event.button == 1:
            self.cursor = event.pos
            self.hand.follow(self._at_cursor(), self._now)
            self.hand.release(self.simulation)

    def _act(self, action: Action | None) -> None:
        if action is None:
            return
        if action in PANNING:
            self._held_keys.add(action)
            return
        {
            Action.PAUSE: self._toggle_pause,
            Action.STEP: self._single_step,
            Action.RESTART: self._restart,
            Action.METHOD: self._switch_method,
            Action.TREE: self._cycle_tree,
            Action.HOME: self.picture.camera.home,
            Action.HELP: self._toggle_help,
            Action.QUIT: self._quit,
        }[action]()

    def _toggle_pause(self) -> None:
        self.paused = not self.paused

    def _single_step(self) -> None:
        self.paused = True
        self._step()

    def _restart(self) -> None:
        self.hand.drop()
        self.simulation.restart()
        self.picture.restart()

    def _switch_method(self) -> None:
        refusal = self.simulation.switch_method()
        self.picture.readout.forget()
        self._say(refusal or f"Now {method_name(self.simulation.method)}")

    def _cycle_tree(self) -> None:
        self.picture.tree_view = self.picture.tree_view.next()
        self._say(f"Tree: {self.picture.tree_view.value}")

    def _toggle_help(self) -> None:
        self.picture.help = not self.picture.help

    def _quit(self) -> None:
        self.open = False

    def _say(self, notice: str) -> None:
        self._notice, self._notice_until = notice, self._now + NOTICE_TIME

    # The picture

    def _at_cursor(self) -> Point:
        return self.picture.camera.to_world(self.cursor)

    def _pan(self, elapsed: float) -> None:
        for action in self._held_keys:
            x, y = PANNING[action]
            way = PAN_SPEED * elapsed
            self.picture.camera.pan((x * way, y * way))

    def _resize(self) -> None:
        self.screen = pygame.display.get_surface() or self.screen
        if self.screen.get_size() != self.picture.canvas.get_size():
            self.picture.resize(self.screen.get_size())

    def _draw(self) -> None:
        self.picture.draw(
            self.simulation,
            ("frames a second", self._rate),
            self._now,
            paused=self.paused,
            notice=self._notice if self._now < self._notice_until else "",
        )
        self.picture.draw_hint()
        self.screen.blit(self.picture.canvas, (0, 0))
        pygame.display.flip()
