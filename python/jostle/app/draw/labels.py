"""Labels on discs: the tag and the speed."""

from __future__ import annotations

import numpy as np
import pygame

from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import TEXT
from jostle.app.draw.subsampling import in_view, subset
from jostle.app.draw.text import SMALL, font, word
from jostle.app.simulate.simulation import Frame

SMALLEST = 7.0  # pixels of radius; smaller discs have no label
INSIDE = 20.0  # pixels of radius; larger discs show the speed, too
MOST = 200
SHADE = (8, 10, 14)  # outline of the text


def draw_labels(painter: Painter, frame: Frame, camera: Camera) -> str | None:
    """Draw tag and speed at large discs; return a note if some are omitted."""
    seen = in_view(frame.positions, camera)
    seen = seen[frame.movable[seen]]
    sizes = frame.radii[seen].astype(np.float64) * camera.scale
    places = seen[sizes >= SMALLEST]
    if len(seen) and not len(places):
        return "labels: zoom in to see them"
    drawn = places[subset(frame.tags[places], MOST)]
    x, y = camera.to_screen(frame.positions[drawn])
    radii = frame.radii[drawn] * camera.scale
    speeds = np.hypot(frame.velocities[drawn, 0], frame.velocities[drawn, 1])
    line = font(SMALL).get_linesize()
    columns = x, y, radii, frame.tags[drawn], speeds
    for at_x, at_y, radius, tag, speed in zip(*(c.tolist() for c in columns), strict=True):
        texts = [f"{tag}", _speed(speed)] if radius >= INSIDE else [f"{tag}"]
        top = at_y - line * len(texts) / 2
        for k, text in enumerate(texts):
            sheet = _shaded(text)
            painter.sheet(sheet, (at_x - sheet.get_width() / 2, top + k * line))
    if len(drawn) < len(places):
        return f"labels: {len(drawn):,} of {len(places):,} shown"
    return None


def _speed(value: float) -> str:
    return f"{value:,.0f}" if value >= 10 else f"{value:.1f}"


_SHEETS: dict[str, pygame.Surface] = {}


def _shaded(text: str) -> pygame.Surface:
    """Return a text with a dark outline, cached."""
    sheet = _SHEETS.get(text)
    if sheet is None:
        if len(_SHEETS) > 4_000:
            _SHEETS.clear()
        light, dark = word(text, TEXT, SMALL), word(text, SHADE, SMALL)
        sheet = pygame.Surface((light.get_width() + 2, light.get_height() + 2), pygame.SRCALPHA, 32)
        for shift in ((0, 1), (2, 1), (1, 0), (1, 2)):
            sheet.blit(dark, shift)
        sheet.blit(light, (1, 1))
        _SHEETS[text] = sheet
    return sheet
