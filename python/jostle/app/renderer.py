"""Discs and walls, drawn by the processor alone: the renderer that works everywhere.

Discs fall into three kinds by their radius on the screen: large circles, stamps and dust.
"""

from __future__ import annotations

import numpy as np
import pygame
from numpy.typing import NDArray

import jostle
from jostle.app import dust
from jostle.app.camera import Camera
from jostle.app.palette import DISCS, GROUND, STAGE, WALL, blend
from jostle.app.simulation import Container, Frame, Rect
from jostle.app.stamps import MAX_RADIUS as MAX_STAMP
from jostle.app.stamps import RIM_SHADE, RIM_WIDTH, Stamps

Floats = NDArray[np.floating]

CIRCLE_LIMIT = 4000.0  # pixels; pygame's circles cost time in proportion to their radius
WALL_WIDTH = 2
FAR = 30_000  # pixels; what is drawn by pygame is clipped to this first


class Renderer:
    """Draws a frame onto a surface. Keeps stamps between frames, and nothing else."""

    def __init__(self) -> None:
        self._stamps = Stamps()

    def draw_stage(self, target: pygame.Surface, container: Container, camera: Camera) -> None:
        """Clear the surface and draw the walls."""
        target.fill(GROUND)
        walls = bounds(container)
        if walls is None:
            target.fill(STAGE)
        elif isinstance(container, jostle.Circle):
            (x,), (y,) = camera.to_screen(np.array([container.center], np.float64))
            radius = container.radius * camera.scale
            _draw_circle(target, (x, y), radius + WALL_WIDTH, WALL)
            _draw_circle(target, (x, y), radius, STAGE)
        else:
            inside = rect_on_screen(walls, camera)
            target.fill(WALL, inside.inflate(2 * WALL_WIDTH, 2 * WALL_WIDTH))
            target.fill(STAGE, inside)

    def draw_discs(
        self,
        target: pygame.Surface,
        frame: Frame,
        shades: NDArray[np.uint8],
        camera: Camera,
    ) -> None:
        """Draw every disc that the view shows: the large ones first, so that they hide none."""
        x, y = camera.to_screen(frame.positions)
        radii = frame.radii.astype(np.float64) * camera.scale
        width, height = camera.size
        reach = radii + 1
        seen = (x > -reach) & (x < width + reach) & (y > -reach) & (y < height + reach)
        if not seen.all():
            x, y, radii, shades = x[seen], y[seen], radii[seen], shades[seen]
        kind = np.digitize(radii, (dust.MAX_RADIUS, MAX_STAMP), right=True)
        for number, draw in ((2, _draw_large), (1, self._stamps.blit), (0, dust.scatter)):
            mine = kind == number
            if mine.all():
                draw(target, x, y, radii, shades)
            elif mine.any():
                draw(target, x[mine], y[mine], radii[mine], shades[mine])


def bounds(container: Container) -> Rect | None:
    """Return the rectangle around the walls; None where there are none."""
    if container is None:
        return None
    if isinstance(container, jostle.Torus):
        return 0.0, 0.0, container.width, container.height
    if isinstance(container, jostle.Circle):
        (x, y), radius = container.center, container.radius
        return x - radius, y - radius, x + radius, y + radius
    return container.min_x, container.min_y, container.max_x, container.max_y


def rect_on_screen(rect: Rect, camera: Camera) -> pygame.Rect:
    """Return a rectangle in whole pixels, clipped far outside of every screen."""
    x0, y0, x1, y1 = (max(-FAR, min(FAR, round(c))) for c in camera.rect_to_screen(rect))
    return pygame.Rect(x0, y0, x1 - x0, y1 - y0)


def _draw_large(
    target: pygame.Surface, x: Floats, y: Floats, radii: Floats, shades: NDArray[np.uint8]
) -> None:
    columns = x.tolist(), y.tolist(), radii.tolist(), shades.tolist()
    for at_x, at_y, radius, shade in zip(*columns, strict=True):
        colour = DISCS[shade]
        _draw_circle(target, (at_x, at_y), radius, blend((0, 0, 0), colour, RIM_SHADE))
        _draw_circle(target, (at_x, at_y), radius - RIM_WIDTH, colour)


def _draw_circle(
    target: pygame.Surface,
    center: tuple[float, float],
    radius: float,
    colour: tuple[int, int, int],
) -> None:
    """Draw a filled circle of any size."""
    if radius <= CIRCLE_LIMIT:
        if radius > 0:
            pygame.draw.aacircle(target, colour, center, radius)
        return
    # So large that its edge is almost straight: decide pixel by pixel.
    width, height = target.get_size()
    x = np.arange(width) + 0.5 - center[0]
    y = np.arange(height) + 0.5 - center[1]
    inside = (x * x)[:, None] + (y * y)[None, :] <= radius * radius
    pygame.surfarray.pixels3d(target)[inside] = colour
