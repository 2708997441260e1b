"""Trees, spaces and events that are pickled or copied answer as before."""

from typing import Any

import numpy as np
import pytest
from copies import WAYS
from hypothesis import given
from hypothesis import strategies as st

import jostle


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_trees(way: Any, dtype: Any) -> None:
    rng = np.random.default_rng(4)
    centers = rng.uniform(0, 30, (300, 2)).astype(dtype)
    sizes = rng.uniform(0, 1, (300, 2)).astype(dtype)
    for arguments in (
        {"positions": centers, "radii": sizes[:, 0]},
        {"positions": centers, "half_sizes": sizes, "categories": np.arange(300), "masks": 3},
        {"boxes": np.hstack([centers, centers + sizes]), "radii": sizes[:, 1], "period": (0, 31)},
        {"positions": centers[:0]},
    ):
        tree = jostle.Quadtree(**arguments, leaf_capacity=7, max_depth=5, threads=1)
        twin = way(tree)
        assert repr(twin) == repr(tree)
        assert twin.period == tree.period
        for name in ("boxes", "radii", "categories", "masks"):
            assert np.array_equal(getattr(twin, name), getattr(tree, name))
            assert getattr(twin, name).dtype == getattr(tree, name).dtype
        assert np.array_equal(twin.pairs(), tree.pairs())
        assert np.array_equal(twin.nodes().boxes, tree.nodes().boxes)


@given(
    st.lists(st.sampled_from(["add", "move", "remove", "update", "boxes"]), max_size=30), st.data()
)
def test_spaces(acts: list[str], data: Any) -> None:
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    period = data.draw(st.sampled_from([None, 9.0]))
    spaces = [jostle.Space(period=period)]
    for act in [*acts, "update", "twins", "move", "update", "add", "remove", "update", "update"]:
        chosen = rng.permutation(spaces[0].ids.copy())[: len(spaces[0]) // 2]
        places = rng.uniform(0, 12, (max(len(chosen), 5), 2))
        if act == "twins":
            spaces += [way(spaces[0]) for way in WAYS]
        results = []
        for space in spaces:
            if act == "add":
                results.append(space.add(places, radii=0.5, categories=3))
            elif act == "boxes":
                results.append(space.add(boxes=np.hstack([places, places + 1])))
            elif act == "move":
                space.set(chosen, positions=places[: len(chosen)])
            elif act == "remove":
                space.remove(chosen)
            elif act == "update":
                events = space.update()
                results.append(np.vstack([events.entered, events.stayed, events.exited]))
        for found in results[1:]:
            assert np.array_equal(found, results[0])
    for space in spaces[1:]:
        assert np.array_equal(space.ids, spaces[0].ids)
        assert np.array_equal(space.boxes, spaces[0].boxes)
        assert np.array_equal(space.pairs(sort=True), spaces[0].pairs(sort=True))
        assert (space.dtype, space.period) == (spaces[0].dtype, spaces[0].period)


def test_a_copy_is_independent() -> None:
    space = jostle.Space()
    space.add([(0, 0), (1, 0)], radii=1.0)
    for way in WAYS:
        twin = way(space)
        twin.remove(0)
        assert len(twin) == 1
    assert len(space) == 2


@pytest.mark.parametrize("way", WAYS)
def test_events(way: Any) -> None:
    space = jostle.Space()
    ids = space.add([(0, 0), (1, 0), (2, 0)], radii=0.75)
    space.update()
    space.set(ids[2], positions=(9, 9))
    events = space.update()
    twin = way(events)
    space.update()
    for name in ("entered", "stayed", "exited"):
        assert np.array_equal(getattr(events, name), getattr(twin, name))
    assert repr(twin) == repr(events)


def test_states_that_no_space_can_have_are_refused() -> None:
    space = jostle.Space()
    space.add([(0, 0), (1, 0)], radii=1.0)
    space.update()
    space.remove(1)
    restore, (options, state) = space.__reduce__()
    for place, value in (
        (0, np.zeros((1, 4))),
        (1, np.array([-1.0, 1.0])),
        (4, np.array([0, 1], np.uint32)),
        (5, np.array([7], np.uint32)),
        (6, np.array([1])),
        (6, np.array([0, 0])),
        (6, np.array([1 << 40])),
        (7, np.array([0, 9], np.uint32)),
        (7, np.array([1, 1], np.uint32)),
        (9, np.array([0], np.uint32)),
    ):
        wrong = (*state[:place], value, *state[place + 1 :])
        with pytest.raises(ValueError, match="state"):
            restore(options, wrong)
    assert len(restore(options, state)) == 1


def test_hits_keep_all_fields() -> None:
    tree = jostle.Quadtree(boxes=[(0, 0, 1, 1)])
    hit, hits = tree.raycast((-2, 0.5), (1, 0)), tree.raycast([(-2, 0.5)], (1, 0))
    for way in WAYS:
        assert way(hit) == hit and way(hits) == hits
        assert way(hit).normal.tolist() == [-1.0, 0.0]
        assert way(hits).normals.tolist() == [[-1.0, 0.0]]
