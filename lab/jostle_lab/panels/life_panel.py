"""Particle life: the matrix of the attractions between kinds; and the collision filter."""

from functools import partial

import numpy as np
from imgui_bundle import imgui, imgui_ctx
from numpy.typing import NDArray

from jostle import life
from jostle_lab.act.interaction import Tool
from jostle_lab.draw.palette import KINDS, TEXT
from jostle_lab.gui.host import Gui
from jostle_lab.gui.style import RAISED, rgba
from jostle_lab.panels import widgets as ui
from jostle_lab.session import Session

STEP = 0.1  # change of an attraction by a click
HEAD = 20.0  # points: width of the first column, height of the first line
GAP = 2.0  # between cells
CELL = 30.0  # largest side
PULL, PUSH = (86, 190, 120), (222, 92, 92)  # colours of attraction and repulsion
MUTUAL = "A random matrix with mutual attractions. Everything comes to rest."
ABOUT = (
    "How strongly the kind of the row is attracted by that of the column. Click to raise it, "
    "right-click to lower it."
)


def build(session: Session, gui: Gui) -> None:
    matrix = session.frame.matrix
    if matrix is None:
        return
    _grid(session, gui, matrix)

    def randomise(symmetric: bool) -> None:
        rng = np.random.default_rng()
        _apply(session, life.random_matrix(rng, len(matrix), symmetric=symmetric))

    ui.buttons(
        gui,
        ui.Button("randomise", "randomise", partial(randomise, False)),
        ui.Button("randomise symmetric", "symmetric", partial(randomise, True), MUTUAL),
    )
    present = (name for name, known in life.MATRICES.items() if np.array_equal(matrix, known))
    names = {name: name for name in life.MATRICES}
    picked = ui.combo(gui, "preset", names, next(present, "choose one"))
    if picked is not None:
        session.runner.adjust("matrix", picked)
    ui.buttons(
        gui,
        ui.Button("scatter", "scatter", session.interaction.commands.scramble),
        ui.Button("save life", "save scene", session.files.save),
    )


def _apply(session: Session, matrix: NDArray[np.float64]) -> None:
    session.runner.adjust("matrix", tuple(map(tuple, matrix.tolist())))


def _grid(session: Session, gui: Gui, matrix: NDArray[np.float64]) -> None:
    """Build the cells, between the kinds that feel (left) and those that act (above)."""
    kinds, commands = len(matrix), session.interaction.commands
    space = imgui.get_content_region_avail().x
    side = min((space - HEAD) / kinds - GAP, CELL)
    corner = imgui.get_cursor_screen_pos()
    left = corner.x + HEAD

    def place(k: int) -> float:
        return k * (side + GAP)

    for k in range(kinds):
        _dot(left + place(k) + side / 2, corner.y + HEAD / 2, k, chosen=False)
        middle = corner.y + HEAD + place(k) + side / 2
        imgui.set_cursor_screen_pos((corner.x, middle - side / 2))
        if imgui.invisible_button(f"##kind {k}", (HEAD - GAP, side)):
            commands.kind = k
            session.interaction.choose(Tool.BRUSH)
        gui.mark(f"kind {k}")
        ui.hint("New particles have this kind: drag with the brush, or press A at the cursor.")
        _dot(corner.x + HEAD / 2 - 1, middle, k, chosen=k == commands.kind % kinds)
    for a in range(kinds):
        for b in range(kinds):
            at = (left + place(b), corner.y + HEAD + place(a))
            _cell(session, gui, matrix, (a, b), at, side)
    imgui.set_cursor_screen_pos((corner.x, corner.y + HEAD + place(kinds) + GAP))
    imgui.dummy((1.0, 1.0))


def _cell(
    session: Session,
    gui: Gui,
    matrix: NDArray[np.float64],
    pair: tuple[int, int],
    at: tuple[float, float],
    side: float,
) -> None:
    """Build the cell of one attraction, and apply clicks."""
    value = float(matrix[pair])
    imgui.set_cursor_screen_pos(at)
    flags = imgui.ButtonFlags_.mouse_button_left | imgui.ButtonFlags_.mouse_button_right
    clicked = imgui.invisible_button(f"##cell {pair}", (side, side), flags)
    gui.mark(f"attraction {pair[0]} {pair[1]}")
    ui.hint(f"{ui.signed(value, '+.1f')}. {ABOUT}")
    draw, share = imgui.get_window_draw_list(), min(abs(value), 1.0)
    tint = PULL if value > 0 else PUSH
    end = (at[0] + side, at[1] + side)
    draw.add_rect_filled(at, end, rgba(RAISED), 3.0)
    draw.add_rect_filled(at, end, rgba(tint, 0.15 + 0.85 * share if share else 0.0), 3.0)
    if imgui.is_item_hovered():
        draw.add_rect(at, end, rgba(TEXT), 3.0)
    if not clicked:
        return
    change = -STEP if imgui.is_mouse_released(imgui.MouseButton_.right) else STEP
    new = min(max(round(value + change, 1), -1.0), 1.0)
    if new != value:
        changed = matrix.copy()
        changed[pair] = new
        _apply(session, changed)


def _dot(x: float, y: float, kind: int, *, chosen: bool) -> None:
    """Draw a disc in the colour of a kind."""
    draw = imgui.get_window_draw_list()
    draw.add_circle_filled((x, y), 6.0, rgba(KINDS[kind % len(KINDS)]))
    if chosen:
        draw.add_circle((x, y), 8.5, rgba(TEXT), 0, 1.5)


SHOWN = 8  # of 32 categories; the others stay as they are
COLUMNS = {
    "categories": ("category", "Bit {0}: {1} in the categories of files and of World."),
    "masks": ("collides with", "Bit {0} of the mask: collisions with particles of category {0}."),
}


def build_filter(session: Session, gui: Gui) -> None:
    """Build a line of categories and one of masks; a click changes one bit.

    Of several selected particles the first one is shown, so that a frame takes the same time for
    any number of them.
    """
    tags, commands = session.interaction.selection.tags, session.interaction.commands
    ui.soft(f"of {len(tags):,} selected" if len(tags) else "of new particles")
    # Without padding, so that a digit is centred on a narrow button.
    padding = 0.0, imgui.get_style().frame_padding.y
    with imgui_ctx.push_style_var(imgui.StyleVar_.frame_padding, padding):
        for column, (words, about) in COLUMNS.items():
            rows = session.frame.rows(tags[:1])
            new = commands.new_filter[column]
            bits = int(getattr(session.frame, column)[rows[0]]) if len(rows) else new
            ui.label(words)
            for bit, across in ui.in_rows(range(SHOWN), SHOWN):
                on = bool(bits >> bit & 1)
                if ui.choice(gui, f"{words} {bit}", str(bit), across, chosen=on):
                    commands.set_bit(tags, column, bit, on=not on)
                ui.hint(about.format(bit, 1 << bit))
