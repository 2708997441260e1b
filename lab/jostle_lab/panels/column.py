"""The column at the left: the time, and sections, scrolled if they do not fit."""

from collections.abc import Callable
from functools import partial

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
MEGABYTE = 2**20
SHORTEST = 0.05  # seconds of history below which the slider is disabled


def _playback(session: Session, gui: Gui) -> None:
    """Build the buttons of the time: pause, step, restart, previous and next scene."""
    paused, can_go_back = session.runner.paused, session.runner.history.can_go_back
    for (name, icon), across in ui.in_rows(ICONS.items(), len(ICONS)):
        held = name == "pause" and paused
        reason = "There is no earlier state." if name == "step back" and not can_go_back else ""
        if ui.choice(gui, name, PLAY if held else icon, across, chosen=held, reason=reason):
            HANDLERS[name](session)
        if not reason:
            ui.hint(f"{'Resume' if held else name.capitalize()}  ({key_of(name)})")


def _rewind(session: Session, gui: Gui) -> None:
    """Build the slider; its right end is the latest state."""
    history = session.runner.history
    span = ui.Range(-max(history.span, SHORTEST), 0.0)
    imgui.begin_disabled(history.span <= SHORTEST)
    moved, value = ui.slider(gui, "moment", span, -history.back, _ago)
    imgui.end_disabled()
    if moved is not ui.Moved.NOT:
        session.runner.rewind(-value)
    steps = "each step" if history.stride == 1 else f"every {history.stride} steps"
    ui.soft(f"{history.span:.1f} s · snapshot {steps} · {history.bytes / MEGABYTE:.1f} MB")
    ui.hint(
        f"Snapshots take up to {history.budget / MEGABYTE:.0f} MB. Steps without a snapshot are "
        "re-simulated, with the same bits."
    )


def _ago(value: float) -> str:
    return f"\u2212{-value:.1f} s" if value < -SHORTEST else "now"


TITLE = 21.0
LIFE = "Particle life"
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
                ui.section(gui, title, partial(contents, session, gui))
        if not widths.statistics:
            statistics_panel.build_sections(session, gui)


def _title(session: Session) -> None:
    with imgui_ctx.push_font(None, TITLE):
        imgui.text_unformatted(session.engine.scene)
    if session.runner.paused:
        with ui.colours(text=vec(ACCENT)):
            ui.at_right("paused")
    with ui.colours(text=vec(TEXT_SOFT)):
        words = f"{len(session.frame):,} particles · {METHODS[session.settings.method]}"
        imgui.text_unformatted(words)
    imgui.dummy((0.0, 2.0))
