"""Discs and walls, drawn by the processor alone: the renderer that works everywhere.

Discs fall into three kinds by their radius on the screen: dust, stamps and large circles.
Whatever lies outside the view is left out first.
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
from jostle.app.stamps import MAX_RADIUS, MIN_RADIUS, RIM_SHADE, RIM_WIDTH, Stamps

CIRCLE_LIMIT = 4000.0  # pixels; pygame's circles cost time in proportion to their radius
FAR = 30_000  # pixels; what is drawn by pygame is clipped to this first


class Renderer:
    """Draws a frame onto a surface. Keeps stamps between frames, and nothing else."""

    def __init__(self) -> None:
        self._stamps = Stamps()

    def draw_stage(self, target: pygame.Surface, container: Container, camera: Camera) -> None:
        """Clear the surface and draw the walls."""
        target.fill(GROUND)
        if isinstance(container, jostle.Circle):
            x, y = camera.to_screen(np.array([container.center], np.float64))[0]
            radius = container.radius * camera.scale
            _draw_circle(target, (x, y), radius + 2, WALL)
            _draw_circle(target, (x, y), radius, STAGE)
        elif container is None:
            target.fill(STAGE)
        else:
            _draw_box(target, camera.rect_to_screen(_rect_of(container)))

    def draw_discs(
        self,
        target: pygame.Surface,
        frame: Frame,
        shades: NDArray[np.uint8],
        camera: Camera,
    ) -> None:
        """Draw every disc that the view shows, in the order of the columns."""
        centers = camera.to_screen(frame.positions)
        radii = frame.radii * np.float64(camera.scale)
        reach = radii[:, None] + 1
        seen = ((centers > -reach) & (centers < camera.size + reach)).all(axis=1)
        if not seen.all():
            centers, radii, shades = centers[seen], radii[seen], shades[seen]
        small, large = radii < MIN_RADIUS, radii > MAX_RADIUS
        if small.any():
            dust.scatter(target, centers[small], radii[small], shades[small])
        if large.any():
            _draw_large(target, centers[large], radii[large], shades[large])
        if small.any() or large.any():
            middle = ~(small | large)
            centers, radii, shades = centers[middle], radii[middle], shades[middle]
        if len(radii):
            self._stamps.blit(target, centers, radii, shades)


def _rect_of(container: jostle.Box | jostle.Torus) -> Rect:
    if isinstance(container, jostle.Torus):
        return 0.0, 0.0, container.width, container.height
    return container.min_x, container.min_y, container.max_x, container.max_y


def _draw_box(target: pygame.Surface, corners: Rect) -> None:
    x0, y0, x1, y1 = (max(-FAR, min(FAR, round(corner))) for corner in corners)
    inner = pygame.Rect(x0, y0, x1 - x0, y1 - y0)
    target.fill(WALL, inner.inflate(4, 4))
    target.fill(STAGE, inner)


def _draw_large(
    target: pygame.Surface,
    centers: NDArray[np.float64],
    radii: NDArray[np.float64],
    shades: NDArray[np.uint8],
) -> None:
    columns = centers.tolist(), radii.tolist(), shades.tolist()
    for center, radius, shade in zip(*columns, strict=True):
        colour = DISCS[shade]
        _draw_circle(target, center, radius, blend((0, 0, 0), colour, RIM_SHADE))
        _draw_circle(target, center, radius - RIM_WIDTH, colour)


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
