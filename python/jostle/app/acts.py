"""What each action of the table of keys does to a session."""

from __future__ import annotations

from collections.abc import Callable

from jostle.app.controls import Action
from jostle.app.session import Session

ACTS: dict[Action, Callable[[Session], None]] = {
    Action.PAUSE: Session.toggle_pause,
    Action.STEP: Session.single_step,
    Action.RESTART: Session.restart,
    Action.METHOD: Session.switch_method,
    Action.TREE: Session.cycle_tree,
    Action.HOME: lambda session: session.camera.home(),
    Action.HELP: lambda session: session.toggle("help"),
    Action.QUIT: Session.quit,
}
