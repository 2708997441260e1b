"""All layers of a frame in their order, for the window and for videos."""

from collections.abc import Callable

import pygame

import jostle
from jostle_lab.draw import base_layers, marks
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.colouring import Colouring
from jostle_lab.draw.marks import Trails
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.scene_overlays import SceneOverlays
from jostle_lab.draw.text import EDGE, Card, Legend, draw_cards
from jostle_lab.draw.view_options import ColourBy, TreeView, ViewOptions
from jostle_lab.simulate.containers import bounds
from jostle_lab.simulate.frame import Frame, FrameRequest

DrawTree = Callable[[Painter, jostle.Nodes, Camera], Legend | None]


class Picture:
    """Draws frames, and keeps what one frame needs of those before it.

    Each run has its own.
    """

    def __init__(self) -> None:
        self.colouring = Colouring()  # the colour of each particle
        self.trails = Trails()  # the past positions of particles
        self._extras = SceneOverlays()

    @staticmethod
    def request(options: ViewOptions) -> FrameRequest:
        """Return what a frame must contain for the view options."""
        return FrameRequest(
            tree=options.tree is not TreeView.OFF, contacts=options.contacts or options.forces
        )

    def draw(
        self,
        painter: Painter,
        frame: Frame,
        camera: Camera,
        options: ViewOptions,
        part: pygame.Rect | None = None,
    ) -> None:
        """Draw the part of the world in the camera's view, on the canvas or a part of it."""
        painter.clip(part)
        cards: list[Card | None] = []
        shades = self.colouring.shades(frame, options.colour_by)
        if options.colour_by is not ColourBy.AUTO:
            cards.append(self.colouring.legend)
        base_layers.draw_container(painter, frame.container, camera)
        if options.tree is TreeView.FILLED:
            _draw_tree(base_layers.draw_filled, painter, frame, camera, part)
        elif options.tree is TreeView.HEAT:
            cards.append(_draw_tree(base_layers.draw_heat, painter, frame, camera, part))
        if options.trails:
            cards.append(self.trails.draw(painter, frame, shades, camera))
        self._extras.draw_below(painter, frame, camera)
        marks.draw_springs(painter, frame, camera)
        base_layers.draw_discs(painter, frame, shades, camera)
        marks.draw_spins(painter, frame, camera)
        base_layers.draw_wall_discs(painter, frame, camera)
        base_layers.draw_walls(painter, frame.walls, frame.container, camera)
        if options.tree is TreeView.OUTLINE:
            _draw_tree(base_layers.draw_outline, painter, frame, camera, part)
        marks.draw_attractors(painter, frame, camera)
        if options.forces:
            cards.append(marks.draw_force_chains(painter, frame, camera))
        if options.contacts:
            cards.append(marks.draw_contacts(painter, frame, camera))
        if options.velocities:
            cards.append(marks.draw_velocities(painter, frame, camera))
        if options.labels:
            cards.append(marks.draw_labels(painter, frame, camera))
        cards += self._extras.draw_above(painter, frame, camera)
        painter.clip(None)
        left, right = camera.left_margin + EDGE, camera.column_edge(camera.columns)
        if part is not None:
            left, right = max(left, part.left + EDGE), min(right, part.right)
        draw_cards(painter, [card for card in cards if card], left, right)


def _draw_tree(
    draw: DrawTree, painter: Painter, frame: Frame, camera: Camera, part: pygame.Rect | None
) -> Legend | None:
    """Draw the boxes inside the container; those outside are always empty."""
    if frame.tree is None:
        return None
    walls = bounds(frame.container)
    if walls is not None:
        inside = base_layers.rect_on_screen(walls, camera)
        painter.clip(inside if part is None else inside.clip(part))
    legend = draw(painter, frame.tree, camera)
    painter.clip(part)
    return legend
