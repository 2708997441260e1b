"""`Space.update(swept=True)`: pairs that overlap only on the way between two updates."""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from copies import WAYS
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracle import ALL_BITS, DTYPES

import jostle

Pair = tuple[int, int]
Point = tuple[Fraction, Fraction]

HALF = Fraction(1, 2)


class Body:
    """A shape of the model in exact arithmetic, with its centre now and where its path began."""

    def __init__(self, center: Any, radius: Any, half: Any, own: int, wanted: int) -> None:
        self.now = self.start = exact(center)
        self.radius, self.half = Fraction(radius), exact(half)
        self.own, self.wanted = own, wanted


def exact(point: Any) -> Point:
    """Return the coordinates as fractions."""
    return Fraction(point[0]), Fraction(point[1])


def near(offset: Fraction, side: Fraction) -> Fraction:
    """Return the smallest absolute value of a coordinate's images."""
    if not side:
        return abs(offset)
    rest = offset % side
    return min(rest, side - rest)


def overlap_at(offset: Point, half: Point, reach: Fraction, period: Point) -> bool:
    """Return whether the shapes overlap: the formula, in exact arithmetic."""
    gaps = [near(v, side) - h for v, h, side in zip(offset, half, period, strict=True)]
    outside = [max(gap, Fraction(0)) for gap in gaps]
    return outside[0] ** 2 + outside[1] ** 2 < reach**2 or max(gaps) < 0


def path(body: Body, period: Point) -> Point:
    """Return the shortest displacement that brings a body from its start to where it is."""
    ways = []
    for start, now, side in zip(body.start, body.now, period, strict=True):
        way = now - start
        if side and abs(way) > side / 2:
            way -= side if way > 0 else -side
        ways.append(way)
    return ways[0], ways[1]


def offsets(a: Body, b: Body, period: Point) -> tuple[Point, Point]:
    """Return the offset of b from a at the end, and by how much it has changed on the way."""
    ways = [path(body, period) for body in (a, b)]
    end = (b.now[0] - a.now[0], b.now[1] - a.now[1])
    return end, (ways[1][0] - ways[0][0], ways[1][1] - ways[0][1])


def crosses(a: Body, b: Body, period: Point) -> bool:
    """Return whether two bodies overlap on the way, and neither at its start nor at its end.

    The squared distance is quadratic between the times at which a side or the middle of one image
    is level with the other shape. So it is enough to look at these times, between them, and where
    each parabola is lowest.
    """
    end, way = offsets(a, b, period)
    half = (a.half[0] + b.half[0], a.half[1] + b.half[1])
    reach = a.radius + b.radius

    def at(time: Fraction) -> Point:
        return end[0] - way[0] * (1 - time), end[1] - way[1] * (1 - time)

    def overlaps(time: Fraction) -> bool:
        return overlap_at(at(time), half, reach, period)

    if overlaps(Fraction(0)) or overlaps(Fraction(1)):
        return False
    breaks = {Fraction(0), Fraction(1)}
    for axis, side in enumerate(period):
        if way[axis]:
            levels = {-half[axis], Fraction(0), half[axis], side / 2}
            turns = range(-4, 5) if side else range(1)
            at_start = end[axis] - way[axis]
            times = {(v + k * side - at_start) / way[axis] for v in levels for k in turns}
            breaks |= {time for time in times if 0 < time < 1}

    def square(time: Fraction) -> Fraction:
        gaps = [near(v, s) - h for v, h, s in zip(at(time), half, period, strict=True)]
        return sum((max(gap, Fraction(0)) ** 2 for gap in gaps), Fraction(0))

    times = sorted(breaks)
    for first, last in itertools.pairwise(times):
        middle = (first + last) / 2
        if overlaps(first) or overlaps(middle):
            return True
        # Of the parabola through three points.
        low, mid, high = square(first), square(middle), square(last)
        bend = low - 2 * mid + high
        if bend > 0:
            lowest = middle + (last - first) / 4 * (low - high) / bend
            if first < lowest < last and overlaps(lowest):
                return True
    return False


