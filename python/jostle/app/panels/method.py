"""How pairs are found and by whose rules they bounce."""

from __future__ import annotations

from jostle.app.carry import ARTICLE_LIMIT
from jostle.app.gui import Gui
from jostle.app.panels.widgets import beside, choice, label, share_out
from jostle.app.session import Session
from jostle.app.world_simulation import BRUTE_LIMIT

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


def _reason(method: str, count: int) -> str:
    """Return why a method cannot be chosen now."""
    if method.startswith("article-") and count > ARTICLE_LIMIT:
        return f"The article's programs need {ARTICLE_LIMIT:,} particles or fewer."
    if method == "brute" and count > BRUTE_LIMIT:
        return f"Brute force would take seconds a step above {BRUTE_LIMIT:,} particles."
    return ""
