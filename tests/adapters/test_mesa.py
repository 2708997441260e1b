"""`jostle.mesa` beside Mesa's own continuous space: the same agents, in the same order."""

import copy
import random
from typing import Any

import mesa
import numpy as np
import pytest
from copies import by_pickle
from hypothesis import given
from hypothesis import strategies as st
from mesa.experimental.continuous_space import ContinuousSpace as MesaSpace
from mesa.experimental.continuous_space import ContinuousSpaceAgent

from jostle.mesa import ContinuousSpace

DIMENSIONS = [[-5.0, 15.0], [0.0, 10.0]]


class Twins:
    """The same agents in a space of Mesa and in one of jostle."""

    def __init__(self, torus: bool, places: Any = (), dimensions: Any = DIMENSIONS) -> None:
        self.spaces = [
            kind(dimensions, torus=torus, random=random.Random(1), n_agents=3)
            for kind in (MesaSpace, ContinuousSpace)
        ]
        self.models = [mesa.Model(seed=1) for _ in self.spaces]
        self.agents: list[list[Any]] = [[], []]
        for place in places:
            self.add(place)

    def add(self, position: Any) -> None:
        for space, model, agents in zip(self.spaces, self.models, self.agents, strict=True):
            agent = ContinuousSpaceAgent(space, model)
            agent.position = position
            agents.append(agent)

    def answers(self, query: str, *arguments: Any) -> list[tuple[list[int], list[float]]]:
        """Return the numbers of the agents that each space finds, and their distances."""
        found = []
        for space, own in zip(self.spaces, self.agents, strict=True):
            agents, distances = getattr(space, query)(*arguments)
            found.append(([own.index(agent) for agent in agents], distances.tolist()))
        return found

    def agree(self, point: Any, radius: float, k: int) -> None:
        found = self.answers("get_agents_in_radius", point, radius)
        assert found[0] == found[1]
        if not 0 < k < len(self.agents[0]):
            return
        nearest = self.answers("get_k_nearest_agents", point, k)
        # Mesa's order is not specified; at equal distances any of the agents may be in it.
        assert sorted(nearest[0][1]) == nearest[1][1]
        if len(set(nearest[1][1])) == k and k + 1 < len(self.agents[0]):
            more = self.spaces[1].get_k_nearest_agents(point, k + 1)[1]
            if more[k] > more[k - 1]:
                assert sorted(nearest[0][0]) == sorted(nearest[1][0])


coordinates = st.one_of(
    st.integers(-5, 15).map(float), st.floats(-5, 15), st.just(15.0), st.just(-5.0)
)
points = st.tuples(coordinates, st.one_of(st.integers(0, 10).map(float), st.floats(0, 10)))


@given(
    st.booleans(),
    st.lists(points, max_size=25),
    st.lists(
        st.tuples(
            st.sampled_from(["place", "add", "both", "item", "many", "remove", "look"]),
            st.integers(0, 99),
            points,
        ),
        max_size=20,
    ),
    st.sampled_from([0.0, 1.0, 2.5, 5.0, 30.0, np.inf]),
    st.integers(1, 6),
)
def test_the_same_agents(
    torus: bool, places: list[Any], acts: list[Any], radius: float, k: int
) -> None:
    twins = Twins(torus, places)
    for act, which, place in acts:
        count = len(twins.agents[0])
        if act == "add" or not count:
            twins.add(place)
            continue
        row = which % count
        for space, agents in zip(twins.spaces, twins.agents, strict=True):
            if act == "place":
                agents[row].position = place
            elif act == "both":
                agents[row].position *= 0.5
            elif act == "item":
                agents[row].position[0] = place[0]
            elif act == "many":
                space.agent_positions[[row, 0]] = place
            elif act == "remove":
                agents.pop(row).remove()
        if twins.agents[0]:
            twins.agree(place, radius, k)
            own = [agents[-1].position for agents in twins.agents]
            assert own[0].tolist() == own[1].tolist()
            twins.agree(own[0], radius, k)
            near = [agents[-1].get_neighbors_in_radius(radius)[1] for agents in twins.agents]
            assert near[0].tolist() == near[1].tolist()