def may_pair(a: Body, b: Body) -> bool:
    return bool(a.own & b.wanted and b.own & a.wanted)


class Model:
    """Bodies by id, and the pairs of the last update."""

    def __init__(self, period: Any = (0, 0)) -> None:
        self.period = exact(period)
        self.bodies: dict[int, Body] = {}
        self.touching: set[Pair] = set()

    def wrap(self, point: Any) -> Point:
        """Return a point in the first period."""
        x, y = (v % side if side else v for v, side in zip(exact(point), self.period, strict=True))
        return x, y

    def pairs(self, found: Any) -> set[Pair]:
        """Return the pairs of bodies that may pair and for which `found` is true."""
        every = itertools.combinations(sorted(self.bodies), 2)
        some = (p for p in every if may_pair(self.bodies[p[0]], self.bodies[p[1]]))
        return {(i, j) for i, j in some if found(self.bodies[i], self.bodies[j])}

    def overlap(self, a: Body, b: Body) -> bool:
        offset = (b.now[0] - a.now[0], b.now[1] - a.now[1])
        half = (a.half[0] + b.half[0], a.half[1] + b.half[1])
        return overlap_at(offset, half, a.radius + b.radius, self.period)

    def update(self, swept: bool) -> list[list[Pair]]:
        """Return the expected pairs that entered, stayed and exited."""
        now, old = self.pairs(self.overlap), self.touching
        crossed = self.pairs(lambda a, b: crosses(a, b, self.period)) - old if swept else set()
        self.touching = now
        for body in self.bodies.values():
            body.start = body.now
        return [sorted(some) for some in ((now - old) | crossed, now & old, (old - now) | crossed)]


def told(events: jostle.Events) -> list[list[Pair]]:
    arrays = (events.entered, events.stayed, events.exited)
    return [[(i, j) for i, j in pairs.tolist()] for pairs in arrays]


# Multiples of an eighth up to 8: the library computes without rounding, and many shapes only touch.
grid = st.integers(-64, 64).map(lambda k: k / 8)
points = st.tuples(grid, grid)
sizes = st.sampled_from([0.0, 0.125, 0.5, 1.0, 2.0])
halves = st.tuples(sizes, sizes) | st.just((0.0, 0.0))
bits = st.sampled_from([ALL_BITS, ALL_BITS, 1, 2, 3])
acts = st.sampled_from(
    ["add", "box", "move", "move", "move", "size", "filter", "remove", "copy", "update"]
)


@given(
    data=st.data(),
    dtype=st.sampled_from(DTYPES),
    period=st.sampled_from([(0, 0), (0, 0), (6, 0), (4, 5), (0, 16)]),
    threads=st.integers(1, 2),
)
def test_swept_updates_tell_what_exact_arithmetic_tells(
    data: st.DataObject, dtype: Any, period: Any, threads: int
) -> None:
    space = jostle.Space(dtype=dtype, period=period, leaf_capacity=2, threads=threads)
    model = Model(period)

    def add(new: Any) -> None:
        center, radius, half, own, wanted = new
        id = space.add(center, radius, half, categories=own, masks=wanted)
        model.bodies[id] = Body(model.wrap(center), radius, half, own, wanted)

    def box(new: Any) -> None:
        (x, y), _, (width, height), own, wanted = new
        sides = (x - width, y - height, x + width, y + height)
        id = space.add(boxes=sides, categories=own, masks=wanted)
        model.bodies[id] = Body(model.wrap((x, y)), 0, (width, height), own, wanted)

    def change(what: str, id: int) -> None:
        body = model.bodies[id]
        if what == "move":
            to = data.draw(points)
            space.set(id, positions=to)
            body.now = model.wrap(to)
        elif what == "size":
            radius, half = data.draw(sizes), data.draw(halves)
            space.set(id, radii=radius, half_sizes=half)
            body.radius, body.half = Fraction(radius), exact(half)
        elif what == "filter":
            body.own, body.wanted = data.draw(bits), data.draw(bits)
            space.set(id, categories=body.own, masks=body.wanted)
        else:
            space.remove(id)
            del model.bodies[id]

    shapes = st.tuples(points, sizes, halves, bits, bits)
    for new in data.draw(st.lists(shapes, max_size=8)):
        add(new)
    for act in [*data.draw(st.lists(acts, max_size=25)), "update"]:
        if act in ("add", "box"):
            (add if act == "add" else box)(data.draw(shapes))
        elif act == "update":
            swept = data.draw(st.sampled_from([True, True, False]))
            assert told(space.update(swept=swept)) == model.update(swept)
        elif act == "copy":
            space = data.draw(st.sampled_from(WAYS))(space)
        elif model.bodies:
            change(act, data.draw(st.sampled_from(sorted(model.bodies))))


