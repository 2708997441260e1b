"""The files panel: save, load, record, export."""

from __future__ import annotations

from pathlib import Path

from imgui_bundle import imgui

from jostle.app.gui.host import Gui
from jostle.app.gui.style import FILLED, vec
from jostle.app.panels.widgets import (
    BUTTON,
    choice,
    colours,
    combo,
    hint,
    in_rows,
    label,
    soft,
    width,
)
from jostle.app.session import Session
from jostle.app.storage.encoder import FORMATS
from jostle.app.storage.recording import Recording

SIZES = {"window": None, "720p": (1280, 720), "1080p": (1920, 1080), "4K": (3840, 2160),
         "square": (1080, 1080)}  # fmt: skip
LENGTHS = {"until stopped": None, "5 s": 5.0, "10 s": 10.0, "30 s": 30.0}


def build(session: Session, gui: Gui) -> None:
    """Build the buttons, the options of a video, and its progress."""
    files = session.files
    commands = {"save": files.save, "screenshot": files.screenshot}
    for (name, command), across in in_rows(commands.items(), 2):
        if choice(gui, name, name, across, chosen=False):
            command()
    saved = {str(path): path.stem for path in files.scenes()}
    none = "" if saved else f"There is no saved scene in {files.folder}."
    picked = combo(gui, "load", saved, "choose a scene" if saved else "none yet", reason=none)
    if picked is not None:
        files.load(Path(picked))
    _film(session, gui)
    label("export")
    exports = (
        ("CSV", files.export_csv, "The present particles, and energy and momentum over time."),
        ("GSD", files.export_gsd, "The last 30 s, ten frames per second, for OVITO and others."),
    )
    for (name, export, contents), across in in_rows(exports, 2):
        if choice(gui, f"export {name}", name, across, chosen=False):
            export()
        hint(contents)


def build_why(session: Session, gui: Gui) -> None:
    """Build the button that explains a contact."""
    asked, count = session.question.pair is not None, len(session.interaction.selection)
    reason = "" if asked or count == 2 else f"Select two particles; {count} are selected."
    if choice(gui, "why", "Why do they touch, or not?", width(), chosen=asked, reason=reason):
        session.explain()


def _film(session: Session, gui: Gui) -> None:
    recording, options = session.files.recording, session.files.options
    busy = "A video is being recorded." if recording else ""
    label("video")
    for suffix, across in in_rows(FORMATS, len(FORMATS)):
        name, chosen = suffix.lstrip(".").upper(), options.suffix == suffix
        if choice(gui, f"film {name}", name, across, chosen=chosen, reason=busy):
            options.suffix = suffix
    size = next((name for name, size in SIZES.items() if size == options.size), str(options.size))
    picked = combo(gui, "size", {name: name for name in SIZES}, size, reason=busy)
    if picked is not None:
        options.size = SIZES[picked]
    length = next((name for name, long in LENGTHS.items() if long == options.seconds), "")
    picked = combo(gui, "length", {name: name for name in LENGTHS}, length, reason=busy)
    if picked is not None:
        options.seconds = LENGTHS[picked]
    ending = recording is not None and recording.stopped
    words = "record" if recording is None else "finishing" if ending else "stop"
    reason = "The end of the video is being written." if ending else ""
    if choice(gui, "record", words, width(), chosen=recording is not None, reason=reason):
        session.files.toggle_recording()
    if recording is not None:
        _progress(recording, gui)


def _progress(recording: Recording, gui: Gui) -> None:
    if recording.progress is not None:
        with colours(plot_histogram=vec(FILLED)):
            imgui.progress_bar(recording.progress, (width(), BUTTON / 3), "")
        gui.mark("film progress")
    soft(f"{recording.seconds:.1f} s · {recording.written:,} written, {recording.queued:,} queued")
