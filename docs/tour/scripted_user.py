"""Scripted user input in a window without a display.

Time is counted in frames of 1/60 s, not by a clock, so the same script gives the same pictures.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import pygame

from jostle_lab.draw.palette import ACCENT, GROUND, TEXT
from jostle_lab.simulate.frame import Point
from jostle_lab.window import Window

FRAME = 1 / 60  # seconds
FILMED = 2  # frames per frame of a video
UNRECORDED = 6  # frames per drawn frame outside a video; panels and trails need some
LEFT, RIGHT = 1, 3
Pixel = tuple[float, float]
Show = Callable[[pygame.Surface], None]

_ARROW = ((0, 0), (0, 17), (4, 13.4), (6.6, 19.6), (9.6, 18.4), (7, 12.3), (12.3, 12.3))
_FINE = 4  # scale at which the arrow is drawn, for antialiasing


class ScriptedUser:
    """Waits, moves the mouse, presses buttons and keys in a window.

    `film` is called with each frame of a video, from `start_recording` on.
    """

    def __init__(self, window: Window, film: Show | None = None) -> None:
        self.window, self.session = window, window.session  # that of the window
        self._film, self._recording = film, False
        self._frames = 0
        self._pointing = self._pressing = False
        self._mouse: Pixel = self.session.interaction.cursor
        pygame.event.clear()

    # Time

    def wait(self, seconds: float, every: int = UNRECORDED) -> None:
        """Advance the time; outside a video only some frames are drawn."""
        for _ in range(round(seconds / FRAME)):
            self._tick(every)

    def live(self, seconds: float) -> None:
        """Run in real time, to show the speed."""
        end = last = time.perf_counter()
        end += seconds
        while last < end:
            time.sleep(max(last + FRAME - time.perf_counter(), 0.0))
            now = time.perf_counter()
            self.window.frame(now - last)
            last = now

    def look(self, pictures: int = 3) -> None:
        """Draw a few frames outside the video: panels need two to settle."""
        for _ in range(pictures):
            self.window.frame(FRAME)

    def start_recording(self) -> None:
        """Begin the video, if there is one."""
        self._recording = self._film is not None

    def picture(self) -> pygame.Surface:
        """Return the frame, with the pointer."""
        canvas = self.window.screen.canvas()
        if self._pointing:
            x, y = self._mouse
            if self._pressing:
                pygame.draw.aacircle(canvas, ACCENT, (x, y), 11, 2)
            canvas.blit(_pointer(), (x, y))
        return canvas

    def _tick(self, every: int = UNRECORDED) -> None:
        self._frames += 1
        if self._frames % (FILMED if self._recording else every):
            self.session.messages.now += FRAME
            self.session.advance(FRAME)
            return
        self.window.frame(FRAME)
        if self._recording and self._film is not None:
            self._film(self.picture())

    # Mouse and keys

    def pixel(self, point: Point) -> Pixel:
        """Return the pixel of a world point."""
        ((x,), (y,)) = self.session.camera.to_screen(np.array([point], np.float64))
        return float(x), float(y)

    def mark(self, name: str) -> Pixel | None:
        """Return the centre of a widget; None if it does not exist."""
        rect = self.window.gui.marks.get(name)
        return rect and (float(rect.centerx), float(rect.centery))

    def move(self, to: Pixel, seconds: float = 0.5) -> None:
        """Move the mouse, with smooth acceleration."""
        start, count = self._mouse, max(round(seconds / FRAME), 1)
        for k in range(1, count + 1):
            share = k / count
            share *= share * (3 - 2 * share)
            self._point(
                (start[0] + share * (to[0] - start[0]), start[1] + share * (to[1] - start[1]))
            )
            self._tick(FILMED)
        self._point(to)

    def press(self, button: int = LEFT, mod: int = 0) -> None:
        self._button(pygame.MOUSEBUTTONDOWN, button, mod)

    def release(self, button: int = LEFT, mod: int = 0) -> None:
        self._button(pygame.MOUSEBUTTONUP, button, mod)

    def click(self, at: Pixel, button: int = LEFT, mod: int = 0, seconds: float = 0.3) -> None:
        self.move(at, seconds)
        self.press(button, mod)
        self.release(button, mod)

    def click_on(self, name: str) -> None:
        """Click on a widget, if it exists."""
        place = self.mark(name)
        if place is not None:
            self.click(place, seconds=0.1)
            self.look()

    def drag(self, start: Pixel, end: Pixel, seconds: float = 0.6) -> None:
        self.move(start, seconds / 2)
        self.press()
        self.move(end, seconds)
        self.release()

    def key(self, key: int) -> None:
        for kind in (pygame.KEYDOWN, pygame.KEYUP):
            _post(kind, key=key, mod=0)
        self.look(1)

    def hide_pointer(self) -> None:
        """Hide the pointer in all further frames."""
        self._pointing = False
        _post(pygame.WINDOWLEAVE)
        self.window.take_events()

    def _point(self, to: Pixel) -> None:
        self._pointing, self._mouse = True, to
        _post(pygame.MOUSEMOTION, pos=to, rel=(0, 0), buttons=(0, 0, 0))
        self.window.take_events()

    def _button(self, kind: int, button: int, mod: int) -> None:
        self._pressing = kind == pygame.MOUSEBUTTONDOWN
        _post(kind, pos=self._mouse, button=button, mod=mod)
        self.look(1)


def _post(kind: int, **facts: Any) -> None:
    pygame.event.post(pygame.event.Event(kind, **facts))


@lru_cache(maxsize=1)
def _pointer() -> pygame.Surface:
    """Return an arrow with its tip in the upper left corner."""
    fine = pygame.Surface((16 * _FINE, 24 * _FINE), pygame.SRCALPHA)
    corners = [((x + 1) * _FINE, (y + 1) * _FINE) for x, y in _ARROW]
    pygame.draw.polygon(fine, TEXT, corners)
    pygame.draw.polygon(fine, GROUND, corners, _FINE)
    return pygame.transform.smoothscale(fine, (16, 24))
