"""`World.free_positions`, against all distances in plain NumPy."""

import re
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import jostle

BOX = jostle.Box(-10, 0, 30, 25)
ROUND = jostle.Circle((3, 4), 20)
WALLS = np.array([[(-5, 5), (20, 9)], [(0, 20), (0, 30)], [(25, 0), (28, 1)]])


def distances(a: NDArray[Any], b: NDArray[Any], period: Any = None) -> NDArray[np.float64]:
    """All distances of two lists of points, of the minimum images."""
    apart = a[:, None].astype(float) - b[None].astype(float)
    if period is not None:
        apart -= period * np.round(apart / period)
    return np.hypot(*apart.T).T


def to_segments(points: NDArray[Any], segments: NDArray[Any]) -> NDArray[np.float64]:
    """Distances of points from line segments."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    offset = points[:, None].astype(float) - start
    share = np.clip((offset * along).sum(-1) / (along**2).sum(-1), 0, 1)
    return np.hypot(*(offset - share[..., None] * along).T).T


def check(world: jostle.World, at: NDArray[Any], radii: Any, gap: float = 0.0) -> None:
    """The discs touch nothing."""
    r = np.broadcast_to(radii, len(at)).astype(float)
    period = world.period
    solid = ~world.sensors
    apart = distances(at, at, period) + np.diag(np.full(len(at), np.inf))
    rounding = 1e-5
    assert (apart >= r[:, None] + r + gap - rounding).all()
    others = distances(at, world.positions[solid], period)
    assert (others >= r[:, None] + world.radii[solid] + gap - rounding).all()
    lines = world.walls.segments.astype(float)
    images = [(0.0, 0.0)]
    if period is not None:
        images = [(x, y) for x in (-period[0], 0, period[0]) for y in (-period[1], 0, period[1])]
        assert (at >= 0).all() and (at <= period).all()
    for image in images:
        assert (to_segments(at + np.array(image), lines) >= r[:, None] + gap - rounding).all()
    match world.container:
        case jostle.Box(min_x=x0, min_y=y0, max_x=x1, max_y=y1):
            inset = (r + gap - rounding)[:, None]
            assert (at - inset >= (x0, y0)).all() and (at + inset <= (x1, y1)).all()
        case jostle.Circle(center=center, radius=outer):
            assert (np.hypot(*(at - center).T) <= outer - r - gap + rounding).all()


@pytest.mark.parametrize("gap", [0.0, 0.4])
@pytest.mark.parametrize(
    "rules", [{"container": BOX}, {"container": ROUND}, {"period": (40, 25)}], ids=str
)
def test_they_touch_nothing(rules: dict[str, Any], gap: float) -> None:
    rng = np.random.default_rng(7)
    walls = WALLS % 25 if "period" in rules else WALLS
    old = rng.uniform(2, 23, (30, 2))
    sensors = np.arange(30) % 3 == 0
    world = jostle.World(old, rng.uniform(0.1, 1.5, 30), sensors=sensors, walls=walls, **rules)
    radii = rng.uniform(0, 1.2, 60) ** 2
    at = world.free_positions(60, radii, gap=gap, seed=3)
    assert at.shape == (60, 2) and at.dtype == np.float32 and len(world) == 30
    check(world, at, radii, gap)
    # Sensors do not keep discs away.
    assert (distances(at, old[sensors], world.period) < radii[:, None] + world.radii[sensors]).any()
    hash_before = world.state_hash()
    world.add(at, radii, masses=1.0)
    assert world.state_hash() != hash_before
    pairs = world.pairs()
    assert rules.get("period") or not [
        pair for pair in pairs if max(pair) >= 30 and not world.sensors[min(pair)]
    ]


def test_walls_across_the_side_of_a_period() -> None:
    world = jostle.World(period=20, walls=[[(-3, 5), (3, 5)], [(10, 18), (10, 22)]])
    for seed in range(20):
        at = world.free_positions(20, 0.9, seed=seed)
        check(world, at, 0.9)


def test_sensor_walls_do_not_count() -> None:
    lines = [[(0, 5), (10, 5)], [(5, 0), (5, 10)]]
    walls = {"segments": lines, "sensors": [True, False]}
    world = jostle.World(container=jostle.Box(0, 0, 10, 10), walls=walls)
    at = np.concatenate([world.free_positions(4, 1.0, seed=seed) for seed in range(20)])
    to_each = to_segments(at, np.array(lines, float))
    assert (to_each[:, 0] < 1).any() and (to_each[:, 1] >= 1 - 1e-5).all()


def test_regions() -> None:
    world = jostle.World()
    box, disc = jostle.Box(1, 2, 9, 5), jostle.Circle((50, -50), 6)
    at = world.free_positions(8, 0.5, region=box, gap=0.3, seed=1)
    assert (at >= (1.5, 2.5)).all() and (at <= (8.5, 4.5)).all()
    check(world, at, 0.5, 0.3)
    at = world.free_positions(30, 0.5, region=disc, seed=1)
    assert (np.hypot(*(at - (50, -50)).T) <= 5.5 + 1e-5).all()
    check(world, at, 0.5)
    # A region that extends beyond the container: the container counts, too.
    world = jostle.World(container=jostle.Box(0, 0, 10, 10))
    at = world.free_positions(20, 0.5, region=jostle.Circle((10, 10), 7), seed=2)
    check(world, at, 0.5)
    assert (np.hypot(*(at - (10, 10)).T) <= 6.5 + 1e-5).all()


def test_a_region_on_a_periodic_plane() -> None:
    world = jostle.World([(5, 5)], 2.0, period=(20, 20))
    at = world.free_positions(10, 0.5, region=jostle.Box(3, 3, 12, 12), seed=2)
    check(world, at, 0.5)
    assert (at >= 3.5).all() and (at <= 11.5).all()


def test_large_discs_are_placed_first() -> None:
    world = jostle.World(container=jostle.Box(0, 0, 20, 20))
    radii = np.where(np.arange(201) == 200, 6.0, 0.4)  # the last one finds no room after the others
    at = world.free_positions(201, radii, seed=1)
    check(world, at, radii)


def test_nearly_full() -> None:
    # Random sequential addition ends at 54.7 % of the area; half of it is filled in every case.
    world = jostle.World(period=(50, 50))
    n = int(0.5 * 2500 / (np.pi * 0.5**2))
    for seed in range(3):
        at = world.free_positions(n, 0.5, seed=seed)
        check(world, at, 0.5)


def test_they_are_uniform() -> None:
    world = jostle.World(container=jostle.Box(0, 0, 40, 20))
    at = np.concatenate([world.free_positions(100, 0.2, seed=seed) for seed in range(100)])
    counts, *_ = np.histogram2d(*at.T, bins=(8, 4), range=[(0.2, 39.8), (0.2, 19.8)])
    assert np.abs(counts - 10_000 / 32).max() < 5 * np.sqrt(10_000 / 32)


def test_seeds_and_threads() -> None:
    world = jostle.World([(20, 12)], 4.0, period=(40, 25))
    first = world.free_positions(50, 0.7)
    np.testing.assert_array_equal(first, world.free_positions(50, 0.7, seed=0))
    assert not np.array_equal(first, world.free_positions(50, 0.7, seed=1))
    world.threads = 1
    np.testing.assert_array_equal(first, world.free_positions(50, 0.7))


def test_points_and_none() -> None:
    world = jostle.World(container=BOX)
    assert world.free_positions(0, 1.0).shape == (0, 2)
    assert world.free_positions(0, []).shape == (0, 2)
    assert len(np.unique(world.free_positions(1000, 0.0), axis=0)) == 1000


def test_too_many_discs_are_refused_with_the_number_that_found_room() -> None:
    world = jostle.World(container=jostle.Box(0, 0, 10, 10))
    with pytest.raises(
        ValueError, match=r"^n is 60; there is room for (\d+), and none was found"
    ) as raised:
        world.free_positions(60, 1.0)
    assert str(raised.value).endswith(
        "for the next one, of radius 1; random positions fill at most about half of a region"
    )
    found = int(re.findall(r"room for (\d+)", str(raised.value))[0])
    assert 10 < found < 22
    world.free_positions(found, 1.0)
    with pytest.raises(ValueError, match="there is room for 0"):
        jostle.World([(5, 5)], 5.0, container=world.container).free_positions(1, 4.0)


@pytest.mark.parametrize(
    ("arguments", "options", "error", "message"),
    [
        ((-1, 1.0), {}, ValueError, "n is -1; it must be at least 0"),
        ((2.5, 1.0), {}, TypeError, "n must be an integer, not float"),
        ((2**40, 1.0), {}, ValueError, "n is 1099511627776; it must be below 4294967295"),
        ((2, [1.0]), {}, ValueError, "radii has shape (1,); it must be a number or (2,)"),
        (
            (2, [1.0, -1.0]),
            {},
            ValueError,
            "radii[1] is -1; a radius must be finite and at least 0",
        ),
        ((1, 6.0), {}, ValueError, "radii is 6; it must fit between the walls (at most 5)"),
        ((1, 1.0), {"gap": -1}, ValueError, "gap is -1; it must be finite and at least 0"),
        ((1, 1.0), {"gap": np.nan}, ValueError, "gap is NaN; it must be finite and at least 0"),
        ((1, 1.0), {"gap": "x"}, TypeError, "gap must be a number, not str"),
        ((1, 1.0), {"seed": -1}, ValueError, "seed is -1; it must be at least 0"),
        ((1, 1.0), {"seed": 2**32}, ValueError, "seed is 4294967296; it must be below 4294967296"),
        (
            (1, 1.0),
            {"region": (0, 0, 1, 1)},
            TypeError,
            "region must be a jostle.Box, jostle.Circle or None, not tuple",
        ),
        (
            (1, 2.0),
            {"region": jostle.Circle((0, 0), 1)},
            ValueError,
            "radii is 2; it must fit into the round container (at most 1)",
        ),
    ],
    ids=str,
)
def test_bad_input(arguments: Any, options: Any, error: type[Exception], message: str) -> None:
    world = jostle.World(container=jostle.Box(0, 0, 10, 10))
    with pytest.raises(error, match=f"^{re.escape(message)}$"):
        world.free_positions(*arguments, **options)


def test_a_world_without_region() -> None:
    message = "region is None; a world without container and period needs a Box or a Circle"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        jostle.World().free_positions(3, 1.0)
