"""The smallest and the largest numbers give right answers or are refused."""

import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from oracle import DTYPES

import jostle

# Whole numbers: every product below is exact in float32, times any power of two.
RNG = np.random.default_rng(11)
N = 90
CENTERS = RNG.integers(-20, 20, (N, 2))
RADII = RNG.integers(0, 4, N)
HALVES = RNG.integers(0, 4, (N, 2))
POINTS = RNG.integers(-24, 24, (12, 2))
DIRECTIONS = np.array([(1, 0), (0, -1), (-3, 4), (1, 1)] * 3)
SQUARES = np.array([(0, 0), (6, 0), (6, 6), (0, 6)]) + POINTS[:, None]

# Powers of two with which the radii above stay within the limits of each type; for shapes without
# radii, those with which the coordinates are numbers of full precision and sums of them finite.
ROUND = {np.float32: (-59, 57), np.float64: (-498, 496)}
FLAT = {np.float32: (-126, 117), np.float64: (-1022, 1014)}


def answers(dtype: Any, exponent: int, radii: bool, halves: bool) -> dict[str, Any]:
    """Make all queries in a unit that is a power of two, and return lengths in that unit."""
    unit = dtype(2.0) ** exponent

    def scaled(numbers: NDArray[Any]) -> NDArray[Any]:
        return numbers.astype(dtype) * unit

    shapes: dict[str, Any] = {"half_sizes": scaled(HALVES)} if halves else {}
    tree = jostle.Quadtree(
        scaled(CENTERS), scaled(RADII) if radii else dtype(0), **shapes, leaf_capacity=4
    )
    thrown = scaled(np.resize(RADII, len(POINTS))) if radii else np.zeros(len(POINTS), dtype)
    points = scaled(POINTS)
    contacts = tree.contacts()
    nearest = tree.nearest(points, 5, max_distance=float(unit * 30))
    rays = tree.raycast(points, DIRECTIONS, max_distance=float(unit * 40))
    discs = tree.shape_cast(points, DIRECTIONS, radii=thrown)
    return {
        "pairs": tree.pairs(sort=True),
        "contacts": contacts.pairs,
        "normals": contacts.normals,
        "depths": contacts.depths / unit,
        "rects": np.concatenate(tree.query_rect(np.hstack([points, points + 6 * unit]))),
        "circles": np.concatenate(tree.query_circle(points, thrown)),
        "points": np.concatenate(tree.query_point(points)),
        "polygons": np.concatenate(tree.query_polygon(scaled(SQUARES))),
        "nearest": nearest.ids,
        "distances": nearest.distances / unit,
        "rays": rays.ids,
        "ray distances": rays.distances / unit,
        "discs": discs.ids,
        "disc distances": discs.distances / unit,
    }


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize(("radii", "halves"), [(True, False), (True, True), (False, True)])
def test_the_unit_of_length_does_not_matter(dtype: Any, radii: bool, halves: bool) -> None:
    expected = answers(dtype, 0, radii, halves)
    assert len(expected["pairs"]) > 20
    for exponent in (ROUND if radii else FLAT)[dtype]:
        for name, found in answers(dtype, exponent, radii, halves).items():
            np.testing.assert_array_equal(found, expected[name], f"{name} at 2^{exponent}")


@pytest.mark.parametrize("dtype", DTYPES)
def test_points_at_any_distance_are_different_points(dtype: Any) -> None:
    """Squares of such distances are 0."""
    tiny = np.finfo(dtype).smallest_subnormal
    tree = jostle.Quadtree(np.zeros((1, 2), dtype))
    assert tree.query_point((0, 0)).tolist() == [0]
    assert tree.query_point((tiny, 0)).tolist() == []
    assert tree.raycast((tiny, 0), (1, 0)).id == -1
    assert tree.raycast((tiny, 0), (0, 1)).id == -1
    assert tree.raycast((tiny, 0), (-1, 0)).distance == tiny
    assert tree.raycast((-1, tiny), (1, 0)).id == -1
    assert tree.nearest((tiny, 0)).distances[0] == tiny


@pytest.mark.parametrize("dtype", DTYPES)
def test_contacts_of_discs_that_nearly_coincide(dtype: Any) -> None:
    tiny = np.finfo(dtype).smallest_subnormal
    for offset, normal in [((0, tiny), (0, 1)), ((0, -tiny), (0, -1)), ((-tiny, 0), (-1, 0))]:
        contacts = jostle.Quadtree(np.array([(0, 0), offset], dtype), dtype(1)).contacts()
        assert contacts.normals.tolist() == [[*normal]]
        assert contacts.depths.tolist() == [2.0]
    apart = np.array([(0, 0), (3e-25, 4e-25)], dtype)
    normal = jostle.Quadtree(apart, dtype(1)).contacts().normals[0]
    np.testing.assert_allclose(normal, (0.6, 0.8), rtol=1e-6)


