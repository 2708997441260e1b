"""Film a scene whose discs are distributed over the ranks of MPI, each rank in its own colour.

    mpiexec -n 4 python examples/film_over_ranks.py gas -n 4000 --out gas.mp4

It needs mpi4py, pygame-ce and imageio-ffmpeg. The hash of the last state is the same for every
number of ranks.
"""

import argparse
import traceback

import imageio_ffmpeg
import numpy as np
import pygame
from mpi4py import MPI

import jostle.mpi

WIDTH, RATE = 960, 60  # pixels, frames per second
GROUND, WALL = "#10141a", "#8e9aab"
COLOURS = ("#e2c67c", "#6fb0a2", "#c9686a", "#5590a8", "#a7c58c", "#e09b6a", "#8a6aa8", "#dce3ec")


class Film:
    """A video of a part of the plane."""

    def __init__(self, path: str, view: tuple[float, float, float, float]) -> None:
        self.origin = np.array(view[:2])
        self.scale = WIDTH / (view[2] - view[0])  # pixels per unit
        height = 16 * round(self.scale * (view[3] - view[1]) / 16)  # a whole number of blocks
        self.canvas = pygame.Surface((WIDTH, height))
        self.video = imageio_ffmpeg.write_frames(path, (WIDTH, height), fps=RATE)
        self.video.send(None)  # starts ffmpeg

    def add(self, shares: list[tuple[np.ndarray, np.ndarray]], walls: np.ndarray) -> None:
        """Draw a frame: the positions and radii of each rank, and line segments."""
        self.canvas.fill(GROUND)
        for rank, (positions, radii) in enumerate(shares):
            centers = self.scale * (positions - self.origin)
            sizes = np.maximum(self.scale * radii, 1)
            for center, size in zip(centers.tolist(), sizes.tolist()):
                pygame.draw.circle(self.canvas, COLOURS[rank % len(COLOURS)], center, size)
        for start, end in (self.scale * (walls.reshape(-1, 2, 2) - self.origin)).tolist():
            pygame.draw.aaline(self.canvas, WALL, start, end)
        self.video.send(pygame.image.tobytes(self.canvas, "RGB"))


def run(comm: MPI.Intracomm, scene: str, n: int, frames: int, out: str) -> None:
    """Make the steps on all ranks; rank 0 gets all discs of each frame and writes the film."""
    world = jostle.mpi.create_scene(comm, scene, n=n)
    film = Film(out, jostle.scenes.view(scene, n)) if comm.rank == 0 else None
    for _ in range(frames):
        shares = comm.gather((world.positions, world.radii))  # None on the other ranks
        if film and shares:
            film.add(shares, world.walls.segments)
        world.step(1 / RATE)  # a call of all ranks, as gather and state_hash are
    state = world.state_hash()
    if film:
        film.video.close()
        print(f"{out}: {world.total:,} discs on {comm.size} ranks, state {state:016x}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Film a scene over the ranks of MPI.")
    parser.add_argument("scene", nargs="?", default="gas", choices=jostle.scenes.names())
    parser.add_argument("-n", type=int, default=4_000, help="number of discs")
    parser.add_argument("--frames", type=int, default=600, help="60 are a second")
    parser.add_argument("--out", default="film.mp4")
    try:
        run(MPI.COMM_WORLD, **vars(parser.parse_args()))
    except Exception:
        traceback.print_exc()
        MPI.COMM_WORLD.Abort(1)  # the other ranks would wait for this one
