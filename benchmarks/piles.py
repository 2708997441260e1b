"""Overlaps of the same pile of discs in jostle, Box2D and pymunk.

    python benchmarks/piles.py              2,000 discs, 8 seconds
    python benchmarks/piles.py 10000 12     other numbers

Prints a table and draws docs/pictures/piles.png. All have four sub-steps, no friction and no
sleeping.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import step_rivals as rivals
from machine import describe
from numpy.typing import NDArray
from PIL import Image
from plot import figure, save
from timing import clock

import jostle

PICTURE = Path(__file__).parents[1] / "docs" / "pictures" / "piles.png"
DEEPEST = 10.0  # per cent of the smaller radius at the end of the colours
TIMED = 60  # frames

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Pile:
    """A pile at the end of its fall."""

    name: str
    positions: Numbers
    speed: float
    """Root of the mean square, pixels per second."""
    overlaps: Numbers
    """The deepest of each disc, in per cent of the smaller radius."""
    milliseconds: float
    """Median time of a frame at the end."""

    def __str__(self) -> str:
        return (
            f"{self.name:8} overlap: deepest {self.overlaps.max():5.2f} %, mean "
            f"{self.overlaps.mean():5.2f} %; centre of mass {self.positions[:, 1].mean():6.1f}; "
            f"{self.speed:6.2f} px/s; {self.milliseconds:7.3f} ms per frame"
        )


def overlaps_of(positions: Numbers, radii: Numbers) -> Numbers:
    """Return the deepest overlap of each disc, in per cent of the smaller radius."""
    pairs = jostle.find_pairs(positions, radii)
    i, j = pairs.T
    depths = radii[i] + radii[j] - np.hypot(*(positions[i] - positions[j]).T)
    share = 100 * depths / np.minimum(radii[i], radii[j])
    deepest = np.zeros(len(radii))
    np.maximum.at(deepest, i, share)
    np.maximum.at(deepest, j, share)
    return deepest


def fall(name: str, running: rivals.RunningSimulation, radii: Numbers, seconds: float) -> Pile:
    """Simulate the fall, and measure."""
    frame = next(reversed(running.frames.values()))
    for _ in range(round(seconds / rivals.FRAME) - TIMED):
        frame()
    times = [clock(frame) for _ in range(TIMED)]
    positions, velocities = (np.asarray(column, np.float64) for column in running.state())
    running.close()
    speed = rivals.speed(velocities)
    overlaps = overlaps_of(positions, radii)
    return Pile(name, positions, speed, overlaps, 1e3 * float(np.median(times)))


def draw(piles: list[Pile], radii: Numbers, box: tuple[float, float, float, float]) -> None:
    """Draw the piles side by side, coloured by the overlap."""
    from matplotlib.collections import EllipseCollection

    drawing, panels = figure(len(piles), 3.6 * len(piles), 2.7, same=True)
    top = min(pile.positions[:, 1].min() for pile in piles) - 3 * radii.max()
    for pile, axes in zip(piles, panels[0], strict=True):
        discs = EllipseCollection(
            *(2 * radii, 2 * radii, 0),
            offsets=pile.positions,
            offset_transform=axes.transData,
            units="x",
            array=pile.overlaps,
            cmap="viridis",
            clim=(0, DEEPEST),
        )
        axes.add_collection(discs)
        axes.set(xlim=(box[0], box[2]), ylim=(box[3], top), aspect="equal", xticks=[], yticks=[])
        axes.grid(visible=False)
        axes.spines[:].set_visible(False)
        axes.set_title(
            f"{pile.name}: mean {pile.overlaps.mean():.1f} %, deepest {pile.overlaps.max():.1f} %"
        )
    drawing.colorbar(discs, ax=panels[0], label="overlap, % of\nthe smaller radius")
    title = f"{len(radii):,} discs after the same fall, four sub-steps"
    save(drawing, PICTURE, [{"machine": describe()}], title)
    picture = Image.open(PICTURE).convert("RGB")
    picture.quantize(64, dither=Image.Dither.NONE).save(PICTURE, optimize=True)


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 8.0
    world = jostle.scenes.create("pile", n=count)
    world.substeps = 4
    start = rivals.state_of(world)
    entrants = {
        "jostle": lambda: rivals.jostle_world(start, 1),
        "Box2D": lambda: rivals.box2d_world(start, 1),
        "pymunk": lambda: rivals.pymunk_space(start, 1),
    }
    radii = start.radii.astype(np.float64)
    piles = []
    for name, make in entrants.items():
        piles.append(fall(name, make(), radii, seconds))
        print(piles[-1], flush=True)
    draw(piles, radii, start.box)


if __name__ == "__main__":
    main()
