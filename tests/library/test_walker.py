"""Characters of `Space.move_and_slide`: floors, steps, lifts, doors."""

import numpy as np
import pytest

import jostle

# Radius and half size.
MOVERS = {"box": (0.0, (5, 8)), "disc": (7.0, (0, 0)), "rounded": (2.0, (3, 6))}
movers = pytest.mark.parametrize("mover", MOVERS)
WALL, HERO = 1, 2


def ground(*points) -> jostle.Space:
    """A space with a polyline as the ground; y grows downwards."""
    space = jostle.Space()
    space.add(segments=jostle.polyline(points))
    return space


def hero_at(space: jostle.Space, mover: str, x: float, feet: float) -> int:
    """Add a character that stands on a horizontal floor."""
    radius, half = MOVERS[mover]
    return space.add((x, feet - half[1] - radius), radius, half, categories=HERO)


def walk(space: jostle.Space, hero: int, frames: int, speed: float, gravity: float, **rules):
    """Walk as the documents say: `remaining` is the velocity that is left."""
    velocity, slides, places = np.zeros(2), [], []
    for _ in range(frames):
        velocity = np.array([speed, velocity[1] + gravity])
        slides.append(space.move_and_slide(hero, velocity, **rules))
        velocity = slides[-1].remaining.copy()
        places.append(space.get(hero).positions)
    return slides, np.array(places)


def shift(space: jostle.Space, id: int, *by: float) -> None:
    """Move an obstacle."""
    space.set(id, positions=space.get(id).positions + np.array(by))


def flags(slides, name: str) -> list[bool]:
    return [getattr(slide, name) for slide in slides]


