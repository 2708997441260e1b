"""One table of keys: the window acts on it, the help overlay and the documents show it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

import pygame


class Action(Enum):
    """What a key may mean."""

    PAUSE = auto()
    STEP = auto()
    RESTART = auto()
    METHOD = auto()
    TREE = auto()
    LEFT = auto()
    RIGHT = auto()
    UP = auto()
    DOWN = auto()
    HOME = auto()
    HELP = auto()
    QUIT = auto()


@dataclass(frozen=True)
class Control:
    """One line of the table. Mouse gestures have no keys: `window` knows them, help shows them."""

    label: str
    meaning: str
    keys: dict[int, Action]


CONTROLS = (
    Control("left mouse", "pick up a particle, let go to throw it", {}),
    Control("wheel", "zoom at the cursor", {}),
    Control(
        "arrows",
        "pan",
        {
            pygame.K_LEFT: Action.LEFT,
            pygame.K_RIGHT: Action.RIGHT,
            pygame.K_UP: Action.UP,
            pygame.K_DOWN: Action.DOWN,
        },
    ),
    Control("Home", "show the whole scene again", {pygame.K_HOME: Action.HOME}),
    Control("P", "pause, go on", {pygame.K_p: Action.PAUSE}),
    Control("O", "one step", {pygame.K_o: Action.STEP}),
    Control("R", "restart", {pygame.K_r: Action.RESTART}),
    Control("B", "brute force or tree", {pygame.K_b: Action.METHOD}),
    Control("T", "tree: off, outline, filled", {pygame.K_t: Action.TREE}),
    Control("H", "show or hide this list", {pygame.K_h: Action.HELP}),
    Control("Esc", "quit", {pygame.K_ESCAPE: Action.QUIT}),
)

_ACTIONS = {key: action for control in CONTROLS for key, action in control.keys.items()}

# Actions that last while their key is down, as a direction on the screen.
PANNING = {
    Action.LEFT: (-1, 0),
    Action.RIGHT: (1, 0),
    Action.UP: (0, -1),
    Action.DOWN: (0, 1),
}


def action_of(key: int) -> Action | None:
    """Return what a key does."""
    return _ACTIONS.get(key)
