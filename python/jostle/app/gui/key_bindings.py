"""The effect of each action of the keymap on a session."""

from __future__ import annotations

from collections.abc import Callable

from jostle.app.act.keymap import Action
from jostle.app.act.tools import Tool
from jostle.app.session import Session

GRAVITY_STEP = 1.5
TIME_STEP = 2.0


def _switch(name: str) -> Callable[[Session], None]:
    """Return the handler that toggles a switch of `ViewOptions`, with a message."""

    def handle(session: Session) -> None:
        session.toggle(name)
        state = "on" if getattr(session.view_options, name) else "off"
        session.messages.say(f"{name.capitalize()} {state}")

    return handle


def _choose(tool: Tool) -> Callable[[Session], None]:
    return lambda session: session.interaction.tools.choose(tool)


HANDLERS: dict[Action, Callable[[Session], None]] = {
    Action.PAUSE: lambda session: session.runner.toggle_pause(),
    Action.STEP: lambda session: session.runner.single_step(),
    Action.STEP_BACK: lambda session: session.runner.step_back(),
    Action.RESTART: lambda session: session.runner.restart(),
    Action.SLOWER: lambda session: session.runner.scale_time(1 / TIME_STEP),
    Action.FASTER: lambda session: session.runner.scale_time(TIME_STEP),
    Action.PREVIOUS_SCENE: lambda session: session.runner.previous_scene(),
    Action.NEXT_SCENE: lambda session: session.runner.next_scene(),
    Action.METHOD: lambda session: session.runner.switch_method(),
    Action.RACE: lambda session: session.runner.toggle_race(),
    Action.POINTER: _choose(Tool.POINTER),
    Action.WALL: _choose(Tool.WALL),
    Action.ATTRACTOR: _choose(Tool.ATTRACTOR),
    Action.CREATE: lambda session: session.interaction.commands.create(
        session.interaction.at_cursor()
    ),
    Action.CLONE: lambda session: session.interaction.commands.clone(session.interaction.targets()),
    Action.DELETE: lambda session: session.interaction.commands.delete(
        session.interaction.targets()
    ),
    Action.MENU: lambda session: session.interaction.open_menu(),
    Action.WHY: Session.explain,
    Action.MORE_GRAVITY: lambda session: session.interaction.gravity.scale(GRAVITY_STEP),
    Action.LESS_GRAVITY: lambda session: session.interaction.gravity.scale(1 / GRAVITY_STEP),
    Action.TURN_GRAVITY: lambda session: session.interaction.gravity.turn(),
    Action.INVERT_GRAVITY: lambda session: session.interaction.gravity.invert(),
    Action.ZERO_GRAVITY: lambda session: session.interaction.gravity.zero(),
    Action.TREE: Session.cycle_tree,
    Action.CONTACTS: _switch("contacts"),
    Action.FORCES: _switch("forces"),
    Action.VELOCITIES: _switch("velocities"),
    Action.TRAILS: _switch("trails"),
    Action.CLEAR_TRAILS: lambda session: session.runner.picture.clear_trails(),
    Action.LABELS: _switch("labels"),
    Action.COLOURS: Session.cycle_colours,
    Action.PANELS: lambda session: session.toggle("panels"),
    Action.HOME: lambda session: session.camera.home(),
    Action.RECORD: lambda session: session.files.toggle_recording(),
    Action.SCREENSHOT: lambda session: session.files.screenshot(),
    Action.SAVE: lambda session: session.files.save(),
    Action.HELP: lambda session: session.toggle("help"),
    Action.ESCAPE: Session.escape,
}
