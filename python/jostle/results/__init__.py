"""Results that consist of several arrays or numbers."""

from jostle.results.queries import (
    Contacts,
    IdLists,
    Neighbors,
    Nodes,
    RayHit,
    RayHitLists,
    RayHits,
    Stats,
)
from jostle.results.scenes import GaltonBoard
from jostle.results.spaces import Separated, Shape, Shapes, Slide, Slides
from jostle.results.worlds import (
    LastCall,
    LastStep,
    Particle,
    Particles,
    Wall,
    WallColumns,
    WallContacts,
    WallEvents,
    WorldContacts,
    WorldEvents,
)

__all__ = [
    "Contacts",
    "GaltonBoard",
    "IdLists",
    "LastCall",
    "LastStep",
    "Neighbors",
    "Nodes",
    "Particle",
    "Particles",
    "RayHit",
    "RayHitLists",
    "RayHits",
    "Separated",
    "Shape",
    "Shapes",
    "Slide",
    "Slides",
    "Stats",
    "Wall",
    "WallColumns",
    "WallContacts",
    "WallEvents",
    "WorldContacts",
    "WorldEvents",
]
