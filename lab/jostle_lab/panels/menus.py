"""The context menus: their items as data, and how ImGui draws them.

Of a particle: commands on it, or on the selection that contains it. Of the background: commands on
all particles.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import imgui, imgui_ctx

from jostle_lab.act.interaction import Menu
from jostle_lab.gui.host import Gui
from jostle_lab.gui.keymap import key_of
from jostle_lab.panels import widgets as ui
from jostle_lab.session import Session
from jostle_lab.simulate.frame import Frame, Point, Tags

GRAVITY_FACTOR = 3.0
POPUP = "menu"
NUMBER_WIDTH = 90.0


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


Line = Item | Number | None  # None is a separator


def lines_of(session: Session, menu: Menu) -> list[Line]:
    if menu.tag is None:
        return _of_background(session, menu.point)
    return _of_particles(session, menu.tag, menu.tags)


def _of_particles(session: Session, tag: int, tags: Tags) -> list[Line]:
    interaction, frame = session.interaction, session.frame
    commands, attractors = interaction.commands, interaction.attractors
    selection = interaction.selection
    movable, attracts = bool(frame.movable[frame.rows(tag)].all()), attractors.attracts(tag)
    attract = "Stop attracting" if attracts else "Attract"
    fix = "Make immovable" if movable else "Make movable"
    asked = session.question.pair is not None
    why = Item("why", "Why do these two touch or not?", session.explain, asked, key="why")
    return [
        Item("delete", "Delete", lambda: commands.delete(tags), key="delete"),
        Item("clone", "Clone", lambda: commands.clone(tags), key="clone"),
        None,
        Item("attract", attract, lambda: attractors.set_attracting(tags, not attracts)),
        Item("stop", "Set speed to 0", lambda: commands.stop(tags), enabled=movable),
        Item("movable", fix, lambda: commands.fix(tags, movable=not movable)),
        None,
        Item("select", "Selected", lambda: selection.toggle(tag), checked=tag in selection),
        *([why] if len(tags) == 2 else []),
    ]


def _of_background(session: Session, point: Point) -> list[Line]:
    interaction, gravity = session.interaction, session.interaction.gravity
    commands, attractors = interaction.commands, interaction.attractors
    placed, drawn = bool(attractors.placed), len(commands.drawn_walls) > 0
    invert, off = "invert gravity", "zero gravity"

    def down(strength: float) -> None:
        gravity.set((0.0, strength))

    return [
        Item("create", "New particle here", lambda: commands.create(point), key="create"),
        Item("attractor", "New attractor here", lambda: attractors.place(point)),
        Item("stop attraction", "Stop all attraction", attractors.stop, enabled=placed),
        None,
        Item("triple", "Gravity × 3", lambda: gravity.scale(GRAVITY_FACTOR)),
        Item("third", "Gravity ÷ 3", lambda: gravity.scale(1 / GRAVITY_FACTOR)),
        Item("invert", "Invert gravity", gravity.invert, key=invert),
        Item("zero", "Zero gravity", gravity.zero, key=off),
        Number("gravity", "y", gravity.value[1], down),
        None,
        Item("scramble", "Randomise positions", commands.scramble),
        Item("randomise", "Randomise positions, velocities and densities", commands.randomise),
        Item("clear walls", "Clear drawn walls", commands.clear_walls, enabled=drawn),
    ]


def is_over(menu: Menu, frame: Frame) -> bool:
    """Return whether the particle of a menu no longer exists."""
    return menu.tag is not None and len(frame.rows(menu.tag)) == 0


def title(menu: Menu, frame: Frame) -> str:
    if menu.tag is None:
        x, y = menu.point
        return f"at {x:,.0f}, {y:,.0f}"
    n = len(frame.rows(menu.tags))
    return f"particle {menu.tag}" if n <= 1 else f"particle {menu.tag} of {n:,} selected"


def numbers(menu: Menu, frame: Frame) -> dict[str, str]:
    """Return the present numbers of the particle of a menu; none if it no longer exists."""
    if menu.tag is None or is_over(menu, frame):
        return {}
    row = frame.rows(menu.tag)[0]
    (x, y), velocity = frame.positions[row].tolist(), frame.velocities[row].tolist()
    return {
        "speed": f"{math.hypot(*velocity):,.1f}",
        "position": f"{x:,.1f}, {y:,.1f}",
        "mass": f"{frame.densities[row] * frame.radii[row] ** 2:,.4g}",
        "radius": f"{frame.radii[row]:,.4g}",
    }


def build(session: Session, gui: Gui) -> None:
    """Show the open menu, and run the clicked command."""
    menu = session.interaction.menu
    if menu is None:
        return
    if not menu.shown:
        imgui.open_popup(POPUP)
        menu.shown = True
    with imgui_ctx.begin_popup(POPUP) as popup:
        if not popup:
            session.interaction.menu = None  # a click elsewhere, or Esc
        elif is_over(menu, session.frame):
            session.interaction.menu = None
            imgui.close_current_popup()
        else:
            _fill(session, gui, menu)


def _fill(session: Session, gui: Gui, menu: Menu) -> None:
    imgui.text(title(menu, session.frame))
    for name, value in numbers(menu, session.frame).items():
        ui.soft(name)
        imgui.same_line(imgui.get_font_size() * 5)
        imgui.text(value)
    imgui.separator()
    for line in lines_of(session, menu):
        if line is None:
            imgui.separator()
        elif isinstance(line, Number):
            _number(gui, line)
        elif _clicked(gui, line):
            line.command()
            session.interaction.menu = None


def _clicked(gui: Gui, item: Item) -> bool:
    key = key_of(item.key) if item.key else ""
    clicked, _ = imgui.menu_item(item.label, key, item.checked, item.enabled)
    gui.mark(f"menu {item.name}")
    return bool(clicked)


def _number(gui: Gui, number: Number) -> None:
    """Build a number field; Enter applies it."""
    imgui.set_next_item_width(NUMBER_WIDTH)
    flags, name = imgui.InputTextFlags_.enter_returns_true, f"{number.label}##{number.name}"
    typed, value = imgui.input_float(name, number.value, format="%.5g", flags=flags)
    gui.mark(f"menu {number.name}")
    if typed:
        number.command(value)
