"""Translation of mouse and key events into actions on a session."""

from __future__ import annotations

import math

import pygame

from jostle.app.act.acts import ACTS
from jostle.app.act.controls import HELD, PANNING, Action, action_of
from jostle.app.session import Session
from jostle.app.simulate.simulation import Point

PAN_SPEED = 700.0  # pixels a second while an arrow key is down
ZOOM_STEP = 1.15  # for one notch of the wheel
CLICK = 4.0  # pixels: a button that moves less while it is down was a click
LEFT, MIDDLE, RIGHT = 1, 2, 3


class Input:
    """Takes events one by one; `hold` does what lasts while a key is down."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._down: set[Action] = set()  # those of `HELD`
        self._panning: dict[int, Point] = {}  # buttons that pan: where they went down
        self._moved = False  # whether the picture was panned since

    def handle(self, event: pygame.event.Event) -> None:
        """Act on one event of mouse or keys; others are nothing to it."""
        if event.type == pygame.KEYDOWN:
            self._press_key(event)
        elif event.type == pygame.KEYUP:
            self._release_key(action_of(event.key))
        elif event.type == pygame.WINDOWFOCUSLOST:
            self.let_go()
        elif event.type == pygame.MOUSEMOTION:
            self._move(event.pos)
        elif event.type == pygame.MOUSEWHEEL:
            turns = getattr(event, "precise_y", event.y)
            self._session.camera.zoom_at(self._session.cursor, ZOOM_STEP**turns)
        elif event.type == pygame.MOUSEBUTTONDOWN:
            self._press_button(event)
        elif event.type == pygame.MOUSEBUTTONUP:
            self._release_button(event)

    def hold(self, elapsed: float) -> None:
        """Once a frame: do what lasts as long as a key is down."""
        for action in self._down & PANNING.keys():
            x, y = PANNING[action]
            way = PAN_SPEED * elapsed
            self._session.camera.pan((x * way, y * way))
        if Action.PULL in self._down:
            self._session.pulls.pull_to(self._session.at_cursor())

    def let_go(self) -> None:
        """Let go of every key: the events that say so go to another window."""
        for action in list(self._down):
            self._release_key(action)

    # Keys

    def _press_key(self, event: pygame.event.Event) -> None:
        action = action_of(event.key)
        if action in HELD:
            self._down.add(action)
        elif action is not None:
            ACTS[action](self._session)

    def _release_key(self, action: Action | None) -> None:
        if action in self._down:
            self._down.discard(action)
            if action is Action.PULL:
                self._session.pulls.pull_to(None)

    # Mouse

    def _move(self, place: Point) -> None:
        session = self._session
        before, session.cursor = session.cursor, place
        far = (math.dist(place, start) > CLICK for start in self._panning.values())
        if self._moved or any(far):
            # All the way from where the button went down, so that the ground stays in hand.
            start = before if self._moved else next(iter(self._panning.values()))
            if self._panning:
                session.camera.pan((start[0] - place[0], start[1] - place[1]))
                self._moved = True
        session.drag_on()

    def _press_button(self, event: pygame.event.Event) -> None:
        session = self._session
        session.cursor = event.pos
        if event.button == LEFT:
            session.press(add=bool(_modifiers(event) & pygame.KMOD_SHIFT))
        elif event.button in (MIDDLE, RIGHT):
            self._panning[event.button] = event.pos
            self._moved = False

    def _release_button(self, event: pygame.event.Event) -> None:
        session = self._session
        session.cursor = event.pos
        if event.button == LEFT:
            session.release()
        elif self._panning.pop(event.button, None) is not None:
            moved, self._moved = self._moved, bool(self._panning) and self._moved
            if event.button == RIGHT and not moved:
                session.open_menu()


def _modifiers(event: pygame.event.Event) -> int:
    """Return the modifier keys: those of the event where it says so, else those of the moment."""
    modifiers: int = event.mod if hasattr(event, "mod") else pygame.key.get_mods()
    return modifiers
