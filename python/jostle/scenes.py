"""Seeded scenes by name, the same for tests, benchmarks and the simulator.

Lengths are pixels, times seconds, y grows downwards; a step is 1/60 s. Every scene
takes any number of particles, and its size follows.
"""

from jostle._core import create_scene as create
from jostle._core import describe_scene as describe
from jostle._core import scene_names as names
from jostle._core import scene_view as view

__all__ = ["create", "describe", "names", "view"]
