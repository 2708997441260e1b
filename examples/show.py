"""Code that the examples share: colours, a window, axes, a caption.

Without arguments an example opens a window. With `--picture FILE` it runs without a display and
with simulated mouse movement, saves its last frame and ends; `--frames N` sets the number of
frames.
"""

from __future__ import annotations

import argparse
import itertools
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

SIZE = WIDTH, HEIGHT = 800, 500

GROUND, DIM, SOFT, TEXT = "#10141a", "#2c3542", "#8e9aab", "#dce3ec"
BLUE, TEAL, GREEN = "#4f6d9e", "#6fb0a2", "#a7c58c"
YELLOW, ORANGE, RED = "#e2c67c", "#e09b6a", "#c9686a"
RAMP = [BLUE, "#5590a8", TEAL, GREEN, YELLOW, ORANGE, RED]

_parser = argparse.ArgumentParser()
_parser.add_argument("--picture", metavar="FILE", help="draw without a display, save, and end")
_parser.add_argument("--frames", metavar="N", type=int, help="frames before the picture is saved")
_asked = _parser.parse_args()

if _asked.picture:
    os.environ["SDL_VIDEODRIVER"] = "dummy"


# ---- pygame ----


def frames(title: str, until: int = 120) -> Iterator[Any]:
    """Open a window and yield it, cleared, sixty times per second, until it is closed.

    With `--picture`, `until` is the number of frames before it is saved.
    """
    import pygame

    pygame.display.init()
    pygame.font.init()
    screen = pygame.display.set_mode(SIZE, 0 if _asked.picture else pygame.SCALED)
    pygame.display.set_caption(title)
    clock = pygame.time.Clock()
    last = (_asked.frames or until) - 1
    for frame in itertools.count():
        if _asked.picture:
            _move_hand(frame, last)
        pygame.event.pump()
        if pygame.event.get(pygame.QUIT):
            return
        screen.fill(GROUND)
        yield screen
        if _asked.picture and frame == last:
            pygame.image.save(screen, _asked.picture)
            return
        pygame.display.flip()
        if not _asked.picture:
            clock.tick(60)
            pygame.display.set_caption(f"{title} - {clock.get_fps():.0f} FPS")
        pygame.event.get(exclude=pygame.QUIT, pump=False)  # discards unread events


def _move_hand(frame: int, last: int) -> None:
    """Simulate a drag from the upper left, around the centre, to the lower right."""
    import pygame

    angle = math.pi * (0.75 - frame / max(last, 1))
    place = (round(400 + 220 * math.cos(angle)), round(250 - 130 * math.sin(angle)))
    pygame.mouse.set_pos(place)
    if frame == 0:
        pygame.event.post(pygame.Event(pygame.MOUSEBUTTONDOWN, pos=place, button=1))


@cache
def _font() -> Any:
    import pygame

    faces = "inter,segoeui,helveticaneue,notosans,dejavusans,liberationsans,arial"
    return pygame.font.SysFont(faces, 14)


def caption(screen: Any, text: str) -> None:
    """Draw a line of text at the bottom of the window."""
    import pygame

    words = _font().render(text, True, TEXT)
    sheet = pygame.Surface((words.get_width() + 24, words.get_height() + 12), pygame.SRCALPHA)
    pygame.draw.rect(sheet, (12, 15, 20, 224), sheet.get_rect(), border_radius=8)
    sheet.blit(words, (12, 6))
    screen.blit(sheet, (12, HEIGHT - 12 - sheet.get_height()))


# ---- matplotlib ----


@contextmanager
def axes(text: str, labels: tuple[str, str] | None = None) -> Iterator[Any]:
    """Yield axes for a still picture, of 800 by 500 pixels with y downwards, as in a window.

    With labels for x and y the axes have scales, which fit what is drawn, and y points upwards.
    """
    import matplotlib.pyplot as plt

    if _asked.picture:
        plt.switch_backend("Agg")
    figure = plt.figure(figsize=(WIDTH / 100, HEIGHT / 100), dpi=100, facecolor=GROUND)
    plot = figure.add_axes((0.09, 0.22, 0.87, 0.73) if labels else (0, 0, 1, 1), facecolor=GROUND)
    if labels:
        plot.set(xlabel=labels[0], ylabel=labels[1])
        plot.tick_params(colors=SOFT)
        plot.spines[:].set_color(DIM)
        plot.xaxis.label.set_color(TEXT)
        plot.yaxis.label.set_color(TEXT)
    else:
        plot.axis("off")
        plot.set(xlim=(0, WIDTH), ylim=(HEIGHT, 0))
    yield plot
    box = {"boxstyle": "round,pad=0.6", "fc": (0.05, 0.06, 0.08, 0.88), "ec": "none"}
    figure.text(24 / WIDTH, 24 / HEIGHT, text, color=TEXT, size=9.8, bbox=box, va="baseline")
    if _asked.picture:
        figure.savefig(_asked.picture, dpi=100, facecolor=GROUND)
    else:
        plt.show()


def discs(plot: Any, centers: Any, radii: Any, color: Any, **style: Any) -> None:
    """Draw discs by their centres and radii."""
    from matplotlib.collections import EllipseCollection

    style = {"facecolors": color, "edgecolors": GROUND, "linewidths": 0.8, **style}
    place = {"offsets": centers, "offset_transform": plot.transData, "units": "xy"}
    plot.add_collection(EllipseCollection(2 * radii, 2 * radii, 0 * radii, **place, **style))
