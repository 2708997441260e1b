"""The column at the left: the time, and sections, scrolled if they do not fit."""

from collections.abc import Callable
from functools import partial

import numpy as np
from imgui_bundle import imgui, imgui_ctx

from jostle_lab.draw.palette import ACCENT, TEXT_SOFT
from jostle_lab.gui.host import Gui
from jostle_lab.gui.keymap import HANDLERS, key_of
from jostle_lab.gui.style import layout, vec
from jostle_lab.panels import files_panel, life_panel, settings_panel, statistics_panel
from jostle_lab.panels import widgets as ui
from jostle_lab.schema import METHODS
from jostle_lab.session import Session

# Commands of the keymap, and their icons in Font Awesome.
ICONS = {
    "previous scene": "\uf049",
    "step back": "\uf048",
    "pause": "\uf04c",
    "step": "\uf051",
    "next scene": "\uf050",
    "restart": "\uf2f9",
}
PLAY = "\uf04b"
RESTART = "Restart the scene with these settings; drawn walls and attractors go"
BAR_EDGE, BAR_BUTTON = 10.0, 30.0  # points
SLOW = 0.9  # of the chosen speed; below, the real one is shown
MEGABYTE = 2**20
SHORTEST = 0.05  # seconds of history below which the slider is disabled


def build_bar(session: Session, gui: Gui) -> None:
    """Build a bar in place of the panels: it opens them, and has the buttons of the time."""
    flags = ui.FIXED | imgui.WindowFlags_.always_auto_resize
    imgui.set_next_window_pos((BAR_EDGE, BAR_EDGE))
    imgui.set_next_window_bg_alpha(0.8)
    with imgui_ctx.begin("bar", None, flags):
        if ui.choice(gui, "open panels", "\uf0c9", BAR_BUTTON, chosen=False):
            session.toggle("panels")
        ui.hint(f"Settings and statistics  ({key_of('panels')})")
        for name in ("pause", "restart", "next scene"):
            imgui.same_line()
            _playback_button(session, gui, name, BAR_BUTTON)
        imgui.same_line()
        imgui.align_text_to_frame_padding()
        imgui.text_unformatted(session.engine.scene)
        _slowness(session)
        gui.mark_window("bar")


def _slowness(session: Session) -> None:
    """Show the speed after the last text if it is clearly less than the chosen one."""
    rate = session.rate
    if 0 < rate < SLOW * session.settings.time_scale:
        imgui.same_line()
        with ui.colours(text=vec(ACCENT)):
            imgui.text_unformatted(f"{rate:.2g} × real time")
        ui.hint("The computer is too slow for the chosen speed.")


def _playback(session: Session, gui: Gui) -> None:
    """Build the buttons of the time: pause, step, restart, previous and next scene."""
    for name, across in ui.in_rows(ICONS, len(ICONS)):
        _playback_button(session, gui, name, across)


def _playback_button(session: Session, gui: Gui, name: str, across: float) -> None:
    paused, can_go_back = session.runner.paused, session.runner.history.can_go_back
    held = name == "pause" and paused
    reason = "There is no earlier state." if name == "step back" and not can_go_back else ""
    icon = PLAY if held else ICONS[name]
    if ui.choice(gui, name, icon, across, chosen=held, reason=reason):
        HANDLERS[name](session)
    if not reason:
        about = RESTART if name == "restart" else "Resume" if held else name.capitalize()
        ui.hint(f"{about}  ({key_of(name)})")


def _rewind(session: Session, gui: Gui) -> None:
    """Build the slider; its right end is the latest state."""
    history = session.runner.history
    span = ui.Range(-max(history.span, SHORTEST), 0.0)
    imgui.begin_disabled(history.span <= SHORTEST)
    form = "now" if history.back < SHORTEST else "%.1f s"
    moved, value = ui.slider(gui, "moment", span, -history.back, form)
    imgui.end_disabled()
    if moved is not ui.Moved.NOT:
        session.runner.rewind(-value)
    steps = "each step" if history.stride == 1 else f"every {history.stride} steps"
    ui.soft(f"{history.span:.1f} s · snapshot {steps} · {history.bytes / MEGABYTE:.1f} MB")
    ui.hint(
        f"Snapshots take up to {history.budget / MEGABYTE:.0f} MB. Steps without a snapshot are "
        "re-simulated, with the same bits."
    )


TITLE = 21.0
LIFE = "Particle life"
OPEN = {"Scenes", LIFE, "World"}  # the others are folded at first
SECTIONS: list[tuple[str, Callable[[Session, Gui], None]]] = [
    ("Scenes", files_panel.build_scenes),
    (LIFE, life_panel.build),
    ("Method", settings_panel.build_method),
    ("Particles and tree", settings_panel.build_tree),
    ("Display", settings_panel.build_display),
    ("World", settings_panel.build_world),
    ("Time", settings_panel.build_time),
    ("Rewind", _rewind),
    ("Collision filter", life_panel.build_filter),
    ("Two particles", files_panel.build_why),
    ("Files", files_panel.build),
]


def build(session: Session, gui: Gui) -> None:
    """Build the column, if the window is wide enough."""
    widths = layout(session, *imgui.get_io().display_size)
    if not widths.column:
        return
    with ui.side_panel("controls", (0.0, 0.0), (widths.column, widths.height)):
        _title(session)
        _playback(session, gui)
        for title, contents in SECTIONS:
            # In other scenes this section could change nothing.
            if title != LIFE or session.frame.matrix is not None:
                ui.section(gui, title, partial(contents, session, gui), is_open=title in OPEN)
        if not widths.statistics:
            statistics_panel.build_sections(session, gui)


def _title(session: Session) -> None:
    with imgui_ctx.push_font(None, TITLE):
        imgui.text_unformatted(session.engine.scene)
    if session.runner.paused:
        with ui.colours(text=vec(ACCENT)):
            ui.at_right("paused")
    with ui.colours(text=vec(TEXT_SOFT)):
        count = np.count_nonzero(session.frame.movable)  # without the discs of walls
        words = f"{count:,} particles · {METHODS[session.settings.method]}"
        imgui.text_unformatted(words)
    _slowness(session)
    imgui.dummy((0.0, 2.0))
