"""The keymap: one table of keys and commands for the window, the help and the documents."""

from collections.abc import Callable
from dataclasses import dataclass, field

import pygame

from jostle_lab.act.interaction import Tool
from jostle_lab.session import Session

GRAVITY_STEP = 1.5
TIME_STEP = 2.0

Command = Callable[[Session], None]


@dataclass(frozen=True)
class Control:
    """One line of the table. Mouse gestures have no keys: `gui.input` implements them."""

    label: str  # the keys, two spaces apart if each has its own command
    meaning: str
    # Of each command: pygame's names of keys, after "C-" for Ctrl and "S-" for Shift with Ctrl.
    keys: dict[str, str] = field(default_factory=dict)


GROUPS = {
    "Mouse": (
        Control("drag a particle", "move it; release to throw it"),
        Control("drag the background", "select the particles in a box"),
        Control("click", "select; Shift adds or removes"),
        Control("right click", "menu of the particle or the background"),
        Control("right or middle drag", "pan"),
        Control("wheel", "zoom at the cursor"),
    ),
    "Tools and particles": (
        Control("1", "pointer: drag, throw, select", {"pointer": "1"}),
        Control("2", "wall: drag to draw one, click one to remove it", {"wall": "2"}),
        Control("3", "attractor: click, or drag to set its strength", {"attractor": "3"}),
        Control("4", "brush: drag to add particles", {"brush": "4"}),
        Control("Space", "hold: attract all particles to the cursor", {"attract": "SPACE"}),
        Control("A", "add a particle at the cursor", {"create": "a"}),
        Control("D", "clone the selection, or the particle under the cursor", {"clone": "d"}),
        Control(
            "Del",
            "delete the selection, or the particle under the cursor",
            {"delete": "DELETE BACKSPACE"},
        ),
        Control("Ctrl+Z  Ctrl+Y", "undo the last edit; redo", {"undo": "C-z", "redo": "C-y C-S-z"}),
        Control("M", "open the menu at the cursor", {"menu": "m"}),
        Control("W", "explain why the two selected touch or not", {"why": "w"}),
    ),
    "Gravity": (
        Control(
            "+  −",
            "stronger, weaker",
            {"more gravity": "PLUS EQUALS KP_PLUS", "less gravity": "MINUS KP_MINUS"},
        ),
        Control("G", "rotate by 90°, or switch on", {"turn gravity": "g"}),
        Control("I", "invert", {"invert gravity": "i"}),
        Control("0", "switch off", {"zero gravity": "0"}),
    ),
    "Time and scene": (
        Control("P", "pause, resume", {"pause": "p"}),
        Control("O  U", "one step; one step back in time", {"step": "o", "step back": "u"}),
        Control(",  .", "slower, faster", {"slower": "COMMA", "faster": "PERIOD"}),
        Control(
            "R",
            "restart with the present settings; drawn walls, attractors and new particles go",
            {"restart": "r"},
        ),
        Control(
            "[  ]",
            "previous, next scene",
            {"previous scene": "LEFTBRACKET PAGEUP", "next scene": "RIGHTBRACKET PAGEDOWN"},
        ),
        Control("B  Q", "brute force or quadtree; compare both", {"method": "b", "race": "q"}),
    ),
    "Display": (
        Control("T", "tree: off, outline, filled, occupancy", {"tree": "t"}),
        Control("C", "contacts", {"contacts": "c"}),
        Control("K", "forces between particles", {"forces": "k"}),
        Control("V", "velocities", {"velocities": "v"}),
        Control("L  X", "trails; clear them", {"trails": "l", "clear trails": "x"}),
        Control("N", "labels: number and speed", {"labels": "n"}),
        Control("E", "colour by", {"colours": "e"}),
        Control("Tab  F11", "panels; full screen", {"panels": "TAB", "full screen": "F11"}),
        Control("arrows", "pan", {"left": "LEFT", "right": "RIGHT", "up": "UP", "down": "DOWN"}),
        Control("Home", "reset the view", {"home": "HOME"}),
    ),
    "Files and help": (
        Control("F", "start or stop recording a video", {"record": "f F9"}),
        Control("S", "save a screenshot", {"screenshot": "s F12"}),
        Control("Ctrl+S  Ctrl+O", "save the scene; open one", {"save": "C-s F5", "open": "C-o"}),
        Control("H", "show or hide this list", {"help": "h F1"}),
        Control("Esc", "cancel a drag, close a menu or the help, deselect", {"escape": "ESCAPE"}),
        Control("Ctrl+Q", "quit; unsaved edits are kept", {"quit": "C-q"}),
    ),
}
KEYMAP = tuple(control for group in GROUPS.values() for control in group)

