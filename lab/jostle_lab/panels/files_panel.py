"""The list of scenes; and files: save, load, record, export."""

from pathlib import Path

from imgui_bundle import imgui, imgui_ctx

import jostle
from jostle_lab.draw.camera import Size
from jostle_lab.draw.palette import ACCENT
from jostle_lab.gui.host import Gui
from jostle_lab.gui.style import CHOSEN, FILLED, vec
from jostle_lab.panels import widgets as ui
from jostle_lab.session import Session
from jostle_lab.storage.recording import RATES, Recording

ROWS = 6  # visible
LINE, PADDING = 22.0, 5.0  # points
SIZES: dict[str, Size | None] = {
    "window": None, "720p": (1280, 720), "1080p": (1920, 1080), "4K": (3840, 2160),
    "square": (1080, 1080),
}  # fmt: skip
TOML = "The settings as a text, for jostle run FILE."
CSV = "The present particles, and energy and momentum over time."
GSD = "The last 30 s, ten frames per second, for OVITO and others."
LENGTHS: dict[str, float | None] = {"until stopped": None, "5 s": 5.0, "10 s": 10.0, "30 s": 30.0}


def build_scenes(session: Session, gui: Gui) -> None:
    """Build the list and the description."""
    names, present = jostle.scenes.names(), session.engine.scene
    size = imgui.ImVec2(0.0, LINE * min(ROWS, len(names)) + PADDING)
    with (
        ui.colours(child_bg=vec((255, 255, 255), 0.025)),
        imgui_ctx.push_style_var(imgui.StyleVar_.window_padding, (8.0, PADDING)),
        imgui_ctx.push_style_var(imgui.StyleVar_.item_spacing, (8.0, 3.0)),
        imgui_ctx.begin_child("scenes", size, imgui.ChildFlags_.always_use_window_padding),
    ):
        if imgui.is_window_appearing() and present in names:
            imgui.set_scroll_y(LINE * (names.index(present) - ROWS // 2))  # whole rows
        for name in names:
            _scene(session, gui, name, present=name == present)
    if present in names:
        ui.wrapped(jostle.scenes.describe(present))


def _scene(session: Session, gui: Gui, name: str, *, present: bool) -> None:
    with ui.colours(
        header=vec(CHOSEN), header_hovered=vec(CHOSEN if present else ACCENT, 1 if present else 0.2)
    ):
        flags = imgui.SelectableFlags_.allow_overlap
        clicked, _ = imgui.selectable(f"{name}##scene", present, flags, (0.0, LINE - 3.0))
    gui.mark(f"scene {name}")
    ui.at_right(f"{jostle.scenes.default_count(name):,}", quiet=not present)
    if clicked:
        session.runner.choose_scene(name)


def build(session: Session, gui: Gui) -> None:
    """Build the buttons, the options of a video, and its progress."""
    files = session.files
    ui.buttons(
        gui,
        ui.Button("save", "save", files.save),
        ui.Button("save settings", "settings", files.save_settings, TOML),
        ui.Button("screenshot", "picture", files.screenshot),
    )
    saved = {str(path): path.stem for path in files.scenes()}
    none = "" if saved else f"There is no saved scene in {files.folder}."
    picked = ui.combo(gui, "load", saved, "choose a scene" if saved else "none yet", reason=none)
    if picked is not None:
        files.load(Path(picked))
    _film(session, gui)
    ui.label("export")
    ui.buttons(
        gui,
        ui.Button("export CSV", "CSV", files.export_csv, CSV),
        ui.Button("export GSD", "GSD", files.export_gsd, GSD),
    )


def build_why(session: Session, gui: Gui) -> None:
    """Build the button that explains a contact."""
    asked, count = session.question.pair is not None, len(session.interaction.selection)
    reason = "" if asked or count == 2 else f"Select two particles; {count} are selected."
    if ui.choice(gui, "why", "Why do they touch, or not?", ui.width(), chosen=asked, reason=reason):
        session.explain()


def _film(session: Session, gui: Gui) -> None:
    recording, options = session.files.recording, session.files.options
    busy = "A video is being recorded." if recording else ""
    ui.label("video")
    for suffix, across in ui.in_rows(RATES, len(RATES)):
        name, chosen = suffix.lstrip(".").upper(), options.suffix == suffix
        if ui.choice(gui, f"film {name}", name, across, chosen=chosen, reason=busy):
            options.suffix = suffix
    options.size = ui.select(gui, "size", SIZES, options.size, reason=busy)
    options.seconds = ui.select(gui, "length", LENGTHS, options.seconds, reason=busy)
    ending = recording is not None and recording.stopped
    words = "record" if recording is None else "finishing" if ending else "stop"
    reason = "The end of the video is being written." if ending else ""
    if ui.choice(gui, "record", words, ui.width(), chosen=recording is not None, reason=reason):
        session.files.toggle_recording()
    if recording is not None:
        _progress(recording, gui)


def _progress(recording: Recording, gui: Gui) -> None:
    if recording.progress is not None:
        with ui.colours(plot_histogram=vec(FILLED)):
            imgui.progress_bar(recording.progress, (ui.width(), ui.BUTTON / 3), "")
        gui.mark("film progress")
    ui.soft(
        f"{recording.seconds:.1f} s · {recording.written:,} written, {recording.queued:,} queued"
    )