def closest(start: NDArray[Any], end: NDArray[Any]) -> NDArray[Any]:
    """Return the least distance from the origin on the way between two points."""
    way = end - start
    square = (way**2).sum(axis=-1)
    share = np.clip(-(start * way).sum(axis=-1) / np.where(square == 0, 1, square), 0, 1)
    return np.linalg.norm(start + share[..., None] * way, axis=-1)


@pytest.mark.parametrize("dtype", DTYPES)
def test_many_bullets_meet_what_a_quadratic_tells(dtype: Any) -> None:
    """Of discs: the least distance of two points that move, for every pair."""
    rng = np.random.default_rng(3)
    space = jostle.Space(dtype=dtype)
    n = 700
    start = rng.uniform(0, 600, (n, 2)).astype(dtype)
    end = (start + np.where(np.arange(n)[:, None] % 3 == 0, 0, rng.normal(0, 60, (n, 2)))).astype(
        dtype
    )
    radii = rng.uniform(1, 6, n).astype(dtype)
    categories = np.where(rng.random(n) < 0.5, 1, 2)
    space.add(start, radii, categories=categories, masks=3 - categories)
    space.update()
    space.positions = end
    events = space.update(swept=True)
    offsets = [(p[None] - p[:, None]).astype(float) for p in (start, end)]
    reach = radii[None] + radii[:, None]
    apart = np.linalg.norm(offsets, axis=-1) >= reach
    met = closest(*offsets) < reach
    allowed = categories[None] != categories[:, None]
    crossed = np.argwhere(np.triu(apart[0] & apart[1] & met & allowed, 1))
    entered = np.argwhere(np.triu(apart[0] & ~apart[1] & allowed, 1))
    assert len(crossed) > 100 and len(entered) > 30
    expected = sorted(np.vstack([crossed, entered]).tolist())
    assert events.entered.tolist() == expected
    assert set(map(tuple, crossed.tolist())) <= set(map(tuple, events.exited.tolist()))
    assert told(space.update(swept=True)) == [[], events_of(~apart[1] & allowed), []]


def events_of(overlaps: NDArray[np.bool_]) -> list[Pair]:
    return [(int(i), int(j)) for i, j in np.argwhere(np.triu(overlaps, 1))]


def shot(space: jostle.Space, start: Any, end: Any, **columns: Any) -> int:
    """Add a bullet, and move it after an update."""
    id = space.add(start, **columns)
    space.update()
    space.set(id, positions=end)
    return id


def test_what_is_passed_has_entered_and_exited() -> None:
    space = jostle.Space()
    rock = space.add((30, 0), radii=2.0)
    bullet = shot(space, (0, 0), (60, 0), radii=1.0)
    assert told(space.update(swept=True)) == [[(rock, bullet)], [], [(rock, bullet)]]
    # Nothing is left of it: not at rest, and not on the way back without `swept`.
    assert told(space.update(swept=True)) == [[], [], []]
    space.set(bullet, positions=(0, 0))
    assert told(space.update()) == [[], [], []]
    # The path of an ordinary update is not added to that of the next one.
    space.set(bullet, positions=(0, 1))
    assert told(space.update(swept=True)) == [[], [], []]


