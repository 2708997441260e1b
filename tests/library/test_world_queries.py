"""The queries of a world for particles, compared with brute force, and what changes answers."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracle_worlds import (
    MASKS,
    NEAR,
    WORLDS,
    agree,
    from_polygon,
    from_rect,
    gaps_of,
    has_bits,
    images,
    made,
)
from results import fields
from worlds import gas

import jostle


@given(WORLDS, MASKS)
def test_regions(drawn: tuple[int, str], mask: int | None) -> None:
    world, rng = made(drawn)
    chosen = has_bits(world, mask)
    before = world.state_hash()
    for _ in range(4):
        point, radius = rng.uniform(-9, 9, 2), rng.uniform(0, 4)
        gaps = gaps_of(world, lambda at, point=point: np.linalg.norm(at - point, axis=-1))
        assert agree(world.query_point(tuple(point), mask=mask), world, gaps, chosen)
        found = world.query_circle(tuple(point), radius, mask=mask)
        assert agree(found, world, gaps - radius, chosen)
        low, size = point, rng.uniform(0.1, 6, 2)
        gaps = gaps_of(world, lambda at, low=low, size=size: from_rect(at, low, low + size))
        rect = (*low, *(low + size))
        assert agree(world.query_rect(rect, mask=mask), world, gaps, chosen)
        corners = point + rng.uniform(1, 3) * np.array([(1, 0), (0, 1), (-1, 0.2), (0, -1)])
        gaps = gaps_of(world, lambda at, corners=corners: from_polygon(at, corners))
        assert agree(world.query_polygon(corners.tolist(), mask=mask), world, gaps, chosen)
        if len(found):
            less = world.query_circle(tuple(point), radius, mask=mask, exclude=found[0])
            assert less.tolist() == found[1:].tolist()
    assert world.state_hash() == before


@given(WORLDS, MASKS, st.sampled_from([0.0, 1.5]))
def test_pairs_and_neighbors(drawn: tuple[int, str], mask: int | None, distance: float) -> None:
    world, _ = made(drawn)
    at, ids = world.positions.astype(float), world.ids
    apart = at[:, None] - at - images(world, 2)[:, None, None]
    gaps = np.linalg.norm(apart, axis=-1).min(axis=0)
    gaps = gaps - np.add.outer(world.radii, world.radii) - distance
    meets = (world.categories[:, None] & world.masks) != 0
    meets &= meets.T & ~np.eye(len(at), dtype=bool)
    chosen = has_bits(world, mask)
    meets &= chosen[:, None] & chosen
    pairs = world.pairs(distance=distance, mask=mask, sort=True)
    assert pairs.tolist() == sorted(pairs.tolist()) and (pairs[:, 0] < pairs[:, 1]).all()
    found = np.zeros((len(at), len(at)), bool)
    first, second = world.rows(pairs).T
    found[first, second] = found[second, first] = True
    known = np.abs(gaps) > NEAR
    np.testing.assert_array_equal(found[known], ((gaps < 0) & meets)[known])
    lists = world.neighbors(distance, mask=mask)
    assert [row.tolist() for row in lists] == [ids[row].tolist() for row in found]
    if distance == 0:
        contacts = world.contacts(mask=mask, sort=True)
        np.testing.assert_array_equal(contacts.pairs, pairs)
        np.testing.assert_allclose(contacts.depths, -gaps[first, second], atol=NEAR)
        np.testing.assert_array_equal(contacts.categories[:, 0], world.categories[first])
        with_unit = contacts.depths > NEAR
        lengths = np.linalg.norm(contacts.normals, axis=1)
        np.testing.assert_allclose(lengths[with_unit], 1, atol=1e-5)
        if len(pairs):
            with pytest.raises(ValueError, match="max_pairs"):
                world.pairs(max_pairs=0, mask=mask)


@given(WORLDS, MASKS, st.integers(1, 5))
def test_nearest(drawn: tuple[int, str], mask: int | None, k: int) -> None:
    world, rng = made(drawn)
    points, limit = rng.uniform(-9, 9, (5, 2)), rng.uniform(1, 9)
    near = world.nearest(points, k, max_distance=limit, mask=mask)
    excluded = world.nearest(points, k, max_distance=limit, mask=mask, exclude=near.ids[:, 0])
    assert near.ids.shape == (5, k)
    for point, ids, distances, others in zip(
        points, near.ids, near.distances, excluded.ids, strict=True
    ):
        gaps = gaps_of(world, lambda at, point=point: np.linalg.norm(at - point, axis=-1))
        gaps = np.where(has_bits(world, mask), np.maximum(gaps, 0), np.inf)
        expected = np.sort(np.append(gaps, [np.inf] * k))[:k]
        expected[expected > limit] = np.inf
        np.testing.assert_allclose(distances, expected, atol=NEAR)
        there = ids >= 0
        assert np.array_equal(there, np.isfinite(distances))
        np.testing.assert_allclose(gaps[world.rows(ids[there])], distances[there], atol=NEAR)
        assert len(set(ids[there])) == there.sum()
        assert others[: k - 1].tolist() == ids[1:].tolist()


def test_a_world_without_particles() -> None:
    world = jostle.World(container=jostle.Box(-1, -1, 1, 1))
    assert world.pairs().shape == (0, 2) and len(world.contacts().pairs) == 0
    assert len(world.neighbors(1.0)) == 0 and len(world.nodes().boxes) == 0
    assert len(world.query_circle((0, 0), 9)) == 0 and len(world.query_point((0, 0))) == 0
    assert world.nearest((0, 0), 2).ids.tolist() == [-1, -1]
    assert world.raycast((0, 0), (1, 0)).wall == jostle.Side.MAX_X
    world.container = None
    assert world.raycast((0, 0), (1, 0)).wall == -1
    assert len(world.raycast_all((0, 0), (1, 0)).ids) == 0


def columns_of(answer: Any) -> tuple[Any, ...]:
    return (answer,) if isinstance(answer, np.ndarray) else fields(answer)


def answers(world: jostle.World) -> list[Any]:
    """The answers of many queries."""
    ways = np.array([(1, 0), (0, 1), (-1, 0.1), (0.3, -1)])
    found = [
        world.pairs(sort=True, distance=0.5),
        world.contacts(sort=True),
        world.neighbors(1.0, mask=3),
        world.query_rect((-5, -5, 5, 5)),
        world.nearest([(0, 0), (9, 9)], 3),
        world.raycast((5, 5), ways, max_distance=30),
        world.raycast_all((5, 5), ways, max_distance=30),
        world.raycast_all((5, 5), ways, max_distance=30, mask=1),
        world.walls.query_circle((3, 5), 1.0),
        world.walls.nearest((0, 0), 2),
        world.walls.raycast_all((9, 5), (-1, 0), max_distance=30),
        world.nodes(),
    ]
    return [np.hstack([np.ravel(column) for column in columns_of(one)]) for one in found]


def are_equal(some: list[Any], others: list[Any]) -> bool:
    pairs = zip(some, others, strict=True)
    return all(np.array_equal(one, other, equal_nan=True) for one, other in pairs)


CHANGES: dict[str, Callable[[jostle.World], Any]] = {
    "step": lambda world: world.step(0.1),
    "add": lambda world: world.add((0, 0), 2.0),
    "remove": lambda world: world.remove(world.ids[3]),
    "set positions": lambda world: world.set(world.ids[:4], positions=[(0, 0)] * 4),
    "set radii": lambda world: world.set(world.ids[:4], radii=2.0),
    "set categories": lambda world: world.set(world.ids[:9], categories=4),
    "set masks": lambda world: world.set(world.ids[:9], masks=0),
    "set velocities": lambda world: world.set(world.ids[:4], velocities=(5, 0)),
    "positions": lambda world: setattr(world, "positions", world.positions[::-1]),
    "radii": lambda world: setattr(world, "radii", 0.9),
    "masks": lambda world: setattr(world, "masks", 2),
    "container": lambda world: setattr(world, "container", jostle.Box(-50, -50, 50, 50)),
    "leaf_capacity": lambda world: setattr(world, "leaf_capacity", 8),
    "move walls": lambda world: setattr(world.walls, "segments", [[(1, 1), (2, 30)]]),
    "set walls": lambda world: world.walls.set(0, segments=((1, 1), (2, 30))),
    "wall categories": lambda world: world.walls.set(0, categories=4),
    "one_way": lambda world: setattr(world.walls, "one_way", True),
    "sensors": lambda world: setattr(world.walls, "sensors", True),
    "add walls": lambda world: world.walls.add([[(1, 1), (2, 30)]]),
    "remove walls": lambda world: world.walls.remove(0),
    "forces": lambda world: setattr(world, "forces", []),
}


@pytest.mark.parametrize("name", CHANGES)
def test_after_each_change_the_answers_are_new(name: str) -> None:
    world = gas(200, leaf_capacity=16, walls=[[(3, 1), (4, 9)]])
    before = answers(world)
    CHANGES[name](world)
    again = jostle.World.restore(world.snapshot())
    for found, expected in zip(answers(world), answers(again), strict=True):
        np.testing.assert_array_equal(found, expected)
    assert are_equal(before, answers(world)) == (name in ("set velocities", "forces"))


def test_queries_find_those_that_sleep_and_those_that_woke() -> None:
    places, options = [(3 * k, 1) for k in range(30)], {"gravity": (0, -9.8), "restitution": 0.25}
    world = jostle.World(places, 1.0, period=90, **options)
    world.walls.add(((0, 0), (45, 0)))
    world.walls.add(((45, 0), (90, 0)))
    world.step(1 / 60, steps=120)
    assert world.asleep.all()
    for woken in ([], [3], [7, 8, 29]):
        world.set(woken, velocities=(0, 2))
        assert world.asleep.sum() == 30 - len(woken) - (1 if len(woken) == 3 else 0)
        for _ in range(2):  # in the trees of sleepers, then in that of all
            assert world.query_rect((-2, -1, 200, 9)).tolist() == list(range(30))
            found = world.query_circle(world.positions, 0.5)
            assert [ids.tolist() for ids in found] == [[row] for row in range(30)]
            near = world.nearest(world.positions + np.array([0.1, 0]), 2)
            np.testing.assert_array_equal(near.ids[:, 0], range(30))
            np.testing.assert_array_equal(near.ids[:, 1], np.roll(range(30), -1))
            hits = world.raycast_all((-1.4, 1.1), (1, 0), max_distance=89)
            assert hits.ids.tolist() == [*range(30)] and (hits.walls == -1).all()
            excluded = world.raycast((-1.4, 1.1), [(1, 0)] * 2, max_distance=89, exclude=[0, 1])
            assert excluded.ids.tolist() == [1, 0]
            assert len(world.pairs()) == 0


def test_a_period_is_assigned() -> None:
    world = jostle.World([(0.5, 0.5), (9.5, 0.5)], 0.6)
    assert len(world.pairs()) == 0
    world.period = 10
    assert world.pairs().tolist() == [[0, 1]]
    world.period = None
    assert len(world.pairs()) == 0


def test_merged_particles_answer_once() -> None:
    world = jostle.World([(0, 0), (1, 0), (9, 0)], 0.6, on_touch="merge")
    assert world.pairs().tolist() == [[0, 1]]
    world.step(0.1)
    assert len(world.pairs()) == 0 and world.query_circle((0, 0), 2).tolist() == [0]
    assert world.raycast((20, 0), (-1, 0)).id == 2


def test_removed_ids_are_not_found() -> None:
    world = jostle.World([(0, 0), (5, 0), (9, 0)], 1.0)
    assert world.query_circle((0, 0), 2).tolist() == [0]
    world.remove(0)
    assert len(world.query_circle((0, 0), 2)) == 0
    assert world.query_circle((9, 0), 0.5, exclude=0).tolist() == [2]
    assert world.raycast((-9, 0), (1, 0), exclude=0).id == 1
    assert world.raycast((-9, 0), (1, 0), exclude=1).id == 2
    assert world.nearest((0, 0), 3, exclude=0).ids.tolist() == [1, 2, -1]
    assert [row.tolist() for row in world.neighbors(3.0)] == [[2], [1]]


NAN = float("nan")
REFUSED: list[tuple[str, Callable[[jostle.World], Any]]] = [
    (r"^point is \(NaN, 0\)", lambda world: world.query_point((NAN, 0))),
    (r"^rect", lambda world: world.query_rect((0, NAN, 1, 1))),
    (r"^radius", lambda world: world.query_circle((0, 0), NAN)),
    (r"^vertices", lambda world: world.query_polygon([(0, 0), (1, 0), (0, NAN)])),
    (r"^point", lambda world: world.nearest((0, NAN))),
    (r"^max_distance", lambda world: world.nearest((0, 0), max_distance=NAN)),
    (r"^origin", lambda world: world.raycast((NAN, 0), (1, 0))),
    (r"^direction", lambda world: world.raycast((0, 0), (NAN, 0))),
    (r"^direction", lambda world: world.raycast_all((0, 0), (0, 0))),
    (r"^max_distance", lambda world: world.raycast((0, 0), (1, 0), max_distance=-1)),
    (r"^radii", lambda world: world.shape_cast((0, 0), (1, 0), radii=NAN)),
    (r"^distance", lambda world: world.neighbors(NAN)),
    (r"^distance", lambda world: world.pairs(distance=-1)),
    (r"^max_pairs", lambda world: world.contacts(max_pairs=-1)),
    (r"^mask", lambda world: world.pairs(mask=2**32)),
    (r"^point is \(NaN, 0\)", lambda world: world.walls.query_point((NAN, 0))),
    (r"^origin", lambda world: world.walls.raycast((NAN, 0), (1, 0))),
    (r"^direction", lambda world: world.walls.raycast_all((0, 0), (0, 0))),
    (r"^radii", lambda world: world.walls.shape_cast((0, 0), (1, 0), radii=-1)),
    (r"^k", lambda world: world.walls.nearest((0, 0), 0)),
]


@pytest.mark.parametrize(("message", "ask"), REFUSED)
def test_wrong_arguments_are_refused(message: str, ask: Callable[[jostle.World], Any]) -> None:
    world = jostle.World([(0, 0), (1, 0)], 1.0)
    before = world.state_hash()
    with pytest.raises(ValueError, match=message):
        ask(world)
    assert world.state_hash() == before


def test_queries_change_no_step() -> None:
    asked, alone = gas(300), gas(300)
    for _ in range(5):
        answers(asked)
        assert asked.snapshot() == alone.snapshot()
        asked.step(0.05)
        alone.step(0.05)
    assert asked.state_hash() == alone.state_hash()


@pytest.mark.parametrize("threads", [1, 2, 8])
def test_threads_change_no_answer(threads: int) -> None:
    one, many = gas(2000, threads=1), gas(2000, threads=threads)
    for found, expected in zip(answers(many), answers(one), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_queries_while_another_thread_steps() -> None:
    world, expected = gas(500), gas(500)
    stepping = threading.Thread(target=lambda: [world.step(0.01) for _ in range(30)])
    stepping.start()
    while stepping.is_alive():
        hits = world.raycast((5, 5), np.random.default_rng(1).normal(size=(50, 2)))
        assert np.isfinite(hits.distances[hits.ids >= 0]).all()
        world.pairs()
    stepping.join()
    expected.step(0.01, steps=30)
    assert world.state_hash() == expected.state_hash()


def test_a_copy_has_the_same_answers() -> None:
    world = gas(100)
    before = answers(world)
    world_copy = jostle.World.restore(world.snapshot())
    world.step(1.0)
    assert are_equal(answers(world_copy), before)


def indices_of_four() -> list[Any]:
    """Return all classes that answer queries, with four shapes along the x axis."""
    places = [(3.0 * k, 0.0) for k in range(4)]
    space = jostle.Space()
    space.add(places, 1.0)
    world = jostle.World(places, 1.0)
    world.walls.add([((x, -1), (x, 1)) for x, _ in places])
    return [jostle.Quadtree(places, 1.0), space, world, world.walls]


QUERIES: dict[str, Any] = {
    "nearest": lambda of, **more: of.nearest((0, 0), 4, **more).ids,
    "query_circle": lambda of, **more: of.query_circle((0, 0), 20, **more),
    "query_rect": lambda of, **more: of.query_rect((-9, -9, 20, 9), **more),
    "query_polygon": lambda of, **more: of.query_polygon(
        [(-9, -9), (20, -9), (20, 9), (-9, 9)], **more
    ),
    "raycast": lambda of, **more: [of.raycast((-5, 0), (1, 0), **more).id],
    "raycast_all": lambda of, **more: of.raycast_all((-5, 0), (1, 0), **more).ids,
    "shape_cast": lambda of, **more: [of.shape_cast((-5, 0), (1, 0), radii=0.5, **more).id],
}


@pytest.mark.parametrize("query", QUERIES)
def test_an_id_that_nothing_has_excludes_nothing(query: str) -> None:
    """-1 above all, and ids that were removed: the owner of a bullet may be gone."""
    for of in indices_of_four():
        if not hasattr(of, query):
            continue
        if hasattr(of, "remove"):
            of.remove(2)
        ask = QUERIES[query]
        every = list(ask(of))
        assert 0 in every
        for nothing in (None, -1, -2, -7, 2, 99, 2**62):
            if not (nothing == 2 and isinstance(of, jostle.Quadtree)):
                assert list(ask(of, exclude=nothing)) == every, (of, nothing)
        assert 0 not in list(ask(of, exclude=0)), of
        with pytest.raises(ValueError, match=r"^exclude has 2 ids; it must be one id, as there is"):
            ask(of, exclude=[0, 1])
        with pytest.raises(jostle.IdError, match=f"^exclude is {2**70}; no shape has this id"):
            ask(of, exclude=2**70)