Key = tuple[int, int]  # pygame's number, and its modifiers: Ctrl and, with it, Shift


def _key(name: str) -> Key:
    *modifiers, key = name.split("-")
    bits = {"C": pygame.KMOD_CTRL, "S": pygame.KMOD_SHIFT}
    return getattr(pygame, f"K_{key}"), sum(bits[modifier] for modifier in modifiers)


COMMANDS: dict[Key, str] = {
    _key(key): command
    for control in KEYMAP
    for command, keys in control.keys.items()
    for key in keys.split()
}


def command_of(key: int, modifiers: int = 0) -> str | None:
    """Return the command of a key with pygame's modifiers, or None."""
    control = bool(modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META))
    shift = control and bool(modifiers & pygame.KMOD_SHIFT)
    return COMMANDS.get((key, control * pygame.KMOD_CTRL + shift * pygame.KMOD_SHIFT))


# Commands that last while their key is down: the arrows, as directions on the screen, and Space.
PANNING = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}
HELD = {*PANNING, "attract"}
SWITCHES = ("contacts", "forces", "velocities", "trails", "labels")  # of `ViewOptions`


def _switch(name: str) -> Command:
    """Return the command that toggles a switch of `ViewOptions`, with a message."""

    def handle(session: Session) -> None:
        session.toggle(name)
        state = "on" if getattr(session.view_options, name) else "off"
        session.messages.say(f"{name.capitalize()} {state}")

    return handle


def _choose(tool: Tool) -> Command:
    return lambda session: session.interaction.choose(tool)


HANDLERS: dict[str, Command] = {
    **{tool.value: _choose(tool) for tool in Tool},
    **{name: _switch(name) for name in SWITCHES},
    "create": lambda s: s.interaction.commands.create(s.interaction.at_cursor()),
    "clone": lambda s: s.interaction.commands.clone(s.interaction.targets()),
    "delete": lambda s: s.interaction.commands.delete(s.interaction.targets()),
    "menu": lambda s: s.interaction.open_menu(),
    "why": Session.explain,
    "more gravity": lambda s: s.interaction.gravity.scale(GRAVITY_STEP),
    "less gravity": lambda s: s.interaction.gravity.scale(1 / GRAVITY_STEP),
    "turn gravity": lambda s: s.interaction.gravity.turn(),
    "invert gravity": lambda s: s.interaction.gravity.invert(),
    "zero gravity": lambda s: s.interaction.gravity.zero(),
    "pause": lambda s: s.runner.toggle_pause(),
    "step": lambda s: s.runner.single_step(),
    "step back": lambda s: s.runner.step_back(),
    "slower": lambda s: s.runner.scale_time(1 / TIME_STEP),
    "faster": lambda s: s.runner.scale_time(TIME_STEP),
    "restart": lambda s: s.runner.restart(),
    "previous scene": lambda s: s.runner.next_scene(-1),
    "next scene": lambda s: s.runner.next_scene(),
    "method": lambda s: s.runner.switch_method(),
    "race": lambda s: s.runner.toggle_race(),
    "tree": lambda s: s.cycle("tree"),
    "clear trails": lambda s: s.runner.picture.trails.clear(),
    "colours": lambda s: s.cycle("colour_by"),
    "panels": lambda s: s.toggle("panels"),
    "full screen": Session.toggle_full_screen,
    "home": lambda s: s.camera.home(),
    "record": lambda s: s.files.toggle_recording(),
    "screenshot": lambda s: s.files.screenshot(),
    "save": lambda s: s.files.save(),
    "open": Session.choose_file,
    "undo": lambda s: s.runner.undo(),
    "redo": lambda s: s.runner.redo(),
    "quit": Session.quit,
    "help": lambda s: s.toggle("help"),
    "escape": Session.escape,
}


def key_of(command: str) -> str:
    """Return the label of the key of a command."""
    control = next(control for control in KEYMAP if command in control.keys)
    names, commands = control.label.split("  "), list(control.keys)
    return names[commands.index(command)] if len(names) == len(commands) else control.label
