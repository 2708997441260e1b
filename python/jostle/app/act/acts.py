"""What each action of the table of keys does to a session."""

from __future__ import annotations

from collections.abc import Callable

from jostle.app.act.controls import Action
from jostle.app.act.tools import Tool
from jostle.app.session import Session

GRAVITY_STEP = 1.5
TIME_STEP = 2.0


def _switch(name: str) -> Callable[[Session], None]:
    """Return what flips a switch of `Shown`, and says so."""

    def act(session: Session) -> None:
        session.toggle(name)
        state = "on" if getattr(session.shown, name) else "off"
        session.say(f"{name.capitalize()} {state}")

    return act


def _choose(tool: Tool) -> Callable[[Session], None]:
    return lambda session: session.tools.choose(tool)


ACTS: dict[Action, Callable[[Session], None]] = {
    Action.PAUSE: Session.toggle_pause,
    Action.STEP: Session.single_step,
    Action.STEP_BACK: Session.step_back,
    Action.RESTART: Session.restart,
    Action.SLOWER: lambda session: session.scale_time(1 / TIME_STEP),
    Action.FASTER: lambda session: session.scale_time(TIME_STEP),
    Action.PREVIOUS_SCENE: Session.previous_scene,
    Action.NEXT_SCENE: Session.next_scene,
    Action.METHOD: Session.switch_method,
    Action.RACE: Session.toggle_race,
    Action.POINTER: _choose(Tool.POINTER),
    Action.WALL: _choose(Tool.WALL),
    Action.ATTRACTOR: _choose(Tool.ATTRACTOR),
    Action.CREATE: lambda session: session.deeds.create(session.at_cursor()),
    Action.CLONE: lambda session: session.deeds.clone(session.targets()),
    Action.DELETE: lambda session: session.deeds.delete(session.targets()),
    Action.MENU: Session.open_menu,
    Action.WHY: Session.ask_why,
    Action.MORE_GRAVITY: lambda session: session.gravity.scale(GRAVITY_STEP),
    Action.LESS_GRAVITY: lambda session: session.gravity.scale(1 / GRAVITY_STEP),
    Action.TURN_GRAVITY: lambda session: session.gravity.turn(),
    Action.INVERT_GRAVITY: lambda session: session.gravity.invert(),
    Action.ZERO_GRAVITY: lambda session: session.gravity.zero(),
    Action.TREE: Session.cycle_tree,
    Action.CONTACTS: _switch("contacts"),
    Action.FORCES: _switch("forces"),
    Action.VELOCITIES: _switch("velocities"),
    Action.TRAILS: _switch("trails"),
    Action.CLEAR_TRAILS: Session.clear_trails,
    Action.LABELS: _switch("labels"),
    Action.COLOURS: Session.cycle_colours,
    Action.PANELS: lambda session: session.toggle("panels"),
    Action.HOME: lambda session: session.camera.home(),
    Action.RECORD: Session.toggle_recording,
    Action.SCREENSHOT: Session.screenshot,
    Action.SAVE: Session.save,
    Action.HELP: lambda session: session.toggle("help"),
    Action.ESCAPE: Session.escape,
}
