"""Convex shapes in exact arithmetic: the definition of an overlap, word for word.

A shape is a core, the hull of a few points, with a radius. Numbers are fractions, so no answer is
rounded. Where a test allows for rounding, the same functions take floats, which are faster.
"""

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import product
from typing import NamedTuple

Number = Fraction | float
Vector = tuple[Number, Number]


class Exact(NamedTuple):
    """A core, as the corners of its hull in order, and a radius."""

    core: tuple[Vector, ...]
    radius: Number

    def moved(self, by: Sequence[Number]) -> "Exact":
        """The shape somewhere else."""
        return self._replace(core=tuple((x + by[0], y + by[1]) for x, y in self.core))

    def rounded(self) -> "Exact":
        """The same shape in floats."""
        return Exact(tuple((float(x), float(y)) for x, y in self.core), float(self.radius))


def shape(points: Iterable[Iterable[float]], radius: float = 0.0) -> Exact:
    """A shape with these corners of its core."""
    x_y = [tuple(Fraction(float(v)) for v in point) for point in points]
    return Exact(tuple(x_y), Fraction(float(radius)))


def box(sides: Iterable[float], radius: float = 0.0) -> Exact:
    """A rounded box with the sides min_x, min_y, max_x, max_y."""
    left, low, right, high = sides
    return shape([(left, low), (right, low), (right, high), (left, high)], radius)


def overlap(a: Exact, b: Exact) -> bool:
    """Whether two shapes overlap."""
    reach = a.radius + b.radius
    if any(are_apart(a, b, axis, reach) for axis in (0, 1)):  # most pairs
        return False
    return is_interior(a, b) or square_of_distance(a, b) < reach * reach


def are_apart(a: Exact, b: Exact, axis: int, reach: Number) -> bool:
    """Whether the gap between two cores along an axis is at least as large as a length."""
    one, other = ([point[axis] for point in core] for core in (a.core, b.core))
    return max(min(other) - max(one), min(one) - max(other)) >= reach > 0


def touch(a: Exact, b: Exact) -> bool:
    """Whether two shapes overlap or touch."""
    reach = a.radius + b.radius
    return is_interior(a, b) or square_of_distance(a, b) <= reach * reach


def is_interior(a: Exact, b: Exact) -> bool:
    """Whether (0, 0) is in the interior of the Minkowski difference of the cores."""
    points = [(q[0] - p[0], q[1] - p[1]) for p, q in product(a.core, b.core)]
    along = [(v[0] - u[0], v[1] - u[1]) for u, v in (*edges(a), *edges(b)) if u != v]
    # Otherwise a line through (0, 0) has all points on one side, or on it; one that is parallel to
    # a side of a core is among them.
    sides = [cross(side, point) for side in along for point in points]
    rows = [sides[k : k + len(points)] for k in range(0, len(sides), len(points))]
    return bool(rows) and all(min(row) < 0 < max(row) for row in rows)


def square_of_distance(a: Exact, b: Exact) -> Number:
    """The squared distance of the cores, unless one contains the other."""
    return min(between(p, q) for p, q in product(edges(a), edges(b)))


def distance(a: Exact, b: Exact) -> float:
    """The distance of the cores; 0 if they overlap."""
    return 0.0 if is_interior(a, b) else float(square_of_distance(a, b)) ** 0.5


def edges(of: Exact) -> list[tuple[Vector, Vector]]:
    """The sides of a core."""
    corners = of.core if len(of.core) > 2 else of.core[:1]
    return list(zip(corners, (*of.core[1:], of.core[0]), strict=False))


def between(p: tuple[Vector, Vector], q: tuple[Vector, Vector]) -> Number:
    """The squared distance of two line segments."""
    (a, b), (c, d) = p, q
    ab, cd = (b[0] - a[0], b[1] - a[1]), (d[0] - c[0], d[1] - c[1])
    sides = [cross(ab, (e[0] - a[0], e[1] - a[1])) for e in (c, d)]
    others = [cross(cd, (e[0] - c[0], e[1] - c[1])) for e in (a, b)]
    if sides[0] * sides[1] < 0 and others[0] * others[1] < 0:
        return 0
    return min(*(to_segment(e, q) for e in p), *(to_segment(e, p) for e in q))


def to_segment(point: Vector, segment: tuple[Vector, Vector]) -> Number:
    """The squared distance of a point from a line segment."""
    a, b = segment
    along, to = (b[0] - a[0], b[1] - a[1]), (point[0] - a[0], point[1] - a[1])
    square = dot(along, along)
    share = min(max(dot(to, along) / square, 0), 1) if square else 0
    rest = (to[0] - share * along[0], to[1] - share * along[1])
    return dot(rest, rest)


def cross(a: Vector, b: Vector) -> Number:
    """Positive if `b` is on the left of `a`."""
    return a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> Number:
    """The product of two vectors."""
    return a[0] * b[0] + a[1] * b[1]


def pairs(shapes: Sequence[Exact], period: tuple[int, int] = (0, 0)) -> list[list[int]]:
    """All pairs that overlap, sorted; with a period those of all images."""
    found = []
    turns = [range(-2, 3) if side else range(1) for side in period]
    shifts = [(Fraction(x * period[0]), Fraction(y * period[1])) for x, y in product(*turns)]
    for j, b in enumerate(shapes):
        images = [b.moved(by) for by in shifts]
        found += [[i, j] for i in range(j) if any(overlap(shapes[i], image) for image in images)]
    return sorted(found)


def lowest(value, low: float = 0.0, high: float = 1.0) -> tuple[float, float]:
    """Where a convex function of one number is lowest in an interval, and its value there.

    By the golden section.
    """
    share = (5**0.5 - 1) / 2
    left, right = high - share * (high - low), low + share * (high - low)
    at_left, at_right = value(left), value(right)
    for _ in range(50):
        if at_left < at_right:
            high, right, at_right = right, left, at_left
            left = high - share * (high - low)
            at_left = value(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + share * (high - low)
            at_right = value(right)
    return min((value(place), place) for place in (low, left, right, high))[::-1]
