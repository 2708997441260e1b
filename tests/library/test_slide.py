"""`Space.move_and_slide`: never inside, never through, no snagging, floors and platforms."""

import numpy as np
import pytest
from copies import WAYS
from hypothesis import given
from hypothesis import strategies as st

import jostle

WALL, WALKER, LEDGE = 1, 2, 4
# Radius and half size of walkers, in units of their size.
SHAPES = {"disc": (1.0, 0.0), "box": (0.0, 1.0), "rounded": (0.4, 0.6)}
# Radii and half sizes of one walker of each kind.
ONE_OF_EACH = [(1.0, (0, 0)), (0.0, (0.7, 0.4)), (0.3, (0.2, 0.5))]


def pairs_of(space: jostle.Space, ids) -> set:
    """Pairs of which one is in `ids`, by brute force over all pairs of the space."""
    pairs = np.sort(space.pairs(), axis=1)
    return set(map(tuple, pairs[np.isin(pairs, ids).any(axis=1)].tolist()))


def shift(space: jostle.Space, ids, by) -> None:
    space.set(ids, positions=space.get(ids).positions + np.asarray(by))


@st.composite
def scenes(draw):
    """Obstacles and walkers of all kinds that overlap nothing, and displacements."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    dtype = draw(st.sampled_from(["float64", "float32"]))
    scale = draw(st.sampled_from([0.01, 1.0, 100.0]))
    space = jostle.Space(dtype=dtype)
    n = draw(st.integers(1, 60))
    low = rng.uniform(-20, 20, (n, 2)).round(rng.integers(0, 3))
    size = rng.uniform(0, 6, (n, 2)).round(1)
    space.add(boxes=np.concatenate([low, low + size], 1) * scale)
    space.add(rng.uniform(-20, 20, (n, 2)) * scale, rng.uniform(0.1, 3, n) * scale)
    walkers = []
    for _ in range(12):
        kind = rng.integers(0, 3)
        half = rng.uniform(0.1, 1, 2) * (kind > 0) * scale
        radius = rng.uniform(0.1, 1) * (kind != 1) * scale
        walker = space.add(rng.uniform(-22, 22, 2) * scale, radius, half)
        if pairs_of(space, [walker]):
            space.remove(walker)
        else:
            walkers.append(walker)
    steps = rng.normal(0, 1, (len(walkers), 2)) * rng.choice([0.1, 5, 1000], (len(walkers), 1))
    steps *= scale * rng.choice([0, 1], steps.shape, p=[0.2, 0.8])
    return space, np.array(walkers, int), steps


@given(scenes(), st.sampled_from([(0, -1), (0, 0), (1, 2)]), st.integers(0, 2**32))
def test_never_inside(scene, up, seed: int) -> None:
    """Walkers come to overlap nothing, also while platforms are moved between calls.

    Only a platform may carry or push a walker to where something else stops it.
    """
    space, ids, steps = scene
    rng = np.random.default_rng(seed)
    others = np.setdiff1d(space.ids, ids)
    platforms = others[rng.random(len(others)) < rng.choice([0, 0.2])]
    scale = space.half_sizes.max() / 6
    floors = np.full(len(ids), -1)
    for _ in range(4):
        before = pairs_of(space, ids)
        slides = space.move_and_slide(ids, steps, up=up)
        is_carried = np.isin(floors, platforms)
        carried = np.sort(np.column_stack([ids, floors])[is_carried], axis=1)
        pushed = {
            (min(id, platform), max(id, platform))
            for id, hits in zip(ids.tolist(), slides.hits, strict=True)
            for platform in platforms.tolist()
            if np.any(hits != platform)
        }
        assert pairs_of(space, ids) <= before | set(map(tuple, carried.tolist())) | pushed
        floors = slides.floor
        shift(space, platforms, rng.normal(0, scale, (len(platforms), 2)))


@given(scenes())
def test_the_first_impact_is_where_brute_force_finds_it(scene) -> None:
    """Free on the whole path up to where it stops, and inside a little beyond."""
    space, ids, steps = scene
    if len(ids) == 0 or not steps[0].any():
        return
    start, step = space.get(ids[0]).positions.astype(float), steps[0]
    slide = space.move_and_slide(int(ids[0]), step, max_slides=1, up=(0, 0))
    moved = slide.displacement.astype(float)
    share = float(moved @ step / (step @ step))
    probe = jostle.Space(dtype=space.dtype)
    everything = np.setdiff1d(space.ids, ids[:1])
    probe.add(boxes=space.get(everything).boxes, radii=space.get(everything).radii)
    ghost = probe.add(start, space.get(ids[0]).radii, space.get(ids[0]).half_sizes)
    exact = 1e-9 if space.dtype == "float64" else 1e-3
    for part in np.linspace(0, 1, 200):
        probe.set(ghost, positions=start + step * share * part * (1 - exact))
        depths = probe_depth(probe, ghost)
        assert depths <= exact * (1 + np.abs(start).max() + np.abs(step).max())
    if len(slide.hits):
        assert share < 1
        size = space.get(ids[0]).radii + space.get(ids[0]).half_sizes.min()
        beyond = moved + step / np.linalg.norm(step) * 1e-2 * size
        probe.set(ghost, positions=start + beyond - slide.normals[-1] * 1e-2 * size)
        assert pairs_of(probe, [ghost])
    else:
        assert share == pytest.approx(1, abs=exact)


def probe_depth(space: jostle.Space, id: int) -> float:
    """Depth of the deepest overlap of a shape."""
    pairs = space.pairs()
    found = pairs[(pairs == id).any(axis=1)]
    depth = 0.0
    for a, b in found:
        boxes = space.get([a, b]).boxes.astype(float)
        gap = np.maximum(boxes[0, :2] - boxes[1, 2:], boxes[1, :2] - boxes[0, 2:])
        outside = np.hypot(*np.maximum(gap, 0))
        depth = max(depth, space.get([a, b]).radii.sum() - (outside or gap.max()))
    return depth


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("thickness", [0.0, 1e-3, 5.0])
def test_nothing_leaves_a_room_at_any_speed(dtype: str, thickness: float) -> None:
    rng = np.random.default_rng(1)
    space = jostle.Space(dtype=dtype)
    t = thickness
    space.add(boxes=[(-10 - t, -10 - t, 10 + t, -10), (-10 - t, 10, 10 + t, 10 + t)])
    space.add(boxes=[(-10 - t, -10, -10, 10), (10, -10, 10 + t, 10)])
    disc, box = space.add((0, 0), 1.0), space.add((3, 3), 0.0, (1.0, 0.5))
    for _ in range(400):
        steps = rng.normal(0, 1, (2, 2)) * 10 ** rng.uniform(-3, 9)
        space.move_and_slide([disc, box], steps, up=(0, 0))
        assert (np.abs(space.positions[-2:]) < 10).all()
        assert not pairs_of(space, [disc, box])


@pytest.mark.parametrize("size", [0.1, 1 / 3, 16.0])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_joints_of_tiles_do_not_stop_a_walker(size: float, shape: str, dtype: str) -> None:
    space = jostle.Space(dtype=dtype)
    edges = np.arange(201) * size
    space.add(boxes=np.stack([edges[:-1], 0 * edges[:-1], edges[1:], 0 * edges[:-1] + size], 1))
    radius, half = 0.4 * size * np.array(SHAPES[shape])
    walker = space.add((150 * size, -0.4 * size - size), radius, (half, half))
    space.move_and_slide(walker, (0, 3 * size))
    step = 0.37 * size
    for _ in range(100):
        slide = space.move_and_slide(walker, (-step, 0.2 * size))
        assert slide.on_floor and not slide.on_wall
        assert slide.displacement[0] == pytest.approx(-step, rel=1e-4)
        assert slide.remaining.tolist() == pytest.approx([-step, 0])


def test_a_walker_falls_along_a_wall_of_tiles() -> None:
    space = jostle.Space()
    edges = np.arange(101) * 0.1
    space.add(boxes=np.stack([0 * edges[:-1], edges[:-1], 0 * edges[:-1] + 0.1, edges[1:]], 1))
    walker = space.add((0.3, 0.0), 0.0, (0.1, 0.1))
    for _ in range(80):
        slide = space.move_and_slide(walker, (-0.5, 0.1))
        assert slide.on_wall and not slide.on_floor
        assert slide.displacement[1] == pytest.approx(0.1)


def test_touching_exactly_is_free() -> None:
    space = jostle.Space()
    space.add(boxes=[(0, 1, 10, 2)])
    walker = space.add((2, 0.5), half_sizes=0.5)
    slide = space.move_and_slide(walker, (5, 0))
    assert not slide.on_floor and slide.displacement.tolist() == [5, 0]
    slide = space.move_and_slide(walker, (-5, 1))
    assert slide.on_floor and space.get(walker).positions == pytest.approx([2, 0.5], abs=1e-12)
    assert len(space.pairs()) == 0


def test_a_walker_climbs_to_the_floor_angle_and_stands_there() -> None:
    """The slope of a large disc at an angle from its top; a small walker goes up to it."""
    for degrees, climbs in ((30, True), (44, True), (46, False), (80, False)):
        space = jostle.Space()
        space.add((0, 0), 1000.0)
        angle = np.radians(degrees)
        walker = space.add((-1001 * np.sin(angle), -1001 * np.cos(angle)), 1.0)
        space.move_and_slide(walker, (0, 0.5))
        height = space.get(walker).positions[1]
        slide = space.move_and_slide(walker, (0.5, 0.01))
        assert slide.on_floor == climbs
        before = space.get(walker).positions
        assert (before[1] < height - 0.1) == climbs
        for _ in range(100 * climbs):
            assert space.move_and_slide(walker, (0, 0.3)).on_floor
        assert not climbs or np.abs(space.get(walker).positions - before).max() < 0.05


def test_ceilings_and_masks() -> None:
    space = jostle.Space()
    space.add(boxes=(-5, -3, 5, -2), categories=WALL)
    walker = space.add((0, 0), 1.0, categories=WALKER)
    slide = space.move_and_slide(walker, (2, -9))
    assert slide.on_ceiling and slide.remaining.tolist() == [2, 0]
    assert not space.move_and_slide(walker, (0, -9), mask=LEDGE).on_ceiling
    space.set(walker, positions=(0, 0))
    space.set(walker, masks=LEDGE)
    assert len(space.move_and_slide(walker, (0, -9)).hits) == 0


def test_one_way_platforms() -> None:
    space = jostle.Space()
    ledge = space.add(boxes=(-5, 0, 5, 1), categories=LEDGE)
    walker = space.add((0, 3), half_sizes=(0.5, 1.0))
    rules = {"one_way": LEDGE}
    up = space.move_and_slide(walker, (0, -2.5), **rules)  # into it from below
    assert not up.on_ceiling and up.displacement.tolist() == [0, -2.5]
    side = space.move_and_slide(walker, (3, 0.1), **rules)  # inside
    assert len(side.hits) == 0
    space.move_and_slide(walker, (0, -3.0), **rules)
    down = space.move_and_slide(walker, (0, 50.0), **rules)
    assert down.on_floor and down.floor == ledge
    assert space.get(walker).positions[1] == pytest.approx(-1)
    assert space.move_and_slide(walker, (0, 1.0)).on_floor  # a floor for all else too
    from_the_side = space.add((9, 0.5), half_sizes=(0.5, 0.2))
    assert len(space.move_and_slide(from_the_side, (-4, 0), **rules).hits) == 0


def test_moving_platforms_carry() -> None:
    space = jostle.Space()
    platform = space.add(boxes=(-5, 0, 5, 1))
    wall = space.add(boxes=(20, -9, 21, 9))
    walker = space.add((0, -2), half_sizes=(0.5, 1.0))
    assert space.move_and_slide(walker, (0, 5)).floor == platform
    for _ in range(22):
        shift(space, platform, (1, -0.25))
        assert space.move_and_slide(walker, (0, 0.1)).on_floor
        assert not pairs_of(space, [walker])
    assert space.get(walker).positions[0] == pytest.approx(19.5)  # the wall held it back
    assert wall not in space.move_and_slide(walker, (0, 0)).hits


@pytest.mark.parametrize("way", WAYS)
def test_copies_keep_riders_and_segments(way) -> None:
    space = jostle.Space()
    space.add(segments=jostle.polyline([(-9, 0), (0, 0), (9, -9)]))
    platform = space.add(boxes=(-5, -20, 5, -19))
    walker = space.add((0, -22), half_sizes=(0.5, 1.0))
    space.move_and_slide(walker, (0, 5))
    twin = way(space)
    np.testing.assert_array_equal(twin.segments, space.segments)
    shift(twin, platform, (3, -1))
    assert twin.move_and_slide(walker, (0, 0.1)).displacement == pytest.approx([3, -1])


@pytest.mark.parametrize("order", [[0, 1, 2], [2, 1, 0]])
def test_a_floor_that_moves_in_the_same_call_carries(order) -> None:
    """A lift with a crate on it, and a walker on the crate."""
    space = jostle.Space()
    lift = space.add((0, 0), half_sizes=(5, 0.5))
    crate = space.add((0, -2), half_sizes=(2, 1))
    walker = space.add((0, -5), half_sizes=(0.5, 1.0))
    ids = np.array([lift, crate, walker])
    for _ in range(3):
        space.move_and_slide(ids, [(0, 0), (0, 2), (0, 2)])
    before = space.get(ids).positions
    for steps in ([(3, -1), (0, 0.1), (0, 0.1)], [(-2, 30), (0, 0.1), (0.5, 0.1)]):
        slides = space.move_and_slide(ids[order], np.array(steps)[order])
        moved = slides.displacement[np.argsort(order)]
        assert moved[0] == pytest.approx(steps[0])
        assert moved[1] == pytest.approx(moved[0], abs=1e-9)
        assert moved[2] == pytest.approx(moved[0] + (steps[2][0], 0), abs=1e-9)
        assert len(space.pairs()) == 0
    assert not (space.get(ids).positions == before).all()


KINDS = {
    "box": {"half_sizes": (5, 8)},
    "disc": {"radii": 8.0},
    "rounded": {"radii": 3.0, "half_sizes": (2, 5)},
}


def move_lifts(space: jostle.Space, lifts, by, way: str) -> None:
    """Move them by `by`, in one motion, in two, or by a call of their own."""
    if way == "other call":
        space.move_and_slide(lifts, np.tile(by, (len(lifts), 1)), mask=0)
        return
    for share in (0.75, 0.25) if way == "twice" else (1,):
        shift(space, lifts, np.array(by) * share)


@pytest.mark.parametrize("one_way", [0, LEDGE])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize(
    ("way", "mask"),
    [
        ("move", None),
        ("move", LEDGE),
        ("twice", LEDGE),
        ("after", None),
        ("other call", None),
        ("same call", LEDGE),
    ],
)
def test_a_rising_lift_catches_what_falls_onto_it(one_way, dtype, way, mask) -> None:
    """100 walkers above 100 lifts, at speeds up to a hundred times their height."""
    rng = np.random.default_rng(1)
    n, rules = 100, {"one_way": one_way, "mask": mask}
    x = np.arange(n) * 100.0
    for speed in (0.25, 0.5, 1, 2, 4, 8, 16, 64, 1600):
        space = jostle.Space(dtype=dtype)
        lifts = space.add(boxes=np.stack([x - 30, x * 0, x + 30, x * 0 + 8], 1), categories=LEDGE)
        heights = rng.uniform(0, 60, n)
        walkers = space.add(np.stack([x, -8 - heights], 1), half_sizes=(5, 8), categories=WALKER)
        ids = np.concatenate([walkers, lifts])
        velocities, has_landed = np.zeros((n, 2)), np.zeros(n, bool)
        tolerance = 1e-9 if dtype == "float64" else 0.1 * max(1, speed / 64)
        for _ in range(25):
            velocities[:, 1] += 0.5
            if way == "same call":
                steps = np.concatenate([velocities, np.tile((0, -speed), (n, 1))])
                slides = space.move_and_slide(ids, steps, **rules)
            else:
                if way != "after":
                    move_lifts(space, lifts, (0, -speed), way)
                slides = space.move_and_slide(walkers, velocities, **rules)
            tops = space.get(lifts).positions[:, 1] - 4
            assert (space.get(walkers).positions[:, 1] + 8 <= tops + tolerance).all()
            velocities = slides.remaining[:n].copy()
            on_floor = slides.on_floor[:n]
            assert on_floor[has_landed].all()
            has_landed |= on_floor
            if way == "after":
                move_lifts(space, lifts, (0, -speed), "move")
        assert has_landed.all() or (speed < 2 and has_landed.mean() > 0.5)


@pytest.mark.parametrize("shape", KINDS)
@pytest.mark.parametrize(
    "way", ["move", "one by one", "same call", "same call, masked", "same call, reversed"]
)
def test_platforms_that_move_together_carry_across_their_joints(shape: str, way: str) -> None:
    """Rows of 1, 2 and 8 platforms, velocities of them and of the walker on them."""
    for pieces in ([440.0], [40.0, 400.0], [55.0] * 8):
        x = np.concatenate([[0], np.cumsum(pieces)])
        boxes = np.stack([x[:-1], x[:-1] * 0, x[1:], x[1:] * 0 + 8], 1)
        for vx in (-3, -1.5, -1, 0, 1, 1.5, 3):
            for vy in (-2, -1, -0.5, 0, 0.5, 1, 2):
                for walk in (0.2, 1, 3):
                    space = jostle.Space()
                    parts = space.add(boxes=boxes, categories=LEDGE)
                    walker = space.add((20, -8.0), categories=WALKER, **KINDS[shape])
                    rules = {"mask": LEDGE if way == "same call, masked" else None}
                    space.move_and_slide(walker, (0, 0.5), **rules)
                    ids, steps = [*parts, walker], [(vx, vy)] * len(parts) + [(walk, 0.5)]
                    turn = -1 if way.endswith("reversed") else 1
                    for _ in range(20):
                        if way.startswith("same call"):
                            slides = space.move_and_slide(ids[::turn], steps[::turn], **rules)
                        else:
                            for some in [parts] if way == "move" else parts[:, None]:
                                shift(space, some, (vx, vy))
                            slides = space.move_and_slide([walker], [(walk, 0.5)], **rules)
                        row = 0 if turn < 0 else -1
                        moved = slides.displacement[row].tolist()
                        case = (pieces, vx, vy, walk)
                        assert moved == pytest.approx((vx + walk, vy), abs=1e-9), case
                        assert slides.on_floor[row] and not slides.on_wall[row], case
                    gaps = np.diff(space.get(parts).positions, axis=0)
                    middles = (x[:-1] + x[1:]) / 2
                    np.testing.assert_allclose(gaps[:, 0], np.diff(middles), atol=1e-9)
                    np.testing.assert_allclose(gaps[:, 1], 0, atol=1e-9)


def test_a_lift_does_not_drag_what_is_not_above_it() -> None:
    """Beside it, below it, above it with a gap, and on a floor beside it."""
    space = jostle.Space()
    lift = space.add(boxes=(0, 0, 60, 8), categories=LEDGE)
    space.add(boxes=(70, 8, 200, 16), categories=LEDGE)
    places = [(-5.0, 4), (30, 20), (30, -40), (75, 0)]
    walkers = space.add(places, half_sizes=(5, 8), categories=WALKER)
    rules = {"one_way": LEDGE, "mask": LEDGE}
    space.move_and_slide(walkers, np.zeros((4, 2)), **rules)
    for by in ((0, -10), (0, 10), (3, 10), (-3, -10), (0, 200)):
        shift(space, lift, by)
        slides = space.move_and_slide(walkers, np.zeros((4, 2)), **rules)
        assert slides.displacement.tolist() == np.zeros((4, 2)).tolist(), by
        assert len(slides.hits.ids) == 0


def test_a_lift_that_moves_away_downwards_lets_fall() -> None:
    space = jostle.Space()
    lift = space.add(boxes=(0, 0, 60, 8))
    walker = space.add((30, -20), half_sizes=(5, 8))
    for _ in range(5):
        shift(space, lift, (0, 30))
        slide = space.move_and_slide(walker, (0, 1))
        assert not slide.on_floor and slide.displacement.tolist() == [0, 1]


def test_a_long_move_is_a_motion_and_there_and_back_and_a_new_shape_are_not() -> None:
    for way in ("move", "there and back", "remove and add"):
        space = jostle.Space()
        wall = space.add((-500, 0), half_sizes=(5, 50))
        walker = space.add((0, 0), half_sizes=(5, 8))
        space.move_and_slide(walker, (0, 0))
        if way == "remove and add":
            space.remove(wall)
            wall = space.add((500, 0), half_sizes=(5, 50))
        else:
            space.set(wall, positions=(500, 0))
        if way == "there and back":
            space.set(wall, positions=(-500, 0))
        slide = space.move_and_slide(walker, (0, 1))
        moved = [510, 1] if way == "move" else [0, 1]
        assert slide.displacement.tolist() == pytest.approx(moved)
        assert list(slide.hits) == ([wall] if way == "move" else [])


def test_every_call_meets_what_has_moved_since_the_last_motion_of_its_walkers() -> None:
    """Walkers in calls of their own, in any order; one is added after the motion."""
    space = jostle.Space()
    lift = space.add(boxes=(0, 0, 90, 8))
    first, second = (space.add((x, -20), half_sizes=(5, 8)) for x in (10, 40))
    for walker in (first, second):
        space.move_and_slide(walker, (0, 0))
    for frame in range(6):
        shift(space, lift, (0, -40))
        third = space.add((70, space.get(lift).positions[1] + 27), half_sizes=(5, 8))
        for walker in [first, second, third][:: (-1) ** frame]:
            space.move_and_slide(walker, (0, 0.5))
            feet = space.get(walker).positions[1] + 8
            assert feet == pytest.approx(space.get(lift).positions[1] - 4)
            assert len(space.pairs()) == 0
        space.remove(third)


@pytest.mark.parametrize("way", WAYS)
def test_copies_keep_what_has_moved(way) -> None:
    space = jostle.Space(dtype="float32")
    gone, lift = space.add(boxes=[(200, 0, 260, 8), (0, 0, 60, 8)], categories=LEDGE)
    walker = space.add((30, -20), half_sizes=(5, 8))
    space.move_and_slide(walker, (0, 0))
    space.set([gone, lift], positions=[(230, 9), (30, -100)])
    space.remove(gone)
    twin = way(space)
    for one in (space, twin):
        slide = one.move_and_slide(walker, (0, 0.5), one_way=LEDGE)
        assert slide.floor == lift and one.get(walker).positions[1] == pytest.approx(-112)


def test_a_lift_crosses_the_edge_of_a_periodic_plane() -> None:
    for by in ((0, -40), (30, 0), (-30, 0), (10, 40)):
        space = jostle.Space(period=(100, 90))
        lift = space.add((95, 5), half_sizes=(4, 4))
        away = np.array(by) * 0.5
        walker = space.add(np.array((95, 5)) + away, radii=2.0)
        space.move_and_slide(walker, (0, 0))
        space.set(lift, positions=np.array((95, 5)) + by)
        slide = space.move_and_slide(walker, (0, 0))
        assert len(space.pairs()) == 0 and list(slide.hits) == [lift]
        along = slide.displacement @ away / np.linalg.norm(away)
        assert along == pytest.approx(np.linalg.norm(by) / 2 + 6, abs=1.5)


def test_a_lift_and_a_ceiling_leave_what_is_between_in_its_place() -> None:
    """It overlaps the lift as long as there is no room, and is pushed out afterwards."""
    space = jostle.Space()
    lift = space.add(boxes=(0, 0, 60, 8))
    ceiling = space.add(boxes=(0, -30, 60, -20))
    walker = space.add((30, -8), half_sizes=(5, 8))
    space.move_and_slide(walker, (0, 0.5))
    for top, fall, y in ((-3, 0.5, -11), (-8, 0, -12), (-2, 0.5, -10)):
        space.set(lift, positions=(30, top + 4))
        slide = space.move_and_slide(walker, (0, fall))
        assert space.get(walker).positions[1] == pytest.approx(y)
        assert pairs_of(space, [walker]) == ({(lift, walker)} if top == -8 else set())
        assert slide.on_ceiling == (top == -8) and (ceiling in slide.hits) == (top == -8)


@pytest.mark.parametrize("way", ["move", "same call"])
def test_a_rider_below_a_ceiling_does_not_pull_a_platform_apart(way: str) -> None:
    space = jostle.Space()
    boxes = [(0, 0, 20, 8), (20, 0, 60, 8), (60, 0, 90, 8)]
    parts = space.add(boxes=boxes, categories=LEDGE)
    space.add(boxes=(0, -30, 60, -18), categories=WALL)
    rider = space.add((18, -8), half_sizes=(5, 8), categories=WALKER)
    ids, starts = [*parts, rider], space.get(parts).positions
    space.move_and_slide(rider, (0, 0.5))
    for frame in range(1, 5):
        if way == "move":
            shift(space, parts, (0, -1))
            space.move_and_slide(rider, (0, 0.5))
        else:
            space.move_and_slide(ids, [(0, -1)] * 3 + [(0, 0.5)])
        np.testing.assert_allclose(space.get(parts).positions, starts - (0, frame), atol=1e-9)
        assert space.get(rider).positions[1] > -10 - 1e-9


def test_moved_obstacles_do_not_depend_on_ids_threads_or_their_number() -> None:
    """Many more obstacles than a call tests one by one, in any order, added before or after."""
    rng = np.random.default_rng(5)
    places, steps = rng.uniform(0, 400, (300, 2)), rng.normal(0, 6, (4, 300, 2))
    walks = rng.normal(0, 2, (4, 60, 2))
    found = []
    for order, threads in ((np.arange(300), 1), (rng.permutation(300), 2)):
        space = jostle.Space(threads=threads)
        ids = space.add(places[order], half_sizes=(3, 1), categories=LEDGE)
        free = np.stack(np.divmod(np.arange(60), 8), 1) * 50.0 + 7
        walkers = space.add(free, radii=1.0, categories=WALKER)
        shown = []
        for step, walk in zip(steps, walks, strict=True):
            shift(space, ids, step[order])
            together = 60 if threads == 1 else 4  # few at once are tested one by one
            for k in range(0, 60, together):
                some = slice(k, k + together)
                slides = space.move_and_slide(walkers[some], walk[some], mask=LEDGE)
                places_now = space.get(walkers[some]).positions
                shown.append(np.column_stack([places_now, slides.remaining, slides.on_floor]))
        found.append(np.concatenate(shown))
    np.testing.assert_array_equal(*found)


@given(st.integers(0, 2**32), st.sampled_from(["float32", "float64"]), st.booleans())
def test_nothing_leaves_a_room_that_moves(seed: int, dtype: str, is_one_call: bool) -> None:
    """Walls that move together by up to a thousand times the width of the room."""
    rng = np.random.default_rng(seed)
    space = jostle.Space(dtype=dtype)
    sides = [(-12, -12, -10, 12), (10, -12, 12, 12), (-12, -12, 12, -10), (-12, 10, 12, 12)]
    walls = space.add(boxes=sides, categories=WALL)
    ids = [space.add((0, 0), *shape, categories=WALKER) for shape in ONE_OF_EACH]
    for _ in range(15):
        by = rng.normal(0, 1, 2) * 10 ** rng.uniform(-3, 3.3)
        steps = rng.normal(0, 1, (3, 2)) * 10 ** rng.uniform(-3, 3)
        up = [(0, 0), (0, -1)][int(rng.integers(2))]
        if is_one_call:
            # `walls` are in the way of each other; `move` has no obstacles.
            space.set(walls, masks=WALKER)
            all_steps = np.concatenate([np.tile(by, (4, 1)), steps])
            space.move_and_slide([*walls, *ids], all_steps, up=up, mask=WALL)
        else:
            shift(space, walls, by)
            space.move_and_slide(ids, steps, up=up, mask=WALL)
        low, high = space.get(walls).boxes[0, 2:], space.get(walls).boxes[1, :2]
        room = np.array(
            [low[0], space.get(walls).boxes[2, 3], high[0], space.get(walls).boxes[3, 1]]
        )
        size = np.abs(room).max()
        slack = size * (1e-12 if dtype == "float64" else 1e-5)
        for box in space.get(ids).boxes.astype(float):
            assert (box[:2] >= room[:2] - slack).all() and (box[2:] <= room[2:] + slack).all()


@pytest.mark.parametrize("order", [[0, 1, 2], [2, 0, 1]])
def test_a_walker_jumps_with_what_stands_on_it_up_to_a_ceiling(order) -> None:
    space = jostle.Space()
    ids = space.add([(0, -0.75), (0, -2.25), (0, -3.75)], half_sizes=0.75)
    ceiling = space.add(boxes=(-9, -8, 9, -7))
    space.move_and_slide(ids[order], np.array([(0, 0), (0, 0.1), (0, 0.1)])[order])
    moved = []
    for _ in range(3):
        steps = np.array([(0, -2), (0, 0.1), (0, 0.1)])[order]
        slides = space.move_and_slide(ids[order], steps)
        back = np.argsort(order)
        moved.append(slides.displacement[back, 1].tolist())
        assert len(space.pairs()) == 0
        assert slides.on_floor[back].tolist() == [False, True, True]
    assert moved == [pytest.approx(row, abs=1e-9) for row in ([-2] * 3, [-0.5] * 3, [0] * 3)]
    hits = [slides.hits[row].tolist() for row in back]
    assert slides.on_ceiling.all() and hits[0] == [ids[1]] and ceiling in hits[2]
    assert slides.remaining[back[0]].tolist() == [0, 0]


def test_what_cannot_be_carried_stops_a_walker() -> None:
    """A disc leans against a wall, on a disc that walks towards the wall."""
    space = jostle.Space()
    space.add(boxes=(-9, 1, 9, 2))
    wall = space.add(boxes=(1.5, -9, 3, -0.5))
    ids = space.add([(0, 0), (0.5, -1.94)], radii=1.0)
    space.move_and_slide(ids, [(0, 0.1), (0, 0.1)])
    for _ in range(3):
        slides = space.move_and_slide(ids, [(0.2, 0.1), (0, 0.1)])
        assert len(space.contacts().depths) == 0
        assert np.abs(slides.displacement).max() < 1e-9
        assert ids[1] in slides.hits[0] and wall in slides.hits[1]
    slides = space.move_and_slide(ids, [(-0.2, 0.1), (0, 0.1)])  # away from it
    assert slides.displacement[0].tolist() == pytest.approx([-0.2, 0])
    assert slides.displacement[1, 0] == pytest.approx(-0.2, abs=0.1)


def test_a_lift_whose_riders_are_no_obstacles_is_not_stopped_by_them() -> None:
    space = jostle.Space()
    space.add(boxes=(-9, -6, 9, -5), categories=WALL)
    lift = space.add((0, 0), half_sizes=(5, 0.5), categories=LEDGE)
    rider = space.add((0, -1.5), radii=1.0, categories=WALKER)
    ids, steps = [lift, rider], [(0, -1), (0, 0.1)]
    space.move_and_slide(rider, (0, 0.1))
    for frame in range(3):
        slides = space.move_and_slide(ids, steps, mask=WALL | LEDGE)
        assert slides.displacement[0].tolist() == [0, -1]
        assert pairs_of(space, [rider]) == ({(lift, rider)} if frame == 2 else set())
    space.move_and_slide(ids, [(0, 2), (0, 0.1)], mask=WALL | LEDGE)
    assert pairs_of(space, [rider]) == set()


def test_a_platform_that_was_moved_into_its_rider_stays_there() -> None:
    """It is in the same call too; the rider makes room, not the platform."""
    space = jostle.Space()
    ids = space.add([(0, 0), (0, -1.5), (0, -3.5)], half_sizes=[(5, 0.5), (1, 1), (1, 1)])
    steps = [(0, 0), (0, 0.1), (0, 0.1)]
    space.move_and_slide(ids, steps)
    space.set(ids[0], positions=(1, -0.3))
    slides = space.move_and_slide(ids, steps)
    moved = [(0, 0), (1, -0.3), (1, -0.3)]
    np.testing.assert_allclose(slides.displacement, moved, atol=1e-9)
    assert len(space.pairs()) == 0


def test_a_stack_is_carried_across_the_edge_of_a_periodic_plane() -> None:
    space = jostle.Space(period=(20, 0))
    ids = space.add([(19.5, 0), (0.5, -2), (19, -4)], half_sizes=(2, 1))
    space.move_and_slide(ids, [(0, 0), (0, 0.1), (0, 0.1)])
    for step in ([1, -1], [1, -0.5], [-1, 0.5], [-2, -1]):
        slides = space.move_and_slide(ids, [step, (0, 0.1), (0, 0.1)])
        np.testing.assert_allclose(slides.displacement, [step] * 3, atol=1e-9)
        assert len(space.pairs()) == 0
        assert (space.positions[:, 0] >= 0).all() and (space.positions[:, 0] < 20).all()


def test_stacks_do_not_depend_on_threads_or_on_the_order_of_others() -> None:
    """Three discs in each of 200 pens."""
    rng = np.random.default_rng(4)
    steps = rng.normal(0, 0.3, (40, 600, 2))
    results = []
    for threads in (1, 2):
        space = jostle.Space(threads=threads)
        x = np.arange(201) * 3.0
        space.add(boxes=np.stack([x - 0.2, x - x - 9, x + 0.2, x - x + 1], 1))
        space.add(boxes=(0, 1, 600, 2))
        centers = np.stack([np.repeat(x[:200] + 1.5, 3), np.tile([0, -2.1, -4.2], 200)], 1)
        ids = space.add(centers, radii=0.9)
        order = np.arange(600) if threads == 1 else np.arange(600).reshape(200, 3)[::-1].ravel()
        for step in steps:
            slides = space.move_and_slide(ids[order], step[order] + (0, 0.2))
            assert len(space.contacts().depths) == 0
        back = np.argsort(order)
        results.append([space.get(ids).positions, slides.remaining[back], slides.floor[back]])
    for one, other in zip(*results, strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_platform_pushes_what_it_carries_out_where_there_is_room() -> None:
    """A disc moves under another one, which leans against a wall and slides up it."""
    space = jostle.Space()
    space.add(boxes=(1.5, -9, 3, -1.2))
    platform = space.add((0, 0), radii=1.0)
    rider = space.add((0.5, -1.95), radii=1.0)
    space.move_and_slide(rider, (0, 0.1))
    for _ in range(5):
        shift(space, platform, (0.1, 0))
        space.move_and_slide(rider, (0, 0.1))
        assert len(space.pairs()) == 0 and space.get(rider).positions[0] == pytest.approx(0.5)
    assert space.get(rider).positions[1] == pytest.approx(-2)
    ceiling = space.add(boxes=(-9, -5, 1.5, -3.01))
    shift(space, platform, (0, -0.3))
    space.move_and_slide(rider, (0, 0.1))  # there is no room
    assert pairs_of(space, [rider]) == {(platform, rider)}
    space.remove(ceiling)
    space.move_and_slide(rider, (0, 0.1))
    assert pairs_of(space, [rider]) == set()


def test_one_way_platforms_carry_whatever_is_rounded() -> None:
    for seed in range(60):
        rng = np.random.default_rng(seed)
        space = jostle.Space()
        lift = space.add(rng.uniform(-9, 9, 2), half_sizes=(5, 0.5), categories=LEDGE)
        walker = space.add(space.get(lift).positions - np.array((0, 3)), half_sizes=(0.3, 0.7))
        space.move_and_slide(walker, (0, 5), one_way=LEDGE)
        for _ in range(60):
            shift(space, lift, rng.normal(0, 0.3, 2))
            assert space.move_and_slide(walker, (0, 0.1), one_way=LEDGE).on_floor


@pytest.mark.parametrize("y", [0.7, 0.1, -3.3])
def test_the_joint_of_a_box_and_a_polyline_does_not_stop_a_walker(y: float) -> None:
    """Heights that float32 does not have."""
    space = jostle.Space()
    space.add(boxes=(0, y, 10, y + 1))
    space.add(segments=jostle.polyline([(10, y), (20, y)]))
    walker = space.add((2, y - 0.5), half_sizes=(0.3, 0.5))
    for _ in range(40):
        assert not space.move_and_slide(walker, (0.3, 0.05)).on_wall
    assert space.get(walker).positions[0] == pytest.approx(14)


def test_landing_on_a_floor_that_moves_later_in_the_call() -> None:
    space = jostle.Space()
    lift, walker = space.add([(0, 0), (0, -3)], half_sizes=[(5, 1), (0.5, 1)])
    space.move_and_slide([walker, lift], [(0, 5), (2, 0)])
    assert space.get(walker).positions[0] == 0
    space.move_and_slide(walker, (0, 0.1))  # what the floor has moved since
    assert space.get(walker).positions[0] == pytest.approx(2)


def test_what_stops_a_carried_or_pushed_walker_is_in_the_hits() -> None:
    space = jostle.Space()
    platform = space.add(boxes=(-5, 0, 5, 1))
    wall = space.add(boxes=(3, -9, 4, -0.1))
    walker = space.add((0, -2), half_sizes=(0.5, 1.0))
    space.move_and_slide(walker, (0, 5))
    shift(space, platform, (9, 0))
    carried = space.move_and_slide(walker, (0, 0.1))
    assert wall in carried.hits and carried.on_wall and carried.on_floor is False
    assert carried.displacement[0] == pytest.approx(2.5)
    piston = space.add(boxes=(-20, -9, 2.2, -0.1))  # it leaves a gap of 0.8 for a width of 1
    pushed = space.move_and_slide(walker, (0, 0), mask=0xFFFFFFFF)
    assert wall in pushed.hits and piston not in pushed.hits


def test_a_deep_overlap_does_not_depend_on_the_order() -> None:
    """One walker leaves a large box, and comes to another one far away."""
    results = []
    for order in ([0, 1], [1, 0]):
        space = jostle.Space()
        space.add(boxes=(0, -100, 100, 100))
        ids = space.add([(30, 0), (-3, 0.5)], 1.0)
        steps = np.array([(0.0, 0.0), (0.0, 2.0)])
        space.move_and_slide(ids[order], steps[order], up=(0, 0))
        assert len(space.pairs()) == 0
        results.append(space.get(ids).positions)
    # The second one moves out of the way before or after the first one comes.
    np.testing.assert_allclose(results[0][1], results[1][1], atol=3)


def test_ties_do_not_depend_on_the_history_of_the_space() -> None:
    """The same shapes, added in another order, one of them moved before."""
    boxes = np.array([(5, -2, 6, 0), (5, 0, 6, 2), (5, -2, 8, 2), (-9, 5, 9, 6)], float)
    found = []
    for order in ([0, 1, 2, 3], [2, 0, 3, 1], [3, 2, 1, 0]):
        for moves in (False, True):
            space = jostle.Space(leaf_capacity=1)
            ids = space.add(boxes=boxes[order] + 100 * moves)
            walker = space.add((0, 0), half_sizes=(1, 1))
            if moves:
                space.update()
                space.set(ids, boxes=boxes[order])
            slide = space.move_and_slide(walker, (30, 30))
            found.append([boxes[order][list(ids).index(hit)].tolist() for hit in slide.hits])
            found[-1].append(slide.displacement.tolist())
    assert all(one == found[0] for one in found)


def test_a_crowd_at_one_place() -> None:
    """So many walkers whose paths all may meet that a list of their pairs would be too long."""
    space = jostle.Space()
    n = 20_000
    ids = space.add(np.stack(np.divmod(np.arange(n), 200), 1) * 4.0, 1.0)
    space.move_and_slide(ids, np.tile((1000.0, 0.5), (n, 1)), up=(0, 0))
    assert len(space.pairs()) == 0


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("shape", SHAPES)
def test_slopes_are_climbed_up_to_the_floor_angle(shape: str, dtype: str) -> None:
    radius, half = SHAPES[shape]
    for degrees, climbs in ((20, True), (44.9, True), (45.1, False), (80, False)):
        angle = np.radians(degrees)
        space = jostle.Space(dtype=dtype)
        points = [(-50, 0), (0, 0), (100 * np.cos(angle), -100 * np.sin(angle))]
        _, slope = space.add(segments=jostle.polyline(points))
        walker = space.add((-10, -1.0), radius, (half, half))
        for _ in range(40):
            slide = space.move_and_slide(walker, (1.0, 0.5))
        assert (space.get(walker).positions[1] < -5) == climbs
        assert slide.on_floor and slide.on_wall == (not climbs)
        if climbs:
            before = space.get(walker).positions
            for _ in range(200):  # it stands
                assert space.move_and_slide(walker, (0, 0.5)).floor == slope
            most = 5e-4 if dtype == "float32" else 1e-12
            assert np.abs(space.get(walker).positions - before).max() < most


@given(st.integers(0, 2**32), st.sampled_from(["float32", "float64"]))
def test_nothing_leaves_a_polygon_of_segments(seed: int, dtype: str) -> None:
    """Discs, boxes and rounded boxes, at speeds from a thousandth to a billion."""
    rng = np.random.default_rng(seed)
    corners = int(rng.integers(3, 9))
    angles = np.arange(corners) * 2 * np.pi / corners + rng.uniform(0, 6)
    outline = 10 * np.stack([np.cos(angles), np.sin(angles)], 1)  # convex
    space = jostle.Space(dtype=dtype)
    space.add(segments=jostle.polyline(outline, closed=True))
    walls = space.segments.astype(float)
    ids = [space.add(np.zeros(2), *shape) for shape in ONE_OF_EACH]
    categories = np.array([2, 4, 8])  # they pass each other
    space.set(ids, masks=categories | 1, categories=categories)
    along = walls[:, 1] - walls[:, 0]
    for _ in range(40):
        steps = rng.normal(0, 1, (3, 2)) * 10 ** rng.uniform(-3, 9)
        space.move_and_slide(ids, steps, up=[(0, 0), (0, -1)][int(rng.integers(2))])
        centers = space.get(ids).positions.astype(float)
        for (radius, half), center in zip(ONE_OF_EACH, centers, strict=True):
            away = center - walls[:, 0]
            cross = along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]
            distance = np.abs(cross) / np.linalg.norm(along, axis=1)
            winding = np.sign(cross)
            assert (winding == winding[0]).all(), "it is outside"
            normal = np.stack([-along[:, 1], along[:, 0]], 1)
            normal /= np.linalg.norm(normal, axis=1)[:, None]
            reach = radius + np.abs(normal) @ np.array(half, float)
            assert (distance >= reach - (1e-9 if dtype == "float64" else 1e-3)).all()


def test_the_joints_of_segments_do_not_stop_a_walker() -> None:
    x = np.linspace(0, 100, 301)
    space = jostle.Space()
    space.add(segments=jostle.polyline(np.stack([x, 2 * np.sin(x / 3)], 1)))
    disc = space.add((3, -3), 0.5)
    box = space.add((3, -3), 0.0, (0.3, 0.5))
    space.set([disc, box], categories=[2, 4], masks=[3, 5])
    for _ in range(300):
        slides = space.move_and_slide([disc, box], [(0.3, 0.2)] * 2, floor_angle=1.0)
        assert not slides.on_wall.any()
    assert (space.get([disc, box]).positions[:, 0] > 60).all()


def test_a_walker_inside_an_obstacle_is_moved_out() -> None:
    space = jostle.Space()
    space.add(boxes=(0, 0, 10, 10))
    walker = space.add((-0.5, 5), 1.0)
    space.move_and_slide(walker, (0, 0))
    assert space.get(walker).positions[0] == pytest.approx(-1) and not pairs_of(space, [walker])


def test_long_motions_end_at_max_slides() -> None:
    space = jostle.Space()
    space.add(boxes=[(5, -50, 6, 50), (-50, 5, 50, 6)])
    walker = space.add((0, 0), 1.0)
    slide = space.move_and_slide(walker, (100, 70), max_slides=1, up=(0, 0))
    assert len(slide.hits) == 1 and slide.displacement == pytest.approx([4, 2.8])


def test_many_and_one() -> None:
    space = jostle.Space(dtype="float32")
    ids = space.add([(0, 0), (5, 0)], 1.0)
    slides = space.move_and_slide(ids, [(9, 0), (0, 1)])
    assert isinstance(slides, jostle.Slides) and slides.displacement.dtype == np.float32
    assert slides.hits[0].tolist() == [1] and slides.normals.tolist() == [[-1, 0]]
    assert slides.floor.tolist() == [-1, -1] and slides.on_wall.tolist() == [True, False]
    assert isinstance(space.move_and_slide(0, (0, 0)), jostle.Slide)
    empty = space.move_and_slide([], np.empty((0, 2)))
    assert len(empty.displacement) == 0 and len(empty.hits.ids) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([0, 0], [(0, 0), (1, 1)]), "given twice"),
        (([7], [(0, 0)]), "no shape has this id"),
        (([0], [(0, np.nan)]), r"displacements\[0\] is \(0, NaN\)"),
        (([0], [(0, 1e200)]), r"displacements\[0\] is"),
        (([0], [(0, 0), (1, 1)]), r"displacements has shape \(2, 2\)"),
        ((0, [(0, 0)]), "displacements has shape"),
        (([0], [(0, 0)], {"max_slides": 0}), "max_slides is 0"),
        (([0], [(0, 0)], {"max_slides": 1001}), "max_slides is 1001; it must be at most 1000"),
        (([0], [(0, 0)], {"up": (0, np.inf)}), "up is"),
        (([0], [(0, 0)], {"floor_angle": 2.0}), "floor_angle is 2"),
    ],
)
def test_bad_arguments_move_nothing(arguments, message: str) -> None:
    space = jostle.Space()
    space.add([(0, 0), (5, 0)], 1.0)
    ids, steps, keywords = (*arguments, {})[:3]
    with pytest.raises(ValueError, match=message):
        space.move_and_slide(ids, steps, **keywords)
    assert space.positions.tolist() == [[0, 0], [5, 0]]
