"""Contacts and events of worlds by the categories of particles and walls."""

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from results import chosen

import jostle

NAMES = ("entered", "stayed", "exited")


def gas(seed: int, **options: Any) -> jostle.World:
    """Return discs with friction and categories, among walls with categories, in a box."""
    draw = np.random.default_rng(seed)
    at = np.mgrid[0:12, 0:12].reshape(2, -1).T * 2.2 + 1.5
    walls = {"segments": draw.uniform(0, 28, (9, 2, 2)), "categories": draw.integers(1, 8, 9)}
    return jostle.World(
        at + draw.uniform(-0.1, 0.1, at.shape), 1.0, velocities=draw.normal(0, 9, at.shape),
        friction=0.4, angular_velocities=draw.normal(0, 3, len(at)),
        categories=draw.integers(0, 8, len(at)), container=jostle.Box(0, 0, 28, 28), walls=walls,
        track_events=True, **options,
    )  # fmt: skip


def rows_between(whole: Any, a: int, b: int) -> tuple[list[int], list[list[int]], np.ndarray]:
    """Return the rows of contacts that should be kept, their pairs, and which are turned."""
    every = zip(whole.pairs.tolist(), whole.categories.tolist(), strict=True)
    found = [(row, chosen(pair, both, a, b)) for row, (pair, both) in enumerate(every)]
    kept = [(row, pair) for row, pair in found if pair]
    rows, pairs = [row for row, _ in kept], [pair for _, pair in kept]
    return rows, pairs, np.array([pair != whole.pairs[row].tolist() for row, pair in kept], bool)


@given(seed=st.integers(0, 3), a=st.integers(0, 7), b=st.integers(-8, 7))
def test_contacts_of_particles_between_categories(seed: int, a: int, b: int) -> None:
    world = gas(seed)
    world.step(0.05, 3)
    whole = world.last_step.contacts
    assert len(whole.pairs) > 10
    np.testing.assert_array_equal(whole.categories, world.categories[world.rows(whole.pairs)])
    before = copy.deepcopy(whole)
    part = whole.between(a, b)
    assert whole == before and type(part) is jostle.WorldContacts
    rows, pairs, turned = rows_between(whole, a, b)
    assert part.pairs.tolist() == pairs
    signs = np.where(turned, -1.0, 1.0)[:, None]
    np.testing.assert_array_equal(part.normals, whole.normals[rows] * signs)
    np.testing.assert_array_equal(part.categories, world.categories[world.rows(part.pairs)])
    for name in ("depths", "normal_impulses", "friction_impulses"):
        np.testing.assert_array_equal(getattr(part, name), getattr(whole, name)[rows])


def test_impulses_of_turned_contacts_are_on_the_second_particle() -> None:
    """The momentum of the second particle changes by what its definition says."""
    world = jostle.World(
        [(0, 0), (3, 0)], 1.0, velocities=[(2, 0), (0, 0)], angular_velocities=[4, 0],
        friction=0.5, categories=[2, 4],
    )  # fmt: skip
    before = world.velocities
    world.step(0.5001)  # they touch after half a second, so the normal is still that of then
    whole = world.last_step.contacts
    for contacts, second in ((whole, 1), (whole.between(2, 4), 1), (whole.between(4, 2), 0)):
        assert contacts.pairs.tolist() == [[1 - second, second]]
        (x, y), friction = contacts.normals[0], contacts.friction_impulses[0]
        assert abs(friction) > 0.1
        impulse = contacts.normal_impulses[0] * np.array([x, y]) + friction * np.array([-y, x])
        change = (world.velocities - before)[second] * world.masses[second]
        np.testing.assert_allclose(change, impulse, atol=1e-3)


@given(seed=st.integers(0, 3), a=st.integers(0, 7), b=st.integers(-8, 7))
def test_contacts_with_walls_between_categories(seed: int, a: int, b: int) -> None:
    world = gas(seed)
    world.step(0.05, 3)
    whole = world.last_step.wall_contacts
    sides = whole.walls < 0
    assert sides.any() and not sides.all()
    expected = np.ones((len(sides), 2), np.uint32)  # that of sides
    expected[:, 0] = world.categories[world.rows(whole.ids)]
    expected[~sides, 1] = world.walls.categories[world.walls.rows(whole.walls[~sides])]
    np.testing.assert_array_equal(whole.categories, expected)
    part = whole.between(a, b)
    assert type(part) is jostle.WallContacts
    rows = [row for row, (own, of) in enumerate(whole.categories.tolist()) if own & a and of & b]
    for name, column in whole.to_dict().items():
        np.testing.assert_array_equal(getattr(part, name), column[rows])


def test_sleepers_and_pairs_that_overlap_have_categories() -> None:
    world = jostle.World(
        [(0, 1), (0, 3), (9, 1), (9, 3)], 1.0, gravity=(0, -9), restitution=0.0,
        container=jostle.Box(-20, 0, 20, 20), categories=[2, 4, 4, 2],
    )  # fmt: skip
    world.step(1 / 60, 200)
    assert world.asleep.all()
    contacts = world.last_step.contacts
    assert contacts.between(4, 2).pairs.tolist() == [[1, 0], [2, 3]]
    assert contacts.between(6, 6).pairs.tolist() == contacts.pairs.tolist()
    assert world.last_step.wall_contacts.categories.tolist() == [[2, 1], [4, 1]]
    world.set(3, categories=8)
    assert world.last_step.contacts.between(8, 4).pairs.tolist() == [[3, 2]]
    apart = jostle.World([(0, 0), (1, 0)], 1.0, categories=[4, 2], on_touch="ignore")
    overlaps = apart.last_step.contacts.between(2, 4)
    assert overlaps.pairs.tolist() == [[1, 0]] and overlaps.normals.tolist() == [[-1, 0]]