def test_points_and_positions_outside_and_three_dimensions() -> None:
    for torus in (False, True):
        twins = Twins(torus, [(0, 1), (14, 9), (3, 3)])
        for x in (40.0, 4.0, np.nan):
            for space in twins.spaces:
                space.agent_positions[1] = (x, 3.0)
            for point in ((3.0, 3.0), (-20.0, 5.0), (200.0, 1.0)):
                twins.agree(point, 4.0, 1)
    twins = Twins(True, np.random.default_rng(1).random((20, 3)), [[0, 1], [0, 1], [0, 1]])
    twins.agree(np.array([0.1, 0.9, 0.5]), 0.4, 3)


def test_refresh_after_a_function_with_an_output() -> None:
    twins = Twins(True, [(float(x), 1.0) for x in range(5)])
    twins.agree((0.0, 1.0), 2.0, 2)
    for space in twins.spaces:
        np.add(space.agent_positions, 3.0, out=space.agent_positions)
    twins.spaces[1].refresh()
    twins.agree((0.0, 4.0), 2.0, 2)


def test_the_flocking_example_of_mesa(monkeypatch: pytest.MonkeyPatch) -> None:
    from mesa.examples.basic.boid_flockers import model as flocking

    positions = []
    for space in (MesaSpace, ContinuousSpace):
        monkeypatch.setattr(flocking, "ContinuousSpace", space)
        model = flocking.BoidFlockers(population_size=60, width=30, height=30, vision=4, seed=5)
        for _ in range(10):
            model.step()
        positions.append(np.array([agent.position for agent in model.agents]))
    assert np.array_equal(*positions)


WRITES: dict[str, Any] = {
    "transposed": lambda p: p.T.__setitem__((slice(None), 1), 1.0),
    "unpacked": lambda p: next(iter(p.T)).__setitem__(slice(1, 3), 1.0),
    "flattened": lambda p: p.reshape(-1).__setitem__(slice(2, 4), 1.0),
    "ravelled": lambda p: p.ravel().__setitem__(slice(2, 4), 1.0),
    "viewed": lambda p: p.view().__setitem__(1, 1.0),
    "filled": lambda p: p[1].fill(1.0),
    "put": lambda p: p.put([2, 3], 1.0),
    "in place": lambda p: p.T.__imul__(0.5),
    "row of a slice": lambda p: p[1:][0].__setitem__(0, 1.0),
}


@pytest.mark.parametrize("write", WRITES.values(), ids=WRITES.keys())
def test_writes_to_views_are_detected(write: Any) -> None:
    twins = Twins(True, [(2.0 * x, 5.0) for x in range(6)])
    twins.agree((1.0, 1.0), 3.0, 2)
    for space in twins.spaces:
        write(space.agent_positions)
    twins.agree((1.0, 1.0), 3.0, 2)
    twins.agree((0.0, 5.0), 3.0, 2)


def test_results_of_arithmetic_are_not_positions() -> None:
    """Changing them does not change the space, so it moves nothing."""
    twins = Twins(True, [(2.0, 5.0)])
    space: Any = twins.spaces[1]
    space.get_agents_in_radius((2.0, 5.0), 1.0)
    offsets = space.agent_positions - 1.0
    offsets += 1.0
    twins.agents[1][0].position.copy()[:] = 0.0
    assert not space._all_moved and not space._moved


@pytest.mark.parametrize("copied", [copy.deepcopy, by_pickle])
def test_copies_notice_moved_agents(copied: Any) -> None:
    space = Twins(True, [(2.0 * x, 5.0) for x in range(4)]).spaces[1]
    space.get_agents_in_radius((2.0, 5.0), 1.0)
    other = copied(space)
    moved = other.active_agents[3]
    moved.position = (2.0, 5.5)
    assert other.get_agents_in_radius((2.0, 5.0), 1.0)[0] == [other.active_agents[1], moved]
    assert len(space.get_agents_in_radius((2.0, 5.0), 1.0)[0]) == 1
