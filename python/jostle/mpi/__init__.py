"""Many processes: pairs and worlds that are distributed over the ranks of an mpi4py communicator.

Each rank holds a share of the shapes or particles, and no rank holds all. Answers are those of one
process. Needs mpi4py and an MPI library: in the folder of the source, ``pip install ".[mpi]"``.
"""

from jostle._core import RankError

from .scenes import create_scene
from .search import find_pairs
from .walls import Walls
from .world import World

__all__ = ["RankError", "Walls", "World", "create_scene", "find_pairs"]

for _public in (Walls, World, create_scene, find_pairs):
    _public.__module__ = "jostle.mpi"
