"""The panel of the method: search for pairs, rules of collisions, and a race of two methods."""

from __future__ import annotations

from jostle.app.draw.words import method_name
from jostle.app.gui.host import Gui
from jostle.app.panels.widgets import beside, choice, combo, label, share_out
from jostle.app.session import Session
from jostle.app.simulate.carry import ARTICLE_LIMIT
from jostle.app.simulate.settings import METHODS
from jostle.app.simulate.world_simulation import BRUTE_LIMIT

RULES = (
    ("physics", {"quadtree": "quadtree", "brute": "brute force"}),
    ("the article", {"article-quadtree": "quadtree", "article-brute": "brute force"}),
)


def build(session: Session, gui: Gui) -> None:
    """Build a line of two choices for right physics, and one for the article's rules."""
    now, count = session.settings.method, len(session.frame)
    for rules, methods in RULES:
        label(rules)
        across = share_out(len(methods))
        for k, (method, words) in enumerate(methods.items()):
            if k:
                beside()
            reason = "" if method == now else _reason(method, count)
            chosen = method == now
            if choice(gui, method, words, across, chosen=chosen, reason=reason) and not chosen:
                session.choose_method(method)

    _race(session, gui)


def _race(session: Session, gui: Gui) -> None:
    """Build the choice of a rival, which runs beside the scene."""
    now, rival = session.settings.method, session.race.method if session.race else ""
    rivals = {"": "alone"} | {
        method: f"against {method_name(method)}" for method in METHODS if method != now
    }
    chosen = combo(gui, "race", rivals, rival)
    if chosen is None or chosen == rival:
        return
    if session.race:
        session.toggle_race(rival)
    if chosen:
        session.toggle_race(chosen)


def _reason(method: str, count: int) -> str:
    """Return why a method cannot be chosen now."""
    if method.startswith("article-") and count > ARTICLE_LIMIT:
        return f"The article's programs need {ARTICLE_LIMIT:,} particles or fewer."
    if method == "brute" and count > BRUTE_LIMIT:
        return f"Brute force would take seconds a step above {BRUTE_LIMIT:,} particles."
    return ""
