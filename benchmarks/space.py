"""Dynamic index: the time of a frame if few shapes move, and if all bullets of a game move.

Each call of a frame is timed separately, on one thread. The bullets are compared with two sorts of
the same number: NumPy's of 64-bit keys, and a tree of a single box, which is the tree's own sort
and its copies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from machine import Row
from numpy.typing import NDArray
from timing import Timing, clock

import jostle

FRAMES_TIMES = 9
"""Frames for each requested round, because a frame is short."""

MOVERS = 1_000
SHIPS = 50
BULLET, SHIP = 1, 2
ONE_THREAD = 1


@dataclass
class Scene:
    """A space, and the shapes that move in it."""

    name: str
    space: jostle.Space
    movers: NDArray[np.int64]
    beside: dict[str, Callable[[NDArray[np.float64]], object]] = field(default_factory=dict)

    def frames(self, count: int) -> Iterator[dict[str, float]]:
        """Seconds of each call, frame by frame."""
        random = np.random.default_rng(1)
        centers = self.space.get(self.movers).positions
        for _ in range(count):
            centers = centers + random.uniform(-0.5, 0.5, centers.shape)
            told: list[jostle.Events] = []
            yield {
                "move": clock(lambda at=centers: self.space.set(self.movers, positions=at)),
                "update": clock(lambda to=told: to.append(self.space.update())),
                "entered and left": clock(lambda of=told: (of[0].entered, of[0].left)),
                **{what: clock(lambda f=f, at=centers: f(at)) for what, f in self.beside.items()},
            }


def uniform(count: int, side: float) -> NDArray[np.float64]:
    """Points of a square."""
    return np.random.default_rng(0).uniform(0, side, (count, 2))


def still_shapes(count: int) -> Scene:
    """Discs over 40 % of a square, a thousand of which move."""
    space = jostle.Space(threads=ONE_THREAD)
    ids = space.add(uniform(count, np.sqrt(count * np.pi * 0.25 / 0.4)), 0.5)
    movers = ids[:: max(1, count // MOVERS)][:MOVERS]
    return Scene(f"{len(movers):,} of {count:,} discs move", space, movers)


def bullets(count: int) -> Scene:
    """Bullets that all move and ignore each other, and ships that do not move."""
    side = 500 * np.sqrt(count / 100_000)
    space = jostle.Space(threads=ONE_THREAD)
    space.add(uniform(SHIPS, side), 5.0, categories=SHIP)
    movers = space.add(uniform(count, side), 0.1, categories=BULLET, masks=SHIP)
    keys = np.random.default_rng(2).integers(0, 1 << 63, count)
    beside = {
        "np.sort of bare keys": lambda at: np.sort(keys),
        "tree of one box": lambda at: jostle.Quadtree(at, 0.1, max_depth=0, threads=ONE_THREAD),
        "tree": lambda at: jostle.Quadtree(at, 0.1, threads=ONE_THREAD),
    }
    return Scene(f"{count:,} bullets move past {SHIPS} ships", space, movers, beside)


def crowd(count: int) -> Scene:
    """Discs over 40 % of a square, all of which move."""
    space = jostle.Space(threads=ONE_THREAD)
    movers = space.add(uniform(count, np.sqrt(count * np.pi * 0.25 / 0.4)), 0.5)
    beside = {
        "find_pairs": lambda at: jostle.find_pairs(at, 0.5, threads=ONE_THREAD),
    }
    return Scene(f"all of {count:,} discs move", space, movers, beside)


def race(rounds: int, largest: int) -> Iterator[list[Row]]:
    """Yield the rows of each scene."""
    for scene in (
        still_shapes(min(1_000_000, largest)),
        bullets(min(100_000, largest)),
        crowd(min(100_000, largest)),
    ):
        first = clock(scene.space.update)
        frames = list(scene.frames(FRAMES_TIMES * rounds))[2:]  # the first one allocates memory
        timings = {call: Timing(tuple(frame[call] for frame in frames)) for call in frames[0]}
        timings["first update"] = Timing((first,))
        yield [
            {"scene": scene.name, "call": call, "version": jostle.__version__, **timing.columns()}
            for call, timing in timings.items()
        ]
