"""The items of the context menus as data, which menus draw and tests use.

On a particle: its numbers, and what can be done to it, or to the selection that it belongs to.
On the ground: what can be done to everything.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jostle.app.act.controls import Action, key_of
from jostle.app.simulate.simulation import Frame, Point, Tags

if TYPE_CHECKING:
    from jostle.app.session import Session

GRAVITY_FACTOR = 3.0


@dataclass(frozen=True)
class Item:
    """A line to click on."""

    name: str  # for whoever looks for it
    label: str
    act: Callable[[], None]
    checked: bool = False
    enabled: bool = True
    key: str = ""  # of the table of controls, which does the same


@dataclass(frozen=True)
class Number:
    """A line with a number to type."""

    name: str
    label: str
    value: float
    act: Callable[[float], None]
    enabled: bool = True


Line = Item | Number | None  # None is a rule between two groups


@dataclass
class Menu:
    """One menu, opened at a place: on a particle, or on the ground."""

    point: Point
    tag: int | None
    tags: Tags | None = None  # what it acts on: the particle, or the selection around it
    shown: bool = field(default=False)  # whether it has been drawn

    def title(self, frame: Frame) -> str:
        """Return what it is about."""
        if self.tag is None or self.tags is None:
            x, y = self.point
            return f"at {x:,.0f}, {y:,.0f}"
        n = len(frame.rows(self.tags))
        return f"particle {self.tag}" if n <= 1 else f"particle {self.tag} of {n:,} selected"

    def facts(self, frame: Frame) -> list[tuple[str, str]]:
        """Return the numbers of the particle under it, as they are now."""
        if self.tag is None or self.is_over(frame):
            return []
        row = frame.rows(self.tag)[0]
        (x, y), velocity = frame.positions[row].tolist(), frame.velocities[row].tolist()
        return [
            ("speed", f"{math.hypot(*velocity):,.1f}"),
            ("position", f"{x:,.1f}, {y:,.1f}"),
            ("mass", f"{frame.densities[row] * frame.radii[row] ** 2:,.4g}"),
            ("radius", f"{frame.radii[row]:,.4g}"),
        ]

    def is_over(self, frame: Frame) -> bool:
        """Return whether the particle that it is about has gone."""
        return self.tag is not None and len(frame.rows(self.tag)) == 0

    def lines(self, session: Session) -> list[Line]:
        """Return what it offers now."""
        if self.tag is None or self.tags is None:
            return _on_the_ground(session, self.point)
        return _on_particles(session, self.tag, self.tags)


def _on_particles(session: Session, tag: int, tags: Tags) -> list[Line]:
    deeds, pulls, frame = session.deeds, session.pulls, session.frame
    rows = frame.rows(tag)
    movable = bool(frame.movable[rows].all())
    attracts, selected = pulls.attracts(tag), tag in session.selection
    return [
        Item("delete", "Delete", lambda: deeds.delete(tags), key=key_of(Action.DELETE)),
        Item("clone", "Clone", lambda: deeds.clone(tags), key=key_of(Action.CLONE)),
        None,
        Item(
            "attract",
            "Stop attracting" if attracts else "Attract",
            lambda: pulls.let_attract(tags, not attracts),
        ),
        Item("stop", "Stop", lambda: deeds.stop(tags), enabled=movable),
        Item(
            "movable",
            "Make immovable" if movable else "Make movable",
            lambda: deeds.fix(tags, movable=not movable),
            enabled=not session.settings.by_article,
        ),
        None,
        Item(
            "select",
            "Selected",
            lambda: session.selection.toggle(tag),
            checked=selected,
        ),
        *_question(session, tags),
    ]


def _question(session: Session, tags: Tags) -> list[Line]:
    """Return the question that two particles raise."""
    if len(tags) != 2:
        return []
    return [
        Item(
            "why",
            "Why do these two touch or not?",
            session.ask_why,
            checked=session.question.pair is not None,
            key=key_of(Action.WHY),
        )
    ]


def _on_the_ground(session: Session, point: Point) -> list[Line]:
    deeds, pulls, gravity = session.deeds, session.pulls, session.gravity
    can_fall = "gravity" in session.engine.adjustable
    return [
        Item("create", "New particle here", lambda: deeds.create(point), key=key_of(Action.CREATE)),
        Item("attractor", "New attractor here", lambda: pulls.place(point)),
        Item("stop attraction", "Stop all attraction", pulls.stop, enabled=bool(pulls.placed)),
        None,
        Item("triple", "Gravity × 3", lambda: gravity.scale(GRAVITY_FACTOR), enabled=can_fall),
        Item("third", "Gravity ÷ 3", lambda: gravity.scale(1 / GRAVITY_FACTOR), enabled=can_fall),
        Item(
            "invert",
            "Invert gravity",
            gravity.invert,
            enabled=can_fall,
            key=key_of(Action.INVERT_GRAVITY),
        ),
        Item("zero", "No gravity", gravity.zero, enabled=can_fall, key=key_of(Action.ZERO_GRAVITY)),
        Number("gravity", "downwards", gravity.value[1], gravity.set_downwards, enabled=can_fall),
        None,
        Item("scramble", "Scramble places", deeds.scramble),
        Item("dance", "Dance party", deeds.dance),
        Item(
            "clear walls",
            "Clear drawn walls",
            deeds.clear_walls,
            enabled=len(deeds.drawn_walls) > 0,
        ),
    ]