@pytest.mark.parametrize("dtype", DTYPES)
def test_whether_shapes_of_very_different_sizes_overlap(dtype: Any) -> None:
    """Against exact arithmetic, for radii over the whole range and centres beyond it."""
    low, high = (1e-18, 1e18) if dtype is np.float32 else (1e-150, 1e150)
    rng = np.random.default_rng(5)
    decades = np.log10(high) + 3
    n = 60
    centers = 10 ** rng.uniform(-decades, decades, (n, 2)) * rng.choice([-1, 0, 1], (n, 2))
    radii = 10 ** rng.uniform(np.log10(low), np.log10(high), n)
    centers, radii = centers.astype(dtype), radii.astype(dtype).clip(low, high)
    tree = jostle.Quadtree(centers, radii, leaf_capacity=4)
    unit = Fraction(2) ** 700  # every number is a whole number of 2^-700
    exact = [[int(Fraction(v) * unit) for v in center] for center in centers.tolist()]
    sizes = [int(Fraction(r) * unit) for r in radii.tolist()]

    def inside(i: int, j: int, reach: int) -> bool:
        (x, y), (u, v) = exact[i], exact[j]
        return (x - u) ** 2 + (y - v) ** 2 < reach**2

    pairs = {(i, j) for i in range(n) for j in range(i) if inside(i, j, sizes[i] + sizes[j])}
    assert 100 < len(pairs) < n * (n - 1) // 2
    assert {(j, i) for i, j in tree.pairs().tolist()} == pairs
    assert {(j, i) for i, j in jostle.find_pairs(centers, radii, method="brute").tolist()} == pairs
    around = tree.query_circle(centers, radii)
    assert {(i, j) for i in range(n) for j in around[i].tolist() if j < i} == pairs
    at = tree.query_point(centers)
    expected = {(i, j) for i in range(n) for j in range(n) if inside(i, j, sizes[j])}
    assert {(i, j) for i in range(n) for j in at[i].tolist()} == expected


OUT_OF_RANGE = [
    (np.float32, 2e18, "0, or between 1e-18 and 1e18 in float32"),
    (np.float32, 1e20, "0, or between 1e-18 and 1e18 in float32"),
    (np.float32, 1e-19, "0, or between 1e-18 and 1e18 in float32"),
    (np.float32, 1e-45, "0, or between 1e-18 and 1e18 in float32"),
    (np.float64, 1e160, "0, or between 1e-150 and 1e150 in float64"),
    (np.float64, 1e-151, "0, or between 1e-150 and 1e150 in float64"),
]


@pytest.mark.parametrize(("dtype", "radius", "rule"), OUT_OF_RANGE)
def test_radii_out_of_range_are_refused_by_name(dtype: Any, radius: float, rule: str) -> None:
    centers, radii = np.zeros((2, 2), dtype), np.array([1, radius], dtype)
    tree, space = jostle.Quadtree(centers, dtype(1)), jostle.Space(dtype=np.dtype(dtype).name)
    space.add(centers, 1.0)
    value = rf"{np.format_float_scientific(radii[1], trim='-', exp_digits=1)}".replace("e+", "e")
    calls = {
        "radii[1]": [
            lambda: jostle.find_pairs(centers, radii),
            lambda: jostle.Quadtree(centers, radii),
            lambda: space.add(centers, radii),
            lambda: space.set([0, 1], radii=radii),
            lambda: tree.shape_cast((0, 0), (1, 0), radii=radii),
        ],
        "radius[1]": [
            lambda: tree.query_circle(centers, radii),
            lambda: space.query_circle((0, 0), radii),
        ],
        "radius": [lambda: tree.query_circle((0, 0), radii[1])],
    }
    for name, all_of_it in calls.items():
        for call in all_of_it:
            message = f"{name} is {value}; a radius must be {rule}"
            with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
                call()
    assert space.radii.tolist() == [1, 1]


def test_a_plain_number_too_small_for_float32_is_not_taken_for_0() -> None:
    same = np.zeros((2, 2), np.float32)
    assert jostle.find_pairs(same.astype(np.float64), 1e-60).tolist() == [[0, 1]]
    with pytest.raises(ValueError, match=r"^radii is 1e-45; a radius must be 0, or between"):
        jostle.find_pairs(same, 1e-60)


def test_a_world_has_the_same_limits() -> None:
    for radius in (1e-19, 2e18):
        with pytest.raises(ValueError, match=r"^radii is .*; a radius must be 0, or between 1e-18"):
            jostle.World([(0, 0)], radius)
    world = jostle.World([(0, 0), (1e-18, 0)], 1e-18, masses=1, on_touch="ignore")
    assert world.last_step.contacts.pairs.tolist() == [[0, 1]]


@pytest.mark.parametrize("dtype", DTYPES)
def test_half_sizes_of_any_size(dtype: Any) -> None:
    """Only sums of them have to be finite."""
    largest = np.finfo(dtype).max / 8
    for half in (largest, np.finfo(dtype).tiny):
        centers = np.array([(0, 0), (half, half), (2 * half, 0)], dtype)
        tree = jostle.Quadtree(centers, half_sizes=np.full((3, 2), half, dtype))
        assert tree.pairs(sort=True).tolist() == [[0, 1], [1, 2]]
        assert tree.query_point(centers)[1].tolist() == [1]
        corners = np.array([(0, 0), (half, 0), (half, half)], dtype)
        assert tree.query_polygon(corners).tolist() == [0, 1]
    with pytest.raises(ValueError, match=r"^vertices\[1\] is .*; both coordinates must be within"):
        tree.query_polygon(np.array([(0, 0), (2 * largest, 0), (0, 1)], dtype))
    with pytest.raises(ValueError, match=r"^half_sizes is .*; a half size must be at most "):
        jostle.Quadtree(np.zeros((1, 2), dtype), half_sizes=np.full((1, 2), largest * 2)[0])
