"""The method panel: search for pairs, rules of collisions, and comparison of two methods."""

from __future__ import annotations

from jostle.app.gui.host import Gui
from jostle.app.panels.widgets import choice, combo, in_rows, label
from jostle.app.session import Session
from jostle.app.simulate.settings import METHODS, too_slow

METHODS_BY_RULES = (
    ("exact physics", {"quadtree": "quadtree", "brute": "brute force"}),
    ("2015 program", {"article-quadtree": "quadtree", "article-brute": "brute force"}),
)


def build(session: Session, gui: Gui) -> None:
    """Build two choices for exact physics, and two for the article's program."""
    now, count = session.settings.method, len(session.frame)
    for rules, methods in METHODS_BY_RULES:
        label(rules)
        for (method, words), across in in_rows(methods.items(), len(methods)):
            chosen = method == now
            reason = "" if chosen else too_slow(method, count) or ""
            if choice(gui, method, words, across, chosen=chosen, reason=reason) and not chosen:
                session.runner.choose_method(method)

    _race(session, gui)


def _race(session: Session, gui: Gui) -> None:
    """Build the choice of a second method, which runs on the same scene."""
    now, rival = session.settings.method, session.runner.race.method if session.runner.race else ""
    rivals = {"": "nothing"} | {method: METHODS[method] for method in METHODS if method != now}
    chosen = combo(gui, "compare with", rivals, rival)
    if chosen is None or chosen == rival:
        return
    if session.runner.race:
        session.runner.toggle_race(rival)
    if chosen:
        session.runner.toggle_race(chosen)
