"""The items of the context menus, as data.

Of a particle: commands on it, or on the selection that contains it. Of the background: commands on
all particles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from jostle.app.act.menu import Menu
from jostle.app.session import Session
from jostle.app.simulate.simulation import Point, Tags

GRAVITY_FACTOR = 3.0


@dataclass(frozen=True)
class Item:
    """An item to click on."""

    name: str  # of its mark
    label: str
    command: Callable[[], None]
    checked: bool = False
    enabled: bool = True
    key: str = ""  # the command of the keymap that does the same


@dataclass(frozen=True)
class Number:
    """A number field."""

    name: str
    label: str
    value: float
    command: Callable[[float], None]
    enabled: bool = True


Line = Item | Number | None  # None is a separator


def lines_of(session: Session, menu: Menu) -> list[Line]:
    """Return the items of a menu."""
    if menu.tag is None or menu.tags is None:
        return _of_background(session, menu.point)
    return _of_particles(session, menu.tag, menu.tags)


def _of_particles(session: Session, tag: int, tags: Tags) -> list[Line]:
    commands, attractors = session.interaction.commands, session.interaction.attractors
    frame = session.frame
    rows = frame.rows(tag)
    movable = bool(frame.movable[rows].all())
    attracts, selected = attractors.attracts(tag), tag in session.interaction.selection
    return [
        Item("delete", "Delete", lambda: commands.delete(tags), key="delete"),
        Item("clone", "Clone", lambda: commands.clone(tags), key="clone"),
        None,
        Item(
            "attract",
            "Stop attracting" if attracts else "Attract",
            lambda: attractors.set_attracting(tags, not attracts),
        ),
        Item("stop", "Set speed to 0", lambda: commands.stop(tags), enabled=movable),
        Item(
            "movable",
            "Make immovable" if movable else "Make movable",
            lambda: commands.fix(tags, movable=not movable),
            enabled=not session.settings.by_article,
        ),
        None,
        Item(
            "select",
            "Selected",
            lambda: session.interaction.selection.toggle(tag),
            checked=selected,
        ),
        *_explain_item(session, tags),
    ]


def _explain_item(session: Session, tags: Tags) -> list[Line]:
    """Return the item for two particles."""
    if len(tags) != 2:
        return []
    return [
        Item(
            "why",
            "Why do these two touch or not?",
            session.explain,
            checked=session.question.pair is not None,
            key="why",
        )
    ]


def _of_background(session: Session, point: Point) -> list[Line]:
    interaction = session.interaction
    commands, attractors, gravity = (
        interaction.commands, interaction.attractors, interaction.gravity
    )  # fmt: skip
    can_fall = "gravity" in session.engine.adjustable
    return [
        Item("create", "New particle here", lambda: commands.create(point), key="create"),
        Item("attractor", "New attractor here", lambda: attractors.place(point)),
        Item(
            "stop attraction",
            "Stop all attraction",
            attractors.stop,
            enabled=bool(attractors.placed),
        ),
        None,
        Item("triple", "Gravity × 3", lambda: gravity.scale(GRAVITY_FACTOR), enabled=can_fall),
        Item("third", "Gravity ÷ 3", lambda: gravity.scale(1 / GRAVITY_FACTOR), enabled=can_fall),
        Item(
            "invert",
            "Invert gravity",
            gravity.invert,
            enabled=can_fall,
            key="invert gravity",
        ),
        Item("zero", "No gravity", gravity.zero, enabled=can_fall, key="zero gravity"),
        Number("gravity", "y", gravity.value[1], gravity.set_downwards, enabled=can_fall),
        None,
        Item("scramble", "Randomise positions", commands.scramble),
        Item("dance", "Dance party", commands.dance),
        Item(
            "clear walls",
            "Clear drawn walls",
            commands.clear_walls,
            enabled=len(commands.drawn_walls) > 0,
        ),
    ]
