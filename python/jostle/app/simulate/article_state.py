"""The state of the article's program as bytes."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from jostle import article
from jostle.app.simulate.packing import (
    ATTRACTORS,
    COUNT,
    Arrays,
    column,
    pack,
    particles_of,
    unpack,
    within,
)
from jostle.app.simulate.settings import SETTINGS, Settings
from jostle.app.simulate.simulation import Attractor, Tags
from jostle.app.simulate.validation import FARTHEST, Fields, each, one_of, read, whole

NUMBERS = ("x", "y", "speed", "angle")  # columns of a particle in full precision
LARGEST = 1e9  # radius in pixels, and density: masses stay below 1e30, as in a world
MOST_PIXELS = 10**9  # of a side of the display

FACTS = Fields(
    {
        "settings": SETTINGS,
        "method": one_of(*article.METHODS),
        "size": each(whole(article.SMALLEST_SIDE, MOST_PIXELS), "width", "height"),
        "counters": each(COUNT, "tests", "repeats", "hits"),
        "frames": COUNT,
        "next_tag": COUNT,
        "pulls": ATTRACTORS,
    }
)


@dataclass
class ArticleState:
    """The data from which a simulation of the article's program continues."""

    settings: Settings
    program: article.Simulation
    attractors: tuple[Attractor, ...]
    frames: int
    tags: Tags
    born: NDArray[np.float64]
    next_tag: int

    def save(self) -> bytes:
        program = self.program
        facts = {
            "settings": asdict(self.settings),
            "method": program.method,
            "size": [program.width, program.height],
            "counters": [program.tests, program.repeats, program.hits],
            "frames": self.frames,
            "next_tag": self.next_tag,
            "pulls": [asdict(attractor) for attractor in self.attractors],
        }
        numbers = [[getattr(p, name) for name in NUMBERS] for p in program.particles]
        sizes = [(p.radius, p.density, *p.rectangle) for p in program.particles]
        columns = {
            "numbers": np.array(numbers, np.float64).reshape(-1, len(NUMBERS)),
            "sizes": np.array(sizes, np.int64).reshape(-1, 6),
            "leaves": np.array(program.leaves, np.int64).reshape(-1, 5),
            "tags": self.tags,
            "born": self.born,
        }
        return pack("article", facts, columns)

    @classmethod
    def load(cls, state: bytes) -> ArticleState:
        """Return it from bytes; raise a ValueError if they are wrong."""
        facts, arrays = unpack("article", state)
        facts = read(facts, FACTS)
        settings, method = facts["settings"], facts["method"]
        if settings.method != f"article-{method}":
            raise ValueError(f"method is {method!r}, but settings.method {settings.method!r}")
        particles = _particles_of(arrays)
        tags, born = particles_of(arrays, len(particles), facts["next_tag"])
        leaves = column(arrays, "leaves", "<i8", (_rows(arrays, "leaves"), 5))
        within("leaves", leaves, 0, MOST_PIXELS)
        program = article.Simulation.of(particles, method, *facts["size"])
        program.tests, program.repeats, program.hits = facts["counters"]
        program.leaves = [(x, y, w, h, level) for x, y, w, h, level in leaves.tolist()]
        attractors, frames = facts["pulls"], facts["frames"]
        return cls(settings, program, attractors, frames, tags, born, facts["next_tag"])


def _particles_of(arrays: Arrays) -> list[article.Particle]:
    """Return the particles of a saved state; raise a ValueError with a wrong number."""
    n = _rows(arrays, "numbers")
    numbers = column(arrays, "numbers", "<f8", (n, len(NUMBERS)))
    sizes = column(arrays, "sizes", "<i8", (n, 6))
    within("numbers", numbers, -FARTHEST, FARTHEST)
    within("sizes", sizes[:, :2], 1, LARGEST)
    within("sizes", sizes, -4 * FARTHEST, 4 * FARTHEST)
    particles = []
    for (x, y, speed, angle), (radius, density, *rectangle) in zip(
        numbers.tolist(), sizes.tolist(), strict=True
    ):
        particle = article.Particle(x, y, radius, density, speed, angle)
        left, top, width, height = rectangle
        particle.rectangle = left, top, width, height
        particles.append(particle)
    return particles


def _rows(arrays: Arrays, name: str) -> int:
    return len(arrays[name]) if name in arrays and arrays[name].ndim else 0
