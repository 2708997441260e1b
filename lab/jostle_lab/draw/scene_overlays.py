"""What single scenes show beside their particles: a curve, a path, a line of text."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import ACCENT, TEXT_SOFT
from jostle_lab.draw.text import SMALL, Card, scientific, share, word
from jostle_lab.simulate.frame import Frame

PATH_POINTS = 1_200  # of the heavy particle's path; then every second one is removed
PATH_EVERY = 1 / 30  # initial seconds between points
PATH_COLOUR = (226, 198, 124)
CURVE_POINTS = 96
PACKED = 0.82  # fraction of a bin that resting balls fill
SMALLEST_BIN = 14.0  # pixels; narrower bins have no counts


class SceneOverlays:
    """Draws the overlays of a frame's scene; keeps the path of the heavy particle."""

    def __init__(self) -> None:
        self._forget()

    def _forget(self) -> None:
        self._path: list[tuple[float, float]] = []
        self._every, self._last, self._now = PATH_EVERY, -math.inf, (0.0, 0.0)

    def draw_below(self, painter: Painter, frame: Frame, camera: Camera) -> None:
        """Draw below the discs."""
        if frame.scene == "brownian" and len(frame):
            self._follow(frame)
            _draw_path(painter, np.array([*self._path, self._now]), camera)

    def draw_above(self, painter: Painter, frame: Frame, camera: Camera) -> list[Card]:
        """Draw above the discs; return texts for cards."""
        if len(frame) == 0:
            return []
        if frame.scene == "galton":
            return [_draw_galton(painter, frame, camera)]
        if frame.scene == "brownian" and len(self._path) > 1:
            away = math.dist(self._path[0], self._now)
            return [f"displacement of the large disc: {away:,.0f}"]
        if frame.scene == "thermostat":
            return _mixing(frame)
        if frame.scene == "stars":
            masses = frame.masses.astype(np.float64)
            largest = f"{100 * masses.max() / max(masses.sum(), 1e-30):.2g} %"
            return [f"{len(frame):,} bodies; largest: {largest} of the mass"]
        return []

    def _follow(self, frame: Frame) -> None:
        """Record the position of the heaviest particle."""
        now = frame.stats.time
        if now < self._last:
            self._forget()  # after a rewind the path begins anew
        x, y = frame.positions[int(np.argmax(frame.masses))].tolist()
        self._now = x, y
        if now - self._last < 0.999 * self._every:
            return
        self._last = now
        self._path.append((x, y))
        if len(self._path) > PATH_POINTS:
            self._path, self._every = self._path[::2], 2 * self._every


def _draw_path(painter: Painter, path: NDArray[np.float64], camera: Camera) -> None:
    """Draw a path; later parts are brighter."""
    if len(path) < 2:
        return
    ends = camera.lines_to_screen(path[:-1], path[1:])
    near = camera.sees(ends)
    colours = np.full((len(ends), 4), (*PATH_COLOUR, 255), np.uint8)
    colours[:, 3] = np.linspace(70, 255, len(ends))
    painter.lines(ends[near], colours[near], 2.0)


def _draw_galton(painter: Painter, frame: Frame, camera: Camera) -> Card:
    """Draw the expected height of each bin, and the number of balls in it."""
    board = _board(frame.begun_with)
    edges = board.bin_edges.astype(np.float64)
    balls = frame.positions[frame.movable]
    counts, _ = np.histogram(balls[balls[:, 1] > board.bin_top, 0], edges)
    pitch = edges[1] - edges[0]
    x = np.linspace(edges[0], edges[-1], CURVE_POINTS)
    expected = len(balls) * binomial((x - edges[0]) / pitch - 0.5, board.rows)
    height = expected * math.pi * board.ball_radius**2 / (PACKED * pitch)
    curve = np.column_stack([x, board.floor - height])
    ends = camera.lines_to_screen(curve[:-1], curve[1:])
    ends = ends[camera.sees(ends)]
    painter.lines(ends, ACCENT, 2.0)
    if pitch * camera.scale >= SMALLEST_BIN:
        middles = np.column_stack([(edges[:-1] + edges[1:]) / 2, np.full(len(counts), board.floor)])
        bin_x, bin_y = camera.to_screen(middles)
        for left, top, count in zip(bin_x.tolist(), bin_y.tolist(), counts.tolist(), strict=True):
            picture = word(f"{count}", TEXT_SOFT, SMALL)
            painter.sheet(picture, (left - picture.get_width() / 2, top + 5))
    return f"{int(counts.sum()):,} of {len(balls):,} in bins; line: binomial"


def binomial(k: NDArray[np.floating], n: int) -> NDArray[np.float64]:
    """Return the probability of k heads in n throws, also for k that is not whole."""
    whole = math.lgamma(n + 1) - n * math.log(2)
    inside = np.clip(k, -0.999, n + 0.999)
    logs = [whole - math.lgamma(at + 1) - math.lgamma(n - at + 1) for at in inside.tolist()]
    return np.exp(logs)


@lru_cache(maxsize=4)
def _board(n: int | None) -> jostle.scenes.GaltonBoard:
    return jostle.scenes.galton_board(n)


def _mixing(frame: Frame) -> list[Card]:
    """Return how far two gases of different density have mixed, and their mean energies."""
    heavy = frame.densities > (frame.densities.min() + frame.densities.max()) / 2
    light = ~heavy & frame.movable
    if not heavy.any() or not light.any():
        return []
    middle = (frame.positions[:, 0].min() + frame.positions[:, 0].max()) / 2
    left = frame.positions[:, 0] < middle
    mixed = 1 - abs(float(left[heavy].mean()) - float(left[light].mean()))
    energy = 0.5 * frame.masses * (frame.velocities.astype(np.float64) ** 2).sum(axis=1)
    means = [scientific(float(energy[kind].mean())) for kind in (light, heavy)]
    return [
        f"mixed: {share(round(1_000 * mixed), 1_000)}",
        f"mean energy: light {means[0]}, heavy {means[1]}",
    ]
