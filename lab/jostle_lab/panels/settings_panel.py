"""The settings: search for pairs, sliders of particles, tree, world and time, and the display."""

import os
from typing import Any

import numpy as np

from jostle_lab.act.interaction import Tool
from jostle_lab.draw.view_options import ColourBy, TreeView
from jostle_lab.gui.host import Gui
from jostle_lab.gui.keymap import SWITCHES
from jostle_lab.panels import widgets as ui
from jostle_lab.race import RIVALS
from jostle_lab.schema import METHODS, about, extra, kind_of, settings_with, title_of, too_slow
from jostle_lab.session import Session
from jostle_lab.simulate.simulation import ADJUSTABLE

UNLIMITED = 4_096  # subdivisions that no tree reaches
# If neither the scene nor the world has one.
DEFAULTS = {"threads": os.cpu_count() or 1, "restitution": 1.0, "substeps": 1}


def span_of(name: str) -> ui.Range:
    """Return the range of the slider of a setting."""
    slider = extra(name, "slider")
    return ui.Range(slider.low, slider.high, slider.log, whole=kind_of(name) == "whole number")


def _form(name: str, value: float) -> str:
    """Return the format of the values of a setting, as in C."""
    if name == "max_depth" and value >= UNLIMITED:
        return "no limit"
    form: str = extra(name, "slider").form
    return "%d" if kind_of(name) == "whole number" else form


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
    moved, value = ui.slider(gui, "particles", span_of("n"), count, "%d")
    if moved is ui.Moved.DONE and value != count:
        session.runner.adjust("n", int(value))
    _build(session, gui, "tree")


def build_display(session: Session, gui: Gui) -> None:
    """Build what is drawn beside the particles."""
    options = session.view_options
    options.tree = ui.select(gui, "tree", {view.label: view for view in TreeView}, options.tree)
    quantities = {by.label: by for by in ColourBy}
    options.colour_by = ui.select(gui, "colour by", quantities, options.colour_by)
    for name, across in ui.in_rows(SWITCHES, 3):
        if ui.choice(gui, name, name, across, chosen=getattr(options, name)):
            session.toggle(name)


def build_world(session: Session, gui: Gui) -> None:
    _build(session, gui, "world")
    interaction = session.interaction
    if interaction.tool is Tool.WALL or len(interaction.commands.drawn_walls):
        _build(session, gui, "walls")


def build_time(session: Session, gui: Gui) -> None:
    _build(session, gui, "time")


def _build(session: Session, gui: Gui, panel: str) -> None:
    """Build a line for each setting of a panel: first the lists, then the sliders."""
    names = settings_with("panel", panel)
    for name in sorted(names, key=lambda name: extra(name, "labels") is None):
        if extra(name, "labels"):
            _choice(session, gui, name)
        elif name == "gravity":
            _gravity(session, gui)
        else:
            _line(session, gui, name)


def _choice(session: Session, gui: Gui, name: str) -> None:
    """Build a list of the values of a setting."""
    labels, now = extra(name, "labels"), getattr(session.engine.effective_settings, name)
    options = {words: value for value, words in labels.items()}
    chosen = ui.select(gui, title_of(name), options, now)
    ui.hint(about(name))
    if chosen != now:
        session.runner.adjust(name, chosen)


def _line(session: Session, gui: Gui, name: str) -> None:
    """Build the slider of a setting, with its help as a tooltip."""
    held = getattr(session.engine.effective_settings, name)
    value = float(DEFAULTS.get(name, 0.0) if held is None else held)
    span = span_of(name)
    moved, value = ui.slider(gui, title_of(name), span, value, _form(name, value))
    ui.hint(about(name))
    _apply(session, name, moved, int(value) if span.whole else value)


def _apply(session: Session, name: str, moved: ui.Moved, value: Any) -> None:
    """Change a setting: immediately if possible, else when the slider is released."""
    live = name in ADJUSTABLE
    if moved is ui.Moved.DONE or (moved is ui.Moved.MOVING and live):
        session.runner.adjust(name, value)


def _gravity(session: Session, gui: Gui) -> None:
    """Build a slider for each component of gravity, in one line."""
    strongest = extra("gravity", "slider").high
    span = ui.Range(-strongest, strongest)
    gravity = session.engine.effective_settings.gravity or (0.0, 0.0)
    ui.label("gravity x, y")
    for k, across in ui.in_rows(range(2), 2):
        name = f"gravity {'xy'[k]}"
        moved, new = ui.bare_slider(gui, name, span, gravity[k], "%.0f", across)
        ui.hint(about("gravity"))
        _apply(session, "gravity", moved, (new, gravity[1]) if k == 0 else (gravity[0], new))