def test_the_path_is_one_straight_line_from_the_last_update() -> None:
    space = jostle.Space()
    space.add((30, 30), radii=2.0)
    bullet = shot(space, (0, 0), (30, 30))
    space.pairs()
    space.set(bullet, positions=(60, 0))  # not by way of (30, 30)
    assert told(space.update(swept=True)) == [[], [], []]
    rock = space.add((30, 0), radii=2.0)
    space.update()
    space.set(bullet, positions=(0, 0))
    space.move_and_slide(bullet, (0, 0), mask=0)
    assert told(space.update(swept=True))[0] == [(bullet, rock)]


def test_a_path_begins_where_the_shape_was_added() -> None:
    space = jostle.Space()
    space.add((30, 0), radii=2.0)
    space.update()
    bullet = space.add((0, 0), radii=1.0)
    space.set(bullet, positions=(60, 0))
    late = space.add((90, 0), radii=1.0)
    assert told(space.update(swept=True)) == [[(0, bullet)], [], [(0, bullet)]]
    space.remove(bullet)
    again = space.add((90, 50), radii=1.0)  # in the slot of the bullet, and without its path
    assert told(space.update(swept=True)) == [[], [], []]
    space.set([late, again], positions=[(90, 50), (90, 0)])
    assert told(space.update(swept=True))[0] == [(late, again)]


def test_removed_shapes_meet_nothing() -> None:
    space = jostle.Space()
    space.add((30, 0), radii=2.0)
    bullet = shot(space, (0, 0), (60, 0), radii=1.0)
    space.remove(bullet)
    assert told(space.update(swept=True)) == [[], [], []]


@pytest.mark.parametrize(
    ("x", "y", "met"),
    [(58, 0.5, True), (0, 0, True), (52, 0, True), (48, 0, False), (27, 0, False)],
)
def test_with_a_period_the_path_is_the_shortest(x: float, y: float, met: bool) -> None:
    """From 50 to 5 in a period of 60 a shape moves by 15 over the border, and not by -45.

    It touches the shapes at 52 and 48 at the beginning.
    """
    space = jostle.Space(period=(60, 0))
    rock = space.add((x, y), radii=1.0)
    bullet = shot(space, (50, 0), (5, 0), radii=1.0)
    assert told(space.update(swept=True))[0] == ([(rock, bullet)] if met else [])


def test_too_many_paths_are_refused_and_change_nothing() -> None:
    space = jostle.Space()
    space.add([(30, y) for y in range(0, 40, 4)], radii=2.0)
    ids = space.add([(0, y) for y in range(0, 40, 4)], radii=1.0)
    space.update()
    space.set(ids, positions=[(60, 38 - y) for y in range(0, 40, 4)])
    with pytest.raises(ValueError, match="more than max_pairs = 20 pairs"):
        space.update(swept=True, max_pairs=20)
    events = space.update(swept=True)
    assert len(events.entered) == len(events.exited) >= 10
    with pytest.raises(TypeError, match="swept"):
        space.update(swept="yes")  # type: ignore[arg-type]


def test_the_answer_does_not_depend_on_threads_and_queries() -> None:
    def run(threads: int, asks: bool) -> list[Any]:
        rng = np.random.default_rng(7)
        space = jostle.Space(threads=threads)
        ids = space.add(rng.uniform(0, 300, (20_000, 2)), 0.5)
        found = []
        for step in (1, 9, 50):
            moved = ids[::step]
            space.set(
                moved, positions=space.get(moved).positions + rng.normal(0, 3, (len(moved), 2))
            )
            if asks:
                space.pairs()
            found.append(told(space.update(swept=step != 1)))
        return found

    expected = run(1, False)
    assert len(expected[1][0]) > 1000
    assert run(2, False) == expected and run(1, True) == expected