def check_events(events: Any, categories: dict[int, int], a: int, b: int) -> int:
    """Compare with a choice of the pairs one after the other; return how many are kept."""
    part, kept = events.between(a, b), 0
    assert type(part) is type(events)
    for name in NAMES:
        pairs = getattr(events, name).tolist()
        bits = [[categories[id] for id in pair] for pair in pairs]
        assert getattr(events, f"{name}_categories").tolist() == bits, name
        if isinstance(events, jostle.WallEvents):
            found: Any = [
                pair for pair, (own, of) in zip(pairs, bits, strict=True) if own & a and of & b
            ]
        else:
            every = (chosen(pair, both, a, b) for pair, both in zip(pairs, bits, strict=True))
            found = [pair for pair in every if pair]
        assert getattr(part, name).tolist() == found, name
        own = [[categories[id] for id in pair] for pair in found]
        assert getattr(part, f"{name}_categories").tolist() == own, name
        kept += len(found)
    return kept


@pytest.mark.parametrize("on_touch", ["bounce", "ignore"])
def test_events_between_categories(on_touch: str) -> None:
    """Also of particles that are removed before or after the call, and of snapshots."""
    world, seen = gas(1, on_touch=on_touch), 0
    categories: dict[int, int] = {}
    draw = np.random.default_rng(5)
    for call in range(12):
        # Of particles that are removed before the call, those that they had then.
        categories |= dict(zip(world.ids.tolist(), world.categories.tolist(), strict=True))
        if call % 3 == 2:
            world.remove(world.ids[:: 9 + call])
        elif call % 3 == 1:
            changed = world.ids[::4]
            world.set(changed, categories=draw.integers(0, 8, len(changed)))
            world.step(1e-9)
            categories |= dict(zip(world.ids.tolist(), world.categories.tolist(), strict=True))
        world.step(0.03, 2)
        events = world.events
        world.remove(world.ids[: call + 1])
        assert world.events == events == jostle.World.restore(world.snapshot()).events
        assert pickle.loads(pickle.dumps(events)) == events
        for a, b in ((1, 2), (2, 1), (3, 5), (7, 7), (0, 7), (~1, 1)):
            seen += check_events(events, categories, a, b)
    assert seen > 500


def test_events_of_walls_between_categories() -> None:
    world, seen = gas(2), 0
    walls: dict[int, int] = {}
    for _ in range(8):
        world.step(1e-9)
        walls |= dict(zip(world.walls.ids.tolist(), world.walls.categories.tolist(), strict=True))
        world.step(0.03, 2)
        events = world.wall_events
        for name in NAMES:
            pairs = getattr(events, name)
            own = world.categories[world.rows(pairs[:, 0])].tolist()
            of = [walls.get(wall, 1) for wall in pairs[:, 1].tolist()]
            found = getattr(events, f"{name}_categories").tolist()
            assert found == [list(both) for both in zip(own, of, strict=True)], name
            for a, b in ((1, 2), (3, 4), (7, 1)):
                rows = [row for row, (one, wall) in enumerate(found) if one & a and wall & b]
                part = events.between(a, b)
                assert getattr(part, name).tolist() == pairs[rows].tolist()
                seen += len(rows)
        if len(world.walls) > 5:
            world.walls.remove(world.walls.ids[1])
            world.walls.categories = (world.walls.categories + 1) % 8
    assert seen > 100


def test_a_removed_pair_has_the_categories_that_it_had() -> None:
    """The call after the removal has them among those that exited."""
    world = jostle.World([(0, 0), (1, 0), (9, 0)], 1.0, categories=[4, 2, 8], track_events=True)
    world.walls.add([((-1, -5), (-1, 5))], categories=16)
    world.step(1e-6)
    world.remove(0)
    world.walls.remove(0)
    for kind, bits in (("events", (2, 4)), ("wall_events", (4, 16))):
        assert len(getattr(world, kind).between(*bits).entered) == 1
    world.step(1e-6)
    assert world.events.between(2, 4).exited.tolist() == [[1, 0]]
    assert world.wall_events.between(4, 16).exited.tolist() == [[0, 0]]


def test_merged_particles_have_the_categories_of_then() -> None:
    world = jostle.World(
        [(0, 0), (3, 0), (8, 0)], 1.0, velocities=[(9, 0), (0, 0), (0, 0)], categories=[4, 2, 8],
        on_touch="merge", track_events=True,
    )  # fmt: skip
    world.step(0.2, 10)
    assert world.ids.tolist() == [0] and world.categories.tolist() == [14]
    events = world.events
    assert events.between(2, 4).entered.tolist() == [[1, 0]]
    # The first two were one particle when the third touched it.
    assert events.between(8, 2).entered.tolist() == [[2, 0]]


@pytest.mark.parametrize("kind", ["contacts", "wall_contacts", "events", "wall_events"])
def test_categories_are_sets_of_bits(kind: str) -> None:
    world = gas(0)
    world.step(0.01)
    whole = getattr(world if "events" in kind else world.last_step, kind)
    for wrong in (1.5, "a", None, True, [1]):
        with pytest.raises(TypeError, match=r"^b must be an integer"):
            whole.between(1, wrong)
    for wrong in (1 << 32, -(1 << 32) - 1):
        with pytest.raises(ValueError, match=r"^a is -?\d+; it must be a set of 32"):
            whole.between(wrong, 1)
