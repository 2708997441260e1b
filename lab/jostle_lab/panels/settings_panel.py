"""The settings: search for pairs, sliders of particles, tree, world and time, and the display."""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from jostle_lab.act.interaction import Tool
from jostle_lab.draw.view_options import ColourBy, TreeView
from jostle_lab.gui.host import Gui
from jostle_lab.gui.keymap import SWITCHES
from jostle_lab.panels import widgets as ui
from jostle_lab.race import RIVALS
from jostle_lab.session import Session
from jostle_lab.simulate.containers import kind_of
from jostle_lab.simulate.settings import METHODS, too_slow
from jostle_lab.simulate.simulation import ADJUSTABLE

CONTAINERS = {"box": "box", "circle": "circle", "torus": "periodic", "none": "no walls"}
ON_TOUCH = {"bounce": "bounce", "merge": "merge", "ignore": "off"}
SLEEPING = {"on": "on", "off": "off"}


_whole, _times = "{:,.0f}".format, "{:.2f} ×".format
_short, _signed = partial(ui.signed, form=".2f"), partial(ui.signed, form=",.0f")


def _depth(value: float) -> str:
    return "no limit" if value >= UNLIMITED else _whole(value)


@dataclass(frozen=True)
class Line:
    """A slider on one field of the settings."""

    name: str
    field: str
    span: ui.Range
    write: Callable[[float], str] = _whole
    default: float = 0.0  # if neither the settings nor the world have a value


CORES = os.cpu_count() or 1
UNLIMITED = 4_096  # subdivisions that no tree reaches
STRONGEST = 2000.0  # gravity, world units per second squared
COUNT = Line("particles", "n", ui.Range(0, 1_000_000, log=True, whole=True))
TREE = (
    Line("leaf capacity", "leaf_capacity", ui.Range(1, 1024, log=True, whole=True)),
    Line("max. depth", "max_depth", ui.Range(1, UNLIMITED, log=True, whole=True), _depth),
    Line("threads", "threads", ui.Range(1, max(CORES, 2), whole=True), default=CORES),
)
SIZE = Line("world size", "world_size", ui.Range(0.25, 4.0, log=True), _times, 1.0)
MATERIAL = (
    Line("drag", "drag", ui.Range(0.0, 5.0), _short),
    Line("restitution", "restitution", ui.Range(0.0, 1.0), _short, 1.0),
    Line("friction", "friction", ui.Range(0.0, 2.0), _short),
)
DRAWN_WALLS = Line("wall friction", "wall_friction", ui.Range(0.0, 2.0), _short)
TIME = (
    Line("time scale", "time_scale", ui.Range(0.05, 4.0, log=True), _times, 1.0),
    Line("sub-steps", "substeps", ui.Range(1, 32, log=True, whole=True), default=1),
)
LINES = (COUNT, *TREE, SIZE, *MATERIAL, DRAWN_WALLS, *TIME)


def build_method(session: Session, gui: Gui) -> None:
    """Build the choices of the method, and the comparison with another one."""
    now, race, count = session.settings.method, session.runner.race, len(session.frame)
    for (method, words), across in ui.in_rows(METHODS.items(), len(METHODS)):
        chosen = method == now
        reason = "" if chosen else too_slow(method, count) or ""
        if ui.choice(gui, method, words, across, chosen=chosen, reason=reason) and not chosen:
            session.runner.adjust("method", method)
    rival = race.method if race else ""
    rivals = {"": "nothing"} | {method: RIVALS[method] for method in RIVALS if method != now}
    picked = ui.combo(gui, "compare with", rivals, rival)
    if picked is not None and picked != rival:
        session.runner.end_race()
        if picked:
            session.runner.toggle_race(picked)


def build_tree(session: Session, gui: Gui) -> None:
    """Build the number of particles and the settings of the tree."""
    count = int(np.count_nonzero(session.frame.movable))  # without the discs of walls
    moved, value = ui.slider(gui, COUNT.name, COUNT.span, count, _whole)
    if moved is ui.Moved.DONE and value != count:
        session.runner.adjust("n", int(value))
    _lines(session, gui, *TREE)


def build_display(session: Session, gui: Gui) -> None:
    """Build what is drawn beside the particles."""
    options = session.view_options
    options.tree = ui.select(gui, "tree", {view.value: view for view in TreeView}, options.tree)
    quantities = {by.value: by for by in ColourBy}
    options.colour_by = ui.select(gui, "colour by", quantities, options.colour_by)
    for name, across in ui.in_rows(SWITCHES, 3):
        if ui.choice(gui, name, name, across, chosen=getattr(options, name)):
            session.toggle(name)


def build_world(session: Session, gui: Gui) -> None:
    now, interaction = session.engine.effective_settings, session.interaction
    _choice(session, gui, "container", CONTAINERS, kind_of(session.frame.container))
    _choice(session, gui, "on_touch", ON_TOUCH, now.on_touch or "bounce", "collisions")
    _choice(session, gui, "sleeping", SLEEPING, "off" if now.sleeping is False else "on")
    _lines(session, gui, SIZE)
    _gravity(session, gui)
    _lines(session, gui, *MATERIAL)
    if interaction.tool is Tool.WALL or len(interaction.commands.drawn_walls):
        _lines(session, gui, DRAWN_WALLS)


def build_time(session: Session, gui: Gui) -> None:
    _lines(session, gui, *TIME)


def _choice(
    session: Session, gui: Gui, field: str, options: dict[str, str], now: str, name: str = ""
) -> None:
    """Build a list of the values of a setting."""
    chosen = ui.combo(gui, name or field, options, now)
    if chosen is not None:
        session.runner.adjust(field, chosen == "on" if options is SLEEPING else chosen)


def _lines(session: Session, gui: Gui, *lines: Line) -> None:
    for line in lines:
        held = getattr(session.engine.effective_settings, line.field)
        value = line.default if held is None else float(held)
        moved, value = ui.slider(gui, line.name, line.span, value, line.write)
        _apply(session, line.field, moved, int(value) if line.span.whole else value)


def _apply(session: Session, field: str, moved: ui.Moved, value: Any) -> None:
    """Change a setting: immediately if possible, else when the slider is released."""
    live = field in ADJUSTABLE
    if moved is ui.Moved.DONE or (moved is ui.Moved.MOVING and live):
        session.runner.adjust(field, value)


def _gravity(session: Session, gui: Gui) -> None:
    """Build gravity: its strength in the present direction, and its components."""
    x, y = session.engine.effective_settings.gravity or (0.0, 0.0)
    strength = math.hypot(x, y)
    moved, new = ui.slider(gui, "gravity", ui.Range(0.0, STRONGEST), strength, _signed)
    direction = (x / strength, y / strength) if strength > 0 else (0.0, 1.0)
    _apply(session, "gravity", moved, (direction[0] * new, direction[1] * new))
    span = ui.Range(-STRONGEST, STRONGEST)
    moved, new = ui.slider(gui, "\u2013 x", span, x, _signed)
    _apply(session, "gravity", moved, (new, y))
    moved, new = ui.slider(gui, "\u2013 y", span, y, _signed)
    _apply(session, "gravity", moved, (x, new))
