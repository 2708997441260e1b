"""All layers in their order: the one picture of window and film."""

from __future__ import annotations

from collections.abc import Callable

from jostle.app import overlays
from jostle.app.camera import Camera
from jostle.app.colouring import Colouring
from jostle.app.painter import Painter
from jostle.app.shown import Shown, TreeView
from jostle.app.simulation import Frame, TreeBoxes, Wants
from jostle.app.stage import bounds, draw_discs, draw_stage, rect_on_screen

DrawTree = Callable[[Painter, TreeBoxes, Camera], None]


class Picture:
    """Draws frames; it keeps what a picture remembers from frame to frame, and nothing else."""

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Forget what belongs to a run that is over."""
        self._colouring = Colouring()

    @staticmethod
    def wants(shown: Shown) -> Wants:
        """Return what a frame must hold for what is shown."""
        return Wants(tree=shown.tree is not TreeView.OFF, contacts=shown.contacts)

    def draw(self, painter: Painter, frame: Frame, camera: Camera, shown: Shown) -> None:
        """Draw the world as far as the camera sees it."""
        draw_stage(painter, frame.container, camera)
        if shown.tree is TreeView.FILLED:
            _draw_tree(overlays.draw_filled, painter, frame, camera)
        draw_discs(painter, frame, self._colouring.shades(frame), camera)
        if shown.tree is TreeView.OUTLINE:
            _draw_tree(overlays.draw_outline, painter, frame, camera)


def _draw_tree(draw: DrawTree, painter: Painter, frame: Frame, camera: Camera) -> None:
    """Draw the boxes inside the walls: the squares beyond them are always empty."""
    if frame.tree is None:
        return
    walls = bounds(frame.container)
    if walls is not None:
        painter.clip(rect_on_screen(walls, camera))
    draw(painter, frame.tree, camera)
    painter.clip(None)
