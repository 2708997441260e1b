"""The article's program as values and arrays, for saved states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jostle import article
from jostle.app.simulate.packing import COUNT, Arrays, column, within
from jostle.app.simulate.validation import FARTHEST, each, one_of, whole

NUMBERS = ("x", "y", "speed", "angle")  # columns of a particle in full precision
LARGEST = 1e9  # radius in pixels, and density: masses stay below 1e30, as in a world
MOST_PIXELS = 10**9  # of a side of the display

FACTS = {
    "method": one_of(*article.METHODS),
    "size": each(whole(article.SMALLEST_SIDE, MOST_PIXELS), "width", "height"),
    "counters": each(COUNT, "tests", "repeats", "hits"),
}


def facts_of(program: article.Simulation) -> dict[str, Any]:
    return {
        "method": program.method,
        "size": [program.width, program.height],
        "counters": [program.tests, program.repeats, program.hits],
    }


def arrays_of(program: article.Simulation) -> dict[str, NDArray[Any]]:
    numbers = [[getattr(p, name) for name in NUMBERS] for p in program.particles]
    sizes = [(p.radius, p.density, *p.rectangle) for p in program.particles]
    return {
        "numbers": np.array(numbers, np.float64).reshape(-1, len(NUMBERS)),
        "sizes": np.array(sizes, np.int64).reshape(-1, 6),
        "leaves": np.array(program.leaves, np.int64).reshape(-1, 5),
    }


def program_of(facts: Mapping[str, Any], arrays: Arrays) -> article.Simulation:
    """Return the program of checked values and of arrays; raise a ValueError for wrong ones."""
    particles = _particles_of(arrays)
    leaves = column(arrays, "leaves", "<i8", (_rows(arrays, "leaves"), 5))
    within("leaves", leaves, 0, MOST_PIXELS)
    program = article.Simulation.of(particles, facts["method"], *facts["size"])
    program.tests, program.repeats, program.hits = facts["counters"]
    program.leaves = [(x, y, w, h, level) for x, y, w, h, level in leaves.tolist()]
    return program


def _particles_of(arrays: Arrays) -> list[article.Particle]:
    """Return the particles of a saved state; raise a ValueError with a wrong number."""
    n = _rows(arrays, "numbers")
    numbers = column(arrays, "numbers", "<f8", (n, len(NUMBERS)))
    sizes = column(arrays, "sizes", "<i8", (n, 6))
    within("numbers", numbers, -FARTHEST, FARTHEST)
    within("sizes", sizes[:, :2], 1, LARGEST)
    within("sizes", sizes, -4 * FARTHEST, 4 * FARTHEST)
    particles = []
    for (x, y, speed, angle), (radius, density, left, top, width, height) in zip(
        numbers.tolist(), sizes.tolist(), strict=True
    ):
        particle = article.Particle(x, y, radius, density, speed, angle)
        particle.rectangle = left, top, width, height
        particles.append(particle)
    return particles


def _rows(arrays: Arrays, name: str) -> int:
    return len(arrays[name]) if name in arrays and arrays[name].ndim else 0
