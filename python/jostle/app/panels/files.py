"""Scenes, pictures, films and tables: saved, loaded, recorded, exported."""

from __future__ import annotations

from pathlib import Path

from imgui_bundle import imgui

from jostle.app.gui.host import Gui
from jostle.app.keep.encoder import FORMATS
from jostle.app.keep.recording import Recording
from jostle.app.panels.ink import FILLED, vec
from jostle.app.panels.widgets import (
    BUTTON,
    beside,
    choice,
    colours,
    combo,
    hint,
    label,
    share_out,
    soft,
    width,
)
from jostle.app.session import Session

SIZES = {"window": None, "720p": (1280, 720), "1080p": (1920, 1080), "4K": (3840, 2160),
         "square": (1080, 1080)}  # fmt: skip
LENGTHS = {"until stopped": None, "5 s": 5.0, "10 s": 10.0, "30 s": 30.0}


def build(session: Session, gui: Gui) -> None:
    """Build the buttons, what a film shall be like, and how far it is."""
    files = session.files
    across = share_out(2)
    if choice(gui, "save", "save", across, chosen=False):
        session.save()
    beside()
    if choice(gui, "screenshot", "picture", across, chosen=False):
        session.screenshot()
    saved = {str(path): path.stem for path in files.scenes()}
    none = "" if saved else f"No scene has been saved in {files.folder} yet."
    picked = combo(gui, "load", saved, "choose a scene" if saved else "none yet", reason=none)
    if picked is not None:
        session.load(Path(picked))
    _film(session, gui)
    label("export")
    across = share_out(2)
    if choice(gui, "export CSV", "CSV", across, chosen=False):
        files.export_csv()
    hint("The particles of this moment, and energy and momentum over time, as tables.")
    beside()
    if choice(gui, "export GSD", "GSD", across, chosen=False):
        files.export_gsd()
    hint("The last half minute, ten frames a second, for OVITO and others.")


def build_why(session: Session, gui: Gui) -> None:
    """Build the question about two particles."""
    asked, count = session.question.pair is not None, len(session.selection)
    reason = "" if asked or count == 2 else f"Select two particles; {count} are selected."
    if choice(gui, "why", "Why do they touch, or not?", width(), chosen=asked, reason=reason):
        session.ask_why()


def _film(session: Session, gui: Gui) -> None:
    film, wishes = session.files.recording, session.files.film
    busy = "A film is being recorded." if film else ""
    label("film")
    across = share_out(len(FORMATS))
    for k, suffix in enumerate(FORMATS):
        if k:
            beside()
        name = suffix.lstrip(".").upper()
        chosen = wishes.suffix == suffix
        if choice(gui, f"film {name}", name, across, chosen=chosen, reason=busy):
            wishes.suffix = suffix
    size = next((name for name, size in SIZES.items() if size == wishes.size), str(wishes.size))
    picked = combo(gui, "size", {name: name for name in SIZES}, size, reason=busy)
    if picked is not None:
        wishes.size = SIZES[picked]
    length = next((name for name, long in LENGTHS.items() if long == wishes.seconds), "")
    picked = combo(gui, "length", {name: name for name in LENGTHS}, length, reason=busy)
    if picked is not None:
        wishes.seconds = LENGTHS[picked]
    ending = film is not None and film.stopped
    words = "record" if film is None else "finishing" if ending else "stop"
    reason = "The end of the film is being written." if ending else ""
    if choice(gui, "record", words, width(), chosen=film is not None, reason=reason):
        session.toggle_recording()
    if film is not None:
        _progress(film, gui)


def _progress(film: Recording, gui: Gui) -> None:
    if film.progress is not None:
        with colours(plot_histogram=vec(FILLED)):
            imgui.progress_bar(film.progress, (width(), BUTTON / 3), "")
        gui.mark("film progress")
    soft(f"{film.seconds:.1f} s · {film.written:,} written, {film.queued:,} queued")
