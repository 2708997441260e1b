"""Find every pair of overlapping shapes, and simulate particles that collide.

`find_pairs`
    All overlapping pairs of some circles, rectangles or rounded boxes, once.
`Quadtree`
    The same, and further queries, for shapes that do not change.
`Space`
    Shapes with ids that are added, moved and removed, and the `Events` of their pairs.
    `Space.move_and_slide` moves characters among walls; `tiles` makes boxes of a tile map.
`separate`
    Moves shapes apart until none overlap.
`World`
    Particles that move and collide in a `Box`, a `Circle` or a periodic plane;
    `jostle.scenes` has ready-made worlds. `Attractor`, `Gravitation`, `Springs`,
    `PairForce`, `Flocking`, `Thermostat`, `ThermalWalls`, `AndersenThermostat`, `Motor`, `Pump` and
    `Grab` are its forces. `World.walls` is a `Walls`, `polyline` makes them; `Side` names the
    sides of a container.
    `jostle.life` has matrices for particle life.
`Contacts`, `IdLists`, `Neighbors`, `RayHit`, `RayHits`, `RayHitLists`, `Nodes`, `Stats`
    The results of queries.
`Separated`, `Slide`, `Slides`, `Shape`, `Shapes`
    The results of `separate`, `Space.move_and_slide` and `Space.get`.
`WorldContacts`, `WallContacts`, `WorldEvents`, `WallEvents`, `LastStep`, `LastCall`
    What a world says about its last step.
`Particle`, `Particles`, `Wall`, `WallColumns`
    Copies of some particles and walls.
`IdError`
    The exception for an id that nothing has.
"""

from jostle import life, scenes
from jostle._core import (
    AndersenThermostat,
    Attractor,
    Box,
    Circle,
    Events,
    Flocking,
    Grab,
    Gravitation,
    Motor,
    PairForce,
    Pump,
    Quadtree,
    Space,
    Springs,
    ThermalWalls,
    Thermostat,
    Walls,
    World,
    __version__,
    find_pairs,
    separate,
)
from jostle.errors import IdError
from jostle.results import (
    Contacts,
    IdLists,
    LastCall,
    LastStep,
    Neighbors,
    Nodes,
    Particle,
    Particles,
    RayHit,
    RayHitLists,
    RayHits,
    Separated,
    Shape,
    Shapes,
    Slide,
    Slides,
    Stats,
    Wall,
    WallColumns,
    WallContacts,
    WallEvents,
    WorldContacts,
    WorldEvents,
)
from jostle.tilemap import tiles
from jostle.walls import Side, polyline

__all__ = [
    "AndersenThermostat",
    "Attractor",
    "Box",
    "Circle",
    "Contacts",
    "Events",
    "Flocking",
    "Grab",
    "Gravitation",
    "IdError",
    "IdLists",
    "LastCall",
    "LastStep",
    "Motor",
    "Neighbors",
    "Nodes",
    "PairForce",
    "Particle",
    "Particles",
    "Pump",
    "Quadtree",
    "RayHit",
    "RayHitLists",
    "RayHits",
    "Separated",
    "Shape",
    "Shapes",
    "Side",
    "Slide",
    "Slides",
    "Space",
    "Springs",
    "Stats",
    "ThermalWalls",
    "Thermostat",
    "Wall",
    "WallColumns",
    "WallContacts",
    "WallEvents",
    "Walls",
    "World",
    "WorldContacts",
    "WorldEvents",
    "__version__",
    "find_pairs",
    "life",
    "polyline",
    "scenes",
    "separate",
    "tiles",
]
