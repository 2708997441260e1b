"""Named scenes from a seed, the same for tests, benchmarks and the simulator.

Lengths are pixels, times seconds, y grows downwards; a step is 1/60 s. Every scene
takes any number of particles, and its size depends on it.
"""

from jostle._core import create_scene as create
from jostle._core import describe_scene as describe
from jostle._core import scene_default_count as default_count
from jostle._core import scene_galton_board as galton_board
from jostle._core import scene_names as names
from jostle._core import scene_view as view
from jostle.results import GaltonBoard

__all__ = [
    "GaltonBoard",
    "create",
    "default_count",
    "describe",
    "galton_board",
    "names",
    "view",
]
