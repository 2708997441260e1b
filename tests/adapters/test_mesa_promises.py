"""What Mesa's own tests check of its continuous space holds in `jostle.mesa` too.

The tests are written anew after the subjects of Mesa's `tests/test_continuous_space.py`: bounds,
the torus, agents that are added and removed, distances, differences and neighbours. Each runs on
both spaces.
"""

import random
from typing import Any

import mesa
import numpy as np
import pytest
from mesa.experimental.continuous_space import ContinuousSpace as MesaSpace
from mesa.experimental.continuous_space import ContinuousSpaceAgent

from jostle.mesa import ContinuousSpace

UNIT = [[0, 1], [0, 1]]
on_both = pytest.mark.parametrize("kind", [MesaSpace, ContinuousSpace], ids=["Mesa", "jostle"])


def space_of(kind: Any, dimensions: Any = UNIT, *, torus: bool = False, n_agents: int = 100) -> Any:
    return kind(dimensions, torus=torus, random=random.Random(7), n_agents=n_agents)


def agents_at(space: Any, *positions: Any) -> list[Any]:
    model, agents = mesa.Model(seed=7), []
    for position in positions:
        agents.append(ContinuousSpaceAgent(space, model))
        agents[-1].position = position
    return agents


@on_both
@pytest.mark.parametrize("dimensions", [[[0, 1], [-1, 0]], [[0, 2], [-2, 0], [-2, 2]]])
def test_bounds_are_those_of_the_dimensions(kind: Any, dimensions: Any) -> None:
    space, sides = space_of(kind, dimensions), np.array(dimensions, float)
    assert space.ndims == len(sides) and len(space.agents) == 0
    np.testing.assert_array_equal(space.size, sides[:, 1] - sides[:, 0])
    np.testing.assert_array_equal(space.center, sides.mean(axis=1))
    assert (space.x_min, space.x_max, space.y_min, space.y_max) == tuple(sides[:2].ravel())
    assert (space.width, space.height) == tuple(space.size[:2])
    assert space.in_bounds(space.center) and space.in_bounds(sides[:, 0])
    for axis in range(len(sides)):
        for beyond in (sides[axis, 0] - 0.5, sides[axis, 1] + 0.5):
            outside = space.center.astype(float)
            outside[axis] = beyond
            assert not space.in_bounds(outside)


@on_both
def test_a_torus_moves_positions_inside_and_without_one_they_are_refused(kind: Any) -> None:
    space = space_of(kind, [[0, 1], [-1, 0]], torus=True)
    for turns in ((0, 0), (-1, 1), (1, 0), (0, -1), (3, -2)):
        moved = space.torus_correct(np.array([0.5, -0.75]) + turns)
        np.testing.assert_array_equal(moved, [0.5, -0.75])
    (agent,) = agents_at(space, (1.25, -1.25))
    np.testing.assert_array_equal(agent.position, [0.25, -0.25])
    np.testing.assert_array_equal(agent.pos, agent.position)
    (agent,) = agents_at(space_of(kind), (0.5, 0.5))
    with pytest.raises(ValueError, match="outside the bounds"):
        agent.position = (0.5, 1.5)
    np.testing.assert_array_equal(agent.position, [0.5, 0.5])


@on_both
@pytest.mark.parametrize("torus", [False, True])
def test_positions_follow_agents_that_are_added_and_removed(kind: Any, torus: bool) -> None:
    """More than the expected number, then fewer, until there is none."""
    space, rng = space_of(kind, torus=torus, n_agents=4), np.random.default_rng(1)
    placed = {}
    for count in (3, 40):
        for agent in agents_at(space, *rng.random((count, 2))):
            placed[agent] = agent.position.tolist()
        assert space.agent_positions.shape == (len(placed), 2)
        assert [agent.position.tolist() for agent in space.agents] == list(placed.values())
    order = list(placed)
    rng.shuffle(order)
    for left, agent in zip(range(len(order) - 1, -1, -1), order, strict=True):
        near, distances = space.get_agents_in_radius(placed.pop(agent), 0.0)
        assert near == [agent] and distances.tolist() == [0.0]
        agent.remove()
        assert agent.space is None
        assert space.agent_positions.shape == (left, 2) and len(space.agents) == left
        assert [one.position.tolist() for one in space.agents] == list(placed.values())


@on_both
def test_a_position_is_a_view_and_the_array_another(kind: Any) -> None:
    space = space_of(kind, [[0, 9], [0, 9]])
    first, second = agents_at(space, (1, 1), (2, 2))
    first.position += (1, 2)
    space.agent_positions[1] = (5, 5)
    assert first.position.tolist() == [2, 3] and second.position.tolist() == [5, 5]
    assert space.get_agents_in_radius((5, 5), 0.1)[0] == [second]


@on_both
@pytest.mark.parametrize(
    ("torus", "point", "distance"),
    [
        (False, (0.1, 0.9), 0.8),
        (False, (0.9, 0.1), 0.8),
        (False, (0.9, 0.9), 0.8 * 2**0.5),
        (True, (0.1, 0.9), 0.2),
        (True, (0.9, 0.1), 0.2),
        (True, (0.9, 0.9), 0.2 * 2**0.5),
    ],
)
def test_distances_and_differences(
    kind: Any, torus: bool, point: tuple[float, float], distance: float
) -> None:
    space = space_of(kind, torus=torus)
    agent, other = agents_at(space, (0.1, 0.1), (0.5, 0.5))
    distances, agents = space.calculate_distances(point)
    assert distances[0] == pytest.approx(distance) and list(agents) == [agent, other]
    some, agents = space.calculate_distances(point, agents=[agent])
    assert some.tolist() == distances[:1].tolist() and list(agents) == [agent]
    differences = space.calculate_difference_vector(np.array(point))
    np.testing.assert_allclose(np.hypot(*differences.T), distances)
    moved = np.array(point) + differences[0]
    np.testing.assert_allclose(space.torus_correct(moved) if torus else moved, agent.position)
    some = space.calculate_difference_vector(np.array(point), agents=[other])
    np.testing.assert_array_equal(some, differences[1:])


@on_both
def test_neighbors_within_a_radius_and_the_nearest(kind: Any) -> None:
    space = space_of(kind, [[0, 10], [0, 10]], torus=True)
    agents = agents_at(space, (5, 5), (6, 5), (5, 8), (0.5, 5), (9.5, 5))
    near, distances = agents[0].get_neighbors_in_radius(3.0)
    assert near == agents[1:3] and distances.tolist() == [1.0, 3.0]
    near, distances = agents[3].get_neighbors_in_radius(1.0)
    assert near == [agents[4]] and distances.tolist() == [1.0]
    assert agents[3].get_neighbors_in_radius(0.5)[0] == []
    near, distances = agents[0].get_nearest_neighbors(2)
    assert set(near) == set(agents[1:3]) and sorted(distances) == [1.0, 3.0]
    near, distances = space.get_k_nearest_agents((9.9, 5), 2)
    assert set(near) == set(agents[3:]) and sorted(distances) == pytest.approx([0.4, 0.6])
    near, distances = space.get_agents_in_radius((5, 5), 0.0)
    assert near == [agents[0]] and distances.tolist() == [0.0]
