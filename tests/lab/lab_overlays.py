"""For the tests of drawing: a frame from columns, a camera of pixels, a recording painter."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pygame
import pytest

import jostle
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.screen import NoOpenGLError, Screen
from jostle_lab.simulate.frame import Frame, FrameContacts, StepStats

SIZE = (320, 240)
VIEW = (0.0, 0.0, 320.0, 240.0)


@dataclass
class Notes:
    """A painter that only records its calls."""

    size: tuple[int, int] = SIZE
    strokes: list[tuple[str, tuple, dict]] = field(default_factory=list)

    def __getattr__(self, name: str) -> Any:
        return lambda *values, **options: self.strokes.append((name, values, options))

    def lines_drawn(self) -> np.ndarray:
        """The ends of all lines, (k, 4)."""
        ends = [values[0] for name, values, _ in self.strokes if name == "lines"]
        return np.concatenate(ends) if ends else np.empty((0, 4))

    def colours_drawn(self) -> np.ndarray:
        """The colours of all lines."""
        return np.concatenate([values[1] for name, values, _ in self.strokes if name == "lines"])

    def sheets_drawn(self) -> list[tuple[float, float]]:
        """Where sheets were laid."""
        return [values[1] for name, values, _ in self.strokes if name == "sheet"]


def pixels(painter: Painter | Screen) -> np.ndarray:
    """Colours, shape (width, height, 3)."""
    return pygame.surfarray.array3d(painter.canvas()).astype(int)


def tree_of(boxes, levels, counts, leaves) -> jostle.Nodes:
    return jostle.Nodes(
        np.array(boxes, float).reshape(-1, 4),
        np.array(levels, int),
        np.array(counts, int),
        np.array(leaves, bool),
    )


def camera_of_pixels() -> Camera:
    """One world unit is one pixel."""
    camera = Camera(SIZE, VIEW)
    camera.aim((160.0, 120.0), 1.0)
    return camera


def frame_of(positions, radii=5.0, *, time: float = 0.0, **columns) -> Frame:
    """A frame; what is not given is the same for all."""
    places = np.array(positions, np.float32).reshape(-1, 2)
    n = len(places)

    def column(name: str, value: Any, kind: Any) -> np.ndarray:
        return np.broadcast_to(np.asarray(columns.pop(name, value), kind), n).copy()

    velocities = np.broadcast_to(np.asarray(columns.pop("velocities", 0.0), np.float32), (n, 2))
    tags = columns.pop("tags", np.arange(n))
    frame = {
        "positions": places,
        "velocities": velocities,
        "radii": np.broadcast_to(np.asarray(radii, np.float32), n).copy(),
        "densities": column("densities", 1.0, np.float32),
        "movable": column("movable", True, np.bool_),
        "born": column("born", 0.0, np.float64),
        "tags": np.asarray(tags, np.int64),
        "stats": StepStats(time=time),
    }
    return Frame(**frame, **columns)


def touching_of(pairs, normals, depths, impulses=(), walls=()) -> FrameContacts:
    """Contacts as a frame has them; of each with a wall: row, normal, impulse."""
    return FrameContacts(
        np.array(pairs, np.int64).reshape(-1, 2),
        np.array(normals, np.float32).reshape(-1, 2),
        np.array(depths, np.float32),
        np.array(impulses, np.float32),
        np.array([row for row, _, _ in walls], np.int64),
        np.array([normal for _, normal, _ in walls], np.float32).reshape(-1, 2),
        np.array([impulse for _, _, impulse in walls], np.float32),
    )


def open_screen(size: tuple[int, int] = SIZE) -> Screen:
    """Open a window; skip the test where there is no OpenGL."""
    try:
        return Screen(size)
    except NoOpenGLError as error:
        pytest.skip(str(error))
