"""All layers of the picture in their order, for the window and films."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pygame

from jostle.app.draw import overlays
from jostle.app.draw.camera import Camera
from jostle.app.draw.chains import draw_chains
from jostle.app.draw.colouring import Colouring
from jostle.app.draw.extras import Extras
from jostle.app.draw.labels import draw_labels
from jostle.app.draw.legend import Card, Legend, draw_cards
from jostle.app.draw.marks import (
    draw_attractors,
    draw_contacts,
    draw_spins,
    draw_springs,
    draw_velocities,
)
from jostle.app.draw.painter import Painter
from jostle.app.draw.shown import ColourBy, Shown, TreeView
from jostle.app.draw.stage import Beads, draw_discs, draw_stage, draw_walls, rect_on_screen
from jostle.app.draw.trails import Trails
from jostle.app.simulate.simulation import Frame, TreeBoxes, Wants
from jostle.app.simulate.walls import bounds

DrawTree = Callable[[Painter, TreeBoxes, Camera], Legend | None]


class Picture:
    """Draws frames; it keeps what a picture remembers from frame to frame, and nothing else.

    Another run has another one. Two threads may draw with it, one after the other.

    Attributes
    ----------
    colouring
        What the colours tell.
    trails
        Where particles have been.
    """

    def __init__(self) -> None:
        self._in_use = threading.Lock()  # by the window or by the thread that draws beside it
        self.colouring = Colouring()
        self.trails = Trails()
        self._beads = Beads()
        self._extras = Extras()

    def clear_trails(self) -> None:
        """Forget where particles have been."""
        self.trails.clear()

    @staticmethod
    def wants(shown: Shown) -> Wants:
        """Return what a frame must hold for what is shown."""
        return Wants(tree=shown.tree is not TreeView.OFF, contacts=shown.contacts or shown.forces)

    def draw(
        self,
        painter: Painter,
        frame: Frame,
        camera: Camera,
        shown: Shown,
        part: pygame.Rect | None = None,
    ) -> None:
        """Draw the world as far as the camera sees it, on the whole canvas or a part of it."""
        with self._in_use:
            self._draw(painter, frame, camera, shown, part)

    def _draw(
        self,
        painter: Painter,
        frame: Frame,
        camera: Camera,
        shown: Shown,
        part: pygame.Rect | None,
    ) -> None:
        painter.clip(part)
        cards: list[Card | None] = []
        shades = self.colouring.shades(frame, shown.colour_by)
        if shown.colour_by is not ColourBy.AUTO:
            cards.append(self.colouring.legend)
        draw_stage(painter, frame.container, camera)
        if shown.tree is TreeView.FILLED:
            _draw_tree(overlays.draw_filled, painter, frame, camera, part)
        elif shown.tree is TreeView.HEAT:
            cards.append(_draw_tree(overlays.draw_heat, painter, frame, camera, part))
        if shown.trails:
            cards.append(self.trails.draw(painter, frame, shades, camera))
        self._extras.draw_below(painter, frame, camera)
        draw_springs(painter, frame, camera)
        draw_discs(painter, frame, shades, camera)
        draw_spins(painter, frame, camera)
        self._beads.draw(painter, frame, camera)
        draw_walls(painter, frame.walls, camera)
        if shown.tree is TreeView.OUTLINE:
            _draw_tree(overlays.draw_outline, painter, frame, camera, part)
        draw_attractors(painter, frame, camera)
        if shown.forces:
            cards.append(draw_chains(painter, frame, camera))
        if shown.contacts:
            cards.append(draw_contacts(painter, frame, camera))
        if shown.velocities:
            cards.append(draw_velocities(painter, frame, camera))
        if shown.labels:
            cards.append(draw_labels(painter, frame, camera))
        cards += self._extras.draw_above(painter, frame, camera)
        painter.clip(None)
        right = camera.column_edge(camera.columns)
        if part is not None:
            right = min(right, part.right)
        draw_cards(painter, [card for card in cards if card], right)


def _draw_tree(
    draw: DrawTree, painter: Painter, frame: Frame, camera: Camera, part: pygame.Rect | None
) -> Legend | None:
    """Draw the boxes inside the walls: the squares beyond them are always empty."""
    if frame.tree is None:
        return None
    walls = bounds(frame.container)
    if walls is not None:
        inside = rect_on_screen(walls, camera)
        painter.clip(inside if part is None else inside.clip(part))
    legend = draw(painter, frame.tree, camera)
    painter.clip(part)
    return legend
