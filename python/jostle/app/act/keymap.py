"""The keymap: one table for the window, the help overlay and the documents."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, auto

import pygame


class Action(Enum):
    """The actions of keys."""

    PAUSE = auto()
    STEP = auto()
    STEP_BACK = auto()
    RESTART = auto()
    SLOWER = auto()
    FASTER = auto()
    PREVIOUS_SCENE = auto()
    NEXT_SCENE = auto()
    METHOD = auto()
    RACE = auto()
    POINTER = auto()
    WALL = auto()
    ATTRACTOR = auto()
    ATTRACT = auto()
    CREATE = auto()
    CLONE = auto()
    DELETE = auto()
    MENU = auto()
    WHY = auto()
    MORE_GRAVITY = auto()
    LESS_GRAVITY = auto()
    TURN_GRAVITY = auto()
    INVERT_GRAVITY = auto()
    ZERO_GRAVITY = auto()
    TREE = auto()
    CONTACTS = auto()
    FORCES = auto()
    VELOCITIES = auto()
    TRAILS = auto()
    CLEAR_TRAILS = auto()
    LABELS = auto()
    COLOURS = auto()
    PANELS = auto()
    LEFT = auto()
    RIGHT = auto()
    UP = auto()
    DOWN = auto()
    HOME = auto()
    RECORD = auto()
    SCREENSHOT = auto()
    SAVE = auto()
    HELP = auto()
    ESCAPE = auto()


@dataclass(frozen=True)
class Control:
    """One line of the table. Mouse gestures have no keys: `gui.input` implements them."""

    label: str
    meaning: str
    keys: dict[int, Action] = field(default_factory=dict)


MOUSE = (
    Control("drag a particle", "move it; release to throw it"),
    Control("drag the background", "select the particles in a box"),
    Control("click", "select; Shift adds or removes"),
    Control("right click", "menu of the particle or the background"),
    Control("right or middle drag", "pan"),
    Control("wheel", "zoom at the cursor"),
)

TOOLS = (
    Control("1", "pointer: drag, throw, select", {pygame.K_1: Action.POINTER}),
    Control("2", "wall: drag to draw one, click one to remove it", {pygame.K_2: Action.WALL}),
    Control("3", "attractor: click, or drag to set its strength", {pygame.K_3: Action.ATTRACTOR}),
    Control("Space", "hold: attract all particles to the cursor", {pygame.K_SPACE: Action.ATTRACT}),
    Control("A", "add a particle at the cursor", {pygame.K_a: Action.CREATE}),
    Control(
        "D", "clone the selection, or the particle under the cursor", {pygame.K_d: Action.CLONE}
    ),
    Control(
        "Del",
        "delete the selection, or the particle under the cursor",
        {pygame.K_DELETE: Action.DELETE, pygame.K_BACKSPACE: Action.DELETE},
    ),
    Control("M", "open the menu at the cursor", {pygame.K_m: Action.MENU}),
    Control("W", "explain why the two selected touch or not", {pygame.K_w: Action.WHY}),
)

GRAVITY = (
    Control(
        "+  −",
        "stronger, weaker",
        {
            pygame.K_PLUS: Action.MORE_GRAVITY,
            pygame.K_EQUALS: Action.MORE_GRAVITY,
            pygame.K_KP_PLUS: Action.MORE_GRAVITY,
            pygame.K_MINUS: Action.LESS_GRAVITY,
            pygame.K_KP_MINUS: Action.LESS_GRAVITY,
        },
    ),
    Control("G", "rotate by 90°, or switch on", {pygame.K_g: Action.TURN_GRAVITY}),
    Control("I", "invert", {pygame.K_i: Action.INVERT_GRAVITY}),
    Control("0", "switch off", {pygame.K_0: Action.ZERO_GRAVITY}),
)

TIME = (
    Control("P", "pause, resume", {pygame.K_p: Action.PAUSE}),
    Control(
        "O  U",
        "one step; one step back, or undo",
        {pygame.K_o: Action.STEP, pygame.K_u: Action.STEP_BACK},
    ),
    Control(
        ",  .",
        "slower, faster",
        {pygame.K_COMMA: Action.SLOWER, pygame.K_PERIOD: Action.FASTER},
    ),
    Control("R", "restart", {pygame.K_r: Action.RESTART}),
    Control(
        "[  ]",
        "previous, next scene",
        {
            pygame.K_LEFTBRACKET: Action.PREVIOUS_SCENE,
            pygame.K_PAGEUP: Action.PREVIOUS_SCENE,
            pygame.K_RIGHTBRACKET: Action.NEXT_SCENE,
            pygame.K_PAGEDOWN: Action.NEXT_SCENE,
        },
    ),
    Control(
        "B  Q",
        "brute force or quadtree; compare both",
        {pygame.K_b: Action.METHOD, pygame.K_q: Action.RACE},
    ),
)

FILES = (
    Control(
        "F",
        "start or stop recording a video",
        {pygame.K_f: Action.RECORD, pygame.K_F9: Action.RECORD},
    ),
    Control(
        "S", "save a screenshot", {pygame.K_s: Action.SCREENSHOT, pygame.K_F12: Action.SCREENSHOT}
    ),
    Control("F5", "save the scene", {pygame.K_F5: Action.SAVE}),
    Control("H", "show or hide this list", {pygame.K_h: Action.HELP, pygame.K_F1: Action.HELP}),
    Control(
        "Esc", "cancel a drag, close a menu or the help, quit", {pygame.K_ESCAPE: Action.ESCAPE}
    ),
)

SHOW = (
    Control("T", "tree: off, outline, filled, occupancy", {pygame.K_t: Action.TREE}),
    Control("C", "contacts", {pygame.K_c: Action.CONTACTS}),
    Control("K", "forces between particles", {pygame.K_k: Action.FORCES}),
    Control("V", "velocities", {pygame.K_v: Action.VELOCITIES}),
    Control(
        "L  X",
        "trails; clear them",
        {pygame.K_l: Action.TRAILS, pygame.K_x: Action.CLEAR_TRAILS},
    ),
    Control("N", "labels: number and speed", {pygame.K_n: Action.LABELS}),
    Control("E", "colour by", {pygame.K_e: Action.COLOURS}),
    Control("Tab", "panels", {pygame.K_TAB: Action.PANELS}),
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
    Control("Home", "reset the view", {pygame.K_HOME: Action.HOME}),
)

GROUPS = {
    "Mouse": MOUSE,
    "Tools and particles": TOOLS,
    "Gravity": GRAVITY,
    "Time and scene": TIME,
    "Display": SHOW,
    "Files and help": FILES,
}
KEYMAP = tuple(control for group in GROUPS.values() for control in group)

_ACTIONS = {key: action for control in KEYMAP for key, action in control.keys.items()}

# Actions that last while their key is down: the arrows, as directions on the screen, and Space.
PANNING = {
    Action.LEFT: (-1, 0),
    Action.RIGHT: (1, 0),
    Action.UP: (0, -1),
    Action.DOWN: (0, 1),
}
HELD = {*PANNING, Action.ATTRACT}


def action_of(key: int) -> Action | None:
    """Return the action of a key."""
    return _ACTIONS.get(key)


def key_of(action: Action) -> str:
    """Return the name of the key of an action."""
    control = next(control for control in KEYMAP if action in control.keys.values())
    names, actions = control.label.split("  "), list(dict.fromkeys(control.keys.values()))
    return names[actions.index(action)] if len(names) == len(actions) else control.label


def as_markdown() -> str:
    """Return the table as docs/controls.md."""
    lines = [
        "# Mouse and keys of the simulator",
        "",
        "The simulator shows the same list: press H. This page is written by",
        "`docs/controls.py`.",
    ]
    for group, controls in GROUPS.items():
        lines += ["", f"## {group}", "", "| | |", "|---|---|"]
        lines += [f"| **{control.label}** | {control.meaning} |" for control in controls]
    return "\n".join(lines) + "\n"