@movers
@pytest.mark.parametrize("gravity", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("speed", [0.5, 1.0, 3.0, 6.0])
@pytest.mark.parametrize("angle", [0, 10, 20, 30, 44])
@pytest.mark.parametrize("constant", [False, True])
def test_a_slope_is_a_floor_in_every_frame(mover, angle, speed, gravity, constant) -> None:
    fall = 200 * np.tan(np.radians(angle))
    points = [(-500, 0), (0, 0), (200, fall), (500, fall), (700, 0), (1500, 0)]
    space = ground(*points)
    hero = hero_at(space, mover, -30, 0)
    rules = {"snap": 8, "constant_speed": constant}
    slides, places = walk(space, hero, int(800 / speed), speed, gravity, **rules)
    assert all(flags(slides, "on_floor")) and not any(flags(slides, "on_ceiling"))
    assert not any(flags(slides, "on_wall")) and not any(flags(slides, "crushed"))
    # Never above the ground: the next fall would be longer than rounding.
    space.set(hero, positions=places[-1])
    assert np.abs(space.move_and_slide(hero, (0, 0.1)).displacement).max() < 1e-9
    if constant:
        length = np.linalg.norm(np.diff(places, axis=0), axis=1)
        is_even = (np.abs(length - speed) < 1e-9).mean()
        assert is_even > 0.9 and length.max() < speed * 1.5


@movers
def test_the_speed_does_not_depend_on_gravity(mover) -> None:
    ends = []
    for gravity in (0.1, 0.5, 1.0, 2.0):
        space = ground((-500, 0), (0, 0), (200, 115), (600, -115), (900, -115))
        hero = hero_at(space, mover, -30, 0)
        _, places = walk(space, hero, 150, 3, gravity, snap=8, constant_speed=True)
        ends.append(places[-1])
    np.testing.assert_allclose(ends, ends[:1] * 4, atol=1e-6)


@movers
@pytest.mark.parametrize("speed", [0.5, 2.0, 6.0])
@pytest.mark.parametrize("height", [1.0, 4.9, 5.0])
@pytest.mark.parametrize("constant", [False, True])
def test_steps_up_and_down(mover, speed, height, constant) -> None:
    space = jostle.Space()
    space.add(boxes=[(-100, 0, 300, 50), (0, -height, 60, 0), (30, -2 * height, 60, 0)])
    hero = hero_at(space, mover, -40, 0)
    rules = {"snap": 11, "step_height": 5, "constant_speed": constant}
    slides, places = walk(space, hero, int(180 / speed), speed, 0.5, **rules)
    assert all(flags(slides, "on_floor")) and not any(flags(slides, "on_wall"))
    # The edge of a step is a slope for what is round.
    least = speed - 1e-9 if mover == "box" else 0.5 * speed
    across = np.diff(places[:, 0])
    assert across.min() > least and across.max() < speed + 1e-9
    assert np.ptp(places[:, 1]) == pytest.approx(2 * height)
    assert places[-1, 1] == pytest.approx(places[0, 1])
    assert not (space.pairs() == hero).any()


@movers
@pytest.mark.parametrize("speed", [0.5, 2.0, 6.0])
def test_a_higher_step_is_a_wall(mover, speed) -> None:
    space = jostle.Space()
    space.add(boxes=[(-100, 0, 300, 50), (0, -5.1, 60, 0)])
    hero = hero_at(space, mover, -40, 0)
    slides, places = walk(space, hero, int(160 / speed), speed, 0.5, snap=8, step_height=5)
    assert slides[-1].on_wall and slides[-1].on_floor and places[-1, 0] < 0
    assert np.ptp(places[:, 1]) < 1e-9


def test_a_step_below_a_ceiling_is_a_wall() -> None:
    space = jostle.Space()
    space.add(boxes=[(-100, 0, 300, 50), (0, -5, 60, 0), (-100, -60, 300, -20)])
    hero = hero_at(space, "box", -40, 0)
    slides, places = walk(space, hero, 60, 2, 0.5, snap=8, step_height=5)
    assert slides[-1].on_wall and places[-1, 0] == pytest.approx(-5)


@movers
def test_a_jump_leaves_the_floor(mover) -> None:
    space = ground((-500, 0), (500, 0))
    hero = hero_at(space, mover, 0, 0)
    walk(space, hero, 3, 1, 0.5, snap=8, step_height=5)
    velocity, heights = np.array([1.0, -1.5]), []
    while not heights or velocity[1] < 0.5:
        slide = space.move_and_slide(hero, velocity, snap=8, step_height=5, constant_speed=True)
        assert not slide.on_floor
        np.testing.assert_allclose(slide.displacement, velocity)
        heights.append(space.get(hero).positions[1])
        velocity[1] += 0.5


def test_what_falls_is_not_put_on_the_floor() -> None:
    space = ground((-500, 0), (500, 0))
    hero = hero_at(space, "box", 0, -4)
    assert not space.move_and_slide(hero, (0, 1), snap=8).on_floor
    assert space.move_and_slide(hero, (0, 5), snap=8).on_floor


@movers
@pytest.mark.parametrize("speed", [-8, 8])
@pytest.mark.parametrize("snap", [0, 4])
def test_a_lift(mover, speed, snap) -> None:
    space = jostle.Space()
    lift = space.add(boxes=(-50, 0, 50, 10))
    hero = hero_at(space, mover, 0, 0)
    walk(space, hero, 2, 0, 0.5, snap=snap)
    for _ in range(30):
        shift(space, lift, 1, speed)
        slide = space.move_and_slide(hero, (0, 0.5), snap=snap)
        assert slide.on_floor and not slide.crushed and slide.floor == lift
        assert slide.platform_velocity.tolist() == [1, speed]
        np.testing.assert_allclose(slide.displacement, (1, speed), atol=1e-9)
    jump = space.move_and_slide(hero, (0, -10), snap=snap)
    assert not jump.on_floor and jump.platform_velocity.tolist() == [0, 0]


def test_a_jump_keeps_the_velocity_of_the_platform() -> None:
    space = jostle.Space()
    lift = space.add(boxes=(-50, 0, 50, 10))
    hero = hero_at(space, "box", 0, 0)
    space.move_and_slide(hero, (0, 1))
    shift(space, lift, 3, 0)
    slide = space.move_and_slide(hero, (0, -10), snap=4)
    assert not slide.on_floor and slide.platform_velocity.tolist() == [3, 0]
    slides = space.move_and_slide([hero], [(0, -10)])
    assert slides.platform_velocity.tolist() == [[0, 0]]


@movers
def test_a_door_crushes(mover) -> None:
    space = jostle.Space()
    space.add(boxes=[(-100, 0, 100, 10), (20, -50, 30, 0)])
    door = space.add(boxes=(-30, -50, -20, 0))
    hero = hero_at(space, mover, 10, 0)
    crushed = []
    for _ in range(35):
        shift(space, door, 1, 0)
        slide = space.move_and_slide(hero, (0, 0.5), snap=4)
        crushed.append(slide.crushed)
        assert len(set(slide.hits.tolist())) == len(slide.hits) == len(slide.normals)
    width = 2 * (MOVERS[mover][0] + MOVERS[mover][1][0])
    assert crushed == [k + 1 > 40 - width for k in range(35)]
    shift(space, door, -20, 0)
    assert not space.move_and_slide(hero, (0, 0.5)).crushed


@movers
def test_a_lift_crushes_against_a_ceiling(mover) -> None:
    space = jostle.Space()
    lift = space.add(boxes=(-50, 0, 50, 10))
    space.add(boxes=(-50, -40, 50, -30))
    hero = hero_at(space, mover, 0, 0)
    height = 2 * (MOVERS[mover][0] + MOVERS[mover][1][1])
    space.move_and_slide(hero, (0, 1))
    for k in range(25):
        shift(space, lift, 0, -1)
        assert space.move_and_slide(hero, (0, 0.5), snap=4).crushed == (k + 1 > 30 - height)


def test_many_have_the_columns_of_one() -> None:
    space = ground((-500, 0), (0, 0), (200, 80))
    ids = [hero_at(space, mover, 40 * k - 60, 0) for k, mover in enumerate(MOVERS)]
    slides = space.move_and_slide(ids, [(2, 0.5)] * 3, mask=0, snap=8, step_height=3)
    assert slides.__slots__ == jostle.Slide.__slots__
    assert slides.displacement.shape == slides.platform_velocity.shape == (3, 2)
    assert slides.crushed.dtype == bool and slides.crushed.shape == (3,)


def depths(center, radius, half, line, boxes) -> np.ndarray:
    """How deep a rounded box is in each segment and box, by clipping and distances to corners."""
    starts, ends = line[:-1] - center, line[1:] - center
    way = ends - starts
    with np.errstate(divide="ignore", invalid="ignore"):
        at = np.stack([(-half - starts) / way, (half - starts) / way])
    enters, leaves = np.nanmax(at.min(axis=0), axis=1), np.nanmin(at.max(axis=0), axis=1)
    is_beside = ((np.abs(starts) > half) & (way == 0)).any(axis=1)
    inside = np.clip(leaves, 0, 1) - np.clip(enters, 0, 1)
    crossing = np.where(is_beside, 0, inside * np.linalg.norm(way, axis=1))
    ways = [np.linalg.norm(np.maximum(np.abs(p) - half, 0), axis=1) for p in (starts, ends)]
    for corner in half * [(1, 1), (1, -1), (-1, 1), (-1, -1)]:
        share = ((corner - starts) * way).sum(axis=1) / (way * way).sum(axis=1)
        foot = starts + np.clip(share, 0, 1)[:, None] * way
        ways.append(np.linalg.norm(corner - foot, axis=1))
    apart = np.where(crossing > 1e-6, 0, np.min(ways, axis=0))
    to_lines = radius - apart if radius else np.where(crossing > 1e-6, crossing, 0)
    gaps = np.maximum(boxes[:, :2] - center, center - boxes[:, 2:]) - half
    between = np.linalg.norm(np.maximum(gaps, 0), axis=1)
    to_boxes = radius - between if radius else -gaps.max(axis=1)
    return np.concatenate([to_lines, to_boxes])


@pytest.mark.parametrize("seed", range(60))
def test_no_overlap_and_no_crossing(seed: int) -> None:
    """On random ground with random tiles."""
    rng = np.random.default_rng(seed)
    space = jostle.Space()
    xs = np.cumsum(rng.uniform(5, 40, 40)) - 60
    line = np.column_stack([xs, rng.uniform(-30, 30, 40).round(rng.integers(0, 2))])
    ends = line[[0, -1]] - (0, 500)
    fence = np.concatenate([ends[:1], line, ends[1:]])
    space.add(segments=jostle.polyline(fence))
    low = np.column_stack([rng.uniform(0, 600, 15), rng.uniform(-80, -20, 15)]).round()
    boxes = np.concatenate([low, low + rng.uniform(2, 30, (15, 2)).round()], axis=1)
    space.add(boxes=boxes)
    radius, half = MOVERS[list(MOVERS)[seed % 3]]
    hero = space.add(line[0] + (12, -60), radius, half)
    rules = {"snap": rng.choice([0, 4, 12]), "step_height": rng.choice([0, 6])}
    rules["constant_speed"] = bool(rng.integers(2))
    velocity, before = np.zeros(2), space.get(hero).positions
    for _ in range(400):
        velocity = np.array([rng.choice([-1, 1, 1]) * rng.uniform(0, 8), velocity[1] + 0.7])
        if rng.random() < 0.05:
            velocity[1] = -9
        slide = space.move_and_slide(hero, velocity, **rules)
        velocity, now = slide.remaining.copy(), space.get(hero).positions
        assert not slide.crushed and not (space.pairs() == hero).any()
        assert depths(now, radius, np.asarray(half, float), fence, boxes).max() < 1e-9
        assert line[0, 0] < now[0] < line[-1, 0] and now[1] < np.interp(now[0], *line.T)
        assert np.abs(now - before).sum() < 60
        before = now


@pytest.mark.parametrize("name", ["snap", "step_height"])
@pytest.mark.parametrize("value", [-1, np.nan, np.inf, 1e300])
def test_bad_lengths_move_nothing(name, value) -> None:
    space = ground((-500, 0), (500, 0))
    hero = hero_at(space, "box", 0, -4)
    with pytest.raises(ValueError, match=rf"{name} is .*; it must be between 0 and"):
        space.move_and_slide(hero, (0, 1), **{name: value})
    assert space.get(hero).positions.tolist() == [0, -12]
