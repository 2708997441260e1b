"""The picture of a distributed world: each rank draws its discs, and the first combines them."""

from __future__ import annotations

import numpy as np
import pygame
from mpi4py import MPI
from numpy.typing import NDArray

import jostle.mpi
from jostle_lab.draw.base_layers import draw_container, draw_discs, draw_walls
from jostle_lab.draw.camera import Camera, Size
from jostle_lab.draw.colouring import Colouring
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.simulate.frame import Frame, Rect

_DRAWN = np.uint32(0xFF000000)  # the bits of a pixel that a rank has drawn


class ColouringOfRanks(Colouring):
    """As `Colouring`, over all ranks, which call its methods together."""

    def __init__(self, comm: MPI.Intracomm) -> None:
        super().__init__()
        self._comm = comm

    def extremes(self, values: NDArray[np.floating]) -> tuple[float, float] | None:
        own = [-np.inf, -np.inf]
        if len(values):
            own = [-float(values.min()), float(values.max())]
        largest = np.empty(2)
        self._comm.Allreduce(np.array(own), largest, op=MPI.MAX)
        return None if largest[1] == -np.inf else (-float(largest[0]), float(largest[1]))

    def mean(self, values: NDArray[np.floating]) -> float:
        sums = np.empty(2)
        own = np.array([values.sum(dtype=np.float64), len(values)])
        self._comm.Allreduce(own, sums, op=MPI.SUM)
        return float(sums[0] / max(sums[1], 1.0))


class Composite:
    """A picture of all particles; no rank needs those of others."""

    def __init__(self, comm: MPI.Intracomm, size: Size, view: Rect, left: int) -> None:
        self._comm = comm
        self._camera = Camera(size, view, left=left)
        self._colouring = ColouringOfRanks(comm)
        self.painter = SoftwarePainter(size)

    def draw(self, world: jostle.mpi.World) -> None:
        """Draw the world on the canvas of rank 0. All ranks call this together."""
        frame = _frame_of(world)
        shades = self._colouring.shades(frame)
        painter, camera = self.painter, self._camera
        draw_container(painter, frame.container, camera)
        below = _pixels(painter).copy()
        draw_discs(painter, frame, shades, camera)
        drawn = _pixels(painter)
        own = np.where(drawn == below, 0, drawn | _DRAWN).astype(np.uint32)
        everything = np.empty_like(own)
        self._comm.Reduce(own, everything, op=MPI.MAX, root=0)
        if self._comm.rank == 0:
            drawn[:] = np.where(everything == 0, below, everything & ~_DRAWN)
            del drawn  # it locks the canvas
            draw_walls(painter, frame.walls, frame.container, camera)


def _pixels(painter: SoftwarePainter) -> NDArray[np.uint32]:
    return pygame.surfarray.pixels2d(painter.canvas())


def _frame_of(world: jostle.mpi.World) -> Frame:
    """The particles of this rank."""
    radii = world.radii
    with np.errstate(divide="ignore", invalid="ignore"):
        densities = np.where(radii > 0, world.masses / radii**2, 1.0).astype(np.float32)
    return Frame(
        positions=world.positions,
        velocities=world.velocities,
        radii=radii,
        densities=densities,
        movable=world.movable,
        tags=world.ids,
        born=np.zeros(len(radii)),
        container=world.container,
        walls=world.walls,
        sensors=world.sensors.astype(np.int8) if world.sensors.any() else None,
    )
