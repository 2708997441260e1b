"""The queries of a world by brute force over all particles, walls and sides in NumPy.

The core computes in float32, this file in float64. Where a result depends on less than `NEAR`, both
answers are right.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracle_queries import to_circle

import jostle

Floats = NDArray[np.float64]

NEAR = 3e-4
LONGEST = 25.0
SIDES = [jostle.Side.MIN_X, jostle.Side.MAX_X, jostle.Side.MIN_Y, jostle.Side.MAX_Y]
PLACES: dict[str, dict[str, Any]] = {
    "plane": {},
    "box": {"container": jostle.Box(-9, -8, 10, 7)},
    "circle": {"container": jostle.Circle((1, -1), 11)},
    "period": {"period": (15, 12)},
    "sleepers": {"container": jostle.Box(-9, -8, 10, 7), "gravity": (0, -9.8)},
    "woken sleepers": {"container": jostle.Box(-9, -8, 10, 7), "gravity": (0, -9.8)},
    "periodic sleepers": {"period": (15, 12), "gravity": (0, -9.8)},
}


def random_world(rng: np.random.Generator, place: str) -> jostle.World:
    """Discs and walls of several categories that have moved, some removed, some walls one-way."""
    n, walls = rng.integers(0, 40), rng.uniform(-8, 8, (rng.integers(0, 7), 2, 2))
    sleeps = "sleepers" in place
    if "period" in place:  # a wall crosses each side at most once
        walls[:, 0] = np.abs(walls[:, 0])
        walls[:, 1] = walls[:, 0] + walls[:, 1] / 2
    options: dict[str, Any] = {"on_touch": "ignore", "velocities": rng.normal(0, 2, (n, 2))}
    if sleeps:
        options = {"on_touch": "bounce", "restitution": 0.2}
    if sleeps and "period" not in place:
        walls = walls[:0]
    world = jostle.World(
        beside(n, 10 if "period" in place else 13) if sleeps else rng.uniform(-6, 6, (n, 2)),
        rng.uniform(0.2, 0.5, n),
        categories=rng.integers(1, 8, n),
        masks=rng.integers(1, 8, n),
        walls={
            "segments": walls,
            "velocities": rng.normal(0, 1, (len(walls), 2))
            * (rng.random((len(walls), 1)) < 0.5)
            * (not sleeps),
            "one_way": rng.random(len(walls)) < 0.4,
            "sensors": rng.random(len(walls)) < 0.2,
            "categories": rng.integers(1, 8, len(walls)),
            "masks": 0 if sleeps else rng.integers(0, 8, len(walls)),
        },
        **options,
        **PLACES[place],
    )
    world.remove(np.flatnonzero(rng.random(n) < 0.2))
    world.walls.remove(np.flatnonzero(rng.random(len(walls)) < 0.2))
    if not sleeps:
        world.step(0.05, steps=2)
        return world
    if "period" in place:
        world.walls.add(((0, 4), (15, 4)), categories=7)
    for _ in range(3 if "period" in place else 20):
        if not world.asleep.all():
            world.step(1 / 60, steps=60)
    # Without sides some slide forever. In a box a few may still roll: such worlds are drawn again,
    # and the test fails if they are many.
    assume(world.asleep.all() or "period" in place)
    if place != "sleepers":
        woken = rng.permutation(len(world))[: len(world) // 4]
        world.set(world.ids[woken], velocities=rng.normal(0, 2, 2))
        world.add(rng.uniform(-6, 6, (3, 2)), 0.3, velocities=rng.normal(0, 2, (3, 2)))
        world.step(1 / 60)
    return world


def beside(n: int, columns: int) -> Floats:
    """Places in rows, without overlap, of discs that fall to the floor."""
    return np.stack([np.arange(n) % columns * 1.4 - 8, np.arange(n) // columns * 1.5 - 7], axis=1)


# A seed and a place, of which `made` makes the world.
WORLDS = st.tuples(st.integers(0, 2**32 - 1), st.sampled_from(sorted(PLACES)))
MASKS = st.sampled_from([None, 1, 6])


def made(drawn: tuple[int, str]) -> tuple[jostle.World, np.random.Generator]:
    rng = np.random.default_rng(drawn[0])
    return random_world(rng, drawn[1]), rng


def images(world: jostle.World, count: int) -> Floats:
    """The offsets of the images that matter up to `count` periods away."""
    if world.period is None:
        return np.zeros((1, 2))
    steps = np.arange(-count, count + 1)
    return np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) * world.period


def cross(a: Floats, b: Floats) -> Floats:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def from_segment(point: Floats, a: Floats, b: Floats) -> Floats:
    """The distance of a point from segments."""
    along = b - a
    length = np.maximum((along**2).sum(-1), 1e-300)
    share = np.clip(((point - a) * along).sum(-1) / length, 0, 1)
    return np.linalg.norm(point - a - share[..., None] * along, axis=-1)


def agree(
    found: NDArray[np.int64],
    shapes: jostle.World | jostle.Walls,
    gaps: Floats,
    chosen: NDArray[np.bool_] | bool = True,
) -> bool:
    """Whether the ids that are found are those of the chosen shapes with a gap below 0."""
    is_found = np.isin(shapes.ids, found)
    known = np.abs(gaps) > NEAR
    assert np.array_equal(found, np.sort(found)) and np.isin(found, shapes.ids).all()
    return np.array_equal(is_found[known], ((gaps < 0) & chosen)[known])


def has_bits(shapes: jostle.World | jostle.Walls, mask: int | None) -> NDArray[np.bool_]:
    """Which shapes a query with this mask may find."""
    return shapes.categories & np.uint32(0xFFFFFFFF if mask is None else mask) != 0


def gaps_of(world: jostle.World, distance: Callable[[Floats], Floats]) -> Floats:
    """The distance of a region from the nearest image of each particle, less the radius."""
    places = world.positions[:, None].astype(float) + images(world, 2)
    return distance(places).min(axis=1) - world.radii


def from_rect(at: Floats, low: Floats, high: Floats) -> Floats:
    return np.linalg.norm(np.maximum(np.maximum(low - at, at - high), 0), axis=-1)


def from_polygon(at: Floats, corners: Floats) -> Floats:
    """The distance of points from a convex polygon, counterclockwise; 0 inside."""
    sides = list(zip(corners, np.roll(corners, -1, axis=0), strict=True))
    inside = np.all([cross(np.asarray(b - a), at - a) >= 0 for a, b in sides], axis=0)
    nearest = np.min([from_segment(at, a, b) for a, b in sides], axis=0)
    return np.where(inside, 0, nearest)


def entry(origin: Floats, u: Floats, a: Floats, b: Floats, reach: Floats) -> Floats:
    """The distance along a ray into each capsule: the points within `reach` of a segment."""
    along = b - a
    length = np.maximum(np.linalg.norm(along, axis=-1), 1e-300)
    along = along / length[:, None]
    aside = np.stack([-along[:, 1], along[:, 0]], axis=1) * reach[:, None]
    ways = [to_circle(origin - end, u, reach) for end in (a, b)]
    with np.errstate(divide="ignore", invalid="ignore"):
        for start in (a + aside, a - aside):
            far = cross(start - origin, along) / cross(u, along)
            at = cross(start - origin, u) / cross(u, along)
            ways.append(np.where((far >= 0) & (at >= 0) & (at <= length), far, np.inf))
    inside = from_segment(origin, a, b) <= reach
    return np.where(inside, 0, np.fmin.reduce(ways))


class Hits(NamedTuple):
    """Where a ray hits each particle, wall and the container, at the earliest and at the latest."""

    first: Floats
    last: Floats
    names: list[tuple[int, tuple[int, ...]]]


def stops(
    world: jostle.World, moved: Floats, origin: Floats, u: Floats, extents: tuple[Any, float]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether each image (row) of each wall may stop a moving box, and whether it surely does."""
    ends, (half, radius) = world.walls.segments.astype(float), extents
    along = ends[:, 1] - ends[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    across /= np.linalg.norm(along, axis=1, keepdims=True)
    left = ((origin - ends[:, 0] - moved[:, None]) * across).sum(axis=2)
    left = left - (np.abs(across) * half).sum(axis=1) - radius
    both_sides, speed = ~world.walls.one_way, across @ u
    solid = ~world.walls.sensors
    maybe = solid & (both_sides | ((left > -NEAR) & (speed < 1e-5)))
    surely = solid & (both_sides | ((left > NEAR) & (speed < -1e-5)))
    return maybe, surely


def expected_hits(
    world: jostle.World, origin: Floats, u: Floats, radius: float, mask: int | None
) -> Hits:
    """The hits by brute force; a name is an id, and the walls or sides it may be."""
    moved = images(world, 4)
    kept, walls = has_bits(world, mask), has_bits(world.walls, mask)
    at, ends = world.positions[kept].astype(float), world.walls.segments[walls].astype(float)
    starts, ends = np.concatenate([at, ends[:, 0]]), np.concatenate([at, ends[:, 1]])
    reach = np.append(world.radii[kept], np.zeros(walls.sum())) + radius
    names: list[Any] = [(int(id_), (-1,)) for id_ in world.ids[kept]]
    names += [(-1, (int(id_),)) for id_ in world.walls.ids[walls]]
    shrink = (ends - starts) * np.minimum(
        NEAR / np.maximum(np.linalg.norm(ends - starts, axis=1, keepdims=True), 1e-9), 0.5
    )
    discs = np.ones((len(moved), len(at)), bool)
    first, last = (
        np.min(
            [
                np.where(solid, entry(origin, u, a + move, b + move, grown), np.inf)
                for move, solid in zip(moved, np.hstack([discs, some[:, walls]]), strict=True)
            ],
            axis=0,
        )
        for a, b, grown, some in zip(
            (starts, starts + shrink),
            (ends, ends - shrink),
            (reach + NEAR, np.maximum(reach - NEAR, 0)),
            stops(world, moved, origin, u, (0.0, radius)),
            strict=True,
        )
    )
    sides = exits(world.container, origin, u, radius) if mask is None or mask & 1 else []
    if sides:
        earliest = min(side[0] for side in sides)
        names.append((-1, tuple(side[2] for side in sides if side[0] <= earliest + NEAR)))
        first = np.append(first, earliest)
        last = np.append(last, min(side[1] for side in sides))
    return Hits(first, last, names)


def exits(
    container: Any, origin: Floats, u: Floats, radius: float
) -> list[tuple[float, float, int]]:
    """Where a moving disc meets each side of a container, at the earliest and at the latest."""
    if container is None:
        return []
    if isinstance(container, jostle.Circle):

        def leave(bound: float) -> float:
            m = origin - container.center
            if bound <= 0 or m @ m >= bound**2:
                return 0.0
            return float(np.sqrt(bound**2 - cross(m, u) ** 2) - m @ u)

        bound = container.radius - radius
        return [(leave(bound - NEAR), leave(bound + NEAR), jostle.Side.RIM)]
    found = []
    for side, axis, inward in zip(SIDES, (0, 0, 1, 1), (1, -1, 1, -1), strict=True):
        at = container.bounds[axis if inward == 1 else axis + 2]
        gap, speed = inward * (origin[axis] - at) - radius, -inward * u[axis]
        if gap <= NEAR:
            found.append((0.0, 0.0 if gap < -NEAR or speed <= 0 else gap / speed, side))
        elif speed > 0:
            found.append(((gap - NEAR) / speed, (gap + NEAR) / speed, side))
    return found


def the_one(hits: Hits, id_: int, wall: int) -> int:
    """The index of what has an id and a number of a wall."""
    return next(k for k, (i, walls) in enumerate(hits.names) if i == id_ and wall in walls)


def gap_of_boxes(places: Floats, half: Floats, a: Floats, b: Floats) -> Floats:
    """The gap of boxes at some places (rows) and segments (columns); -1 if they overlap."""
    a, b = a - places[:, None], b - places[:, None]
    gap = np.minimum(*(from_rect(end, -half, half) for end in (a, b)))
    corners = [np.array([x, y]) for x in (-half[0], half[0]) for y in (-half[1], half[1])]
    gap = np.min([gap, *(from_segment(corner, a, b) for corner in corners)], axis=0)
    smaller = half - NEAR
    low, high = np.minimum(a, b), np.maximum(a, b)
    meets = ((low < smaller) & (high > -smaller)).all(axis=-1)
    along = b - a
    meets &= np.abs(cross(a, along)) < (np.abs(along[..., ::-1]) * smaller).sum(axis=-1)
    inside = (np.abs(a) < smaller).all(axis=-1)  # a disc is a segment without length
    return np.where(meets | inside, -1, gap)


def room(container: Any, places: Floats, half: Floats, radius: float) -> Floats:
    """How far rounded boxes are from the sides of a container, at least."""
    if container is None:
        return np.full(len(places), np.inf)
    if isinstance(container, jostle.Circle):
        far = np.linalg.norm(np.abs(places - container.center) + half, axis=1)
        return container.radius - radius - far
    low, high = np.split(np.asarray(container.bounds, float), 2)
    return np.minimum(places - half - low, high - places - half).min(axis=1) - radius
