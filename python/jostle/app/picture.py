"""All layers in their order: the one picture of window and film."""

from __future__ import annotations

import time
from collections.abc import Callable

import pygame

from jostle.app import overlays
from jostle.app.camera import Camera, Size
from jostle.app.colouring import Colouring
from jostle.app.helping import draw_help
from jostle.app.overlays import TreeView
from jostle.app.palette import TEXT, TEXT_SOFT
from jostle.app.readout import EDGE, SPACE, Readout
from jostle.app.renderer import Renderer, bounds, rect_on_screen
from jostle.app.simulation import Simulation, TreeBoxes
from jostle.app.text import BODY, font, panel, write

HINT = "H help"

DrawTree = Callable[[pygame.Surface, TreeBoxes, Camera], None]


class Picture:
    """A canvas, a camera and what is shown; it reads the simulation and never writes to it."""

    def __init__(self, size: Size, simulation: Simulation) -> None:
        self.camera = Camera(size, simulation.view, left=SPACE)
        self.readout = Readout()
        self.tree_view = TreeView.OFF
        self.help = False
        self._renderer = Renderer()
        self.restart()
        self.resize(size)

    def resize(self, size: Size) -> None:
        """Take a new size in pixels."""
        size = max(size[0], 1), max(size[1], 1)
        self.camera.resize(size)
        # The same byte order everywhere, so the same picture everywhere, and fast for blits.
        self.canvas = pygame.Surface(size, 0, 32, (0xFF0000, 0xFF00, 0xFF, 0))

    def restart(self) -> None:
        """Forget what belongs to a run that is over."""
        self._colouring = Colouring()
        self.readout.forget()

    def draw(
        self,
        simulation: Simulation,
        rate: tuple[str, float | None],
        now: float,
        *,
        paused: bool = False,
        notice: str = "",
    ) -> None:
        """Draw everything. `now` is in seconds, from any start."""
        start = time.perf_counter()
        canvas, camera = self.canvas, self.camera
        self._renderer.draw_stage(canvas, simulation.container, camera)
        if self.tree_view is TreeView.FILLED:
            self._draw_tree(overlays.draw_filled, simulation)
        frame = simulation.frame()
        self._renderer.draw_discs(canvas, frame, self._colouring.shades(frame), camera)
        if self.tree_view is TreeView.OUTLINE:
            self._draw_tree(overlays.draw_outline, simulation)
        if canvas.get_width() >= 2 * SPACE:  # else it would hide the scene
            self.readout.draw(canvas, simulation, rate, now, paused=paused)
        if notice:
            _draw_notice(canvas, notice)
        if self.help:
            draw_help(canvas)
        self.readout.measure(draw=(time.perf_counter() - start) * 1e3)

    def _draw_tree(self, draw: DrawTree, simulation: Simulation) -> None:
        """Draw the boxes inside the walls: the squares beyond them are always empty."""
        walls = bounds(simulation.container)
        if walls is not None:
            self.canvas.set_clip(rect_on_screen(walls, self.camera))
        draw(self.canvas, simulation.tree_boxes(), self.camera)
        self.canvas.set_clip(None)

    def draw_hint(self) -> None:
        """Say in a corner that there is help."""
        width, height = self.canvas.get_size()
        place = width - EDGE, height - EDGE - font(BODY).get_linesize()
        write(self.canvas, place, HINT, TEXT_SOFT, flush_right=True)


def _draw_notice(canvas: pygame.Surface, notice: str) -> None:
    """Show a sentence at the foot of the screen."""
    width, height = font(BODY).size(notice)
    sheet = panel((width + 32, height + 18))
    write(sheet, (16, 9), notice, TEXT)
    canvas.blit(
        sheet, sheet.get_rect(midbottom=(canvas.get_width() // 2, canvas.get_height() - 2 * EDGE))
    )
