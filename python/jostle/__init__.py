"""Find every pair of overlapping shapes, and let particles collide.

`find_pairs`
    All overlapping pairs of some circles, rectangles or rounded boxes, once.
`Quadtree`
    The same for shapes that are asked about more than once.
`Space`
    Shapes that come, move and go under ids, and the `Events` of their pairs.
`World`
    Particles that move, collide and bounce off a `Box`, a `Circle` or the seams of
    a `Torus`; `jostle.scenes` has some ready. `Attractor`, `Gravitation`, `Springs`
    and `Thermostat` are the forces that it may have.
`Contacts`, `Hits`, `Neighbors`, `RayHit`, `RayHits`, `Nodes`, `Stats`
    What some of these answer.
`article`
    The two programs of 2015 that it began with, in plain Python, faults and all.
"""

from jostle import article, scenes
from jostle._core import (
    Attractor,
    Box,
    Circle,
    Events,
    Gravitation,
    Quadtree,
    Space,
    Springs,
    Thermostat,
    Torus,
    World,
    __version__,
    find_pairs,
)
from jostle.results import Contacts, Hits, Neighbors, Nodes, RayHit, RayHits, Stats

__all__ = [
    "Attractor",
    "Box",
    "Circle",
    "Contacts",
    "Events",
    "Gravitation",
    "Hits",
    "Neighbors",
    "Nodes",
    "Quadtree",
    "RayHit",
    "RayHits",
    "Space",
    "Springs",
    "Stats",
    "Thermostat",
    "Torus",
    "World",
    "__version__",
    "article",
    "find_pairs",
    "scenes",
]
