"""Translation of mouse and key events into calls of a session."""

import math
from pathlib import Path

import pygame

from jostle_lab.gui.keymap import COMMANDS, HANDLERS, HELD, PANNING, command_of
from jostle_lab.session import Session
from jostle_lab.simulate.frame import Point

PAN_SPEED = 700.0  # pixels per second while an arrow key is down
ZOOM_STEP = 1.15  # for one notch of the wheel
CLICK = 4.0  # pixels: a button that moves less while it is down was a click
LEFT, MIDDLE, RIGHT = 1, 2, 3


class Input:
    """Handles events; `hold` applies keys that are down."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._down: set[str] = set()  # those of `HELD`
        self._panning: dict[int, Point] = {}  # buttons that pan, and where each was pressed
        self._moved = False  # whether the view was panned since then

    def handle(self, event: pygame.event.Event) -> None:
        """Handle one event of mouse or keys; others are ignored."""
        interaction = self._session.interaction
        before, interaction.cursor = interaction.cursor, event.dict.get("pos", interaction.cursor)
        if event.type == pygame.KEYDOWN:
            self._press_key(event)
        elif event.type == pygame.KEYUP:
            self._release_key(COMMANDS.get((event.key, 0)))
        elif event.type == pygame.DROPFILE:
            self._session.files.load(Path(event.file))
        elif event.type == pygame.WINDOWFOCUSLOST:
            for command in list(self._down):  # the window gets no events without focus
                self._release_key(command)
        elif event.type == pygame.MOUSEMOTION:
            self._move(before, event.pos)
        elif event.type == pygame.MOUSEWHEEL:
            turns = getattr(event, "precise_y", event.y)
            self._session.camera.zoom_at(interaction.cursor, ZOOM_STEP**turns)
        elif event.type == pygame.MOUSEBUTTONDOWN:
            self._press_button(event)
        elif event.type == pygame.MOUSEBUTTONUP:
            self._release_button(event)

    def hold(self, elapsed: float) -> None:
        """Apply the keys that are down; called once per frame."""
        for command in self._down & PANNING.keys():
            x, y = PANNING[command]
            distance = PAN_SPEED * elapsed
            self._session.camera.pan((x * distance, y * distance))
        if "attract" in self._down:
            self._session.interaction.attractors.attract_to_cursor(
                self._session.interaction.at_cursor()
            )

    # Keys

    def _press_key(self, event: pygame.event.Event) -> None:
        command = command_of(event.key, event.mod)
        if command in HELD:
            self._down.add(command)
        elif command is not None:
            HANDLERS[command](self._session)

    def _release_key(self, command: str | None) -> None:
        if command in self._down:
            self._down.discard(command)
            if command == "attract":
                self._session.interaction.attractors.attract_to_cursor(None)

    # Mouse

    def _move(self, before: Point, place: Point) -> None:
        session = self._session
        far = (math.dist(place, start) > CLICK for start in self._panning.values())
        if self._moved or any(far):
            # From where the button was pressed, so that this point stays under the cursor.
            start = before if self._moved else next(iter(self._panning.values()))
            if self._panning:
                session.camera.pan((start[0] - place[0], start[1] - place[1]))
                self._moved = True
        session.interaction.drag_on()

    def _press_button(self, event: pygame.event.Event) -> None:
        session = self._session
        if event.button == LEFT:
            session.interaction.press(
                add=bool(getattr(event, "mod", pygame.key.get_mods()) & pygame.KMOD_SHIFT)
            )
        elif event.button in (MIDDLE, RIGHT):
            self._panning[event.button] = event.pos
            self._moved = False

    def _release_button(self, event: pygame.event.Event) -> None:
        session = self._session
        if event.button == LEFT:
            session.interaction.release(throw=not session.runner.paused)
        elif self._panning.pop(event.button, None) is not None:
            moved, self._moved = self._moved, bool(self._panning) and self._moved
            if event.button == RIGHT and not moved:
                session.interaction.open_menu()
